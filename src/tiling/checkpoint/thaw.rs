//! From a checkpoint back to tracks. That the file is whole its digest says; here it is seen that it is a tiling: lives
//! hang together from the beginning of time to its end, and patches of several people are played by all of theirs at one
//! time and place. Who is in whose way is found out with the final bodies, as it is for every tiling.

use std::collections::BTreeMap;

use super::super::Scene;
use super::super::domain::Domain;
use super::super::library::Library;
use super::super::piece::Piece;
use super::super::tracks::Tracks;
use super::Checkpoint;
use super::lay::{Laid, Way};
use crate::geom::{Ground, wrap_angle};
use crate::{Error, Result};

/// Where a piece ends the next begins, this nearly, metres and radians; likewise the roles of one patch.
const NEAR: f32 = 0.01;
const TURNED: f32 = 0.01;

type Problem = String;

/// The tiling of a checkpoint in its scene, whose wishes may be others.
///
/// # Errors
/// Names person and piece, and what is wrong with them.
pub(in super::super) fn thaw<'a>(
    kept: &Checkpoint,
    scene: &Scene,
    library: &'a Library,
    domain: &'a Domain,
) -> Result<Tracks<'a>> {
    let place = |person: usize, k: usize| format!("person {person}, piece {k}");
    let bad = |place: String, problem: Problem| Error::invalid("checkpoint", place, problem);
    let kinds = kinds(kept, library)?;
    let mut tracks = Tracks::new(library, domain);
    let mut casts: BTreeMap<u32, Vec<Piece>> = BTreeMap::new();
    for (person, life) in kept.people.iter().enumerate() {
        let mut pieces: Vec<Piece> = Vec::with_capacity(life.len());
        for (k, laid) in life.iter().enumerate() {
            let piece = piece(laid, &kinds, library, domain).map_err(|p| bad(place(person, k), p))?;
            follows(pieces.last(), &piece, library, domain).map_err(|p| bad(place(person, k), p))?;
            casts.entry(piece.instance).or_default().push(outline(&piece));
            pieces.push(piece);
        }
        spans_time(&pieces, scene, library, domain).map_err(|p| bad(format!("person {person}"), p))?;
        if !tracks.settle(pieces) {
            return Err(bad(format!("person {person}"), "expected less people in one place".into()));
        }
    }
    for (instance, cast) in &casts {
        plays_together(cast, library, domain).map_err(|p| bad(format!("instance {instance}"), p))?;
    }
    tracks.number_from(kept.agenda.next_instance);
    Ok(tracks)
}

/// The library's index of every kind of the checkpoint.
fn kinds(kept: &Checkpoint, library: &Library) -> Result<Vec<u32>> {
    let index = |name: &String| {
        let found = library.set.kinds.iter().position(|k| k.name == *name);
        let problem = || format!("expected kinds of the patch set that the scene uses, found {name:?}");
        found.map(|k| k as u32).ok_or_else(|| Error::invalid("checkpoint", "kinds", problem()))
    };
    kept.kinds.iter().map(index).collect()
}

fn piece(laid: &Laid, kinds: &[u32], library: &Library, domain: &Domain) -> std::result::Result<Piece, Problem> {
    let roles = library.roles_of(kinds[laid.kind as usize]);
    if laid.role as usize >= roles.len() {
        return Err(format!("expected one of {} roles, found number {}", roles.len(), laid.role));
    }
    let role = roles.start + laid.role;
    let source = &library.roles[role as usize];
    let ticks = laid.end - laid.begin;
    match &laid.way {
        Way::Rigid(_) if ticks != source.ticks => Err(format!("expected {} ticks, found {ticks}", source.ticks)),
        Way::Along(path) if path.len() != source.path.len() => {
            Err(format!("expected a path of {} samples, found {}", source.path.len(), path.len()))
        }
        Way::Along(_) if !(source.tick_range.0..=source.tick_range.1).contains(&ticks) => {
            Err(format!("expected {} to {} ticks, found {ticks}", source.tick_range.0, source.tick_range.1))
        }
        _ => Ok(laid.piece(library, domain, role)),
    }
}

