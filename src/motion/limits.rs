//! Limits of the joints of the canonical skeleton: how far people can turn them.
//!
//! Every joint's local rotation is split into a twist about its bone and a swing of the bone (`rotation = swing *
//! twist`). Knees and elbows are hinges: they bend one way, by so much, and hardly go past straight. The others swing
//! within an ellipse of four half axes. The ranges begin at clinical goniometry (AAOS) and are widened until real
//! captures, which measure joints of skin and cloth, rarely leave them: they catch flips, and are no anatomy.

use std::f32::consts::PI;
use std::sync::LazyLock;

use glam::{Quat, Vec3};

use super::skeleton::joint::*;
use super::{JOINT_COUNT, Motion};

/// The range of one joint, radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimit {
    /// The bone's direction at rest, about which the joint twists.
    pub axis: Vec3,
    /// Two axes across the bone, about which it swings.
    pub across: [Vec3; 2],
    /// Least and largest swing about each of them.
    pub swing: [[f32; 2]; 2],
    /// Least and largest twist.
    pub twist: [f32; 2],
}

const fn degrees(value: f32) -> f32 {
    value / 180.0 * PI
}

const fn range(least: f32, most: f32) -> [f32; 2] {
    [degrees(least), degrees(most)]
}

/// A joint whose bone points along y or z or x; swings given about the two other axes in cyclic order, degrees.
const fn limit(axis: Vec3, across: [Vec3; 2], first: [f32; 2], second: [f32; 2], twist: [f32; 2]) -> JointLimit {
    let [a, b, c] = [first, second, twist];
    JointLimit { axis, across, swing: [range(a[0], a[1]), range(b[0], b[1])], twist: range(c[0], c[1]) }
}

const ROUND_Y: [Vec3; 2] = [Vec3::X, Vec3::Z];
const ROUND_X: [Vec3; 2] = [Vec3::Y, Vec3::Z];
const ROUND_Z: [Vec3; 2] = [Vec3::X, Vec3::Y];

/// The limits of a joint; `None` for the hips, which turn freely. Those of the right side mirror the left's.
pub fn limit_of(joint: usize) -> Option<JointLimit> {
    let left = if joint >= 5 && mirror(joint) < joint { mirror(joint) } else { joint };
    let of_left = match left {
        // About x: a positive turn carries a leg, which hangs down, backwards.
        LEFT_UP_LEG => limit(Vec3::NEG_Y, ROUND_Y, [-140.0, 50.0], [-50.0, 75.0], [-70.0, 70.0]),
        // A hinge: knees bend backwards only.
        LEFT_LEG => limit(Vec3::NEG_Y, ROUND_Y, [-10.0, 160.0], [-20.0, 20.0], [-50.0, 50.0]),
        LEFT_FOOT => limit(Vec3::Z, ROUND_Z, [-75.0, 75.0], [-65.0, 65.0], [-50.0, 50.0]),
        LEFT_TOE => limit(Vec3::Z, ROUND_Z, [-95.0, 60.0], [-35.0, 35.0], [-35.0, 35.0]),
        SPINE => limit(Vec3::Y, ROUND_Y, [-45.0, 100.0], [-40.0, 40.0], [-45.0, 45.0]),
        SPINE1 | SPINE2 => limit(Vec3::Y, ROUND_Y, [-45.0, 60.0], [-40.0, 40.0], [-45.0, 45.0]),
        NECK | HEAD => limit(Vec3::Y, ROUND_Y, [-70.0, 90.0], [-55.0, 55.0], [-75.0, 75.0]),
        // About y: a positive turn carries the left arm, which points along +x, backwards; about z, upwards.
        LEFT_SHOULDER => limit(Vec3::X, ROUND_X, [-50.0, 40.0], [-35.0, 55.0], [-40.0, 40.0]),
        LEFT_ARM => limit(Vec3::X, ROUND_X, [-150.0, 90.0], [-115.0, 120.0], [-135.0, 135.0]),
        // A hinge, but how the arm is rolled at rest differs between rigs: the left forearm bends forwards (about -y)
        // or, palms up, upwards (about +z), never back or down.
        LEFT_FORE_ARM => limit(Vec3::X, ROUND_X, [-165.0, 20.0], [-40.0, 165.0], [-120.0, 120.0]),
        LEFT_HAND => limit(Vec3::X, ROUND_X, [-75.0, 75.0], [-95.0, 95.0], [-110.0, 110.0]),
        _ => return None,
    };
    Some(if left == joint { of_left } else { mirrored(of_left) })
}

