//! From the canonical body's final motion to that of a person of another build.
//!
//! Whatever meets the world stays: feet are where they were, and so are hands while they touch somebody, so that
//! plants, stitches and contacts hold as they did. Hips rise or sink in proportion to the legs, everything above them
//! keeps its joint angles, legs and touching arms follow by inverse kinematics. Where a leg would be straighter than
//! the canonical one, the hips come down, smoothly.

use glam::{Quat, Vec3};

use super::{Body, Segment, smoothstep};
use crate::motion::ik::two_bone;
use crate::motion::joint::*;
use crate::motion::limits::excess;
use crate::motion::{ANKLE_HEIGHT, BodyPart, Build, JOINT_COUNT, JointId, Skeleton, canonical};

/// Knees may always straighten to this part of the leg's length, however bent they were.
const EASY_STRETCH: f32 = 0.97;
/// No limb becomes straighter than this.
const MAX_STRETCH: f32 = 0.9995;
/// Most that hips are lowered, metres.
const MAX_LOWERING: f32 = 0.15;
/// Frames over which hips come down and rise again.
const LOWERING_FRAMES: usize = 6;
/// Frames over which a hand goes to the place where it touches, and comes back.
const APPROACH_FRAMES: f32 = 20.0;
/// A touching hand or a foot that falls short of its place by more than this is told, metres.
const MAX_MISS: f32 = 0.004;
/// A joint that is further beyond its limits than the canonical body's by more than this is told, radians.
const MAX_EXCESS: f32 = 2.5 / 180.0 * std::f32::consts::PI;

/// A hand that touches somebody or holds a box, or hips that sit on one, in frames of the body's motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    joint: JointId,
    begin: f32,
    end: f32,
}

impl Hold {
    /// 1 while it touches, less the longer before or after.
    fn weight(&self, frame: f32) -> f32 {
        let away = (self.begin - frame).max(frame - self.end).max(0.0);
        1.0 - smoothstep(away / APPROACH_FRAMES)
    }
}

/// How much a joint is held at a frame.
fn weight(holds: &[Hold], joint: JointId, frame: usize) -> f32 {
    holds.iter().filter(|h| h.joint == joint).map(|h| h.weight(frame as f32)).fold(0.0, f32::max)
}

/// When which hands touch others or hold a box, or hips sit on one, over a chain of segments; `begin` is the first frame of the body's
/// motion.
pub fn holds(segments: &[Segment], begin: u32) -> Vec<Hold> {
    let mut holds = Vec::new();
    for segment in segments {
        let role = segment.placed.role;
        let clock = segment.kind.fragments[role as usize].begin as f32;
        let frame = |at: u32| segment.placed.begin as f32 + (at as f32 - clock) / segment.rate() - begin as f32;
        for contact in &segment.kind.contacts {
            for touch in [&contact.a, &contact.b].into_iter().filter(|t| t.role == role) {
                let hand = match touch.part {
                    BodyPart::LeftHand => LEFT_HAND,
                    BodyPart::RightHand => RIGHT_HAND,
                    _ => continue,
                };
                holds.push(Hold { joint: hand, begin: frame(contact.begin) - 1.0, end: frame(contact.end) + 1.0 });
            }
        }
        for hold in segment.kind.props.iter().flat_map(|p| &p.holds).filter(|h| h.role == role) {
            let (begin, end) = (frame(hold.begin) - 1.0, frame(hold.end) + 1.0);
            holds.extend([LEFT_HAND, RIGHT_HAND].map(|joint| Hold { joint, begin, end }));
        }
        for seat in segment.kind.props.iter().flat_map(|p| &p.sat).filter(|s| s.role == role) {
            holds.push(Hold { joint: HIPS, begin: frame(seat.begin) - 1.0, end: frame(seat.end) + 1.0 });
        }
    }
    holds
}

