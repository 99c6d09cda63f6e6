//! Mending: final bodies are tested with their exact capsules, and where two of them interpenetrate a window of one
//! person's track is ripped up and bridged anew.

use std::collections::BTreeSet;

use glam::{Quat, Vec2, Vec3};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::bake::{Chains, segments_of};
use super::bridge::Taste;
use super::library::Library;
use super::tracks::{TrackId, Tracks, Undo, Window};
use crate::geom::Capsule;
use crate::motion::{JOINT_COUNT, body_capsules};
use crate::patch::turn_between;
use crate::refine::{Body, Segment, refine};

/// Bodies whose hips are further apart than this never touch, metres.
const TOUCHING_HIPS: f32 = 2.2;
/// Interpenetration that is let pass, metres.
const TOLERANCE: f32 = 0.005;
/// Ticks ripped up before and after a fault, growing with each try.
const WINDOW: i32 = 24;
/// Joints may turn this much faster than in the captures.
const RUSH: f32 = 1.15;
/// Tries per fault.
const TRIES: i32 = 8;

/// Something wrong with the final bodies: two people interpenetrate, or one moves as nobody can.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Fault {
    /// One person.
    pub a: TrackId,
    /// The other; the same one if alone to blame.
    pub b: TrackId,
    /// When.
    pub tick: i32,
}

/// The final bodies of all people. In parallel over people.
pub(super) fn bodies(chains: Chains) -> Vec<Body> {
    let last_frame = chains.horizon as u32 - 1;
    (0..chains.lists.len())
        .into_par_iter()
        .map(|t| {
            let uses = segments_of(chains, t);
            let segments: Vec<_> = uses.iter().map(|(kind, placed)| Segment { kind, placed }).collect();
            refine(&segments, last_frame)
        })
        .collect()
}

/// All faults of the final bodies, each at its first tick.
pub(super) fn faults(chains: Chains, bodies: &[Body]) -> Vec<Fault> {
    let per_tick: Vec<Vec<(TrackId, TrackId)>> =
        (0..chains.horizon).into_par_iter().map(|tick| touching(chains, bodies, tick)).collect();
    let mut open: BTreeSet<(TrackId, TrackId)> = BTreeSet::new();
    let mut faults = Vec::new();
    for (tick, pairs) in per_tick.into_iter().enumerate() {
        let now: BTreeSet<_> = pairs.into_iter().collect();
        faults.extend(now.difference(&open).map(|&(a, b)| Fault { a, b, tick: tick as i32 }));
        open = now;
    }
    let alone = bodies.par_iter().enumerate().map(|(t, body)| {
        let frame = body.strained.first().copied().into_iter().chain(first_rushed(body, chains.library)).min();
        frame.map(|f| Fault { a: t, b: t, tick: body.begin as i32 + f as i32 })
    });
    faults.extend(alone.collect::<Vec<_>>().into_iter().flatten());
    faults
}

/// The first frame on which a joint turns, or the hips move, faster than in the captures, with some allowance.
fn first_rushed(body: &Body, library: &Library) -> Option<usize> {
    let longest_step = RUSH * library.fastest_step + library.limits.stretch;
    (1..body.root.len()).find(|&f| {
        let (before, now) = (body.pose(f - 1), body.pose(f));
        body.root[f].distance(body.root[f - 1]) > longest_step
            || (0..JOINT_COUNT).any(|j| turn_between(before[j], now[j]) > RUSH * library.fastest[j])
    })
}

/// Bodies of one tick, sorted along x so that near ones are neighbours.
fn touching(chains: Chains, bodies: &[Body], tick: i32) -> Vec<(TrackId, TrackId)> {
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
            if present[i].0.distance(present[j].0) > TOUCHING_HIPS || same_instance(chains, a, b, tick) {
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

fn same_instance(chains: Chains, a: TrackId, b: TrackId, tick: i32) -> bool {
    let instance = |t: TrackId| chains.piece_at(t, tick).map(|p| p.instance);
    instance(a) == instance(b)
}

fn capsules(body: &Body, frame: usize, globals: &mut Vec<(Vec3, Quat)>) -> Vec<Capsule> {
    body.globals(frame, globals);
    let mut capsules = Vec::new();
    body_capsules(globals, &mut capsules);
    capsules
}

/// Bridges one of the two people's tracks anew around the fault; false if no way was found.
pub(super) fn mend(tracks: &mut Tracks, fault: Fault, taste: Taste, rng: &mut ChaCha8Rng) -> bool {
    (0..TRIES).any(|attempt| {
        let track = if rng.random_range(0..2) == 0 { fault.a } else { fault.b };
        let ticks = WINDOW * (1 + attempt / 2);
        near(tracks, track, fault.tick, |people| people == 1)
            .is_some_and(|at| rebridge(tracks, &[Window { track, from: at, to: at + 1 }], ticks, taste, rng))
    })
}

/// Takes out the patch of several people nearest to a fault that nothing else mends, and bridges its people's tracks;
/// false if there is none or no way was found.
pub(super) fn dissolve(tracks: &mut Tracks, fault: Fault, taste: Taste, rng: &mut ChaCha8Rng) -> bool {
    (0..TRIES).any(|attempt| {
        let track = if rng.random_range(0..2) == 0 { fault.a } else { fault.b };
        let Some(at) = near(tracks, track, fault.tick, |people| people > 1) else { return false };
        let instance = tracks.piece(tracks.tracks[track][at]).instance;
        let windows: Vec<Window> = (0..tracks.tracks.len())
            .filter_map(|t| {
                let from = tracks.tracks[t].iter().position(|&id| tracks.piece(id).instance == instance)?;
                Some(Window { track: t, from, to: from + 1 })
            })
            .collect();
        rebridge(tracks, &windows, WINDOW * attempt, taste, rng)
    })
}

/// Index of the piece at `tick`, or of one of its neighbours, whose patch has the wanted number of people.
fn near(tracks: &Tracks, track: TrackId, tick: i32, wanted: impl Fn(usize) -> bool) -> Option<usize> {
    let pieces = &tracks.tracks[track];
    let at = tracks.index_at(track, tick).min(pieces.len() - 1);
    let distance = |i: &usize| {
        let p = tracks.piece(pieces[*i]);
        (p.begin - tick).max(tick - p.end).max(0)
    };
    let neighbours = at.saturating_sub(1)..(at + 2).min(pieces.len());
    neighbours.filter(|&i| wanted(tracks.people_of(pieces[i]))).min_by_key(distance)
}

/// Rips up windows of tracks, widened by `ticks`, and bridges them another way.
fn rebridge(tracks: &mut Tracks, windows: &[Window], ticks: i32, taste: Taste, rng: &mut ChaCha8Rng) -> bool {
    let mut undo = Undo::default();
    let windows: Vec<Window> = windows.iter().map(|&w| tracks.widen(w, ticks)).collect();
    windows.iter().for_each(|&w| tracks.hide_window(w, &mut undo));
    if windows.into_iter().all(|w| tracks.bridge_window(w, taste, rng, &mut undo).is_some()) {
        tracks.commit(undo);
        true
    } else {
        tracks.roll_back(undo);
        false
    }
}
