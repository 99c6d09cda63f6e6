//! Distances of segments.

use glam::DVec2;

use crate::world::Shape;

/// Least distance of a point that moves from `a` to `b` to the origin.
pub(super) fn to_origin(a: DVec2, b: DVec2) -> f64 {
    to_segment(DVec2::ZERO, a, b)
}

fn to_segment(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let side = b - a;
    let length = side.length_squared();
    let share = if length > 0.0 { ((p - a).dot(side) / length).clamp(0.0, 1.0) } else { 0.0 };
    p.distance(a + side * share)
}

/// Distance of the segment from `a` to `b` to a shape; zero if it touches or enters it.
pub(super) fn to_shape(shape: &Shape, a: DVec2, b: DVec2) -> f64 {
    match shape {
        Shape::Disc { centre, radius } => (to_segment(centre.as_dvec2(), a, b) - f64::from(*radius)).max(0.0),
        Shape::Convex(polygon) => {
            let corners: Vec<DVec2> = polygon.points.iter().map(|p| p.as_dvec2()).collect();
            let sides = || corners.iter().zip(corners.iter().cycle().skip(1));
            if sides().all(|(c, d)| (*d - *c).perp_dot(a - *c) >= 0.0) {
                return 0.0;
            }
            sides().map(|(&c, &d)| between(a, b, c, d)).fold(f64::INFINITY, f64::min)
        }
    }
}

/// Distance of two segments.
fn between(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> f64 {
    let (r, s) = (b - a, d - c);
    let cross = r.perp_dot(s);
    if cross != 0.0 {
        let (t, u) = ((c - a).perp_dot(s) / cross, (c - a).perp_dot(r) / cross);
        if (0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&u) {
            return 0.0;
        }
    }
    to_segment(a, c, d).min(to_segment(b, c, d)).min(to_segment(c, a, b)).min(to_segment(d, a, b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    #[test]
    fn a_segment_through_a_box_touches_it() {
        let shape = Shape::oblong(Vec2::ZERO, Vec2::new(2.0, 1.0), 0.0);
        assert_eq!(to_shape(&shape, DVec2::new(-3.0, 0.0), DVec2::new(3.0, 0.1)), 0.0);
        assert_eq!(to_shape(&shape, DVec2::new(0.1, 0.1), DVec2::new(0.2, 0.1)), 0.0);
        assert!((to_shape(&shape, DVec2::new(-3.0, 2.0), DVec2::new(3.0, 2.0)) - 1.5).abs() < 1e-9);
        assert!(
            (to_shape(&Shape::disc(Vec2::ZERO, 1.0), DVec2::new(-3.0, 2.0), DVec2::new(3.0, 2.0)) - 1.0).abs() < 1e-6
        );
    }
}