/// The motion of a person of `build` who does what `body`, of the canonical build, does. Rotations speak of the
/// build's skeleton; `strained` has the frames on which a limb is too short or turned too far, besides the body's own.
/// O(frames x joints).
pub fn fit(body: &Body, holds: &[Hold], build: &Build) -> Body {
    let mut out = body.clone();
    if &build.skeleton == canonical() {
        return out;
    }
    let mut poses = Poses::new(body, holds, &build.skeleton);
    let lowering = poses.lowering(build.leg());
    for (f, down) in lowering.into_iter().enumerate() {
        let lift = poses.lift(f, build.leg()) - down;
        out.root[f].y += lift;
        let missed = poses.fit_frame(f, lift, holds, &mut out.rotations[f * JOINT_COUNT..][..JOINT_COUNT]);
        if missed > MAX_MISS || is_overturned(body.pose(f), out.pose(f)) {
            out.strained.push(f);
        }
    }
    out.strained.sort_unstable();
    out.strained.dedup();
    out
}

/// True if a joint is further beyond its limits after fitting than before.
fn is_overturned(before: &[Quat], after: &[Quat]) -> bool {
    let changed = (0..JOINT_COUNT).filter(|&j| after[j] != before[j]);
    changed
        .map(|j| (j, excess(j, after[j])))
        .any(|(j, now)| now > MAX_EXCESS && now > excess(j, before[j]) + MAX_EXCESS)
}

/// A motion on both skeletons.
struct Poses<'a> {
    bones: &'a Skeleton,
    /// Global joint transforms of the canonical body, frame-major.
    canonical: Vec<(Vec3, Quat)>,
    /// How much the hips are free to rise, per frame: not at all while they sit.
    free: Vec<f32>,
    /// Joint positions of the build's frame in hand.
    places: [Vec3; JOINT_COUNT],
}

impl<'a> Poses<'a> {
    fn new(body: &Body, holds: &[Hold], bones: &'a Skeleton) -> Self {
        let mut all = vec![(Vec3::ZERO, Quat::IDENTITY); body.rotations.len()];
        for (f, globals) in all.chunks_exact_mut(JOINT_COUNT).enumerate() {
            canonical().place(body.root[f], body.pose(f), globals);
        }
        let free = (0..body.root.len()).map(|f| 1.0 - weight(holds, HIPS, f)).collect();
        Self { bones, canonical: all, free, places: [Vec3::ZERO; JOINT_COUNT] }
    }

    fn frames(&self) -> usize {
        self.canonical.len() / JOINT_COUNT
    }

    fn frame(&self, f: usize) -> &[(Vec3, Quat)] {
        &self.canonical[f * JOINT_COUNT..][..JOINT_COUNT]
    }

    /// How far the hips rise with the legs' length: their height over the ankles grows in proportion.
    fn lift(&self, f: usize, leg: f32) -> f32 {
        let pose = self.frame(f);
        let hips = 0.5 * (pose[LEFT_UP_LEG].0.y + pose[RIGHT_UP_LEG].0.y);
        (hips - ANKLE_HEIGHT).max(0.0) * (leg / canonical_leg() - 1.0) * self.free[f]
    }

    /// How far the lifted hips must come down on each frame for no leg to be straighter than it was, smoothed.
    fn lowering(&self, leg: f32) -> Vec<f32> {
        let need: Vec<f32> = (0..self.frames()).map(|f| self.needed_lowering(f, leg)).collect();
        if need.iter().all(|&v| v == 0.0) {
            return need;
        }
        // A running maximum and a running mean of the same width: smooth, and nowhere less than needed.
        let n = need.len();
        let window = |f: usize| f.saturating_sub(LOWERING_FRAMES)..(f + LOWERING_FRAMES + 1).min(n);
        let widest: Vec<f32> = (0..n).map(|f| need[window(f)].iter().copied().fold(0.0, f32::max)).collect();
        (0..n).map(|f| widest[window(f)].iter().sum::<f32>() / window(f).len() as f32).collect()
    }

