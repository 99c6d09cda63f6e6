//! Acts: full-body clips of people who do something else than walk, as functions of the time.
//!
//! A clip is hips and rotations frame by frame, evenly spaced in time. Who stays repeats a clip for ever: after its last frame
//! comes its first, and a whole number of rounds takes a period, so that the pose at any time follows from the time alone. Who
//! comes to meet others has a clip for its whole stay. Clips are shared: a file has each once. Rotations are 16-bit quaternions.

use glam::{Quat, Vec2, Vec3};

use super::fade::{Shares, fade};
use super::tables::{Tables, expect};
use super::{Spot, Walking, World};
use crate::Result;
use crate::container::{Reader, Writer};
use crate::motion::JOINT_COUNT;

/// In place of a clip: somebody without one.
pub(crate) const NO_ACT: u32 = u32::MAX;
/// What a one is in 16-bit quaternions.
const ONE: f32 = 32_767.0;
/// Walk and clip fade into each other over so many seconds after coming in and before going out.
const FADE_SECS: f64 = 0.5;

/// A clip before it is put into tables.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Act {
    /// Seconds from frame to frame.
    pub step: f32,
    /// Hips of every frame, metres.
    pub roots: Vec<Vec3>,
    /// Rotations, frame-major: the hips' in the same frame as the places, all others local.
    pub rotations: Vec<Quat>,
}

impl Act {
    /// The same for the same clip, wherever it was made.
    pub(crate) fn bits(&self) -> Vec<u32> {
        let numbers = self.roots.iter().flat_map(|p| p.to_array());
        let numbers = numbers.chain(self.rotations.iter().flat_map(|q| q.to_array()));
        std::iter::once(self.step).chain(numbers).map(f32::to_bits).collect()
    }
}

/// The clips of a world, and whose they are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Acts {
    /// End of every clip, in frames of all clips.
    pub ends: Vec<u32>,
    /// Seconds from frame to frame of every clip.
    pub steps: Vec<f32>,
    /// x, y, z of the hips at every frame.
    pub roots: Vec<f32>,
    /// x, y, z, w of every joint at every frame.
    pub rotations: Vec<i16>,
    /// The clip of everybody who stays, or none.
    pub stayers: Vec<u32>,
    /// By how many seconds it is ahead.
    pub stayer_leads: Vec<f32>,
    /// The clip of every walker of every kind, or none.
    pub walkers: Vec<u32>,
    /// Of every walker, seconds since the begin of the period it came in: when its clip begins, when it comes in, when it goes out.
    pub walker_times: Vec<f32>,
    /// Of every walker, on the same clock: when its left and its right foot begin and end to go over from its walk to its clip, then
    /// from its clip to its walk.
    pub walker_feet: Vec<f32>,
}

impl Acts {
    /// Appends a clip; returns its index.
    pub fn add(&mut self, act: &Act) -> u32 {
        self.steps.push(act.step);
        self.roots.extend(act.roots.iter().flat_map(|p| p.to_array()));
        let short = |v: f32| (v * ONE).round() as i16;
        self.rotations.extend(act.rotations.iter().flat_map(|q| q.normalize().to_array().map(short)));
        self.ends.push((self.roots.len() / 3) as u32);
        self.ends.len() as u32 - 1
    }

    /// How many clips there are.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The frames of a clip.
    pub fn frames(&self, act: usize) -> std::ops::Range<usize> {
        let begin = if act == 0 { 0 } else { self.ends[act - 1] as usize };
        begin..self.ends[act] as usize
    }

    /// Seconds of one round of a clip that repeats.
    pub fn round_secs(&self, act: usize) -> f64 {
        self.frames(act).len() as f64 * f64::from(self.steps[act])
    }

