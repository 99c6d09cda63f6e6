//! How deep bodies enter each other, obstacles and the world outside the region: exact distances of capsules.

use glam::{Quat, Vec2, Vec3};
use parry3d::math::Vector;
use parry3d::query::details::closest_points_segment_segment_with_locations_nD as closest_locations;

use crate::geom::{Capsule, Polygon};
use crate::motion::body_capsules;

/// A body at one moment: its capsules and a disc on the ground that covers them.
pub(super) struct Body {
    pub capsules: Vec<Capsule>,
    pub center: Vec2,
    pub radius: f32,
}

impl Body {
    /// The body whose joints' global transforms are given.
    pub(super) fn new(globals: &[(Vec3, Quat)]) -> Self {
        let mut capsules = Vec::new();
        body_capsules(globals, &mut capsules);
        let ends = || capsules.iter().flat_map(|c| [(ground(c.a), c.radius), (ground(c.b), c.radius)]);
        let (low, high) = ends().fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(lo, hi), (p, _)| (lo.min(p), hi.max(p)));
        let center = (low + high) * 0.5;
        let radius = ends().map(|(p, r)| p.distance(center) + r).fold(0.0, f32::max);
        Self { capsules, center, radius }
    }

    /// The same body somewhere else.
    pub(super) fn moved(&self, by: Vec2) -> Self {
        let by3 = Vec3::new(by.x, 0.0, by.y);
        let capsules = self.capsules.iter().map(|c| Capsule { a: c.a + by3, b: c.b + by3, radius: c.radius }).collect();
        Self { capsules, center: self.center + by, radius: self.radius }
    }

    /// How deep the deepest pair of capsules of two bodies overlap, metres; 0 if none does.
    pub(super) fn depth_into(&self, other: &Self) -> f32 {
        if self.center.distance(other.center) >= self.radius + other.radius {
            return 0.0;
        }
        let mut deepest = 0.0f32;
        for a in &self.capsules {
            let (middle, half) = ((a.a + a.b) * 0.5, a.a.distance(a.b) * 0.5 + a.radius);
            for b in &other.capsules {
                let reach = half + b.a.distance(b.b) * 0.5 + b.radius - deepest;
                if middle.distance_squared((b.a + b.b) * 0.5) < reach * reach {
                    deepest = deepest.max(a.radius + b.radius - axis_distance(a, b));
                }
            }
        }
        deepest
    }

    /// How far this body reaches out of `region`, metres; 0 if it is inside.
    pub(super) fn depth_out_of(&self, region: &Polygon) -> f32 {
        if region.signed_distance(self.center) < -self.radius {
            return 0.0;
        }
        let beyond = |c: &Capsule| {
            let (a, b) = (ground(c.a), ground(c.b));
            let border = border_distance(a, b, region);
            let outside = region.signed_distance(a).max(region.signed_distance(b)).max(0.0);
            if outside > 0.0 { outside + c.radius } else { c.radius - border }
        };
        self.capsules.iter().map(beyond).fold(0.0, f32::max)
    }

    /// How deep this body is in `obstacle` (a prism of any height), metres; 0 if it is outside.
    pub(super) fn depth_in_obstacle(&self, obstacle: &Polygon) -> f32 {
        if obstacle.signed_distance(self.center) > self.radius {
            return 0.0;
        }
        let inside = |c: &Capsule| {
            let (a, b) = (ground(c.a), ground(c.b));
            let deepest = -obstacle.signed_distance(a).min(obstacle.signed_distance(b)).min(0.0);
            if deepest > 0.0 { deepest + c.radius } else { c.radius - border_distance(a, b, obstacle) }
        };
        self.capsules.iter().map(inside).fold(0.0, f32::max)
    }
}

fn ground(p: Vec3) -> Vec2 {
    Vec2::new(p.x, p.z)
}

