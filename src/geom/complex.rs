//! Ground vectors as complex numbers z + i x (see [`super::ground`](super)): a similarity of the plane is one number.

use glam::Vec2;

/// Product.
#[inline]
pub fn mul(a: Vec2, b: Vec2) -> Vec2 {
    Vec2::new(a.x * b.y + a.y * b.x, a.y * b.y - a.x * b.x)
}

/// Conjugate.
#[inline]
pub fn conj(a: Vec2) -> Vec2 {
    Vec2::new(-a.x, a.y)
}

/// e^(i angle).
#[inline]
pub fn unit(angle: f32) -> Vec2 {
    let (sin, cos) = angle.sin_cos();
    Vec2::new(sin, cos)
}

/// The angle in radians, in [-pi, pi].
#[inline]
pub fn arg(a: Vec2) -> f32 {
    a.x.atan2(a.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Turn;

    #[test]
    fn multiplication_by_a_unit_turns() {
        let (v, angle) = (Vec2::new(0.3, -1.2), 0.7);
        assert!((mul(unit(angle), v) - Turn::from_angle(angle).apply(v)).length() < 1e-6);
        assert!((arg(mul(unit(0.4), unit(0.5))) - 0.9).abs() < 1e-6);
        assert!((mul(v, conj(v)) - Vec2::new(0.0, v.length_squared())).length() < 1e-6);
    }
}
