//! Polygons on whole units.
//!
//! Overlays cut lines at crossings that are rounded. Where many lines nearly coincide, pieces of one cross another after rounding,
//! are cut again, and so on: a dozen polygons have taken minutes. On whole units lines coincide or they do not, and that is over.

use geo::{Coord, LineString, MultiPolygon, Polygon};

use crate::stage::world::UNITS_PER_METRE;

/// A coordinate on whole units.
pub(super) fn snap(v: f64) -> f64 {
    (v * UNITS_PER_METRE).round() / UNITS_PER_METRE
}

/// A polygon on whole units; its lines may cross afterwards, until the next overlay.
pub(super) fn snapped(polygon: &Polygon<f64>) -> Polygon<f64> {
    let ring = |ring: &LineString<f64>| {
        let mut points: Vec<Coord<f64>> = ring.0.iter().map(|p| Coord { x: snap(p.x), y: snap(p.y) }).collect();
        points.dedup();
        LineString::new(points)
    };
    Polygon::new(ring(polygon.exterior()), polygon.interiors().iter().map(ring).collect())
}

/// Polygons on whole units.
pub(super) fn all_snapped(polygons: &MultiPolygon<f64>) -> MultiPolygon<f64> {
    polygons.0.iter().map(snapped).collect()
}
