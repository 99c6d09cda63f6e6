//! Mending: final bodies are tested with their exact capsules, and boxes with them; where something enters something
//! else a window of one person's track is ripped up and bridged anew.

use std::collections::BTreeSet;
use std::ops::Range;

use glam::{Quat, Vec2, Vec3};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::bake::{Chains, segments_of};
use super::boxes::in_the_way;
use super::bridge::Taste;
use super::domain::Domain;
use super::library::Library;
use super::tracks::{TrackId, Tracks, Undo, Window};
use crate::geom::Capsule;
use crate::motion::{JOINT_COUNT, body_capsules};
use crate::patch::{PatchKind, turn_between};
use crate::refine::{Body, Performance, Segment, refine, refine_all};
use crate::stage::FragmentUse;

/// No body reaches further from its hips than this, metres.
const REACH: f32 = 1.1;
/// Bodies whose hips are further apart than this never touch, metres.
const TOUCHING_HIPS: f32 = 2.2;
/// Interpenetration that is let pass, metres.
const TOLERANCE: f32 = 0.005;
/// Ticks ripped up before and after a fault, growing with each try.
const WINDOW: i32 = 24;
/// Joints may turn this much faster than in the captures.
const RUSH: f32 = 1.15;
/// Neighbours of the piece at fault among which a patch of several people is given up.
const DISSOLVE_REACH: usize = 3;
/// Tries per fault.
const TRIES: i32 = 10;
/// Ticks around a window over which its stitches may change a body.
const BLEND_TICKS: i32 = 16;

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

/// The final bodies of all people, and the boxes that they carry.
pub(super) fn perform(chains: Chains) -> Performance {
    let uses: Vec<_> = (0..chains.lists.len()).map(|t| segments_of(chains, t)).collect();
    let people: Vec<Vec<Segment>> = uses.iter().map(|uses| segments(uses)).collect();
    refine_all(&people, chains.domain.horizon as u32 - 1)
}

/// The final body of a person, but for touching others.
fn body(chains: Chains, track: TrackId) -> Body {
    refine(&segments(&segments_of(chains, track)), chains.domain.horizon as u32 - 1)
}

fn segments<'a>(uses: &'a [(&'a PatchKind, FragmentUse)]) -> Vec<Segment<'a>> {
    uses.iter().map(|(kind, placed)| Segment { kind, placed }).collect()
}

/// All faults of the final bodies, each at its first tick.
pub(super) fn faults(chains: Chains, played: &Performance) -> Vec<Fault> {
    let bodies = &played.bodies;
    let per_tick: Vec<Vec<(TrackId, TrackId)>> =
        (0..chains.domain.horizon).into_par_iter().map(|tick| touching(chains, played, tick)).collect();
    let mut open: BTreeSet<(TrackId, TrackId)> = BTreeSet::new();
    let mut faults = Vec::new();
    for (tick, pairs) in per_tick.into_iter().enumerate() {
        let now: BTreeSet<_> = pairs.into_iter().collect();
        faults.extend(now.difference(&open).map(|&(a, b)| Fault { a, b, tick: tick as i32 }));
        open = now;
    }
    let alone = bodies.par_iter().enumerate().map(|(t, body)| {
        let frame = first_unclean(body, chains, 0..body.root.len());
        frame.map(|f| Fault { a: t, b: t, tick: body.begin as i32 + f as i32 })
    });
    faults.extend(alone.collect::<Vec<_>>().into_iter().flatten());
    faults
}

/// The first of some frames on which a leg is too short, a joint turns or the hips move faster than in the captures
/// (with some allowance), or a limb is in a wall.
fn first_unclean(body: &Body, chains: Chains, mut frames: Range<usize>) -> Option<usize> {
    frames.find(|&f| {
        body.strained.binary_search(&f).is_ok()
            || is_rushed(body, chains.library, f)
            || is_in_wall(body, chains.domain, f)
    })
}

fn is_in_wall(body: &Body, domain: &Domain, frame: usize) -> bool {
    let root = body.root[frame];
    if domain.holds(Vec2::new(root.x, root.z), REACH) {
        return false;
    }
    let inside = |p: Vec3, radius: f32| domain.holds(Vec2::new(p.x, p.z), radius - TOLERANCE);
    // Bones are so short that three discs each are as good as the whole.
    let shapes = capsules(body, frame, &mut Vec::new());
    !shapes.iter().all(|c| [0.0, 0.5, 1.0].into_iter().all(|t| inside(c.a.lerp(c.b, t), c.radius)))
}

fn is_rushed(body: &Body, library: &Library, frame: usize) -> bool {
    let Some(last) = frame.checked_sub(1) else { return false };
    let longest_step = RUSH * library.fastest_step + library.limits.stretch;
    let (before, now) = (body.pose(last), body.pose(frame));
    body.root[frame].distance(body.root[last]) > longest_step
        || (0..JOINT_COUNT).any(|j| turn_between(before[j], now[j]) > RUSH * library.fastest[j])
}

/// Who is in whom or in whose box at a tick. Bodies are sorted along x so that near ones are neighbours.
fn touching(chains: Chains, played: &Performance, tick: i32) -> Vec<(TrackId, TrackId)> {
    let bodies = &played.bodies;
    let frame = |t: TrackId| usize::try_from(tick - bodies[t].begin as i32).ok().filter(|&f| f < bodies[t].root.len());
    let mut present: Vec<(Vec2, TrackId, usize)> = (0..bodies.len())
        .filter_map(|t| frame(t).map(|f| (Vec2::new(bodies[t].root[f].x, bodies[t].root[f].z), t, f)))
        .collect();
    present.sort_by(|a, b| a.0.x.total_cmp(&b.0.x).then(a.1.cmp(&b.1)));
    let mut shapes: Vec<Option<Vec<Capsule>>> = vec![None; present.len()];
    let mut globals = Vec::new();
    let mut pairs = in_the_way(chains, played, tick);
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
        let ticks = WINDOW * (1 + attempt);
        near(tracks, track, fault.tick, 1, |people| people == 1)
            .is_some_and(|at| rebridge(tracks, &[Window { track, from: at, to: at + 1 }], ticks, taste, rng))
    })
}

