//! Feet on the floor: shifts a clip up or down so that planted feet stand at the canonical height, and bends the
//! toes of rigs that have none.

use glam::{Quat, Vec3};

use crate::motion::skeleton::joint::*;
use crate::motion::{Clip, JOINT_COUNT, plants};

/// Height of the ball of a planted foot, metres.
pub(super) const PLANTED: f32 = 0.02;

/// Speed (m/s) below which a ball is taken to stand.
const STANDING: f32 = 0.15;

/// Shifts a clip on the canonical skeleton so that standing balls are at [`PLANTED`]; `toes` says that toes have no
/// motion of their own and are to bend on the floor.
pub(super) fn settle(clip: &mut Clip, toes: bool) {
    let shift = PLANTED - floor_height(clip);
    clip.root.iter_mut().for_each(|p| p.y += shift);
    if toes {
        bend_toes(clip);
    }
}

/// Height of the balls of the feet while they stand: the lower quartile over all frames in which one hardly moves
/// (feet on steps or lifted and held are above it); where none stands, the lowest point.
fn floor_height(clip: &Clip) -> f32 {
    let (mut standing, mut lowest) = (Vec::new(), f32::INFINITY);
    for ball in [LEFT_TOE, RIGHT_TOE] {
        let points = clip.trajectory(ball);
        for (p, speed) in points.iter().zip(plants::speeds(&points, clip.fps)) {
            lowest = lowest.min(p.y);
            if speed < STANDING {
                standing.push(p.y);
            }
        }
    }
    // A foot held in the air may be still for long: only what is near the lowest point can be on the floor.
    standing.retain(|&y| y < lowest + 0.15);
    standing.sort_by(f32::total_cmp);
    standing.get(standing.len() / 4).copied().unwrap_or(lowest)
}

/// Lifts the toes against the foot where the foot's pitch would push them through the floor.
fn bend_toes(clip: &mut Clip) {
    let mut globals = Vec::new();
    for frame in 0..clip.frames() {
        clip.globals(frame, &mut globals);
        for toe in [LEFT_TOE, RIGHT_TOE] {
            let (ball, foot) = globals[toe];
            let tip = clip.skeleton.joints[toe].tip.expect("toes have tips");
            // In the toe's frame the tip may sink by its height above the floor and no more.
            let sink = (foot * tip).y.min(0.0) + (ball.y - PLANTED).max(0.0);
            if sink < 0.0 {
                let lift = (-sink / tip.length()).clamp(0.0, 1.0).asin();
                clip.rotations[frame * JOINT_COUNT + toe] *= Quat::from_axis_angle(Vec3::X, -lift);
            }
        }
    }
}
