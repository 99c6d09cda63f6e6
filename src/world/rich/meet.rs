//! Interaction-rich patches: people come in over the border, meet, and go out over another border, on time.
//!
//! The inside is filled by tiling motion patches ([`crate::tiling`]): the patch's crossings are ports that somebody must come
//! in and go out by, its period is that of the tiling's time. Whoever is in such a patch has a clip for all of the stay; the
//! ordinary way is as near to the clip's own as a walker can go, and straight at the border. There clip and walk fade into each
//! other.

use std::sync::Arc;

use glam::{DVec2, Quat, Vec2, Vec3};

use super::tableau::Role;
use crate::geom::Polygon;
use crate::motion::{FPS, JOINT_COUNT};
use crate::patch::PatchSet;
use crate::stage::world::{Act, mix};
use crate::tiling::{Crossing, Place, Visit, playable, visits};
use crate::world::frame::Line;
use crate::world::solve::follow;
use crate::world::{CrowdPatch, FramePatch, Limits, Path, Port, Walker};

/// Hips are nowhere farther from the way, metres: whoever plays roots alone sees people where they are.
const STRAY: f64 = 0.24;
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
        let path = way(frame, visit, [ins[visit.comes], leave], limits)?;
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

/// The way of a clip; `None` if nobody could walk it, or hips are too far from it while its walker is in the patch.
fn way(frame: &FramePatch, visit: &Visit, ends: [Line; 2], limits: &Limits) -> Option<Path> {
    let (roots, begin) = (&visit.body.root, f64::from(visit.begin));
    let ground = |frame: usize| Vec2::new(roots[frame].x, roots[frame].z).as_dvec2();
    let hips = |time: f64| {
        let at = ((time - begin) * f64::from(FPS)).clamp(0.0, roots.len() as f64 - 1.001);
        ground(at as usize).lerp(ground(at as usize + 1), at.fract())
    };
    let path = follow(frame, limits, ends, hips)?;
    let stays = |i: usize| {
        let secs = begin + i as f64 / f64::from(FPS);
        secs < ends[0].time || secs > ends[1].time || path.position(secs).as_dvec2().distance(ground(i)) < STRAY
    };
    (0..roots.len()).all(stays).then_some(path)
}