    /// Rotations of a clip that repeats into `pose`; returns the hips. O(1), no allocation.
    pub fn sample(&self, act: usize, secs: f64, pose: &mut [Quat; JOINT_COUNT]) -> Vec3 {
        let frames = self.frames(act);
        let at = (secs / f64::from(self.steps[act])).rem_euclid(frames.len() as f64);
        let first = (at as usize).min(frames.len() - 1);
        let next = if first + 1 < frames.len() { first + 1 } else { 0 };
        self.between(frames.start + first, frames.start + next, (at - first as f64) as f32, pose)
    }

    /// The same of a clip that is played once: held before its begin and after its end.
    pub fn sample_once(&self, act: usize, secs: f64, pose: &mut [Quat; JOINT_COUNT]) -> Vec3 {
        let frames = self.frames(act);
        let at = (secs / f64::from(self.steps[act])).clamp(0.0, (frames.len() - 1) as f64);
        let first = at as usize;
        let next = (first + 1).min(frames.len() - 1);
        self.between(frames.start + first, frames.start + next, (at - first as f64) as f32, pose)
    }

    fn between(&self, first: usize, next: usize, share: f32, pose: &mut [Quat; JOINT_COUNT]) -> Vec3 {
        for (joint, out) in pose.iter_mut().enumerate() {
            let (a, b) = (self.rotation(first, joint), self.rotation(next, joint));
            let b = if a.dot(b) < 0.0 { -b } else { b };
            *out = (a * (1.0 - share) + b * share).normalize();
        }
        self.root(first).lerp(self.root(next), share)
    }

    fn root(&self, frame: usize) -> Vec3 {
        Vec3::from_slice(&self.roots[3 * frame..])
    }

    /// Not quite of length one.
    fn rotation(&self, frame: usize, joint: usize) -> Quat {
        let at = 4 * (frame * JOINT_COUNT + joint);
        let part = |i: usize| f32::from(self.rotations[at + i]);
        Quat::from_xyzw(part(0), part(1), part(2), part(3))
    }

    /// Whether it fits the world.
    pub(super) fn validate(&self, tables: &Tables) -> Result<()> {
        let (clips, frames) = (self.ends.len(), self.roots.len() / 3);
        let begins = std::iter::once(0).chain(self.ends.iter().copied());
        let empty = begins.zip(&self.ends).position(|(begin, &end)| begin >= end);
        expect(empty.is_none(), "act_ends", || format!("clip {empty:?} without a frame"))?;
        let last = self.ends.last().map_or(0, |&end| end as usize);
        expect(self.roots.len() == 3 * last, "act_roots", || format!("{frames} frames instead of {last}"))?;
        let found = self.rotations.len();
        expect(found == 4 * JOINT_COUNT * last, "act_rotations", || format!("{found} numbers for {last} frames"))?;
        let steps = self.steps.len() == clips && self.steps.iter().all(|s| (1e-3..=10.0).contains(s));
        expect(steps, "act_steps", || format!("{:?}", self.steps))?;
        let far = self.roots.iter().find(|v| v.is_nan() || v.abs() > 1e3);
        expect(far.is_none(), "act_roots", || format!("{far:?} m"))?;
        let flat = self.rotations.chunks_exact(4).position(|q| q.iter().all(|v| v.unsigned_abs() < 1024));
        expect(flat.is_none(), "act_rotations", || format!("rotation {flat:?} is none"))?;
        let (people, leads) = (tables.stayer_names.len(), self.stayer_leads.len());
        let found = self.stayers.len();
        expect(found == people && leads == people, "stayer_acts", || format!("{found} for {people} people"))?;
        let odd = self.stayers.iter().find(|&&a| a != NO_ACT && a as usize >= clips);
        expect(odd.is_none(), "stayer_acts", || format!("a clip below {clips} is expected, {odd:?}"))?;
        let odd = self.stayer_leads.iter().find(|v| !v.is_finite());
        expect(odd.is_none(), "stayer_act_leads", || format!("{odd:?}"))?;
        let (people, found) = (tables.walkers.len(), self.walkers.len());
        expect(found == people, "walker_acts", || format!("{found} for {people} walkers"))?;
        let odd = self.walkers.iter().find(|&&a| a != NO_ACT && a as usize >= clips);
        expect(odd.is_none(), "walker_acts", || format!("a clip below {clips} is expected, {odd:?}"))?;
        let times = self.walker_times.len() == 3 * people && self.walker_times.iter().all(|t| t.is_finite());
        expect(times, "walker_act_times", || format!("{} numbers for {people} walkers", self.walker_times.len()))?;
        let feet = self.walker_feet.len() == 8 * people && self.walker_feet.iter().all(|t| t.is_finite());
        expect(feet, "walker_act_feet", || format!("{} numbers for {people} walkers", self.walker_feet.len()))
    }

