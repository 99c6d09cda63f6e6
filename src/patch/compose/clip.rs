//! Clips: pieces of takes, from port to port.

use super::super::cut::Source;
use super::edit::edit;
use super::story::{Clip, Piece, bad};
use crate::Result;
use crate::deform::Limits;
use crate::motion::take::{TakeFile, TakePatch, TakePort};
use crate::motion::{FPS, Motion, mirror};

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
    /// The boxes in the hands or under the hips, in order of time.
    pub grasps: Vec<Grasp>,
}

/// A time over which somebody holds a box, or sits on one.
#[derive(Clone, Debug)]
pub(super) struct Grasp {
    pub sits: bool,
    pub size: [f32; 3],
    pub grip: [f32; 2],
    /// How far ahead of a sitter's hips the middle of the box is, metres.
    pub seat: f32,
    /// First and last frame.
    pub span: [usize; 2],
    /// Whether it begins and ends there; else it is cut off.
    pub whole: [bool; 2],
    /// Which take's which prop it is, and the take's frames at which it begins and ends; none if no take knows of it.
    pub source: Option<([usize; 2], [usize; 2])>,
}

/// Boxes of clips may differ by this much, metres.
const ALIKE: f32 = 0.005;

impl Grasp {
    /// True if the box may be the same, and is held or sat on as well.
    pub fn is_like(&self, other: &Self) -> bool {
        let near = |(a, b): (&f32, &f32)| (a - b).abs() <= ALIKE;
        self.sits == other.sits
            && self.size.iter().zip(&other.size).all(near)
            && self.grip.iter().zip(&other.grip).all(near)
    }
}

/// Cuts a clip out of its take. Its ends are the ports nearest to what is asked for; its path leads where it is to.
pub(super) fn cut(clip: &Clip, sources: &[Source], limits: &Limits) -> Result<Cut> {
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
    let index = sources.iter().position(|s| std::ptr::eq(s, source)).unwrap_or(0);
    let grasps = grasps(&source.take, index, person, [begin, last]);
    let (motion, ends) = (motion.slice(begin, last), [&from.pose, &to.pose]);
    let [entry, exit] = ends.map(|pose| if clip.mirror { mirror::group(pose) } else { pose.clone() });
    Ok(Cut { motion: edit(clip, motion, limits)?, entry, exit, grasps })
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

/// The boxes that a person holds or sits on between two frames of the take.
fn grasps(take: &TakeFile, index: usize, person: usize, [begin, last]: [usize; 2]) -> Vec<Grasp> {
    let mut all = Vec::new();
    for (p, prop) in take.props.iter().enumerate() {
        let uses = prop.held.iter().map(|h| (h, false)).chain(prop.sat.iter().map(|s| (s, true)));
        for (hold, sits) in uses.filter(|(h, _)| h.person == person) {
            let [first, end] = [hold.begin, hold.end].map(|t| (t.max(0.0) * FPS).round() as usize);
            let (from, to) = (first.max(begin), end.min(last));
            if from < to {
                all.push(Grasp {
                    sits,
                    size: prop.size,
                    grip: prop.grip,
                    seat: prop.seat,
                    span: [from - begin, to - begin],
                    whole: [first > begin, end < last],
                    source: Some(([index, p], [first, end])),
                });
            }
        }
    }
    all.sort_by_key(|g| g.span);
    all
}