    fn needed_lowering(&self, f: usize, leg: f32) -> f32 {
        let (pose, lift) = (self.frame(f), self.lift(f, leg));
        let of_leg = |up: JointId| {
            let ankle = pose[up + 2].0;
            let stretch = pose[up].0.distance(ankle) / canonical_leg();
            let reach = leg * stretch.clamp(EASY_STRETCH, MAX_STRETCH);
            let hip = pose[HIPS].0 + Vec3::Y * lift + pose[HIPS].1 * self.bones.joints[up].offset;
            let across = (ankle - hip).with_y(0.0).length_squared();
            hip.y - ankle.y - (reach * reach - across).max(0.0).sqrt()
        };
        of_leg(LEFT_UP_LEG).max(of_leg(RIGHT_UP_LEG)).clamp(0.0, MAX_LOWERING)
    }

    /// Fits one frame whose hips are lifted; returns how far the worst foot or touching hand falls short, metres.
    fn fit_frame(&mut self, f: usize, lift: f32, holds: &[Hold], pose: &mut [Quat]) -> f32 {
        self.place(f, lift);
        let mut missed = 0.0f32;
        for ankle in [LEFT_FOOT, RIGHT_FOOT] {
            let target = self.frame(f)[ankle].0;
            missed = missed.max(self.reach(f, ankle, target, Vec3::Z, pose));
        }
        for hand in [LEFT_HAND, RIGHT_HAND] {
            let held = weight(holds, hand, f);
            if held > 0.0 {
                let target = self.places[hand].lerp(self.frame(f)[hand].0, held);
                let short = self.reach(f, hand, target, Vec3::NEG_Z, pose);
                missed = missed.max(if held == 1.0 { short } else { 0.0 });
            }
        }
        missed
    }

    /// Puts the build's joints where the canonical body's rotations have them: only bones differ, so turns are the same.
    fn place(&mut self, f: usize, lift: f32) {
        let pose = &self.canonical[f * JOINT_COUNT..][..JOINT_COUNT];
        self.places[HIPS] = pose[HIPS].0 + Vec3::Y * lift;
        for (j, joint) in self.bones.joints.iter().enumerate().skip(1) {
            let parent = joint.parent.unwrap_or(HIPS);
            self.places[j] = self.places[parent] + pose[parent].1 * joint.offset;
        }
    }

    /// Moves the end of a limb to `target`, the hand or foot keeping its direction; returns how far it falls short.
    fn reach(&self, f: usize, end: JointId, target: Vec3, pole: Vec3, pose: &mut [Quat]) -> f32 {
        let (upper, lower) = (end - 2, end - 1);
        let turns = |j: JointId| self.frame(f)[j].1;
        let [a, b, c] = [upper, lower, end].map(|j| self.places[j]);
        let (swing, bend, reached) = two_bone(a, b, c, target, turns(upper) * pole, MAX_STRETCH);
        let parent = self.bones.joints[upper].parent.unwrap_or(HIPS);
        let (upper_turn, lower_turn) = (swing * turns(upper), swing * bend * turns(lower));
        pose[upper] = (turns(parent).inverse() * upper_turn).normalize();
        pose[lower] = (upper_turn.inverse() * lower_turn).normalize();
        pose[end] = (lower_turn.inverse() * turns(end)).normalize();
        reached.distance(target)
    }
}

