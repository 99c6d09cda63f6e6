//! What is wrong with the final bodies: they are tested with their exact capsules, and boxes with them.

use std::collections::BTreeSet;
use std::ops::Range;

use glam::Vec2;
use rayon::prelude::*;

use super::bake::Chains;
use super::boxes::in_the_way;
use super::bridge::NO_INSTANCE;
use super::domain::{Domain, Spot};
use super::figure::{Figure, Places, REACH, TOLERANCE};
use super::library::Library;
use super::piece::Piece;
use super::tracks::TrackId;
use crate::motion::{JOINT_COUNT, canonical};
use crate::patch::turn_between;
use crate::refine::{Body, Performance};

/// Joints may turn this much faster than in the captures.
const RUSH: f32 = 1.15;

/// Something wrong with the final bodies: two people or their boxes interpenetrate, or one moves as nobody can.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Fault {
    /// One person.
    pub a: TrackId,
    /// The other; the same one if alone to blame.
    pub b: TrackId,
    /// When.
    pub tick: i32,
}

/// All faults of the final bodies in which somebody new has a part, each at its first tick. O(ticks x people x
/// neighbours), in parallel.
pub(super) fn faults(chains: Chains, played: &Performance, is_new: &[bool]) -> Vec<Fault> {
    let at_tick = |tick| {
        let places = Places::at(tick, played.bodies.iter());
        let mut pairs = in_the_way(chains, played, &places, tick);
        pairs.retain(|&(a, b)| is_new[a] || is_new[b]);
        pairs.extend(touching(chains, &played.bodies, &places, is_new, tick));
        pairs
    };
    let per_tick: Vec<Vec<(TrackId, TrackId)>> = (0..chains.domain.horizon).into_par_iter().map(at_tick).collect();
    let mut open: BTreeSet<(TrackId, TrackId)> = BTreeSet::new();
    let mut faults = Vec::new();
    for (tick, pairs) in per_tick.into_iter().enumerate() {
        let now: BTreeSet<_> = pairs.into_iter().collect();
        faults.extend(now.difference(&open).map(|&(a, b)| Fault { a, b, tick: tick as i32 }));
        open = now;
    }
    let alone = |(t, body): (TrackId, &Body)| {
        let frame = first_unclean(body, chains.library, chains.domain, 0..body.root.len())?;
        Some(Fault { a: t, b: t, tick: body.begin as i32 + frame as i32 })
    };
    faults.par_extend(played.bodies.par_iter().enumerate().filter(|(t, _)| is_new[*t]).filter_map(alone));
    faults
}

/// The first of some frames on which a leg cannot do what it should, a joint turns or the hips move faster than in the
/// captures (with some allowance), or a limb is in a wall.
pub(super) fn first_unclean(
    body: &Body,
    library: &Library,
    domain: &Domain,
    mut frames: Range<usize>,
) -> Option<usize> {
    frames.find(|&f| {
        body.strained.binary_search(&f).is_ok() || is_rushed(body, library, f, RUSH) || is_in_wall(body, domain, f)
    })
}

fn is_in_wall(body: &Body, domain: &Domain, frame: usize) -> bool {
    let (root, tick) = (body.root[frame], (body.begin as usize + frame) as i32);
    !domain.holds(Spot::ground(tick), Vec2::new(root.x, root.z), REACH)
        && Figure::of(body, canonical(), tick).is_some_and(|f| f.is_in_wall(domain, tick))
}

/// True if from the frame before a joint turns or the hips move `rush` times faster than in the captures.
pub(super) fn is_rushed(body: &Body, library: &Library, frame: usize, rush: f32) -> bool {
    let Some(last) = frame.checked_sub(1) else { return false };
    let longest_step = rush * library.fastest_hips + library.limits.stretch;
    let (before, now) = (body.pose(last), body.pose(frame));
    body.root[frame].distance(body.root[last]) > longest_step
        || (0..JOINT_COUNT).any(|j| turn_between(before[j], now[j]) > rush * library.fastest[j])
}

/// Who is in whom at a tick, somebody new in each pair.
fn touching(chains: Chains, bodies: &[Body], places: &Places, is_new: &[bool], tick: i32) -> Vec<(TrackId, TrackId)> {
    let mut pairs = Vec::new();
    let figure = |t: TrackId| Figure::of(&bodies[t], canonical(), tick);
    places.pairs(is_new, figure, |(a, first), (b, second)| {
        let depth = first.depth_into(second);
        let pieces = || [a, b].map(|t| chains.piece_at(t, tick));
        if depth > TOLERANCE && depth > TOLERANCE + captured_depth(chains.library, pieces(), tick) {
            pairs.push((a.min(b), a.max(b)));
        }
    });
    pairs
}

/// How deep two people who are in one patch at a tick are in each other in its capture at that moment, metres; 0 if they
/// are in two. Between two captured frames the deeper of them.
pub(super) fn captured_depth(library: &Library, pieces: [Option<&Piece>; 2], tick: i32) -> f32 {
    let [Some(a), Some(b)] = pieces else { return 0.0 };
    if a.instance != b.instance || a.instance == NO_INSTANCE {
        return 0.0;
    }
    let clocks = [a, b].map(|piece| clock(library, piece, tick));
    let (first, last) = (clocks[0].min(clocks[1]).floor() as u32, clocks[0].max(clocks[1]).ceil() as u32);
    (first..=last).map(|c| captured(library, a, c).depth_into(&captured(library, b, c))).fold(0.0, f32::max)
}

/// Frame (with fraction) of the patch's clock that a piece shows at a tick.
fn clock(library: &Library, piece: &Piece, tick: i32) -> f32 {
    const HAIR: f32 = 1e-4;
    let fragment = library.fragment(piece);
    let shown = (tick - piece.begin) as f32 / (piece.end - piece.begin) as f32;
    let at = fragment.begin as f32 + shown * (fragment.motion.len() - 1) as f32;
    if (at - at.round()).abs() < HAIR { at.round() } else { at }
}

/// What was captured of a piece's person at a frame of the patch's clock, or at its end nearest to it.
fn captured(library: &Library, piece: &Piece, clock: u32) -> Figure {
    let fragment = library.fragment(piece);
    let mut globals = Vec::new();
    let frame = (clock.saturating_sub(fragment.begin) as usize).min(fragment.motion.len() - 1);
    fragment.motion.globals(frame, &mut globals);
    Figure::new(&globals)
}
