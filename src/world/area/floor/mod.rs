//! The walkable floor of a mesh: one storey of it, as polygons.
//!
//! Game engines find it by voxels (Recast). Here it is exact: triangles that are not too steep are cut where something is above
//! them that is too high to step on and too low to walk under, and what is left is joined, all by the overlays that repair polygons
//! as well. So edges are where the mesh has them, whatever the size of the place, and no size of a voxel has to be chosen. The price
//! is that a mesh of millions of triangles is refused; levels have far fewer, or bring a coarse mesh for collisions.

mod clip;
mod mesh;
mod storey;

use std::path::Path;

use geo::bool_ops::unary_union;
use geo::{Area as _, BooleanOps, LineString, MultiPolygon, Polygon, Simplify};
use rayon::prelude::*;

use super::Ground;
use super::grid::{all_snapped, snapped};
use super::read::Grounds;
use super::sign::Sign;
use crate::{Error, Result};
use mesh::Triangle;
use storey::{Index, Storey};

/// What counts as floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloorOptions {
    /// Steeper triangles are no floor, degrees.
    pub slope_deg: f64,
    /// People step up and down as far, metres.
    pub step_m: f64,
    /// So much room they need above them, metres.
    pub head_m: f64,
    /// How high the storey is, metres; the largest one if nothing is said.
    pub height_m: Option<f64>,
}

impl Default for FloorOptions {
    fn default() -> Self {
        Self { slope_deg: 45.0, step_m: 0.3, head_m: 2.0, height_m: None }
    }
}

/// People keep so far from what blocks, metres: a wall without thickness has some then.
const CLEARANCE: f64 = 0.1;
/// Gaps between triangles that are none, metres: rounding.
const SEAM: f64 = 0.002;
/// The storey is one of so many largest parts of it.
const CANDIDATES: usize = 32;
/// Outlines are followed to within this, metres.
const DETAIL: f64 = 0.02;

impl FloorOptions {
    fn problem(&self) -> Option<String> {
        let within = |name: &str, value: f64, least: f64, most: f64| {
            let problem = format!("expected {name} from {least} to {most}, found {value}");
            (!(least..=most).contains(&value)).then_some(problem)
        };
        within("slope_deg", self.slope_deg, 0.0, 80.0)
            .or_else(|| within("step_m", self.step_m, 0.01, 1.0))
            .or_else(|| within("head_m", self.head_m, self.step_m.max(1.0), 10.0))
            .or_else(|| self.height_m.and_then(|height| within("height_m", height, -1e5, 1e5)))
    }
}

/// The storey that is asked for.
pub(super) fn grounds(bytes: &[u8], folder: Option<&Path>, options: &FloorOptions, signs: &[Sign]) -> Result<Grounds> {
    let bad = |place: &str, problem: String| Error::invalid("mesh", place, problem);
    if let Some(problem) = options.problem() {
        return Err(bad("options", problem));
    }
    let mut notes = Vec::new();
    let triangles = mesh::read(bytes, folder, options.slope_deg, signs, &mut notes)?;
    let index = Index::new(&triangles)?;
    let storey = Storey::choose(&triangles, &index, options, &mut notes).ok_or_else(|| {
        let steep = options.slope_deg;
        let problem = format!("expected triangles that face up by {steep} degrees, found none of {}", triangles.len());
        bad("floor", problem)
    })?;
    // Every triangle without what blocks it, by template.
    let free = |&t: &usize| (triangles[t].template, free(t, &triangles, &index, &storey, options));
    let pieces: Vec<(Option<usize>, MultiPolygon<f64>)> = storey.triangles.par_iter().map(free).collect();
    let all = all_snapped(&unary_union(pieces.iter().map(|(_, piece)| piece)));
    let near = |t: usize| (triangles[t].middle().y - storey.height).abs() <= options.step_m;
    let level = storey.triangles.iter().zip(&pieces).filter(|&(&t, _)| near(t)).map(|(_, (_, piece))| piece);
    let Some(whole) = connected(&all, &all_snapped(&unary_union(level)), &mut notes) else {
        return Err(bad("floor", format!("expected room for people of {} m, found none", options.head_m)));
    };
    let mut found = Vec::new();
    for template in (0..signs.len()).map(Some) {
        let own = unary_union(pieces.iter().filter(|(of, _)| *of == template).map(|(_, piece)| piece));
        found.extend(
            all_snapped(&own).intersection(&whole).simplify(DETAIL).0.iter().map(|polygon| ground(template, polygon)),
        );
    }
    Ok(Grounds { found, notes })
}

/// What is free of a triangle, in plan.
fn free(
    index: usize,
    triangles: &[Triangle],
    near: &Index,
    storey: &Storey,
    options: &FloorOptions,
) -> MultiPolygon<f64> {
    let triangle = &triangles[index];
    let own = MultiPolygon::new(vec![snapped(&clip::widened(&triangle.corners, SEAM))]);
    let mut blocked: Vec<Polygon<f64>> = Vec::new();
    for other in near.around(triangle, CLEARANCE).filter(|&other| other != index) {
        let part = clip::over(&triangles[other].corners, triangle, CLEARANCE);
        let above = |low: f64, high: f64| clip::between(&part, triangle, low, high);
        // In the way; or another floor of the same storey, above or below, that is more of it.
        let mut add = |part: Vec<glam::DVec3>| {
            blocked.extend((!part.is_empty()).then(|| snapped(&clip::widened(&part, CLEARANCE))));
        };
        add(above(options.step_m, options.head_m));
        if storey.comes_before(other, index) {
            add(above(options.head_m, f64::INFINITY));
            add(above(f64::NEG_INFINITY, -options.head_m));
        }
    }
    if blocked.is_empty() { own } else { all_snapped(&own.difference(&all_snapped(&unary_union(&blocked)))) }
}

/// The connected part that has most ground at the height of the storey.
fn connected(all: &MultiPolygon<f64>, level: &MultiPolygon<f64>, notes: &mut Vec<String>) -> Option<Polygon<f64>> {
    let mut parts: Vec<&Polygon<f64>> = all.0.iter().collect();
    parts.sort_by(|a, b| b.unsigned_area().total_cmp(&a.unsigned_area()));
    let at_level = |part: &&Polygon<f64>| part.intersection(level).unsigned_area();
    let most = parts.iter().take(CANDIDATES).map(|part| (at_level(part), *part));
    let (_, whole) = most.reduce(|best, next| if next.0 > best.0 { next } else { best })?;
    let left = all.unsigned_area() - whole.unsigned_area();
    if left >= 1.0 {
        notes.push(format!("{left:.0} m2 of the floor cannot be reached on this storey: left out"));
    }
    Some(whole.clone())
}

fn ground(template: Option<usize>, polygon: &Polygon<f64>) -> Ground {
    let ring = |ring: &LineString<f64>| ring.0.iter().map(|p| [p.x, p.y]).collect();
    Ground { template, rings: std::iter::once(polygon.exterior()).chain(polygon.interiors()).map(ring).collect() }
}
