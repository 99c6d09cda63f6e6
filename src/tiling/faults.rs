//! What is wrong with the final bodies: they are tested with their exact capsules, and boxes with them.

use std::ops::Range;

use glam::Vec2;
use rayon::prelude::*;

use super::bake::Chains;
use super::boxes::in_the_way;
use super::bridge::NO_INSTANCE;
use super::domain::{Domain, Spot};
use super::encounters::Encounters;
use super::figure::{Figure, Figures, REACH, TOLERANCE, frame_at};
use super::library::Library;
use super::piece::Piece;
use super::tracks::TrackId;
use crate::motion::canonical;
use crate::patch::Turns;
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

impl Fault {
    /// Both people.
    pub fn people(self) -> [TrackId; 2] {
        [self.a, self.b]
    }
}

/// All faults of the final bodies in which somebody new has a part, each at its first tick, in order of time.
/// O(people x ticks), in parallel.
pub(super) fn faults(chains: Chains, played: &Performance, encounters: &Encounters, is_new: &[bool]) -> Vec<Fault> {
    let alone = |(t, body): (TrackId, &Body)| {
        let frame = first_unclean(body, chains.library, chains.domain, tested(chains.domain, body))?;
        Some(Fault { a: t, b: t, tick: body.begin as i32 + frame as i32 })
    };
    let bodies = || played.bodies.par_iter().enumerate();
    let mut faults: Vec<Fault> = bodies().filter(|(t, _)| is_new[*t]).filter_map(alone).collect();
    let people = (0..played.bodies.len()).into_par_iter();
    let with_others = |figures: &mut Figures, a| touches(chains, &played.bodies, encounters, is_new, figures, a);
    faults.par_extend(people.map_init(Figures::default, with_others).flatten_iter());
    faults.extend(in_the_way(chains, played, is_new));
    faults.sort_unstable_by_key(|f| (f.tick, f.a, f.b));
    faults.dedup();
    faults
}

/// Where somebody is in people of larger numbers, one of each two new.
fn touches(
    chains: Chains,
    bodies: &[Body],
    encounters: &Encounters,
    is_new: &[bool],
    figures: &mut Figures,
    a: TrackId,
) -> Vec<Fault> {
    let (torus, body) = (chains.domain.torus, &bodies[a]);
    figures.begin(body.root.len());
    let mut touching = |b: TrackId, tick: i32| {
        let [Some(frame), Some(their_frame)] = [a, b].map(|t| frame_at(&bodies[t], tick)) else { return false };
        let figure = figures.at(body, canonical(), frame);
        let depth = figure.depth_into(&Figure::at(&bodies[b], canonical(), their_frame).beside(figure, torus));
        let pieces = || [a, b].map(|t| chains.piece_at(t, tick));
        depth > TOLERANCE && depth > TOLERANCE + captured_depth(chains.library, chains.domain, pieces(), tick)
    };
    let mut faults = Vec::new();
    let mut last = None;
    for (b, tick) in encounters.with(a) {
        let near = (is_new[a] || is_new[b]) && encounters.are_near(bodies, [a, b], tick, torus, 0.0);
        if near && touching(b, tick) {
            if last != Some((b, tick - 1)) {
                faults.push(Fault { a, b, tick });
            }
            last = Some((b, tick));
        }
    }
    faults
}

/// The frames of a body that are looked at, the one that is the first again included.
fn tested(domain: &Domain, body: &Body) -> Range<usize> {
    let frames = domain.frames();
    let index = |tick: i32| (tick - body.begin as i32).max(0) as usize;
    index(frames.start)..(index(frames.end) + 1).min(body.root.len())
}

/// The first of some frames on which a leg cannot do what it should, a joint turns or the hips move faster than in the
/// captures (with some allowance), or a limb is in a wall.
pub(super) fn first_unclean(
    body: &Body,
    library: &Library,
    domain: &Domain,
    mut frames: Range<usize>,
) -> Option<usize> {
    let haste = Haste::new(library, RUSH);
    frames
        .find(|&f| body.strained.binary_search(&f).is_ok() || haste.is_exceeded(body, f) || is_in_wall(body, domain, f))
}

fn is_in_wall(body: &Body, domain: &Domain, frame: usize) -> bool {
    let (root, tick) = (body.root[frame], (body.begin as usize + frame) as i32);
    !domain.holds(Spot::ground(tick), Vec2::new(root.x, root.z), REACH)
        && Figure::of(body, canonical(), tick).is_some_and(|f| f.is_in_wall(domain, tick))
}

/// How fast people may move.
pub(super) struct Haste {
    /// Longest way of the hips in a frame, metres.
    step: f32,
    turns: Turns,
}

impl Haste {
    /// So many times as fast as in the captures.
    pub fn new(library: &Library, rush: f32) -> Self {
        Self {
            step: rush * library.fastest_hips + library.limits.stretch,
            turns: Turns::up_to(library.fastest.map(|turn| rush * turn)),
        }
    }

    /// True if from the frame before a joint turns or the hips move further.
    pub fn is_exceeded(&self, body: &Body, frame: usize) -> bool {
        frame.checked_sub(1).is_some_and(|last| {
            body.root[frame].distance(body.root[last]) > self.step
                || self.turns.are_exceeded(body.pose(last), body.pose(frame))
        })
    }
}

/// How deep two people who are in one patch at a tick are in each other in its capture at that moment, metres; 0 if they
/// are in two. Between two captured frames the deeper of them.
pub(super) fn captured_depth(library: &Library, domain: &Domain, pieces: [Option<&Piece>; 2], tick: i32) -> f32 {
    let [Some(a), Some(b)] = pieces else { return 0.0 };
    if a.instance != b.instance || a.instance == NO_INSTANCE {
        return 0.0;
    }
    let clocks = [a, b].map(|piece| clock(library, piece, domain.cycle.fold(tick, piece.begin)));
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