/// Distance between the axes of two capsules, metres.
pub(super) fn axis_distance(a: &Capsule, b: &Capsule) -> f32 {
    let [p, q, r, s] = [a.a, a.b, b.a, b.b].map(|v| Vector::from_array(v.to_array()));
    let (on_a, on_b) = closest_locations((&p, &q), (&r, &s));
    let at = |weights: [f32; 2], from: Vector, to: Vector| from * weights[0] + to * weights[1];
    (at(on_a.barycentric_coordinates(), p, q) - at(on_b.barycentric_coordinates(), r, s)).length()
}

/// Distance of the segment ab from the border of `polygon`; 0 if it crosses it.
fn border_distance(a: Vec2, b: Vec2, polygon: &Polygon) -> f32 {
    let n = polygon.points.len();
    let edges = (0..n).map(|i| (polygon.points[i], polygon.points[(i + 1) % n]));
    edges.map(|(c, d)| segment_distance(a, b, c, d)).fold(f32::INFINITY, f32::min)
}

fn segment_distance(a: Vec2, b: Vec2, c: Vec2, d: Vec2) -> f32 {
    let side = |p: Vec2, q: Vec2, r: Vec2| (q - p).perp_dot(r - p);
    if side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0 {
        return 0.0;
    }
    let ends = [(a, c, d), (b, c, d), (c, a, b), (d, a, b)];
    ends.map(|(p, q, r)| point_distance(p, q, r)).into_iter().fold(f32::INFINITY, f32::min)
}

fn point_distance(p: Vec2, a: Vec2, b: Vec2) -> f32 {
    let ab = b - a;
    let t = ((p - a).dot(ab) / ab.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
    p.distance(a + ab * t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn capsule(a: Vec3, b: Vec3, radius: f32) -> Capsule {
        Capsule { a, b, radius }
    }

    #[test]
    fn axis_distance_is_never_beaten_by_a_fine_grid_of_points() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for case in 0..300 {
            let mut point = || Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
            let (a, mut b) = (capsule(point(), point(), 0.1), capsule(point(), point(), 0.1));
            if case % 3 == 0 {
                b.b = b.a + (a.b - a.a) * 0.7; // parallel
            }
            let grid = (0..=60).flat_map(|i| (0..=60).map(move |j| (i as f32 / 60.0, j as f32 / 60.0)));
            let nearest = grid.map(|(s, t)| a.a.lerp(a.b, s).distance(b.a.lerp(b.b, t))).fold(f32::INFINITY, f32::min);
            let found = axis_distance(&a, &b);
            assert!(found <= nearest + 1e-4 && found > nearest - 0.06, "case {case}: {found} against {nearest}");
        }
    }

    fn stick(x: f32, z: f32, length: f32) -> Body {
        let (a, b) = (Vec3::new(x, 1.0, z), Vec3::new(x + length, 1.0, z));
        Body { capsules: vec![capsule(a, b, 0.1)], center: Vec2::new(x + length * 0.5, z), radius: length * 0.5 + 0.1 }
    }

    #[test]
    fn a_body_between_and_across_walls() {
        let room = Polygon::rectangle(Vec2::ZERO, Vec2::splat(4.0));
        assert_eq!(stick(1.0, 1.0, 1.0).depth_out_of(&room), 0.0);
        assert!((stick(1.0, 0.07, 1.0).depth_out_of(&room) - 0.03).abs() < 1e-6);
        assert!((stick(3.5, 1.0, 1.0).depth_out_of(&room) - 0.6).abs() < 1e-6);
        assert!((stick(4.05, 1.0, 1.0).depth_in_obstacle(&room) - 0.05).abs() < 1e-6);
        assert_eq!(stick(4.2, 1.0, 1.0).depth_in_obstacle(&room), 0.0);
        // Both ends outside, the middle across: still found.
        assert!(stick(-1.0, 1.0, 6.0).depth_in_obstacle(&room) >= 0.1);
    }

    #[test]
    fn depth_of_two_sticks() {
        assert!((stick(0.0, 0.0, 1.0).depth_into(&stick(0.5, 0.15, 1.0)) - 0.05).abs() < 1e-6);
        assert_eq!(stick(0.0, 0.0, 1.0).depth_into(&stick(0.5, 0.25, 1.0)), 0.0);
    }
}
