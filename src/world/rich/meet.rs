//! Interaction-rich patches: people come in over the border, meet, and go out over another border, on time.
//!
//! The inside is filled by tiling motion patches ([`crate::tiling`]): the patch's crossings are ports that somebody must come
//! in and go out by, its period is that of the tiling's time. Whoever is in such a patch has a clip for all of the stay; the
//! ordinary way is the clip's own, smoothed until a walker could go it, and straight at the border. There clip and walk fade
//! into each other.

use std::sync::Arc;

use glam::{DVec2, Quat, Vec2, Vec3};

use super::tableau::Role;
use crate::geom::Polygon;
use crate::motion::{FPS, JOINT_COUNT};
use crate::patch::PatchSet;
use crate::stage::world::{Act, mix};
use crate::tiling::{Crossing, Place, Visit, playable, visits};
use crate::world::frame::Line;
use crate::world::{CrowdPatch, FramePatch, Limits, Path, Port, Walker};

/// Seconds between control points of a way, as everywhere in a world.
const STEP: f32 = 0.2;
/// How much a clip's way is smoothed, seconds: as little as it takes.
const SMOOTHED: [f32; 6] = [0.08, 0.15, 0.22, 0.3, 0.4, 0.55];
/// Ways come from the straight line at the border to the clip's own within so many seconds.
const JOINED_SECS: f64 = 0.8;
/// A way keeps this part of the limits: 16 bits round it.
const WITHIN: f32 = 0.98;
/// Hips are nowhere farther from the way, metres: whoever plays roots alone sees people where they are.
const STRAY: f32 = 0.24;
/// Tries with other seeds.
const TRIES: u64 = 3;

/// What people do who meet in a patch.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Meeting {
    /// Labels of the patches of several people that are meant.
    pub labels: Vec<String>,
    /// What they are taken from, if it is known; else people walk through.
    #[serde(default, with = "set_bytes")]
    pub(in crate::world) set: Option<Arc<PatchSet>>,
}

/// A set travels as the bytes of its file.
mod set_bytes {
    use std::sync::Arc;

    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use crate::patch::PatchSet;

    pub fn serialize<S: Serializer>(set: &Option<Arc<PatchSet>>, to: S) -> Result<S::Ok, S::Error> {
        set.as_ref().map(|set| set.to_bytes()).serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Arc<PatchSet>>, D::Error> {
        let bytes = Option::<Vec<u8>>::deserialize(from)?;
        bytes.map(|bytes| PatchSet::from_bytes(&bytes).map(Arc::new).map_err(D::Error::custom)).transpose()
    }
}

impl Meeting {
    /// The same with motions out of a set. Returns whether it has what is meant.
    pub(super) fn cast(&mut self, set: &PatchSet) -> bool {
        let set = playable(set, |k| k.people() <= 3 && k.labels.iter().any(|label| self.labels.contains(label)));
        let found = set.kinds.iter().any(|k| k.people() > 1);
        self.set = found.then(|| Arc::new(set));
        found
    }

