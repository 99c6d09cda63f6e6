//! Whole arms made anew: where a hand is to be and which way it is to face says how the arm that brings it there bends.
//! For gestures that no capture shows; captured arms are corrected by [`super::ik`] instead.

use glam::{Mat3, Quat, Vec3};

use super::Foot;
use super::ik::bend;
use super::mirror::rotation as mirrored;
use super::skeleton::{bone_length, joint::*};

/// Shoulder girdle, upper arm, forearm and hand of one side.
pub(crate) fn joints(side: Foot) -> [usize; 4] {
    if side == Foot::Left {
        [LEFT_SHOULDER, LEFT_ARM, LEFT_FORE_ARM, LEFT_HAND]
    } else {
        [RIGHT_SHOULDER, RIGHT_ARM, RIGHT_FORE_ARM, RIGHT_HAND]
    }
}

/// 1 on the left, -1 on the right: x axes point to the left.
pub(crate) fn sign(side: Foot) -> f32 {
    if side == Foot::Left { 1.0 } else { -1.0 }
}

/// The global rotation of a hand whose fingers point along one direction and whose palm faces another.
pub(crate) fn hand_rotation(side: Foot, fingers: Vec3, facing: Vec3) -> Quat {
    let x = fingers.normalize() * sign(side);
    let y = -(facing - x * facing.dot(x)).try_normalize().unwrap_or_else(|| x.any_orthonormal_vector());
    Quat::from_mat3(&Mat3::from_cols(x, y, x.cross(y)))
}

/// How the shoulder girdle turns, up and forward, with a hand that is raised or reaches far, to be put before its local
/// rotation. `globals` are those of the body's joints.
pub(crate) fn shrug(globals: &[(Vec3, Quat)], side: Foot, palm: Vec3) -> Quat {
    let to = globals[SPINE2].1.inverse() * (palm - globals[joints(side)[1]].0);
    let raise = ((to.y + 0.15) * 0.55).clamp(0.0, 0.35);
    let forward = ((to.z - 0.25) * 0.6).clamp(0.0, 0.3);
    let left = Quat::from_rotation_y(-forward) * Quat::from_rotation_z(raise);
    if side == Foot::Left { left } else { mirrored(left) }
}

/// Local rotations of upper arm, forearm and hand that bring the wrist to a place, or as near as the arm is long, and the
/// hand to a global rotation; the elbow is a hinge, the hand's twist shared with the forearm. `elbow_left` is where it
/// points in the chest's frame, for the left arm (mirrored for the right); `globals` are those of the body's joints.
pub(crate) fn reach(globals: &[(Vec3, Quat)], side: Foot, wrist: Vec3, hand_turn: Quat, elbow_left: Vec3) -> [Quat; 3] {
    let [girdle, upper, lower, hand] = joints(side);
    let sign = sign(side);
    let (shoulder, chest) = (globals[upper].0, globals[SPINE2].1);
    let pole = chest * Vec3::new(elbow_left.x * sign, elbow_left.y, elbow_left.z);
    // An elbow that would point along the arm gives way to the back.
    let along = pole.normalize().dot((wrist - shoulder).normalize_or_zero()).abs();
    let pole = pole.normalize() + chest * Vec3::new(0.2 * sign, 0.0, -1.0) * (0.9 * along.powi(3));
    let (elbow, end) = bend(shoulder, wrist, bone_length(lower), bone_length(hand), pole, 0.995);
    // The elbow is behind the line from shoulder to wrist; the hinge's z looks to its front.
    let front = (shoulder + end) * 0.5 - elbow;
    let bone = |along: Vec3| {
        let x = along.normalize() * sign;
        let z = (front - x * front.dot(x)).normalize_or(chest * Vec3::Z);
        Quat::from_mat3(&Mat3::from_cols(x, z.cross(x), z))
    };
    let (upper_global, lower_global) = (bone(elbow - shoulder), bone(end - elbow));
    let wrist_turn = lower_global.inverse() * hand_turn;
    let twist = Quat::from_rotation_x(2.0 * wrist_turn.x.atan2(wrist_turn.w));
    let twist = if twist.w < 0.0 { -twist } else { twist };
    let shared = Quat::IDENTITY.slerp(twist, 0.75);
    [
        globals[girdle].1.inverse() * upper_global,
        upper_global.inverse() * lower_global * shared,
        shared.inverse() * wrist_turn,
    ]
}