/// A piece without its bodies.
fn outline(piece: &Piece) -> Piece {
    Piece { bodies: vec![], path: piece.path.clone(), ..*piece }
}

fn is_near(a: Ground, b: Ground) -> bool {
    a.position.distance(b.position) <= NEAR && wrap_angle(a.heading - b.heading).abs() <= TURNED
}

/// A piece begins where the one before has ended, as far as that is seen: what changes at the end of time may leave a
/// gap after it.
fn follows(
    before: Option<&Piece>,
    piece: &Piece,
    library: &Library,
    domain: &Domain,
) -> std::result::Result<(), Problem> {
    let Some(before) = before else { return Ok(()) };
    if !domain.cycle.loops() && (before.end >= domain.horizon || piece.begin <= 0) {
        return Ok(());
    }
    let (exit, entry) = (library.exit_of(before), library.entry_of(piece));
    match exit.tick == entry.tick && exit.group == entry.group && is_near(exit.at, entry.at) {
        true => Ok(()),
        false => Err(format!("expected it to begin at {exit:?}, found {entry:?}")),
    }
}

/// A life goes from the beginning of time, or a source, to its end, or a sink; or round.
fn spans_time(pieces: &[Piece], scene: &Scene, library: &Library, domain: &Domain) -> std::result::Result<(), Problem> {
    let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else {
        return Err("expected pieces, found none".into());
    };
    let (begin, end) = (library.entry_of(first), library.exit_of(last));
    if domain.cycle.loops() {
        let back = Ground::new(domain.torus.nearest(end.at.position - begin.at.position), end.at.heading);
        let start = Ground::new(glam::Vec2::ZERO, begin.at.heading);
        let round = end.tick - begin.tick == domain.cycle.ticks() && end.group == begin.group;
        // Nobody's first lap is far from the first of all.
        let near = begin.tick.abs() <= 2 * domain.cycle.ticks();
        return match round && near && is_near(back, start) {
            true => Ok(()),
            false => Err(format!("expected a life that comes round, found one from {begin:?} to {end:?}")),
        };
    }
    let comes = begin.tick <= 0 || !scene.sources.is_empty() && begin.tick < domain.horizon;
    let goes = end.tick >= domain.horizon || !scene.sinks.is_empty() && end.tick > 0;
    match comes && goes {
        true => Ok(()),
        false => {
            Err(format!("expected a life that fills the scene's time, found ticks {} to {}", begin.tick, end.tick))
        }
    }
}

/// The people of a patch are all of its roles, at one time and place.
fn plays_together(cast: &[Piece], library: &Library, domain: &Domain) -> std::result::Result<(), Problem> {
    let kind = |p: &Piece| library.roles[p.role as usize].kind;
    let mut roles: Vec<u32> = cast.iter().map(|p| p.role).collect();
    roles.sort_unstable();
    let expected = library.roles_of(kind(&cast[0]));
    if !expected.clone().eq(roles.iter().copied()) {
        let (name, found) = (&library.set.kinds[kind(&cast[0]) as usize].name, roles.len());
        return Err(format!("expected each of the {} roles of {name:?} once, found {found} pieces", expected.len()));
    }
    let site = |p: &Piece| {
        let role = &library.roles[p.role as usize];
        (p.entry().then(role.entry.inverse()), p.begin - role.begin)
    };
    let (at, clock) = site(&cast[0]);
    let agrees = |p: &Piece| {
        let (here, now) = site(p);
        let apart = domain.torus.nearest(here.position - at.position);
        domain.cycle.slot(now) == domain.cycle.slot(clock)
            && is_near(Ground::new(at.position + apart, here.heading), at)
    };
    let rigid = |p: &Piece| cast.len() == 1 || p.end - p.begin == library.roles[p.role as usize].ticks;
    match cast.iter().all(|p| agrees(p) && rigid(p)) {
        true => Ok(()),
        false => Err("expected all of its people at one time and place".into()),
    }
}
