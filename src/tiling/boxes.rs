//! Exact tests of the boxes that people carry or that lie there: they enter no body, no wall and no other box.

use std::collections::BTreeSet;

use glam::Vec2;
use rayon::prelude::*;

use super::bake::Chains;
use super::domain::{Domain, Spot};
use super::faults::Fault;
use super::figure::{Figure, REACH, TOLERANCE, frame_at};
use super::piece::Piece;
use super::places::Places;
use super::tracks::TrackId;
use crate::geom::{Capsule, Cuboid};
use crate::motion::canonical;
use crate::refine::{Body, Performance};
use crate::stage::Prop;

/// A box nearer to where one lies than this is that box, metres.
const SAME: f32 = 0.02;
/// Points of a box's edges that are tested against walls are this far apart, metres.
const SPACING: f32 = 0.06;

/// All faults of boxes in which somebody new has a part, each at its first tick. O(ticks x people), in parallel.
pub(super) fn in_the_way(chains: Chains, played: &Performance, is_new: &[bool]) -> Vec<Fault> {
    if played.props.is_empty() {
        return vec![];
    }
    let at_tick = |places: &mut Places, tick: i32| {
        places.look(tick..=tick, played.bodies.iter(), chains.domain.torus, 2.0 * REACH);
        let mut now = to_blame(chains, played, places, tick);
        now.retain(|&(a, b)| is_new[a] || is_new[b]);
        (tick, now)
    };
    let per_tick: Vec<_> = chains.domain.frames().into_par_iter().map_init(Places::default, at_tick).collect();
    let mut open: BTreeSet<(TrackId, TrackId)> = BTreeSet::new();
    let mut faults = Vec::new();
    for (tick, pairs) in per_tick {
        let now: BTreeSet<_> = pairs.into_iter().collect();
        faults.extend(now.difference(&open).map(|&(a, b)| Fault { a, b, tick }));
        open = now;
    }
    faults
}

/// The people to blame for boxes that enter something at a tick: two different ones, or one alone.
fn to_blame(chains: Chains, played: &Performance, places: &Places, tick: i32) -> Vec<(TrackId, TrackId)> {
    let mut here: Vec<(&Prop, Cuboid)> =
        played.props.iter().filter_map(|p| Some((p, p.at_frame(u32::try_from(tick).ok()?)?))).collect();
    here.sort_by(|(_, a), (_, b)| a.at.middle.x.total_cmp(&b.at.middle.x));
    let mut pairs = Vec::new();
    for (i, (prop, cuboid)) in here.iter().enumerate() {
        // Looked for only where something is wrong.
        let keeper = || keeper(prop, tick).or_else(|| sitter(chains, prop));
        for t in places.near(cuboid.at.ground().position, REACH + cuboid.radius()) {
            if depth_in_body(cuboid, &played.bodies[t], tick) > TOLERANCE && !is_partner(chains, prop, t, tick) {
                // Where it lies, who runs into it is to go another way.
                let held = prop.holders(tick as u32).next().is_some();
                let other = if held { keeper().unwrap_or(t) } else { t };
                pairs.push((other.min(t), other.max(t)));
            }
        }
        if is_in_wall(cuboid, chains.domain, tick) {
            pairs.extend(keeper().map(|k| (k, k)));
        }
        let beside = |theirs: &Cuboid| cuboid.at.middle.x - theirs.at.middle.x < 2.0 * REACH;
        for (other, theirs) in here[..i].iter().rev().take_while(|(_, theirs)| beside(theirs)) {
            let near = cuboid.at.middle.distance(theirs.at.middle) < cuboid.radius() + theirs.radius();
            if near && cuboid.overlap(theirs) > TOLERANCE {
                let Some(first) = keeper() else { continue };
                let second = self::keeper(other, tick).or_else(|| sitter(chains, other)).unwrap_or(first);
                pairs.push((first.min(second), first.max(second)));
            }
        }
    }
    pairs
}

