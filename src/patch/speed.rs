//! How fast joints turn in the captures of a set.

use std::f32::consts::TAU;

use glam::Quat;

use super::PatchSet;
use crate::motion::{JOINT_COUNT, Motion};

/// A joint that hardly moves in the captures may still turn this much, radians per frame.
const SLOWEST: f32 = 0.5 / crate::motion::FPS;

/// Angle between two rotations, radians.
pub(crate) fn turn_between(a: Quat, b: Quat) -> f32 {
    // Twice the arc sine of half the chord: exact for small angles, where an arc cosine is not.
    let b = if a.dot(b) < 0.0 { -b } else { b };
    4.0 * ((b - a).length() * 0.5).min(1.0).asin()
}

/// Bounds on how far each joint turns, to be compared with many turns.
pub(crate) struct Turns {
    /// Squares of the chords between the ends of the longest turns.
    chords: [f32; JOINT_COUNT],
}

impl Turns {
    /// From the longest turn of each joint, radians.
    pub fn up_to(longest: [f32; JOINT_COUNT]) -> Self {
        // As in `turn_between`: a turn by an angle has a chord of twice the sine of its quarter.
        let chord = |turn: f32| if turn < TAU { (2.0 * (turn / 4.0).sin()).powi(2) } else { f32::INFINITY };
        Self { chords: longest.map(chord) }
    }

    /// True if a joint turns further than it may.
    pub fn are_exceeded(&self, before: &[Quat], now: &[Quat]) -> bool {
        let mut exceeded = false;
        for ((&a, &b), &longest) in before.iter().zip(now).zip(&self.chords) {
            exceeded |= (b - a).length_squared().min((b + a).length_squared()) > longest;
        }
        exceeded
    }
}

impl PatchSet {
    /// The fastest turn of each joint anywhere in the set, radians per frame; hips' global. O(total frames).
    pub fn fastest_turns(&self) -> [f32; JOINT_COUNT] {
        fastest_turns(self.kinds.iter().flat_map(|k| &k.fragments).map(|f| &f.motion))
    }
}

/// The fastest turn of each joint anywhere in `motions`, radians per frame; hips' global.
pub(crate) fn fastest_turns<'a>(motions: impl IntoIterator<Item = &'a Motion>) -> [f32; JOINT_COUNT] {
    let mut fastest = [SLOWEST; JOINT_COUNT];
    for motion in motions {
        let hips = |f: usize| motion.path.at(f).rotation() * motion.pose(f)[0];
        for f in 1..motion.len() {
            let (before, now) = (motion.pose(f - 1), motion.pose(f));
            fastest[0] = fastest[0].max(turn_between(hips(f - 1), hips(f)));
            for j in 1..JOINT_COUNT {
                fastest[j] = fastest[j].max(turn_between(before[j], now[j]));
            }
        }
    }
    fastest
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn turns_are_exceeded_where_the_angle_is_larger() {
        let axis = Vec3::new(0.3, -0.5, 0.8).normalize();
        let from = Quat::from_rotation_x(1.1);
        for longest in [0.02, 0.3, 1.5, 3.0, 7.0] {
            for part in [0.5, 0.99, 1.01, 1.7] {
                let to = Quat::from_axis_angle(axis, longest * part) * from;
                let turns = Turns::up_to([longest; JOINT_COUNT]);
                let mut now = [from; JOINT_COUNT];
                for sign in [1.0, -1.0] {
                    now[7] = to * sign;
                    let angle = turn_between(from, to);
                    assert_eq!(turns.are_exceeded(&[from; JOINT_COUNT], &now), angle > longest, "{longest} {part}");
                }
            }
        }
    }
}
