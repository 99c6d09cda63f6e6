//! Clips: pieces of takes, from port to port.

use super::super::cut::Source;
use super::story::{Clip, Piece, bad};
use crate::Result;
use crate::motion::take::{TakeFile, TakePatch, TakePort};
use crate::motion::{FPS, Motion};

/// A clip's end moves to a port this near, seconds.
const NEAR: f32 = 0.25;
/// Names told where one is not known.
const TOLD: usize = 8;

/// A clip as captured, and the pose groups of its ends.
#[derive(Clone, Debug)]
pub(super) struct Cut {
    pub motion: Motion,
    pub entry: String,
    pub exit: String,
}

/// Cuts a clip out of its take. Its ends are the ports nearest to what is asked for.
pub(super) fn cut(clip: &Clip, sources: &[Source]) -> Result<Cut> {
    let (source, person, from, to) = match &clip.piece {
        Piece::Take { name, person, from, to } => {
            let known = sources.iter().map(|s| s.take.name.as_str());
            let found = sources.iter().find(|s| &s.take.name == name);
            (found.ok_or_else(|| unknown(clip, "a take", name, known))?, *person, *from, *to)
        }
        Piece::Patch { name, role } => of_patch(clip, name, *role, sources)?,
    };
    let Some(motion) = source.motions.get(person) else {
        let expected = format!("expected a person below {}", source.motions.len());
        return Err(bad(clip.line, format!("clip {}: {expected}, found {person}", clip.name)));
    };
    let ports: Vec<&TakePort> = source.take.ports.iter().filter(|p| p.person == person).collect();
    let end = |f32_max: bool| if f32_max { f32::INFINITY } else { 0.0 };
    let from = port(clip, &ports, from.unwrap_or(end(false)), from.is_some())?;
    let to = port(clip, &ports, to.unwrap_or(end(true)), to.is_some())?;
    let frame = |p: &TakePort| (p.time * FPS).round() as usize;
    let (begin, last) = (frame(from), frame(to));
    if begin + 2 > last || last >= motion.len() {
        let found = format!("{:.2} s to {:.2} s", from.time, to.time);
        let expected = format!("expected an end after its begin, within {:.2} s", (motion.len() - 1) as f32 / FPS);
        return Err(bad(clip.line, format!("clip {}: {expected}, found {found}", clip.name)));
    }
    if holds_prop(&source.take, person, from.time, to.time) {
        let problem = format!("clip {}: expected empty hands, found a prop in them", clip.name);
        return Err(bad(clip.line, problem));
    }
    Ok(Cut { motion: motion.slice(begin, last), entry: from.pose.clone(), exit: to.pose.clone() })
}

type Piecewise<'a> = (&'a Source, usize, Option<f32>, Option<f32>);

fn of_patch<'a>(clip: &Clip, name: &str, role: usize, sources: &'a [Source]) -> Result<Piecewise<'a>> {
    let mut all = sources.iter().flat_map(|s| s.take.patches.iter().map(move |p| (s, p)));
    let known = || sources.iter().flat_map(|s| s.take.patches.iter().map(|p: &TakePatch| p.name.as_str()));
    let (source, patch) = all.find(|(_, p)| p.name == name).ok_or_else(|| unknown(clip, "a patch", name, known()))?;
    let found = patch.roles.get(role).ok_or_else(|| {
        let expected = format!("expected a role below {}", patch.roles.len());
        bad(clip.line, format!("clip {}: {expected}, found {role}", clip.name))
    })?;
    Ok((source, found.person, Some(found.begin), Some(found.end)))
}

fn unknown<'a>(clip: &Clip, what: &str, found: &str, known: impl Iterator<Item = &'a str>) -> crate::Error {
    let mut known: Vec<&str> = known.collect();
    // The most alike first: people mistype.
    known.sort_by_key(|name| (std::cmp::Reverse(alike(name, found)), *name));
    known.truncate(TOLD);
    let problem =
        format!("clip {}: expected the name of {what} ({}, ...), found '{found}'", clip.name, known.join(", "));
    bad(clip.line, problem)
}

/// How many letters two names begin with alike.
fn alike(a: &str, b: &str) -> usize {
    a.chars().zip(b.chars()).take_while(|(a, b)| a == b).count()
}

/// The port nearest to a time; near enough if the time was asked for.
fn port<'a>(clip: &Clip, ports: &[&'a TakePort], time: f32, asked: bool) -> Result<&'a TakePort> {
    let away = |p: &TakePort| (p.time - time.min(f32::MAX)).abs();
    let nearest = ports.iter().min_by(|a, b| away(a).total_cmp(&away(b)).then(b.time.total_cmp(&a.time)));
    match nearest {
        Some(port) if !asked || away(port) <= NEAR => Ok(port),
        other => {
            let found = other.map_or("none at all".into(), |p| format!("the nearest at {:.2} s ({})", p.time, p.pose));
            let expected = format!("expected a port of the person within {NEAR} s of {time} s");
            Err(bad(clip.line, format!("clip {}: {expected}, found {found}", clip.name)))
        }
    }
}

fn holds_prop(take: &TakeFile, person: usize, from: f32, to: f32) -> bool {
    let held = take.props.iter().flat_map(|prop| &prop.held);
    held.into_iter().any(|h| h.person == person && h.begin < to && from < h.end)
}
