//! Ground cut into convex cells of sane shape: a constrained Delaunay triangulation of outlines and of points spread
//! evenly inside, whose triangles are joined, the longest edge first, as long as they stay convex and compact.
//!
//! (Hertel and Mehlhorn 1983 join until nothing can be joined; here size and corners count too, since a cell must be
//! walked through in a few seconds, and nobody gets through a sharp corner.)

use std::collections::{BTreeMap, BTreeSet, HashSet};

use geo::{Contains, Coord, MultiPolygon, Point};
use glam::DVec2;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use super::repair::Walkable;
use crate::stage::world::UNITS_PER_METRE;
use crate::{Error, Result};

/// A convex cell.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    /// Its corners, counter-clockwise, on whole units.
    pub corners: Vec<DVec2>,
    /// Cell and its edge on the other side of every edge.
    pub beyond: Vec<Option<(usize, usize)>>,
    /// Which template it is of.
    pub template: usize,
}

impl Cell {
    /// Whether a place is in it or on its border.
    pub fn contains(&self, place: DVec2) -> bool {
        let n = self.corners.len();
        (0..n).all(|i| (self.corners[(i + 1) % n] - self.corners[i]).perp_dot(place - self.corners[i]) >= 0.0)
    }
}

/// Corners turn at least this much, so that rounding never makes them turn back: sine of two degrees.
const TURN: f64 = 0.035;

/// Cuts the ground; cells are in an order that depends on the ground alone.
pub(super) fn cut(ground: &Walkable, side: f64, notes: &mut Vec<String>) -> Result<Vec<Cell>> {
    let (points, edges) = points(&ground.all, side);
    let vertices: Vec<Point2<f64>> = points.iter().map(|p| Point2::new(p.x, p.y)).collect();
    // Where rounding made two outlines cross, one of the lines gives way.
    let mut lost = 0;
    let mesh = ConstrainedDelaunayTriangulation::<Point2<f64>>::try_bulk_load_cdt(vertices, edges, |_| lost += 1)
        .map_err(|e| Error::invalid("area", "polygons", format!("expected ground that can be cut, found {e}")))?;
    if lost > 0 {
        notes.push(format!("{lost} lines of outlines that cross others were left out"));
    }
    let places: Vec<DVec2> = mesh.vertices().map(|v| DVec2::new(v.position().x, v.position().y)).collect();
    let mut faces: Vec<([usize; 3], usize)> = Vec::new();
    for face in mesh.inner_faces() {
        let corners = face.vertices().map(|v| v.fix().index());
        let middle = corners.iter().map(|&c| places[c]).sum::<DVec2>() / 3.0;
        let area = (places[corners[1]] - places[corners[0]]).perp_dot(places[corners[2]] - places[corners[0]]);
        if area > 1e-4 && inside(&ground.all, middle) {
            faces.push((corners, template(ground, middle)));
        }
    }
    let joined = join(&places, &faces, side);
    Ok(connected(&places, joined))
}

fn inside(ground: &MultiPolygon<f64>, p: DVec2) -> bool {
    ground.contains(&Point(Coord { x: p.x, y: p.y }))
}

/// The template of the ground at a place; where several lie on each other the first.
fn template(ground: &Walkable, p: DVec2) -> usize {
    let found = ground.layers.iter().find(|(_, polygons)| inside(polygons, p));
    found.or(ground.layers.first()).map_or(0, |(template, _)| *template)
}

/// Corners of outlines, cut into pieces no longer than a cell, and points spread over the inside; and the pieces.
fn points(ground: &MultiPolygon<f64>, side: f64) -> (Vec<DVec2>, Vec<[usize; 2]>) {
    let (mut points, mut index, mut edges) = (Vec::new(), BTreeMap::new(), BTreeSet::new());
    let mut add = |p: DVec2| {
        let units = (p * UNITS_PER_METRE).round().as_i64vec2();
        *index.entry([units.x, units.y]).or_insert_with(|| {
            points.push(units.as_dvec2() / UNITS_PER_METRE);
            points.len() - 1
        })
    };
    let rings = ground.0.iter().flat_map(|p| std::iter::once(p.exterior()).chain(p.interiors()));
    for line in rings.flat_map(|ring| ring.lines()) {
        let (a, b) = (DVec2::new(line.start.x, line.start.y), DVec2::new(line.end.x, line.end.y));
        let pieces = (a.distance(b) / (1.25 * side)).ceil().max(1.0) as usize;
        let ends: Vec<usize> = (0..=pieces).map(|i| add(a.lerp(b, i as f64 / pieces as f64))).collect();
        for pair in ends.windows(2).filter(|pair| pair[0] != pair[1]) {
            edges.insert([pair[0].min(pair[1]), pair[0].max(pair[1])]);
        }
    }
    let outline = points.clone();
    points.extend(spread(ground, &outline, side));
    (points, edges.into_iter().collect())
}