/// The same range on the other side of the body: turns about y and z change sign, axes along x do.
fn mirrored(limit: JointLimit) -> JointLimit {
    let flip = |[least, most]: [f32; 2]| [-most, -least];
    let turned = |axis: Vec3, range: [f32; 2]| if axis == Vec3::X { range } else { flip(range) };
    let along_x = limit.axis == Vec3::X;
    JointLimit {
        axis: if along_x { Vec3::NEG_X } else { limit.axis },
        across: limit.across,
        swing: [turned(limit.across[0], limit.swing[0]), turned(limit.across[1], limit.swing[1])],
        // A twist about a mirrored bone changes its sense, one about a bone in the mirror's plane as well.
        twist: flip(limit.twist),
    }
}

/// A rotation as swing of the bone (a rotation vector across it) and twist about it: `rotation = swing * twist`.
fn split(rotation: Quat, limit: &JointLimit) -> (Vec3, f32) {
    let q = if rotation.w < 0.0 { -rotation } else { rotation };
    let along = q.xyz().dot(limit.axis);
    let twist = 2.0 * along.atan2(q.w);
    let twist = (twist + PI).rem_euclid(2.0 * PI) - PI;
    let swing = q * Quat::from_axis_angle(limit.axis, -twist);
    (swing.to_scaled_axis(), twist)
}

fn join(swing: Vec3, twist: f32, limit: &JointLimit) -> Quat {
    (Quat::from_scaled_axis(swing) * Quat::from_axis_angle(limit.axis, twist)).normalize()
}

/// How much of the range a value uses: 1 at its edge, 0 at its middle of no turn.
fn used(value: f32, [least, most]: [f32; 2]) -> f32 {
    if value >= 0.0 { value / most } else { value / least }
}

/// The swing, brought into its ellipse.
fn clamp_swing(swing: Vec3, limit: &JointLimit) -> Vec3 {
    let parts = [swing.dot(limit.across[0]), swing.dot(limit.across[1])];
    let whole = used(parts[0], limit.swing[0]).hypot(used(parts[1], limit.swing[1]));
    let keep = if whole > 1.0 { 1.0 / whole } else { 1.0 };
    (limit.across[0] * parts[0] + limit.across[1] * parts[1]) * keep
}

/// The rotation of a joint brought within its limits; the same where it is within them.
pub fn clamp(joint: usize, rotation: Quat) -> Quat {
    let Some(Ready { limit, .. }) = &TABLE[joint] else { return rotation };
    let (swing, twist) = split(rotation, limit);
    let (inside, turned) = (clamp_swing(swing, limit), twist.clamp(limit.twist[0], limit.twist[1]));
    if inside.distance(swing) < 1e-5 && turned == twist { rotation } else { join(inside, turned, limit) }
}

/// A joint's limits, made ready for quick tests.
struct Ready {
    limit: JointLimit,
    /// Cosine of half the smallest of the limits.
    smallest: f32,
    /// Tangents of half the twist's limits.
    twist: [f32; 2],
}

static TABLE: LazyLock<[Option<Ready>; JOINT_COUNT]> = LazyLock::new(|| {
    std::array::from_fn(|joint| {
        let limit = limit_of(joint)?;
        let ends = [limit.swing[0], limit.swing[1], limit.twist];
        let smallest = ends.as_flattened().iter().map(|v| v.abs()).fold(PI, f32::min);
        Some(Ready { limit, smallest: (0.5 * smallest).cos(), twist: limit.twist.map(|t| (0.5 * t).tan()) })
    })
});

/// True only if a rotation is within its joint's limits: quick, since most are, but false for some near them as well.
fn is_well_within(joint: usize, rotation: Quat) -> bool {
    let Some(ready) = &TABLE[joint] else { return true };
    // Neither the swing nor the twist is larger than the whole turn.
    rotation.w.abs() > ready.smallest || ready.holds(if rotation.w < 0.0 { -rotation } else { rotation })
}

impl Ready {
    fn holds(&self, q: Quat) -> bool {
        let along = q.xyz().dot(self.limit.axis);
        let twist = (along * along + q.w * q.w).sqrt();
        if twist == 0.0 || along < self.twist[0] * q.w || along > self.twist[1] * q.w {
            return false;
        }
        let swing = (q * Quat::from_vec4((self.limit.axis * -along).extend(q.w))).xyz() / twist;
        // No arc sine is larger than this polynomial.
        let bound = swing * (2.0 + (PI - 2.0) * swing.length_squared());
        let parts = [0, 1].map(|i| used(bound.dot(self.limit.across[i]), self.limit.swing[i]));
        parts[0] * parts[0] + parts[1] * parts[1] < 1.0
    }
}