/// Who has the box in the hands, or had it last, or will have it first.
fn keeper(prop: &Prop, tick: i32) -> Option<TrackId> {
    let tick = tick.max(0) as u32;
    let last = prop.holds.iter().rev().find(|h| h.begin <= tick);
    last.or(prop.holds.first()).map(|h| h.character as TrackId)
}

/// True for who holds the box, and for who is in one patch with the holder: they are as near it as they were captured.
fn is_partner(chains: Chains, prop: &Prop, person: TrackId, tick: i32) -> bool {
    let instance = |t: TrackId| chains.piece_at(t, tick).map(|p| p.instance);
    let mine = instance(person);
    let mut holders = prop.holders(tick as u32).map(|h| h as TrackId);
    holders.any(|h| h == person || instance(h) == mine)
        || is_lifting(chains, prop, person, tick)
        || changes_hands_in(chains, prop, mine, tick)
}

/// True while the box lies there within the patch in which somebody puts it down or takes it up.
fn changes_hands_in(chains: Chains, prop: &Prop, instance: Option<u32>, tick: i32) -> bool {
    prop.holds.iter().any(|h| {
        let here = chains.piece_at(h.character as TrackId, tick).filter(|p| Some(p.instance) == instance);
        here.is_some_and(|p| [h.begin, h.end].into_iter().any(|f| (p.begin..=p.end).contains(&(f as i32))))
    })
}

/// True while a person is in the patch in which they take the lying box up, put it down or sit on it.
fn is_lifting(chains: Chains, prop: &Prop, person: TrackId, tick: i32) -> bool {
    let Some(piece) = chains.piece_at(person, tick) else { return false };
    let ends = prop.holds.iter().filter(|h| h.character as TrackId == person).flat_map(|h| [h.begin, h.end]);
    // Asked of the role: one that begins at the first frame leaves no box lying before it.
    chains.library.roles[piece.role as usize].leaves_box()
        && (lies_by(chains, prop, piece) || ends.into_iter().any(|f| (piece.begin..=piece.end).contains(&(f as i32))))
}

/// True if a box that nobody ever holds is the one that a piece has people sit on.
fn lies_by(chains: Chains, prop: &Prop, piece: &Piece) -> bool {
    prop.holds.is_empty() && piece.lying(chains.library).any(|at| at.distance(prop.places[0].ground().position) < SAME)
}

/// Who is the first to sit on a box that nobody holds.
fn sitter(chains: Chains, prop: &Prop) -> Option<TrackId> {
    (0..chains.lists.len()).find(|&t| chains.pieces(t).any(|piece| lies_by(chains, prop, piece)))
}

/// How deep a box is in a body of canonical build at a tick, metres.
fn depth_in_body(cuboid: &Cuboid, body: &Body, tick: i32) -> f32 {
    let Some(frame) = frame_at(body, tick) else { return 0.0 };
    let (middle, root) = (cuboid.at.middle, body.root[frame]);
    if Vec2::new(middle.x - root.x, middle.z - root.z).length() > REACH + cuboid.radius() {
        return 0.0;
    }
    Figure::of(body, canonical(), tick).map_or(0.0, |figure| depth_in(cuboid, &figure.capsules))
}

/// How deep a box is in a body's capsules, metres; 0 if it is not.
pub(super) fn depth_in(cuboid: &Cuboid, capsules: &[Capsule]) -> f32 {
    capsules.iter().map(|c| cuboid.penetration(c)).fold(0.0, f32::max)
}

fn is_in_wall(cuboid: &Cuboid, domain: &Domain, tick: i32) -> bool {
    let at = Spot { tick, lift: cuboid.at.middle.y - cuboid.half.y + TOLERANCE };
    if domain.holds(at, cuboid.at.ground().position, cuboid.radius()) {
        return false;
    }
    let plan = cuboid.plan();
    (0..plan.len()).any(|i| {
        let (a, b) = (plan[i], plan[(i + 1) % plan.len()]);
        let steps = (a.distance(b) / SPACING).ceil().max(1.0) as usize;
        (0..steps).any(|k| !domain.holds(at, a.lerp(b, k as f32 / steps as f32), -TOLERANCE))
    })
}
