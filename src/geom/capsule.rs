//! Capsules: what bodies are made of for collision.

use glam::Vec3;

/// All points within `radius` of the segment from `a` to `b`, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// One end of the axis.
    pub a: Vec3,
    /// The other end.
    pub b: Vec3,
    /// Thickness around the axis.
    pub radius: f32,
}
