//! Mending: final bodies are tested with their exact capsules, and where two of them interpenetrate a window of one
//! person's track is ripped up and bridged anew.

use std::collections::BTreeSet;

use glam::{Quat, Vec2, Vec3};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::bake::segments_of;
use super::bridge::Taste;
use super::tracks::{TrackId, Tracks, Undo, Window};
use crate::geom::Capsule;
use crate::motion::{JOINT_COUNT, body_capsules, canonical};
use crate::refine::{Body, Segment, refine};

/// Bodies whose hips are further apart than this never touch, metres.
const TOUCHING_HIPS: f32 = 2.2;
/// Interpenetration that is let pass, metres.
const TOLERANCE: f32 = 0.005;
/// Ticks ripped up before and after a fault, growing with each try.
const WINDOW: i32 = 24;
/// Tries per fault.
const TRIES: i32 = 8;

/// Two people interpenetrating, or one in a wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Fault {
    /// One person.
    pub a: TrackId,
    /// The other.
    pub b: TrackId,
    /// When.
    pub tick: i32,
}

/// The final bodies of all people. In parallel over people.
pub(super) fn bodies(tracks: &Tracks) -> Vec<Body> {
    let last_frame = tracks.domain.horizon as u32 - 1;
    (0..tracks.tracks.len())
        .into_par_iter()
        .map(|t| {
            let uses = segments_of(tracks, t);
            let segments: Vec<_> =
                uses.iter().map(|(kind, placed)| Segment { kind, placed }).collect();
            refine(&segments, last_frame)
        })
        .collect()
}

/// The first tick of each stretch of time over which two people of different instances interpenetrate.
pub(super) fn faults(tracks: &Tracks, bodies: &[Body]) -> Vec<Fault> {
    let per_tick: Vec<Vec<(TrackId, TrackId)>> =
        (0..tracks.domain.horizon).into_par_iter().map(|tick| touching(tracks, bodies, tick)).collect();
    let mut open: BTreeSet<(TrackId, TrackId)> = BTreeSet::new();
    let mut faults = Vec::new();
    for (tick, pairs) in per_tick.into_iter().enumerate() {
        let now: BTreeSet<_> = pairs.into_iter().collect();
        faults.extend(now.difference(&open).map(|&(a, b)| Fault { a, b, tick: tick as i32 }));
        open = now;
    }
    faults
}

/// Bodies of one tick, sorted along x so that near ones are neighbours.
fn touching(tracks: &Tracks, bodies: &[Body], tick: i32) -> Vec<(TrackId, TrackId)> {
    let frame = |t: TrackId| usize::try_from(tick - bodies[t].begin as i32).ok().filter(|&f| f < bodies[t].root.len());
    let mut present: Vec<(Vec2, TrackId, usize)> = (0..bodies.len())
        .filter_map(|t| frame(t).map(|f| (Vec2::new(bodies[t].root[f].x, bodies[t].root[f].z), t, f)))
        .collect();
    present.sort_by(|a, b| a.0.x.total_cmp(&b.0.x).then(a.1.cmp(&b.1)));
    let mut shapes: Vec<Option<Vec<Capsule>>> = vec![None; present.len()];
    let mut globals = Vec::new();
    let mut pairs = Vec::new();
    for i in 0..present.len() {
        for j in i + 1..present.len() {
            if present[j].0.x - present[i].0.x > TOUCHING_HIPS {
                break;
            }
            let ((_, a, fa), (_, b, fb)) = (present[i], present[j]);
            if present[i].0.distance(present[j].0) > TOUCHING_HIPS || same_instance(tracks, a, b, tick) {
                continue;
            }
            for (k, t, f) in [(i, a, fa), (j, b, fb)] {
                if shapes[k].is_none() {
                    shapes[k] = Some(capsules(&bodies[t], f, &mut globals));
                }
            }
            let (Some(p), Some(q)) = (&shapes[i], &shapes[j]) else { unreachable!() };
            if p.iter().any(|c| q.iter().any(|d| c.penetration(d) > TOLERANCE)) {
                pairs.push((a.min(b), a.max(b)));
            }
        }
    }
    pairs
}

fn same_instance(tracks: &Tracks, a: TrackId, b: TrackId, tick: i32) -> bool {
    let instance = |t: TrackId| tracks.tracks[t].get(tracks.index_at(t, tick)).map(|&id| tracks.piece(id).instance);
    instance(a) == instance(b)
}

fn capsules(body: &Body, frame: usize, globals: &mut Vec<(Vec3, Quat)>) -> Vec<Capsule> {
    canonical().globals(body.root[frame], &body.rotations[frame * JOINT_COUNT..(frame + 1) * JOINT_COUNT], globals);
    let mut capsules = Vec::new();
    body_capsules(globals, &mut capsules);
    capsules
}

/// Bridges one of the two people's tracks anew around the fault; false if no way was found.
pub(super) fn mend(tracks: &mut Tracks, fault: Fault, taste: Taste, rng: &mut ChaCha8Rng) -> bool {
    (0..TRIES).any(|attempt| {
        let track = if rng.random_range(0..2) == 0 { fault.a } else { fault.b };
        rebridge(tracks, track, fault.tick, WINDOW * (1 + attempt / 2), taste, rng)
    })
}

/// Rips up the single-person pieces of a track around `tick` and bridges the window another way.
fn rebridge(tracks: &mut Tracks, track: TrackId, tick: i32, ticks: i32, taste: Taste, rng: &mut ChaCha8Rng) -> bool {
    let at = tracks.index_at(track, tick).min(tracks.tracks[track].len() - 1);
    let Some(window) = tracks.widen(Window { track, from: at, to: at + 1 }, ticks) else { return false };
    let mut undo = Undo::default();
    tracks.hide_window(window, &mut undo);
    if tracks.bridge_window(window, taste, rng, &mut undo).is_some() {
        tracks.commit(undo);
        true
    } else {
        tracks.roll_back(undo);
        false
    }
}