    /// Bytes of all arrays.
    pub(super) fn bytes(&self) -> usize {
        let four =
            self.ends.len() + self.steps.len() + self.roots.len() + 2 * self.stayers.len() + 12 * self.walkers.len();
        4 * four + 2 * self.rotations.len()
    }

    pub(super) fn write(&self, writer: &mut Writer) {
        writer.array("act_ends", &self.ends);
        writer.array("act_steps", &self.steps);
        writer.array("act_roots", &self.roots);
        writer.array("act_rotations", &self.rotations);
        writer.array("stayer_acts", &self.stayers);
        writer.array("stayer_act_leads", &self.stayer_leads);
        writer.array("walker_acts", &self.walkers);
        writer.array("walker_act_times", &self.walker_times);
        writer.array("walker_act_feet", &self.walker_feet);
    }

    pub(super) fn read(reader: &Reader) -> Result<Self> {
        let walker_times: Vec<f32> = reader.array("walker_act_times")?;
        // Worlds made before feet stood still meanwhile have none.
        let with_body = || walker_times.chunks_exact(3).flat_map(|times| feet_with_body(times[1], times[2])).collect();
        let has_feet = reader.has("walker_act_feet");
        Ok(Self {
            walker_feet: if has_feet { reader.array("walker_act_feet")? } else { with_body() },
            ends: reader.array("act_ends")?,
            steps: reader.array("act_steps")?,
            roots: reader.array("act_roots")?,
            rotations: reader.array("act_rotations")?,
            stayers: reader.array("stayer_acts")?,
            stayer_leads: reader.array("stayer_act_leads")?,
            walkers: reader.array("walker_acts")?,
            walker_times,
        })
    }
}

/// When feet go over from walk to clip and back if nothing is known of their steps: as the body does.
pub(crate) fn feet_with_body(enter: f32, leave: f32) -> [f32; 8] {
    let (first, last) = (enter + FADE_SECS as f32, leave - FADE_SECS as f32);
    [enter, first, enter, first, last, leave, last, leave]
}

impl World {
    /// The clip of the `index`-th of those who stay in a kind, if it has one, and by how many seconds it is ahead.
    pub fn stayer_act(&self, kind: usize, index: usize) -> Option<(usize, f64)> {
        let acts = self.tables.acts.as_ref()?;
        let number = self.kind(kind).first_stayer() + index;
        let act = acts.stayers[number];
        (act != NO_ACT).then(|| (act as usize, f64::from(acts.stayer_leads[number])))
    }

    /// The clip of a walker of a kind, if it has one: seconds since the begin of the period it came in at which the clip begins, the
    /// walker comes in, and goes out.
    pub fn walker_act(&self, kind: usize, walker: usize) -> Option<(usize, [f64; 3])> {
        let acts = self.tables.acts.as_ref()?;
        let number = self.kind(kind).first_walker() + walker;
        let times = &acts.walker_times[3 * number..3 * number + 3];
        let act = acts.walkers[number];
        (act != NO_ACT).then(|| (act as usize, [times[0], times[1], times[2]].map(f64::from)))
    }

