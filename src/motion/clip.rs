//! A clip: one person's motion, as any importer delivers it.

use glam::{Quat, Vec3};

use super::{JointId, Skeleton};

/// One person's motion on any skeleton, sampled uniformly in time. Metres, seconds, y up.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    /// Name for messages, usually the file's stem.
    pub name: String,
    /// The skeleton the rotations speak of.
    pub skeleton: Skeleton,
    /// Frames per second.
    pub fps: f32,
    /// Root position per frame, metres.
    pub root: Vec<Vec3>,
    /// Local rotations, frame-major: `rotations[frame * joints + joint]`.
    pub rotations: Vec<Quat>,
}

impl Clip {
    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.root.len()
    }

    /// Seconds from the first to the last frame.
    pub fn seconds(&self) -> f32 {
        self.frames().saturating_sub(1) as f32 / self.fps
    }

    /// Local rotations of all joints at `frame`.
    pub fn pose(&self, frame: usize) -> &[Quat] {
        let n = self.skeleton.joints.len();
        &self.rotations[frame * n..(frame + 1) * n]
    }

    /// Global transforms of all joints at `frame`, into `out`.
    pub fn globals(&self, frame: usize, out: &mut Vec<(Vec3, Quat)>) {
        self.skeleton.globals(self.root[frame], self.pose(frame), out);
    }

    /// Global position of one joint at every frame. O(frames x joints).
    pub fn trajectory(&self, joint: JointId) -> Vec<Vec3> {
        let mut globals = Vec::new();
        (0..self.frames())
            .map(|f| {
                self.globals(f, &mut globals);
                globals[joint].0
            })
            .collect()
    }
}