    /// The patch of a frame in which people meet; `None` if no way is found for everybody.
    pub(in crate::world) fn patch(&self, frame: &FramePatch, limits: &Limits, seed: u64) -> Option<CrowdPatch> {
        let set = self.set.as_ref()?;
        (0..TRIES).find_map(|again| solve(frame, set, limits, mix(seed, again)))
    }
}

fn solve(frame: &FramePatch, set: &PatchSet, limits: &Limits, seed: u64) -> Option<CrowdPatch> {
    let [inputs, outputs]: [Vec<Port>; 2] = [frame.inputs().collect(), frame.outputs().collect()];
    let lines =
        |ports: &[Port], inward: bool| -> Vec<Line> { ports.iter().map(|&p| frame.line(p, inward, limits)).collect() };
    let (ins, outs) = (lines(&inputs, true), lines(&outputs, false));
    let crossings = |lines: &[Line]| -> Vec<Crossing> { lines.iter().map(crossing).collect() };
    let (comes, goes) = (crossings(&ins), crossings(&outs));
    let outline = Polygon { points: frame.outline.clone() };
    let place = Place { outline: &outline, period: frame.period(), comes: &comes, goes: &goes };
    let mut found = visits(&place, set, seed)?;
    found.sort_by_key(|visit| visit.comes);
    let walker = |visit: &Visit| {
        let leave = outs[visit.goes].later(f64::from(visit.laps) * f64::from(frame.period()));
        let path = SMOOTHED.iter().find_map(|&secs| way(frame, visit, [ins[visit.comes], leave], secs, limits))?;
        let (input, output) = (inputs[visit.comes], outputs[visit.goes]);
        Some(Walker { input, output, laps: visit.laps, path, role: Some(role(visit)) })
    };
    let walkers = found.iter().map(walker).collect::<Option<Vec<Walker>>>()?;
    Some(CrowdPatch { frame: frame.clone(), walkers })
}

fn crossing(line: &Line) -> Crossing {
    let (place, velocity) = (line.place.as_vec2(), line.velocity.as_vec2());
    Crossing { place, velocity, secs: line.time as f32, edge: line.edge }
}

fn role(visit: &Visit) -> Role {
    let body = &visit.body;
    let act = Act { step: 1.0 / FPS, roots: body.root.clone(), rotations: body.rotations.clone() };
    debug_assert_eq!(act.rotations.len(), act.roots.len() * JOINT_COUNT);
    Role { act: Arc::new(act), lead: -visit.begin }
}

/// A clip seen from another place.
pub(in crate::world) fn moved(act: &Act, by: DVec2) -> Act {
    let by = Vec3::new(by.x as f32, 0.0, by.y as f32);
    let rotations: Vec<Quat> = act.rotations.clone();
    Act { step: act.step, roots: act.roots.iter().map(|&p| p + by).collect(), rotations }
}

/// The way of a clip, smoothed over some seconds; `None` if nobody could walk it.
fn way(frame: &FramePatch, visit: &Visit, ends: [Line; 2], smoothed: f32, limits: &Limits) -> Option<Path> {
    let places = smooth(&visit.body.root, smoothed * FPS);
    let target = |time: f64| target(&places, f64::from(visit.begin), &ends, time);
    let [enter, leave] = &ends;
    let step = f64::from(STEP);
    let first = ((enter.time - enter.reach) / step).floor() as i32 - 1;
    let last = ((leave.time + leave.reach) / step).ceil() as i32 + 1;
    let wanted: Vec<DVec2> = (first..=last).map(|knot| target(f64::from(knot) * step)).collect();
    let is_straight = |index: usize| {
        let time = f64::from(first + index as i32) * step;
        time <= enter.time + enter.reach + step || time >= leave.time - leave.reach - step
    };
    let mut points = wanted.clone();
    for _ in 0..16 {
        let before = points.clone();
        for i in (1..points.len() - 1).filter(|&i| !is_straight(i)) {
            points[i] += wanted[i] - (before[i - 1] + 4.0 * before[i] + before[i + 1]) / 6.0;
        }
    }
    let path = Path { step: STEP, first, points: points.into_iter().map(|p| p.as_vec2()).collect() };
    (can_be_walked(frame, &path, &ends, limits) && stays_with(visit, &path, &ends)).then_some(path)
}

/// Whether a clip's hips are near a way while its walker is in the patch.
fn stays_with(visit: &Visit, path: &Path, ends: &[Line; 2]) -> bool {
    visit.body.root.iter().enumerate().all(|(frame, hips)| {
        let secs = f64::from(visit.begin) + frame as f64 / f64::from(FPS);
        let outside = secs < ends[0].time || secs > ends[1].time;
        outside || Vec2::new(hips.x, hips.z).distance(path.position(secs)) < STRAY
    })
}

/// Where the way should be: the clip's own, but straight at the border.
fn target(places: &[DVec2], begin: f64, ends: &[Line; 2], time: f64) -> DVec2 {
    let at = ((time - begin) * f64::from(FPS)).clamp(0.0, places.len() as f64 - 1.001);
    let own = places[at as usize].lerp(places[at as usize + 1], at.fract());
    let [enter, leave] = ends;
    let inside = [time - enter.time - enter.reach, leave.time - leave.reach - time];
    let [early, late] = inside.map(|secs| {
        let share = (secs / JOINED_SECS).clamp(0.0, 1.0);
        share * share * (3.0 - 2.0 * share)
    });
    leave.at(time).lerp(enter.at(time).lerp(own, early), late)
}

/// Places on the ground, each the mean of those around it.
fn smooth(roots: &[Vec3], frames: f32) -> Vec<DVec2> {
    let reach = (2.5 * frames).ceil() as i64;
    let weight = |k: i64| (-0.5 * (k as f64 / f64::from(frames)).powi(2)).exp();
    let ground = |f: i64| {
        // Beyond the ends it goes on as it went.
        let last = roots.len() as i64 - 1;
        let place = |f: i64| Vec2::new(roots[f as usize].x, roots[f as usize].z).as_dvec2();
        let inside = f.clamp(0, last);
        let step = if f < 0 { place(1) - place(0) } else { place(last) - place(last - 1) };
        place(inside) + step * (f - inside) as f64
    };
    let sum: f64 = (-reach..=reach).map(weight).sum();
    let mean = |f: i64| (-reach..=reach).map(|k| ground(f + k) * (weight(k) / sum)).sum();
    (0..roots.len() as i64).map(mean).collect()
}

/// Whether a way keeps the limits of walking, and a body's radius off all borders but where it crosses them.
fn can_be_walked(frame: &FramePatch, path: &Path, ends: &[Line; 2], limits: &Limits) -> bool {
    let (begin, end) = (ends[0].time, ends[1].time);
    let radius = f64::from(limits.radius);
    let steps = ((end - begin) / 0.025) as usize;
    (0..=steps).map(|i| begin + i as f64 * 0.025).all(|time| {
        let (velocity, pull) = (path.velocity(time), path.acceleration(time));
        let speed = velocity.length();
        let turning = velocity.perp_dot(pull).abs() / (speed * speed).max(1e-6);
        let calm = speed < WITHIN * limits.speed
            && pull.length() < WITHIN * limits.acceleration
            && (speed < limits.standing || turning < WITHIN * limits.turning);
        let place = path.position(time).as_dvec2();
        let inside = (0..frame.outline.len()).all(|edge| {
            let crosses = |line: &Line| {
                line.edge == edge && (time - line.time).abs() * line.velocity.length() <= 2.0 * radius + 0.3
            };
            let border = frame.border(edge);
            (place - border.begin).dot(border.inward) >= radius + 2e-3 || ends.iter().any(crosses)
        });
        calm && inside
    })
}
