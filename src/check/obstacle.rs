//! How deep bodies are in obstacles, which stand or move and may be so low that a body gets over them.

use glam::{Vec2, Vec3};
use parry3d::math::{Pose, Vector};
use parry3d::query::distance;
use parry3d::shape::{Segment, Triangle};

use super::depth::Body;
use crate::geom::{Capsule, Obstacle, Polygon};

/// How far the sides of a low obstacle are followed below the ground, metres: nobody is there.
const CELLAR: f32 = -1.0;

impl Body {
    /// How deep this body is in an obstacle at a moment, metres; 0 if it is outside or above.
    pub(super) fn depth_in(&self, obstacle: &Obstacle, secs: f32) -> f32 {
        let away = self.center.distance(obstacle.place(secs).position);
        let far = obstacle.outline.points.iter().map(|p| p.length()).fold(0.0, f32::max);
        if !obstacle.path.is_empty() && away > far + self.radius {
            return 0.0;
        }
        let outline = obstacle.outline_at(secs);
        match obstacle.height {
            None => self.depth_in_obstacle(&outline),
            Some(_) if outline.signed_distance(self.center) > self.radius => 0.0,
            Some(top) => self.capsules.iter().map(|c| depth_below(c, &outline, top)).fold(0.0, f32::max),
        }
    }
}

/// How deep a capsule is in a prism that ends at height `top`, metres; 0 if it is outside or above.
fn depth_below(capsule: &Capsule, outline: &Polygon, top: f32) -> f32 {
    if capsule.a.y.min(capsule.b.y) - capsule.radius >= top {
        return 0.0;
    }
    let inside = |end: Vec3| {
        let deep = -outline.signed_distance(Vec2::new(end.x, end.z));
        let below = top - end.y;
        if deep > 0.0 { capsule.radius + below.min(deep) } else { 0.0 }
    };
    // Where the axis is nearest to the top but at an end, it is above or in a side.
    let beside = capsule.radius - distance_to_sides(capsule, outline, top);
    inside(capsule.a).max(inside(capsule.b)).max(beside).max(0.0)
}

/// Distance of a capsule's axis from the sides of a prism, metres.
fn distance_to_sides(capsule: &Capsule, outline: &Polygon, top: f32) -> f32 {
    let vector = |p: Vec2, y: f32| Vector::new(p.x, y, p.y);
    let [a, b] = [capsule.a, capsule.b].map(|v| Vector::from_array(v.to_array()));
    let axis = Segment::new(a, b);
    let n = outline.points.len();
    let sides = (0..n).flat_map(|i| {
        let (c, d) = (outline.points[i], outline.points[(i + 1) % n]);
        let corners = [vector(c, CELLAR), vector(d, CELLAR), vector(d, top), vector(c, top)];
        [Triangle::new(corners[0], corners[1], corners[2]), Triangle::new(corners[0], corners[2], corners[3])]
    });
    let apart = |side: Triangle| {
        distance(&Pose::IDENTITY, &axis, &Pose::IDENTITY, &side).expect("both shapes are convex").distance
    };
    sides.map(apart).fold(f32::INFINITY, f32::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Waypoint;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn ell() -> Polygon {
        let corners = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)];
        Polygon::new(corners.map(|(x, z)| Vec2::new(x, z)).to_vec()).unwrap()
    }

    #[test]
    fn depth_agrees_with_points_along_the_axis() {
        let (outline, top) = (ell(), 0.5);
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let (mut free, mut touching) = (0, 0);
        for case in 0..600 {
            let mut point =
                || Vec3::new(rng.random_range(-0.5..2.5), rng.random_range(0.0..1.2), rng.random_range(-0.5..2.5));
            let a = point();
            let b = a + (point() - a) * 0.3;
            let capsule = Capsule { a, b, radius: 0.1 };
            let points = (0..=200).map(|i| a.lerp(b, i as f32 / 200.0));
            let away = |p: Vec3| {
                let beside = outline.signed_distance(Vec2::new(p.x, p.z)).max(0.0);
                beside.hypot((p.y - top).max(0.0))
            };
            let nearest = points.map(away).fold(f32::INFINITY, f32::min);
            let found = depth_below(&capsule, &outline, top);
            if nearest > 0.0 {
                assert!((found - (0.1 - nearest).max(0.0)).abs() < 5e-3, "case {case}: {found}, {nearest} away");
            } else {
                assert!(found >= 0.1, "case {case}: {found}");
            }
            free += (found == 0.0) as usize;
            touching += (found > 0.0 && found < 0.1) as usize;
        }
        assert!(free > 50 && touching > 20, "{free}, {touching}");
    }

    #[test]
    fn over_a_moving_cart_but_not_through_it() {
        let way = [(0.0, 0.0), (10.0, 10.0)];
        let path = way.map(|(secs, x)| Waypoint { secs, position: Vec2::new(x, 0.0), heading: 0.0 }).to_vec();
        let outline = Polygon::rectangle(Vec2::splat(-0.5), Vec2::splat(0.5));
        let cart = Obstacle { outline, height: Some(0.4), path };
        let foot = |y: f32| Body {
            capsules: vec![Capsule { a: Vec3::new(5.0, y, 0.0), b: Vec3::new(5.2, y, 0.0), radius: 0.05 }],
            center: Vec2::new(5.1, 0.0),
            radius: 0.15,
        };
        assert!((foot(0.3).depth_in(&cart, 5.0) - 0.15).abs() < 1e-5);
        assert!((foot(0.43).depth_in(&cart, 5.0) - 0.02).abs() < 1e-5);
        assert_eq!(foot(0.46).depth_in(&cart, 5.0), 0.0);
        assert_eq!(foot(0.3).depth_in(&cart, 3.0), 0.0);
        assert!((foot(0.3).depth_in(&cart, 4.46) - 0.01).abs() < 1e-4);
        let tall = Obstacle { height: None, ..cart };
        assert!(foot(0.46).depth_in(&tall, 5.0) > 0.05 && foot(3.0).depth_in(&tall, 5.0) > 0.05);
        assert_eq!(foot(0.46).depth_in(&tall, 3.0), 0.0);
    }
}