/// By what angle a joint's rotation is beyond its limits, radians; 0 within them.
pub fn excess(joint: usize, rotation: Quat) -> f32 {
    if is_well_within(joint, rotation) {
        return 0.0;
    }
    let kept = clamp(joint, rotation);
    if kept == rotation { 0.0 } else { kept.angle_between(rotation) }
}

/// A joint's rotation, brought back towards its limits where it is beyond them by more than `allowed`, radians: what
/// captures exceed the limits by, a change of them may exceed them by as well. Continuous in the rotation.
pub fn hold_back(joint: usize, rotation: Quat, allowed: impl FnOnce() -> f32) -> Quat {
    if is_well_within(joint, rotation) {
        return rotation;
    }
    let kept = clamp(joint, rotation);
    let (over, allowed) = (if kept == rotation { 0.0 } else { kept.angle_between(rotation) }, allowed());
    if over <= allowed { rotation } else { kept.slerp(rotation, allowed / over) }
}

/// How a motion keeps to the limits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Excess {
    /// The joint that is farthest beyond.
    pub joint: usize,
    /// At which frame.
    pub frame: usize,
    /// By how much, radians.
    pub worst: f32,
    /// Share of all joints and frames that are beyond by more than a degree.
    pub share: f32,
}

/// How far a motion's joints go beyond their limits. O(frames x joints).
pub fn measure(motion: &Motion) -> Excess {
    let mut out = Excess::default();
    let mut beyond = 0;
    for frame in 0..motion.len() {
        for (joint, &rotation) in motion.pose(frame).iter().enumerate() {
            let over = excess(joint, rotation);
            beyond += usize::from(over > degrees(1.0));
            if over > out.worst {
                (out.joint, out.frame, out.worst) = (joint, frame, over);
            }
        }
    }
    out.share = beyond as f32 / (motion.len() * JOINT_COUNT).max(1) as f32;
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::canonical;
    use crate::motion::testing::{standing, walking};
    use proptest::prelude::*;

    #[test]
    fn knees_and_elbows_bend_one_way() {
        let bent = |joint: usize, axis: Vec3, angle: f32| excess(joint, Quat::from_axis_angle(axis, degrees(angle)));
        for knee in [LEFT_LEG, RIGHT_LEG] {
            assert_eq!(bent(knee, Vec3::X, 120.0), 0.0);
            assert!((bent(knee, Vec3::X, -40.0) - degrees(30.0)).abs() < 1e-3);
        }
        for (elbow, side) in [(LEFT_FORE_ARM, 1.0), (RIGHT_FORE_ARM, -1.0)] {
            assert_eq!(bent(elbow, Vec3::NEG_Y * side, 130.0), 0.0);
            assert!(bent(elbow, Vec3::Y * side, 60.0) > degrees(35.0));
        }
        // Bent the allowed way the shin goes back and the forearm forward.
        assert!((Quat::from_rotation_x(1.0) * canonical().joints[LEFT_FOOT].offset).z < 0.0);
        assert!((Quat::from_rotation_y(-1.0) * canonical().joints[LEFT_HAND].offset).z > 0.0);
    }

    #[test]
    fn generated_motion_keeps_to_them() {
        for motion in [walking(3.0), standing(1.0)] {
            assert_eq!(measure(&motion).share, 0.0, "{:?}", measure(&motion));
        }
    }

    proptest! {
        #[test]
        fn clamping_ends_within_and_changes_nothing_within(
            joint in 1..JOINT_COUNT, x in -3.0f32..3.0, y in -3.0f32..3.0, z in -3.0f32..3.0, turn in 0.0f32..3.1,
        ) {
            let rotation = Quat::from_scaled_axis(Vec3::new(x, y, z).normalize_or(Vec3::X) * turn);
            let once = clamp(joint, rotation);
            prop_assert!(once.is_normalized());
            prop_assert!(excess(joint, once) < 2e-3, "{}", excess(joint, once));
            prop_assert!(!is_well_within(joint, rotation) || once == rotation);
            // The mirror image of a rotation is beyond the other side's limits by as much.
            let image = Quat::from_xyzw(rotation.x, -rotation.y, -rotation.z, rotation.w);
            prop_assert!((excess(mirror(joint), image) - excess(joint, rotation)).abs() < 2e-3);
            // Held back, it is beyond them by what is allowed, and no farther than it was.
            let (was, allowed) = (excess(joint, rotation), turn * 0.2);
            let held = hold_back(joint, rotation, || allowed);
            prop_assert!(held.angle_between(rotation) < (was - allowed).max(0.0) + 2e-3);
            prop_assert!(was > allowed || held == rotation);
        }
    }
}
