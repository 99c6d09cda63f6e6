//! Simple polygons on the ground: regions to stay in, obstacles to stay out of.

use geo::{Area, Validation};
use glam::Vec2;

/// A simple polygon on the ground (x, z), counter-clockwise seen from above with x right and z up; not closed.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Polygon {
    /// The corners in metres.
    pub points: Vec<Vec2>,
}

impl Polygon {
    /// A polygon from its corners in either winding.
    ///
    /// # Errors
    /// Says what is wrong: fewer than three corners, a coordinate that is not finite, edges that cross, no area.
    pub fn new(mut points: Vec<Vec2>) -> Result<Self, String> {
        if points.len() < 3 {
            return Err(format!("expected at least 3 corners, found {}", points.len()));
        }
        if let Some(bad) = points.iter().position(|p| !p.is_finite()) {
            return Err(format!("corner {bad} is not a finite point: {}", points[bad]));
        }
        let shape = geo::Polygon::new(points.iter().map(|p| (p.x as f64, p.y as f64)).collect(), vec![]);
        if let Err(problem) = shape.check_validation() {
            return Err(format!("expected edges that do not cross, found: {problem}"));
        }
        let area = shape.signed_area();
        if area.abs() < 1e-6 {
            return Err("expected a positive area, found none".into());
        }
        if area < 0.0 {
            points.reverse();
        }
        Ok(Self { points })
    }

    /// The axis-parallel rectangle between two corners.
    pub fn rectangle(min: Vec2, max: Vec2) -> Self {
        Self { points: vec![min, Vec2::new(max.x, min.y), max, Vec2::new(min.x, max.y)] }
    }

    /// Lower and upper corner of the bounding box.
    pub fn bounds(&self) -> (Vec2, Vec2) {
        self.points.iter().fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)))
    }

    /// Signed distance of `point` to the border: negative inside. O(corners).
    pub fn signed_distance(&self, point: Vec2) -> f32 {
        let n = self.points.len();
        let (mut nearest, mut inside) = (f32::INFINITY, false);
        for i in 0..n {
            let (a, b) = (self.points[i], self.points[(i + 1) % n]);
            nearest = nearest.min(distance_to_segment(point, a, b));
            if (a.y > point.y) != (b.y > point.y) && point.x < a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y) {
                inside = !inside;
            }
        }
        if inside { -nearest } else { nearest }
    }

    /// Area in square metres.
    pub fn area(&self) -> f32 {
        let n = self.points.len();
        (0..n).map(|i| self.points[i].perp_dot(self.points[(i + 1) % n])).sum::<f32>().abs() * 0.5
    }
}

fn distance_to_segment(p: Vec2, a: Vec2, b: Vec2) -> f32 {
    let ab = b - a;
    let t = ((p - a).dot(ab) / ab.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
    (p - a - ab * t).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn self_intersecting_outline_is_refused() {
        let bow_tie = [(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)].map(|(x, y)| Vec2::new(x, y));
        assert!(Polygon::new(bow_tie.to_vec()).unwrap_err().contains("cross"));
    }

    #[test]
    fn signed_distance_of_a_square() {
        let square = Polygon::rectangle(Vec2::ZERO, Vec2::splat(2.0));
        assert!((square.signed_distance(Vec2::splat(1.0)) + 1.0).abs() < 1e-6);
        assert!((square.signed_distance(Vec2::new(3.0, 1.0)) - 1.0).abs() < 1e-6);
        assert!((square.area() - 4.0).abs() < 1e-6);
    }
}