    /// The body of a walker of a patch (its index in the kind, and the period it came in, as [`World::walkers_of`] says) who is
    /// `walking` at `time` ([`World::bodies`] says how), be it that it just walks or that it does something: rotations of the canonical
    /// skeleton into `pose`; returns the hips, relative to the patch's own origin, turned as the patch is. Nobody moves without a
    /// gait. O(1), no allocation.
    pub fn walker_body(
        &self,
        spot: Spot,
        (walker, lap): (usize, i64),
        walking: &Walking,
        time: f64,
        pose: &mut [Quat; JOINT_COUNT],
    ) -> Vec3 {
        let instance = spot.instance as usize;
        let ground = Vec3::new(walking.place.x, 0.0, walking.place.y);
        let hips = self.tables.gait.as_ref().map_or(ground, |gait| walking.pose(&gait.table, pose));
        let Some((act, [begin, enter, leave])) = self.walker_act(self.kind_of(instance), walker) else { return hips };
        let period = f64::from(self.info().period_secs);
        let slot = period / f64::from(self.info().slots);
        let own = time + f64::from(self.tables.instance_phases[instance]) * slot - lap as f64 * period;
        let shares = self.shares(self.kind(self.kind_of(instance)).first_walker() + walker, own, [enter, leave]);
        let mut acted = [Quat::IDENTITY; JOINT_COUNT];
        let Some(acts) = &self.tables.acts else { return hips };
        let turn = Quat::from_rotation_y(-self.turn(instance));
        let place = turn * acts.sample_once(act, own - begin, &mut acted);
        acted[0] = turn * acted[0];
        fade(pose, hips, (&acted, place), shares)
    }

    /// How much of somebody's clip is seen, at a time on its own clock.
    fn shares(&self, walker: usize, own: f64, [enter, leave]: [f64; 2]) -> Shares {
        let eased = |share: f64| {
            let share = share.clamp(0.0, 1.0) as f32;
            share * share * (3.0 - 2.0 * share)
        };
        let body = eased((own - enter).min(leave - own) / FADE_SECS);
        let times = self.tables.acts.as_ref().map_or(&[][..], |acts| &acts.walker_feet[8 * walker..8 * walker + 8]);
        let gone = |i: usize| {
            let (from, to) = (f64::from(times[i]), f64::from(times[i + 1]));
            eased((own - from) / (to - from).max(1e-3))
        };
        Shares { body, feet: [0, 2].map(|foot| gone(foot).min(1.0 - gone(foot + 4))) }
    }

    /// The body of the `index`-th of those who stay in a patch, at `time` (seconds, any): rotations of the canonical skeleton into
    /// `pose`; returns the hips, relative to the patch's own origin, turned as the patch is. `None` if it has no act. O(1), no
    /// allocation.
    pub fn stayer_body(&self, spot: Spot, index: usize, time: f64, pose: &mut [Quat; JOINT_COUNT]) -> Option<Vec3> {
        let instance = spot.instance as usize;
        let kind = self.kind_of(instance);
        let (act, lead) = self.stayer_act(kind, index)?;
        let stayer = self.kind(kind).stayers().nth(index)?;
        let slot = f64::from(self.info().period_secs) / f64::from(self.info().slots);
        let own = time + f64::from(self.tables.instance_phases[instance]) * slot;
        // Rounds are whole parts of the period; folding by it first keeps roundings from adding up over hours.
        let own = own.rem_euclid(f64::from(self.info().period_secs));
        let hips = self.tables.acts.as_ref()?.sample(act, own + lead, pose);
        let turn = self.turn(instance);
        let place = Vec2::from_angle(turn).rotate(stayer.place);
        let heading = Quat::from_rotation_y(stayer.heading - turn);
        pose[0] = heading * pose[0];
        Some(heading * hips + Vec3::new(place.x, 0.0, place.y))
    }
}
