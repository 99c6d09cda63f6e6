//! Feet on the floor: shifts a clip up or down so that planted feet stand at the canonical height, and bends the
//! toes of rigs that have none. Rest poses do not say how the sole lies (and some files carry one person's rotations
//! on another's bones), so the soles are levelled by where feet stand still.

use glam::{Quat, Vec3};

use crate::motion::skeleton::joint::*;
use crate::motion::{Clip, JOINT_COUNT, canonical, plants};

/// Height of the ball of a planted foot, metres.
pub(super) const PLANTED: f32 = 0.02;

/// Speed (m/s) below which a ball is taken to stand.
const STANDING: f32 = 0.15;

/// Largest correction of a sole, radians.
const MAX_LEVELLING: f32 = 25.0 / 180.0 * std::f32::consts::PI;

/// How far a toe's tip may sink into the floor, metres.
const TOE_SLACK: f32 = 0.005;

/// Shifts a clip on the canonical skeleton so that standing balls are at [`PLANTED`]; `toes` says that toes have no
/// motion of their own and are to bend on the floor.
pub(super) fn settle(clip: &mut Clip, toes: bool) {
    for foot in [LEFT_FOOT, RIGHT_FOOT] {
        level_sole(clip, foot);
    }
    let shift = PLANTED - floor_height(clip);
    clip.root.iter_mut().for_each(|p| p.y += shift);
    if toes {
        bend_toes(clip);
    }
}

/// Pitches a foot by a constant, so that where ankle and ball stand still the sole is level: there the median pitch of
/// the line from ankle to ball becomes that of the canonical rest pose. Nothing is done where the foot never stands
/// for a quarter of a second in all, or would have to turn by more than 25 degrees (someone on tiptoe).
fn level_sole(clip: &mut Clip, foot: usize) {
    let (ankles, balls) = (clip.trajectory(foot), clip.trajectory(foot + 1));
    let speeds = [&ankles, &balls].map(|points| plants::speeds(points, clip.fps));
    let lowest = lowest(balls.iter().map(|p| p.y).collect());
    let pitch = |offset: Vec3| f32::atan2(-offset.y, Vec3::new(offset.x, 0.0, offset.z).length());
    let stands = |&f: &usize| speeds.iter().all(|s| s[f] < STANDING) && balls[f].y < lowest + 0.15;
    let mut pitches: Vec<f32> = (0..clip.frames()).filter(stands).map(|f| pitch(balls[f] - ankles[f])).collect();
    if (pitches.len() as f32) < 0.25 * clip.fps {
        return;
    }
    pitches.sort_by(f32::total_cmp);
    let error = pitch(clip.skeleton.joints[foot + 1].offset) - pitches[pitches.len() / 2];
    if error.abs() > MAX_LEVELLING {
        return;
    }
    for pose in clip.rotations.chunks_exact_mut(JOINT_COUNT) {
        pose[foot] *= Quat::from_rotation_x(error);
    }
}

/// Height of the balls of the feet while they stand: the lower quartile over all frames in which one hardly moves
/// (feet on steps or lifted and held are above it); where none stands, the lowest point.
fn floor_height(clip: &Clip) -> f32 {
    let (mut standing, mut all) = (Vec::new(), Vec::new());
    for ball in [LEFT_TOE, RIGHT_TOE] {
        let points = clip.trajectory(ball);
        for (p, speed) in points.iter().zip(plants::speeds(&points, clip.fps)) {
            all.push(p.y);
            if speed < STANDING {
                standing.push(p.y);
            }
        }
    }
    let lowest = lowest(all);
    // A foot held in the air may be still for long: only what is near the lowest point can be on the floor.
    standing.retain(|&y| y < lowest + 0.15);
    standing.sort_by(f32::total_cmp);
    standing.get(standing.len() / 4).copied().unwrap_or(lowest)
}

/// The lowest of many heights, but for the lowest fiftieth: a frame that is out of place does not dig the floor.
pub(crate) fn lowest(mut heights: Vec<f32>) -> f32 {
    heights.sort_by(f32::total_cmp);
    heights.get(heights.len() / 50).copied().unwrap_or(f32::INFINITY)
}

/// Lifts the toes against the foot where the foot's pitch would push them through the floor.
fn bend_toes(clip: &mut Clip) {
    let mut globals = Vec::new();
    for frame in 0..clip.frames() {
        clip.globals(frame, &mut globals);
        for toe in [LEFT_TOE, RIGHT_TOE] {
            clip.rotations[frame * JOINT_COUNT + toe] *= lift_toe(globals[toe].0, globals[toe].1);
        }
    }
}

/// The turn in the toe's own frame that keeps its tip as high as the ball of a planted foot: none if it is. A toe
/// that sinks by up to [`TOE_SLACK`] is left alone.
pub(super) fn lift_toe(ball: Vec3, toe: Quat) -> Quat {
    let tip = canonical().joints[LEFT_TOE].tip.expect("toes have tips");
    let (down, may) = (-(toe * tip).y, (ball.y - PLANTED).max(0.0) + TOE_SLACK);
    if down <= may {
        return Quat::IDENTITY;
    }
    // About the level axis across the toe, wherever the foot has rolled to.
    let across = (toe * tip).cross(Vec3::Y).try_normalize().unwrap_or(toe * Vec3::NEG_X);
    let pitch = |drop: f32| (drop / tip.length()).min(1.0).asin();
    Quat::from_axis_angle(toe.inverse() * across, pitch(down) - pitch(may)).normalize()
}
