//! How fast joints turn in the captures of a set.

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
