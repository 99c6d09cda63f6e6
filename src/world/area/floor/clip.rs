//! Triangles cut by each other: in plan, and by how far one is above the other.

use geo::{ConvexHull, Coord, MultiPoint, Point, Polygon};
use glam::{DVec2, DVec3};

use super::mesh::Triangle;

/// A place in plan.
pub(super) fn plan(p: DVec3) -> DVec2 {
    DVec2::new(p.x, p.z)
}

/// Keeps of a convex polygon what has a `side` of 0 or more.
fn cut(polygon: &[DVec3], side: impl Fn(DVec3) -> f64) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, &p) in polygon.iter().enumerate() {
        let next = polygon[(i + 1) % polygon.len()];
        let (here, there) = (side(p), side(next));
        if here >= 0.0 {
            kept.push(p);
        }
        if (here < 0.0) != (there < 0.0) && here != 0.0 && there != 0.0 {
            kept.push(p.lerp(next, here / (here - there)));
        }
    }
    kept
}

/// The part of a convex polygon that is above or below a triangle, or within `reach` of that in plan.
pub(super) fn over(polygon: &[DVec3], triangle: &Triangle, reach: f64) -> Vec<DVec3> {
    let mut part = polygon.to_vec();
    for i in 0..3 {
        let (a, b) = (plan(triangle.corners[i]), plan(triangle.corners[(i + 1) % 3]));
        let inward = (b - a).normalize_or_zero().perp();
        part = cut(&part, |p| inward.dot(plan(p) - a) + reach);
    }
    part
}

/// The part of a convex polygon that is from `low` to `high` above a triangle's plane.
pub(super) fn between(polygon: &[DVec3], triangle: &Triangle, low: f64, high: f64) -> Vec<DVec3> {
    let part = if low.is_finite() { cut(polygon, |p| triangle.below(p) - low) } else { polygon.to_vec() };
    if high.is_finite() { cut(&part, |p| high - triangle.below(p)) } else { part }
}

/// The plan of a convex polygon, or of a line or point, wider by `by` all around.
pub(super) fn widened(polygon: &[DVec3], by: f64) -> Polygon<f64> {
    // An octagon around a circle.
    let radius = by / (std::f64::consts::PI / 8.0).cos();
    let around = |p: &DVec3| {
        let p = plan(*p);
        (0..8).map(move |i| {
            let at = p + DVec2::from_angle((f64::from(i) + 0.5) * std::f64::consts::FRAC_PI_4) * radius;
            Point(Coord { x: at.x, y: at.y })
        })
    };
    polygon.iter().flat_map(around).collect::<MultiPoint<f64>>().convex_hull()
}
