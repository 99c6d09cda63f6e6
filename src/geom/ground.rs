//! The ground plane as complex numbers.
//!
//! A ground point (x, z) is the complex number z + i x, stored as `Vec2 { x, y: z }`. A turn by `heading`
//! about the vertical (y) axis is then a multiplication by e^(i heading); heading 0 looks along +z and
//! heading +90 deg along +x, as glTF's right-handed y-up frame has it.

use glam::{Quat, Vec2, Vec3};

/// A rotation about the vertical axis, kept as the unit complex number cos + i sin of its angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Cosine of the angle.
    pub cos: f32,
    /// Sine of the angle.
    pub sin: f32,
}

impl Turn {
    /// No turn.
    pub const IDENTITY: Self = Self { cos: 1.0, sin: 0.0 };

    /// The turn by `angle` radians.
    pub fn from_angle(angle: f32) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self { cos, sin }
    }

    /// The ground vector `v` turned.
    #[inline]
    pub fn apply(self, v: Vec2) -> Vec2 {
        Vec2::new(self.cos * v.x + self.sin * v.y, self.cos * v.y - self.sin * v.x)
    }

    /// This turn and another.
    #[inline]
    pub fn then(self, inner: Self) -> Self {
        Self { cos: self.cos * inner.cos - self.sin * inner.sin, sin: self.sin * inner.cos + self.cos * inner.sin }
    }

    /// The angle in radians, in (-pi, pi].
    pub fn angle(self) -> f32 {
        self.sin.atan2(self.cos)
    }
}

/// A rigid transform of the ground plane: turn by `heading`, then move by `position`.
///
/// Also the state of a person on the ground (`world_from_person`).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Ground {
    /// Ground position (x, z) in metres.
    pub position: Vec2,
    /// Turn about the vertical in radians; not wrapped.
    pub heading: f32,
}

impl Ground {
    /// The identity.
    pub const IDENTITY: Self = Self { position: Vec2::ZERO, heading: 0.0 };

    /// The transform that turns by `heading`, then moves by `position`.
    pub fn new(position: Vec2, heading: f32) -> Self {
        Self { position, heading }
    }

    /// `world_from_a.then(a_from_b)` is `world_from_b`.
    pub fn then(self, inner: Self) -> Self {
        Self { position: self.apply(inner.position), heading: self.heading + inner.heading }
    }

    /// The inverse transform.
    pub fn inverse(self) -> Self {
        Self { position: -Turn::from_angle(-self.heading).apply(self.position), heading: -self.heading }
    }

    /// A point carried by this transform.
    pub fn apply(self, point: Vec2) -> Vec2 {
        self.position + self.turn().apply(point)
    }

    /// The turn alone.
    pub fn turn(self) -> Turn {
        Turn::from_angle(self.heading)
    }

    /// A point of space carried by this transform; its height stays.
    pub fn apply3(self, point: Vec3) -> Vec3 {
        let g = self.apply(Vec2::new(point.x, point.z));
        Vec3::new(g.x, point.y, g.y)
    }

    /// The turn as a quaternion about +y.
    pub fn rotation(self) -> Quat {
        Quat::from_rotation_y(self.heading)
    }
}

/// The angle wrapped into [-pi, pi].
pub fn wrap_angle(angle: f32) -> f32 {
    use std::f32::consts::{PI, TAU};
    let wrapped = (angle + PI).rem_euclid(TAU) - PI;
    if wrapped < -PI { -PI } else { wrapped }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::FRAC_PI_2;

    #[test]
    fn heading_ninety_degrees_looks_along_plus_x_as_the_quaternion_does() {
        let ground = Ground::new(Vec2::ZERO, FRAC_PI_2);
        let forward = ground.apply(Vec2::new(0.0, 1.0));
        assert!((forward - Vec2::new(1.0, 0.0)).length() < 1e-6);
        let forward3 = ground.rotation() * Vec3::Z;
        assert!((forward3 - Vec3::X).length() < 1e-6);
    }

    #[test]
    fn inverse_undoes() {
        let a = Ground::new(Vec2::new(3.0, -2.0), 2.3);
        let p = Vec2::new(0.4, 7.0);
        assert!((a.inverse().apply(a.apply(p)) - p).length() < 1e-5);
        let round = a.then(a.inverse());
        assert!(round.position.length() < 1e-6 && round.heading.abs() < 1e-6);
    }
}
