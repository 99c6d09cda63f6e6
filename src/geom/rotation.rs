//! Rotations in space as plain numbers: loops over many of them become vector instructions, which those over `glam::Quat` do not,
//! since that is one already.

use std::ops::Mul;

use glam::{Quat, Vec3};

/// A rotation: a quaternion of about unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rotation {
    /// Axis times sine of half the angle.
    pub axis: Vec3,
    /// Cosine of half the angle.
    pub cosine: f32,
}

impl Rotation {
    /// Of an angle's cosine and sine about a unit axis. Not for half a turn.
    #[inline(always)]
    pub fn about(axis: Vec3, cosine: f32, sine: f32) -> Self {
        Self { axis: axis * sine, cosine: 1.0 + cosine }.normalized()
    }

    /// The other way round.
    #[inline(always)]
    pub fn back(self) -> Self {
        Self { axis: -self.axis, ..self }
    }

    /// Of unit length.
    #[inline(always)]
    pub fn normalized(self) -> Self {
        let scale = 1.0 / (self.axis.length_squared() + self.cosine * self.cosine).sqrt();
        Self { axis: self.axis * scale, cosine: self.cosine * scale }
    }
}

impl Mul for Rotation {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let axis = other.axis * self.cosine + self.axis * other.cosine + self.axis.cross(other.axis);
        Self { axis, cosine: self.cosine * other.cosine - self.axis.dot(other.axis) }
    }
}

impl Mul<Vec3> for Rotation {
    type Output = Vec3;

    #[inline(always)]
    fn mul(self, v: Vec3) -> Vec3 {
        let twice = self.axis.cross(v) * 2.0;
        v + twice * self.cosine + self.axis.cross(twice)
    }
}

impl From<Quat> for Rotation {
    #[inline(always)]
    fn from(q: Quat) -> Self {
        Self { axis: q.xyz(), cosine: q.w }
    }
}

impl From<Rotation> for Quat {
    #[inline(always)]
    fn from(rotation: Rotation) -> Self {
        Self::from_vec4(rotation.axis.extend(rotation.cosine))
    }
}
