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

impl Capsule {
    /// How deep two capsules interpenetrate, metres; negative or zero if they do not (then no true distance).
    #[inline]
    pub fn penetration(&self, other: &Self) -> f32 {
        let apart = self.radius + other.radius;
        let (d1, d2) = (self.b - self.a, other.b - other.a);
        // Cheap: balls around the segments' middles.
        let between = (self.a + self.b - other.a - other.b) * 0.5;
        let bound = apart + (d1.length() + d2.length()) * 0.5;
        if between.length_squared() >= bound * bound {
            return 0.0;
        }
        apart - self.between(other).length()
    }

    /// From the point of this axis that is nearest to the other's to the point of the other that is nearest to this.
    ///
    /// Nearest points of two segments after Ericson, "Real-Time Collision Detection", section 5.1.9.
    #[inline]
    pub fn between(&self, other: &Self) -> Vec3 {
        let (d1, d2, r) = (self.b - self.a, other.b - other.a, self.a - other.a);
        let (a, e, f) = (d1.length_squared(), d2.length_squared(), d2.dot(r));
        let (b, c) = (d1.dot(d2), d1.dot(r));
        let denominator = a * e - b * b;
        let s = if denominator > 1e-12 { ((b * f - c * e) / denominator).clamp(0.0, 1.0) } else { 0.0 };
        let t = if e > 1e-12 { (b * s + f) / e } else { 0.0 };
        let (s, t) = if t < 0.0 {
            (clamp_ratio(-c, a), 0.0)
        } else if t > 1.0 {
            (clamp_ratio(b - c, a), 1.0)
        } else {
            (s, t)
        };
        other.a + d2 * t - self.a - d1 * s
    }
}

fn clamp_ratio(numerator: f32, denominator: f32) -> f32 {
    if denominator > 1e-12 { (numerator / denominator).clamp(0.0, 1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn agrees_with_dense_sampling(v in proptest::collection::vec(-1.0f32..1.0, 12)) {
            let p = |i: usize| Vec3::new(v[i], v[i + 1], v[i + 2]);
            let (one, two) = (Capsule { a: p(0), b: p(3), radius: 0.3 }, Capsule { a: p(6), b: p(9), radius: 0.2 });
            let mut nearest = f32::INFINITY;
            for i in 0..=60 {
                for j in 0..=60 {
                    let (x, y) = (one.a.lerp(one.b, i as f32 / 60.0), two.a.lerp(two.b, j as f32 / 60.0));
                    nearest = nearest.min(x.distance(y));
                }
            }
            let depth = one.penetration(&two);
            if depth > 0.0 || nearest < 0.5 {
                prop_assert!((0.5 - nearest - depth).abs() < 0.03, "{} {}", 0.5 - nearest, depth);
            }
        }
    }
}
