//! Hands led by their arms: what brings hands together and onto boxes.

use glam::{Quat, Vec3};

use super::Body;
use crate::motion::JOINT_COUNT;
use crate::motion::ik::two_bone;
use crate::motion::limits::{excess, hold_back};

/// Moves a hand that keeps its orientation, arm and fore-arm following as far as their joints turn.
pub(super) fn move_hand(body: &mut Body, index: usize, hand: usize, shift: Vec3) {
    let mut globals = Vec::new();
    body.globals(index, &mut globals);
    let (shoulder, arm, elbow) = (hand - 3, hand - 2, hand - 1);
    // Elbows point back where an arm is nearly straight.
    let pole = globals[arm].1 * Vec3::NEG_Z;
    let target = globals[hand].0 + shift;
    let (swing, bend, _) = two_bone(globals[arm].0, globals[elbow].0, globals[hand].0, target, pole, 0.999);
    let (upper, fore) = (swing * globals[arm].1, swing * bend * globals[elbow].1);
    let pose = &mut body.rotations[index * JOINT_COUNT..(index + 1) * JOINT_COUNT];
    let mut turn =
        |joint: usize, to: Quat| pose[joint] = hold_back(joint, to.normalize(), || excess(joint, pose[joint]));
    turn(arm, globals[shoulder].1.inverse() * upper);
    turn(elbow, upper.inverse() * fore);
    turn(hand, fore.inverse() * globals[hand].1);
}

/// How much of its shift a hand keeps `away` frames outside of the time over which it is led, for `frames` frames.
pub(super) fn fade(away: i32, frames: i32) -> f32 {
    let away = away.max(0) as f32 / (frames + 1) as f32;
    if away >= 1.0 { 0.0 } else { 1.0 - away * away * (3.0 - 2.0 * away) }
}