/// Takes out the patch of several people nearest to a fault that nothing else mends, and bridges its people's tracks;
/// false if there is none or no way was found.
pub(super) fn dissolve(tracks: &mut Tracks, fault: Fault, taste: Taste, rng: &mut ChaCha8Rng) -> bool {
    (0..TRIES).any(|attempt| {
        let track = if rng.random_range(0..2) == 0 { fault.a } else { fault.b };
        let Some(at) = near(tracks, track, fault.tick, DISSOLVE_REACH, |people| people > 1) else { return false };
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

/// Index of the piece at `tick`, or of the nearest of `reach` neighbours on either side, whose patch has the wanted
/// number of people.
fn near(tracks: &Tracks, track: TrackId, tick: i32, reach: usize, wanted: impl Fn(usize) -> bool) -> Option<usize> {
    let pieces = &tracks.tracks[track];
    let at = tracks.index_at(track, tick).min(pieces.len() - 1);
    let distance = |i: &usize| {
        let p = tracks.piece(pieces[*i]);
        (p.begin - tick).max(tick - p.end).max(0)
    };
    let neighbours = at.saturating_sub(reach)..(at + reach + 1).min(pieces.len());
    neighbours.filter(|&i| wanted(tracks.people_of(pieces[i]))).min_by_key(distance)
}

/// Rips up windows of tracks, widened by `ticks`, and bridges them another way, on which everybody moves cleanly.
fn rebridge(tracks: &mut Tracks, windows: &[Window], ticks: i32, taste: Taste, rng: &mut ChaCha8Rng) -> bool {
    let mut undo = Undo::default();
    let windows: Vec<Window> = windows.iter().map(|&w| tracks.widen(w, ticks)).collect();
    let spans: Vec<_> =
        windows.iter().map(|w| (tracks.port(w.track, w.from).tick, tracks.port(w.track, w.to).tick)).collect();
    windows.iter().for_each(|&w| tracks.hide_window(w, &mut undo));
    let done = windows.iter().all(|&w| tracks.bridge_window(w, taste, rng, &mut undo).is_some())
        && windows.iter().zip(&spans).all(|(w, span)| is_clean(tracks.chains(), w.track, *span));
    if done {
        tracks.commit(undo);
    } else {
        tracks.roll_back(undo);
    }
    done
}

/// True if a person moves cleanly over some ticks and a blend's length around them.
fn is_clean(chains: Chains, track: TrackId, (from, to): (i32, i32)) -> bool {
    let body = body(chains, track);
    let frame = |tick: i32| (tick - body.begin as i32).clamp(0, body.root.len() as i32) as usize;
    first_unclean(&body, chains, frame(from - BLEND_TICKS)..frame(to + BLEND_TICKS)).is_none()
}
