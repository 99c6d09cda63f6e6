//! Knees are hinges: markers on skin and rigs whose thighs do not roll with the leg make them bend sideways. The thigh
//! is rolled about itself until its knee bends back; hips, knees and feet stay where they are.

use glam::Quat;

use crate::motion::skeleton::joint::*;
use crate::motion::{JOINT_COUNT, Motion, canonical};

/// Sine of the bend at which half of the roll is made: a straight leg's knee bends nowhere.
const HALF_BEND: f32 = 0.2;

/// Rolls the thighs of every frame. O(frames).
pub(super) fn straighten(motion: &mut Motion) {
    for pose in motion.rotations.chunks_exact_mut(JOINT_COUNT) {
        for (thigh, knee) in [(LEFT_UP_LEG, LEFT_LEG), (RIGHT_UP_LEG, RIGHT_LEG)] {
            let roll = roll(pose[knee], knee);
            pose[thigh] = (pose[thigh] * roll).normalize();
            pose[knee] = (roll.inverse() * pose[knee]).normalize();
        }
    }
}

/// The thigh's roll that lets a knee bend back: all of it where the knee bends much, none where it hardly bends or is
/// bent forward.
fn roll(turn: Quat, knee: usize) -> Quat {
    let thigh = canonical().joints[knee].offset.normalize();
    let shin = turn * canonical().joints[knee + 1].offset.normalize();
    let bend = shin.reject_from_normalized(thigh);
    let size = bend.length();
    if size < 1e-6 || bend.z >= 0.0 {
        return Quat::IDENTITY;
    }
    let sideways = (bend.x / size).clamp(-1.0, 1.0).asin();
    let weight = size * size / (size * size + HALF_BEND * HALF_BEND) * (-bend.z / size);
    Quat::from_rotation_y(-sideways * weight)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::limits::excess;
    use crate::motion::testing::walking;
    use glam::Vec3;

    /// A walk whose thighs are rolled, as if markers had slipped, by `roll` radians; the legs are where they were.
    fn slipped(roll: f32) -> Motion {
        let mut motion = walking(3.0);
        for pose in motion.rotations.chunks_exact_mut(JOINT_COUNT) {
            for (thigh, knee) in [(LEFT_UP_LEG, LEFT_LEG), (RIGHT_UP_LEG, RIGHT_LEG)] {
                let turn = Quat::from_rotation_y(roll);
                pose[thigh] *= turn;
                pose[knee] = turn.inverse() * pose[knee];
            }
        }
        motion
    }

    fn sideways(motion: &Motion) -> f32 {
        let knees = |pose: &[Quat]| [LEFT_LEG, RIGHT_LEG].map(|k| (pose[k] * Vec3::NEG_Y).x.abs());
        motion.rotations.chunks_exact(JOINT_COUNT).flat_map(knees).fold(0.0, f32::max)
    }

    #[test]
    fn knees_bend_back_and_legs_stay() {
        for roll in [-0.6, 0.3, 0.6] {
            let was = slipped(roll);
            let mut is = was.clone();
            straighten(&mut is);
            assert!(sideways(&is) < 0.35 * sideways(&was), "{roll}: {} of {}", sideways(&is), sideways(&was));
            let (mut before, mut after) = (Vec::new(), Vec::new());
            for frame in 0..was.len() {
                was.globals(frame, &mut before);
                is.globals(frame, &mut after);
                assert!(before.iter().zip(&after).all(|(a, b)| a.0.distance(b.0) < 1e-4), "{roll}, frame {frame}");
                assert!(is.pose(frame).iter().enumerate().all(|(j, &q)| excess(j, q) < 0.02), "{roll}, frame {frame}");
            }
        }
    }

    #[test]
    fn knees_that_bend_back_already_and_straight_ones_change_nothing() {
        for bend in [0.0, 0.3, 1.0, 2.0] {
            assert!(roll(Quat::from_rotation_x(bend), LEFT_LEG).angle_between(Quat::IDENTITY) < 2e-3, "{bend}");
        }
        let forward = Quat::from_rotation_x(-0.2);
        assert_eq!(roll(forward, LEFT_LEG), Quat::IDENTITY);
    }
}