/// Points inside on a grid of the size of cells, away from the corners of outlines.
fn spread(ground: &MultiPolygon<f64>, outline: &[DVec2], side: f64) -> Vec<DVec2> {
    let key = |p: DVec2| {
        let at = (p / side).floor();
        [at.x as i64, at.y as i64]
    };
    let mut taken: BTreeMap<[i64; 2], Vec<DVec2>> = BTreeMap::new();
    outline.iter().for_each(|&p| taken.entry(key(p)).or_default().push(p));
    let near = |p: DVec2| {
        let [x, z] = key(p);
        let around = (x - 1..=x + 1).flat_map(|x| (z - 1..=z + 1).map(move |z| [x, z]));
        around.filter_map(|cell| taken.get(&cell)).flatten().any(|q| q.distance(p) < 0.6 * side)
    };
    let mut found = Vec::new();
    for polygon in &ground.0 {
        let Some(bounds) = geo::BoundingRect::bounding_rect(polygon) else { continue };
        let range = |low: f64, high: f64| (low / side).ceil() as i64..=(high / side).floor() as i64;
        for z in range(bounds.min().y, bounds.max().y) {
            for x in range(bounds.min().x, bounds.max().x) {
                let p = DVec2::new(x as f64, z as f64) * side;
                if polygon.contains(&Point(Coord { x: p.x, y: p.y })) && !near(p) {
                    found.push(p);
                }
            }
        }
    }
    found
}

/// Joins triangles to convex cells of one template.
fn join(places: &[DVec2], faces: &[([usize; 3], usize)], side: f64) -> Vec<(Vec<usize>, usize)> {
    let mut cells: Vec<Option<Vec<usize>>> = faces.iter().map(|(corners, _)| Some(corners.to_vec())).collect();
    let mut owner: Vec<usize> = (0..faces.len()).collect();
    let mut sides: BTreeMap<[usize; 2], Vec<usize>> = BTreeMap::new();
    for (face, (corners, _)) in faces.iter().enumerate() {
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            sides.entry([a.min(b), a.max(b)]).or_default().push(face);
        }
    }
    let mut inner: Vec<([usize; 2], [usize; 2])> =
        sides.into_iter().filter(|(_, of)| of.len() == 2).map(|(edge, of)| (edge, [of[0], of[1]])).collect();
    let length = |edge: &[usize; 2]| places[edge[0]].distance(places[edge[1]]);
    inner.sort_by(|a, b| length(&b.0).total_cmp(&length(&a.0)).then(a.0.cmp(&b.0)));
    for (edge, of) in inner {
        let [a, b] = of.map(|face| find(&mut owner, face));
        if a == b || faces[a].1 != faces[b].1 {
            continue;
        }
        let (Some(first), Some(second)) = (&cells[a], &cells[b]) else { continue };
        if let Some(both) = merged(first, second, edge).filter(|ring| sane(places, ring, side)) {
            cells[a] = Some(both);
            cells[b] = None;
            owner[b] = a;
        }
    }
    cells.into_iter().enumerate().filter_map(|(i, cell)| Some((cell?, faces[i].1))).collect()
}

/// Who owns all that something was joined with.
pub(super) fn find(owner: &mut [usize], face: usize) -> usize {
    let mut at = face;
    while owner[at] != at {
        owner[at] = owner[owner[at]];
        at = owner[at];
    }
    at
}

/// Two rings along the edge they share; none if they share more than that.
fn merged(a: &[usize], b: &[usize], edge: [usize; 2]) -> Option<Vec<usize>> {
    let shared = a.iter().filter(|v| b.contains(v)).count();
    let at = |ring: &[usize]| {
        (0..ring.len()).find(|&i| edge.contains(&ring[i]) && edge.contains(&ring[(i + 1) % ring.len()]))
    };
    let (i, j) = (at(a)?, at(b)?);
    let from =
        |ring: &[usize], begin: usize| (0..ring.len()).map(|k| ring[(begin + k) % ring.len()]).collect::<Vec<_>>();
    // All of a from the end of the edge to its begin, then what b has between.
    let (first, second) = (from(a, i + 1), from(b, j + 1));
    (shared == 2).then(|| first.into_iter().chain(second[1..b.len() - 1].iter().copied()).collect())
}

/// Whether a ring is convex without straight corners, and compact.
fn sane(places: &[DVec2], ring: &[usize], side: f64) -> bool {
    let n = ring.len();
    let p = |i: usize| places[ring[i % n]];
    let convex = (0..n).all(|i| {
        let (a, b) = ((p(i + 1) - p(i)).normalize_or_zero(), (p(i + 2) - p(i + 1)).normalize_or_zero());
        a.perp_dot(b) > TURN
    });
    let area: f64 = (1..n - 1).map(|i| 0.5 * (p(i) - p(0)).perp_dot(p(i + 1) - p(0))).sum();
    let far = (0..n).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| p(i).distance(p(j))).fold(0.0, f64::max);
    convex && area < 1.9 * side * side && far < 2.1 * side
}

/// Cells with what is beyond their edges.
fn connected(places: &[DVec2], rings: Vec<(Vec<usize>, usize)>) -> Vec<Cell> {
    let mut directed: BTreeMap<[usize; 2], (usize, usize)> = BTreeMap::new();
    let mut twice = HashSet::new();
    for (cell, (ring, _)) in rings.iter().enumerate() {
        for i in 0..ring.len() {
            let edge = [ring[i], ring[(i + 1) % ring.len()]];
            if directed.insert(edge, (cell, i)).is_some() {
                twice.insert(edge);
            }
        }
    }
    let beyond = |ring: &[usize], i: usize| {
        let edge = [ring[(i + 1) % ring.len()], ring[i]];
        directed.get(&edge).copied().filter(|_| !twice.contains(&edge))
    };
    let cell = |(ring, template): &(Vec<usize>, usize)| Cell {
        corners: ring.iter().map(|&v| places[v]).collect(),
        beyond: (0..ring.len()).map(|i| beyond(ring, i)).collect(),
        template: *template,
    };
    rings.iter().map(cell).collect()
}
