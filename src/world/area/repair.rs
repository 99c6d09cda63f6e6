//! Polygons as they come: crossing themselves, lying on each other, thinner than a person, without area.

use geo::algorithm::bool_ops::unary_union;
use geo::{Area as _, BooleanOps, BoundingRect, Coord, LineString, MultiPolygon, Polygon, Simplify};

use super::grid::{all_snapped, snap};
use super::{Ground, MOST_CORNERS};
use crate::{Error, Result};

/// Outlines are followed to within this, metres.
const DETAIL: f64 = 0.05;
/// Ground smaller than this is left out, square metres.
const SMALLEST: f64 = 6.0;
/// Holes smaller than this are no obstacle, square metres.
const SMALLEST_HOLE: f64 = 0.02;
/// Largest world, metres.
const WIDEST: f64 = 20_000.0;

/// Clean ground: polygons that touch neither themselves nor each other, and whose it is.
pub(super) struct Walkable {
    /// All of it.
    pub all: MultiPolygon<f64>,
    /// Templates and their ground, from above: where several lie on each other the first counts.
    pub layers: Vec<(usize, MultiPolygon<f64>)>,
}

/// Repairs polygons; `notes` says what was done.
pub(super) fn repair(grounds: &[Ground], side: f64, notes: &mut Vec<String>) -> Result<Walkable> {
    let corners: usize = grounds.iter().flat_map(|g| &g.rings).map(Vec::len).sum();
    if corners > MOST_CORNERS {
        let problem = format!("expected at most {MOST_CORNERS} corners, found {corners}");
        return Err(Error::invalid("area", "polygons", problem));
    }
    let (mut layers, mut blocked) = (Vec::<(usize, MultiPolygon<f64>)>::new(), Vec::new());
    for (index, ground) in grounds.iter().enumerate() {
        let clean = clean(ground, index, notes);
        match (ground.template, layers.last_mut()) {
            (None, _) => blocked.extend(clean.0),
            (Some(template), Some((last, layer))) if *last == template => layer.0.extend(clean.0),
            (Some(template), _) => layers.push((template, clean)),
        }
    }
    let everything: Vec<Polygon<f64>> = layers.iter().flat_map(|(_, ground)| ground.0.iter().cloned()).collect();
    let mut free = unary_union(&everything);
    if !blocked.is_empty() {
        free = free.difference(&unary_union(&blocked));
    }
    let all = without_small(&simplified(&free), notes);
    let Some(bounds) = all.bounding_rect() else {
        let problem = format!("expected ground to walk on, found none after repairs: {}", notes.join("; "));
        return Err(Error::invalid("area", "polygons", problem));
    };
    if bounds.width().max(bounds.height()) > WIDEST || all.unsigned_area() / (side * side) > 100_000.0 {
        let (w, h) = (bounds.width(), bounds.height());
        let problem = format!("expected a world of at most {WIDEST} m and 100000 cells, found {w:.0} x {h:.0} m");
        return Err(Error::invalid("area", "polygons", problem));
    }
    Ok(Walkable { all, layers })
}

/// One polygon by even and odd: what is surrounded twice is a hole, as in drawings.
fn clean(ground: &Ground, index: usize, notes: &mut Vec<String>) -> MultiPolygon<f64> {
    let rings: Vec<LineString<f64>> = ground.rings.iter().map(|ring| line(ring)).collect();
    let mut rings = rings.into_iter();
    let outline = rings.next().unwrap_or_else(|| LineString::new(Vec::new()));
    let polygon = Polygon::new(outline, rings.collect());
    if polygon.exterior().0.len() < 4 {
        notes.push(format!("polygon {index} has fewer than three different corners: left out"));
        return MultiPolygon::new(Vec::new());
    }
    // What is wrong in words costs time in proportion to the square of the corners.
    let few = polygon.exterior().0.len() < 2_000;
    let said = few.then(|| crate::geom::Polygon::new(outline_of(&polygon)).err()).flatten();
    let clean = polygon.union(&MultiPolygon::new(Vec::new()));
    if clean.unsigned_area() < 1e-6 {
        notes.push(format!("polygon {index} has no area: left out"));
    } else if let Some(problem) = said {
        notes.push(format!("polygon {index} was repaired: {problem}"));
    }
    clean
}

/// A ring on whole units without doubled corners.
fn line(ring: &[[f64; 2]]) -> LineString<f64> {
    let mut points: Vec<Coord<f64>> = ring.iter().map(|&[x, y]| Coord { x: snap(x), y: snap(y) }).collect();
    points.dedup();
    if points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    LineString::new(points)
}

fn outline_of(polygon: &Polygon<f64>) -> Vec<glam::Vec2> {
    let points = &polygon.exterior().0;
    let open = points.len().saturating_sub(1);
    points[..open].iter().map(|p| glam::Vec2::new(p.x as f32, p.y as f32)).collect()
}

/// Fewer corners, on whole units; made clean again, as both may make lines cross.
fn simplified(all: &MultiPolygon<f64>) -> MultiPolygon<f64> {
    all_snapped(&all.simplify(DETAIL)).union(&MultiPolygon::new(Vec::new()))
}

fn without_small(all: &MultiPolygon<f64>, notes: &mut Vec<String>) -> MultiPolygon<f64> {
    let area = |ring: &LineString<f64>| Polygon::new(ring.clone(), Vec::new()).unsigned_area();
    let (kept, small): (Vec<_>, Vec<_>) = all.0.iter().cloned().partition(|p| p.unsigned_area() >= SMALLEST);
    if !small.is_empty() {
        notes.push(format!("{} pieces of ground below {SMALLEST} m2 were left out", small.len()));
    }
    let mut holes = 0;
    let without = |p: Polygon<f64>| {
        let (outline, mut inner) = p.into_inner();
        let before = inner.len();
        inner.retain(|hole| area(hole) >= SMALLEST_HOLE);
        holes += before - inner.len();
        Polygon::new(outline, inner)
    };
    let kept: Vec<Polygon<f64>> = kept.into_iter().map(without).collect();
    if holes > 0 {
        notes.push(format!("{holes} holes below {SMALLEST_HOLE} m2 were closed"));
    }
    MultiPolygon::new(kept)
}