fn canonical_leg() -> f32 {
    let joints = &canonical().joints;
    joints[LEFT_LEG].offset.length() + joints[LEFT_FOOT].offset.length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{FPS, testing};
    use crate::patch::turn_between;
    use crate::refine::testing::body;

    fn globals(body: &Body, build: &Build, frame: usize) -> Vec<(Vec3, Quat)> {
        let mut out = Vec::new();
        build.skeleton.globals(body.root[frame], body.pose(frame), &mut out);
        out
    }

    fn fastest(body: &Body) -> f32 {
        let turns = |f: usize| (0..JOINT_COUNT).map(move |j| (f, j));
        let pairs = (1..body.root.len()).flat_map(turns);
        pairs.map(|(f, j)| turn_between(body.pose(f - 1)[j], body.pose(f)[j])).fold(0.0, f32::max)
    }

    #[test]
    fn feet_stay_where_they_were_and_hips_rise_with_the_legs() {
        let original = body(&testing::walking(4.0));
        for build in Build::catalogue().iter().flatten() {
            let fitted = fit(&original, &[], build);
            assert!(fitted.strained.is_empty(), "{}", build.name);
            for f in 0..original.root.len() {
                let (was, is) = (globals(&original, &Build::canonical(), f), globals(&fitted, build, f));
                for j in [LEFT_FOOT, LEFT_TOE, RIGHT_FOOT, RIGHT_TOE] {
                    assert!(was[j].0.distance(is[j].0) < 1e-3, "{}, frame {f}, joint {j}", build.name);
                    assert!(was[j].1.angle_between(is[j].1) < 1e-2, "{}, frame {f}, joint {j}", build.name);
                }
                let (rise, grown) = (is[HIPS].0.y - was[HIPS].0.y, build.leg() - canonical_leg());
                assert!((rise - grown).abs() < 0.04, "{}, frame {f}: {rise} for {grown}", build.name);
            }
            let (then, now) = (fastest(&original), fastest(&fitted));
            assert!(now < 1.2 * then, "{}: {now} after {then} radians per frame", build.name);
        }
    }

    #[test]
    fn a_touching_hand_stays_where_it_was_and_a_free_one_keeps_its_angles() {
        let mut motion = testing::standing(5.0);
        for f in 0..motion.len() {
            motion.rotations[f * JOINT_COUNT + RIGHT_ARM] = Quat::from_rotation_y(1.1) * Quat::from_rotation_z(0.6);
            motion.rotations[f * JOINT_COUNT + RIGHT_FORE_ARM] = Quat::from_rotation_y(0.9);
        }
        let original = body(&motion);
        let hold = Hold { joint: RIGHT_HAND, begin: 70.0, end: 80.0 };
        for build in Build::catalogue().iter().flatten() {
            let fitted = fit(&original, &[hold], build);
            assert!(fitted.strained.is_empty(), "{}", build.name);
            for f in 70..=80 {
                let (was, is) = (globals(&original, &Build::canonical(), f), globals(&fitted, build, f));
                assert!(was[RIGHT_HAND].0.distance(is[RIGHT_HAND].0) < 1e-3, "{}", build.name);
                assert!(was[RIGHT_HAND].1.angle_between(is[RIGHT_HAND].1) < 1e-2, "{}", build.name);
            }
            for f in [0, 40, 110, 149] {
                assert_eq!(original.pose(f)[RIGHT_ARM], fitted.pose(f)[RIGHT_ARM], "{}, frame {f}", build.name);
            }
            let step = |f: usize| {
                globals(&fitted, build, f)[RIGHT_HAND].0.distance(globals(&fitted, build, f - 1)[RIGHT_HAND].0)
            };
            let speed = (1..fitted.root.len()).map(step).fold(0.0, f32::max) * FPS;
            assert!(speed < 0.5, "{}: the hand goes to its place at {speed} m/s", build.name);
        }
    }

    #[test]
    fn a_touch_out_of_reach_is_told() {
        let mut motion = testing::standing(1.0);
        for f in 0..motion.len() {
            motion.rotations[f * JOINT_COUNT + LEFT_ARM] = Quat::from_rotation_z(1.5);
        }
        let hold = Hold { joint: LEFT_HAND, begin: 10.0, end: 12.0 };
        let small = Build::catalogue().iter().min_by(|a, b| a[0].stature().total_cmp(&b[0].stature())).unwrap();
        let fitted = fit(&body(&motion), &[hold], &small[0]);
        assert_eq!(fitted.strained, [10, 11, 12]);
        assert!(fit(&body(&motion), &[hold], &small[2]).strained.is_empty());
    }
}
