//! Motion on the canonical skeleton as the later stages want it: a motion path on the ground, and
//! body poses relative to the path's local frames, so that deforming the path carries the body along.

use glam::{Quat, Vec2, Vec3};

use super::skeleton::{JOINT_COUNT, canonical};
use crate::geom::Ground;

/// The ground trajectory of a person's root: where, and heading, at every frame of [`super::FPS`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MotionPath {
    /// Ground points (x, z) under the hips, metres.
    pub points: Vec<Vec2>,
    /// Unwrapped headings in radians: continuous from frame to frame, smoother than the hips' own yaw.
    pub headings: Vec<f32>,
}

impl MotionPath {
    /// Number of frames.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// True if it has no frame.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// The local frame at `frame`.
    pub fn at(&self, frame: usize) -> Ground {
        Ground::new(self.points[frame], self.headings[frame])
    }
}

/// Left or right.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Foot {
    /// The left foot.
    Left,
    /// The right foot.
    Right,
}

/// A time over which the ball of a foot (its toe joint) stays in place.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Plant {
    /// Which foot.
    pub foot: Foot,
    /// First frame.
    pub begin: u32,
    /// Last frame, inclusive.
    pub end: u32,
}

/// One person's motion on the canonical skeleton at [`super::FPS`]: path plus body plus foot plants.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Motion {
    /// The path; the hips are always straight above its points.
    pub path: MotionPath,
    /// Height of the hips per frame, metres.
    pub heights: Vec<f32>,
    /// Rotations, frame-major (`frame * JOINT_COUNT + joint`): the hips' relative to the path's frame, all others local.
    pub rotations: Vec<Quat>,
    /// Foot plants, sorted by begin.
    pub plants: Vec<Plant>,
}

impl Motion {
    /// Number of frames.
    pub fn len(&self) -> usize {
        self.path.len()
    }

    /// True if it has no frame.
    pub fn is_empty(&self) -> bool {
        self.path.is_empty()
    }

    /// The motion from frame `begin` to frame `end`, both included; foot plants are clipped to it, and those that
    /// reach in by a single frame are left out. Panics where `end` is not below the motion's length.
    pub fn slice(&self, begin: usize, end: usize) -> Self {
        let clipped = self.plants.iter().filter_map(|p| {
            let (from, to) = ((p.begin as usize).max(begin), (p.end as usize).min(end));
            (from < to).then(|| Plant { foot: p.foot, begin: (from - begin) as u32, end: (to - begin) as u32 })
        });
        Self {
            path: MotionPath {
                points: self.path.points[begin..=end].to_vec(),
                headings: self.path.headings[begin..=end].to_vec(),
            },
            heights: self.heights[begin..=end].to_vec(),
            rotations: self.rotations[begin * JOINT_COUNT..(end + 1) * JOINT_COUNT].to_vec(),
            plants: clipped.collect(),
        }
    }

    /// Rotations of all joints at `frame`, the hips' relative to the path's frame.
    pub fn pose(&self, frame: usize) -> &[Quat] {
        &self.rotations[frame * JOINT_COUNT..(frame + 1) * JOINT_COUNT]
    }

    /// Global joint transforms at `frame`, into `out`, with the path's frame moved to `world_from_path`.
    pub fn globals_at(&self, frame: usize, world_from_path: Ground, out: &mut Vec<(Vec3, Quat)>) {
        let mut pose: [Quat; JOINT_COUNT] = self.pose(frame).try_into().expect("JOINT_COUNT rotations");
        pose[0] = world_from_path.rotation() * pose[0];
        let root = Vec3::new(world_from_path.position.x, self.heights[frame], world_from_path.position.y);
        canonical().globals(root, &pose, out);
    }

    /// Global joint transforms at `frame`, into `out`.
    pub fn globals(&self, frame: usize, out: &mut Vec<(Vec3, Quat)>) {
        self.globals_at(frame, self.path.at(frame), out);
    }
}
