//! Storeys: floors that people can go about on without steps that are too high; and which of them is meant.

use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::FloorOptions;
use super::clip::{over, plan};
use super::mesh::Triangle;
use crate::world::area::cells::find;
use crate::{Error, Result};

/// Triangles this near to each other in plan touch, metres.
const TOUCH: f64 = 0.01;
/// Pairs of triangles above each other that are looked at, at most.
const MOST_PAIRS: usize = 50_000_000;

/// Other floors that are smaller are tops of tables, square metres.
const WORTH_TELLING: f64 = 6.0;

type Entry = GeomWithData<Rectangle<[f64; 2]>, usize>;

/// Finds triangles that are near each other in plan.
pub(super) struct Index {
    tree: RTree<Entry>,
}

impl Index {
    /// # Errors
    /// If so many triangles lie on each other that going through them would take for ever.
    pub fn new(triangles: &[Triangle]) -> Result<Self> {
        let entry = |(index, triangle): (usize, &Triangle)| {
            let bounds = bounds(triangle, 0.0);
            GeomWithData::new(Rectangle::from_aabb(bounds), index)
        };
        let index = Self { tree: RTree::bulk_load(triangles.iter().enumerate().map(entry).collect()) };
        let mut pairs = 0;
        for triangle in triangles.iter().filter(|t| t.template.is_some()) {
            pairs += index.tree.locate_in_envelope_intersecting(&bounds(triangle, TOUCH)).count();
            if pairs > MOST_PAIRS {
                let problem = format!("expected at most {MOST_PAIRS} pairs of triangles above each other, found more");
                return Err(Error::invalid("mesh", "floor", problem));
            }
        }
        Ok(index)
    }

    /// The triangles around one, in the order of the file.
    pub fn around(&self, triangle: &Triangle, reach: f64) -> impl Iterator<Item = usize> {
        let found = self.tree.locate_in_envelope_intersecting(&bounds(triangle, reach));
        let mut found: Vec<usize> = found.map(|entry| entry.data).collect();
        found.sort_unstable();
        found.into_iter()
    }
}

fn bounds(triangle: &Triangle, reach: f64) -> AABB<[f64; 2]> {
    let [a, b, c] = triangle.corners.map(plan);
    let (low, high) = (a.min(b).min(c) - reach, a.max(b).max(c) + reach);
    AABB::from_corners(low.into(), high.into())
}

/// A storey: perhaps with parts above each other, where stairs lead to another one.
pub(super) struct Storey {
    /// Its triangles.
    pub triangles: Vec<usize>,
    /// Where most of it is, or where it is meant to be, metres.
    pub height: f64,
    /// Of every triangle of the mesh, how far it is from there; none if it is not of this storey.
    away: Vec<Option<f64>>,
}

impl Storey {
    /// The storey that is meant; none if there is no floor. Others are told.
    pub fn choose(
        triangles: &[Triangle],
        index: &Index,
        options: &FloorOptions,
        notes: &mut Vec<String>,
    ) -> Option<Self> {
        let mut storeys: Vec<(Vec<usize>, f64)> = linked(triangles, index, options.step_m)
            .into_iter()
            .map(|storey| {
                let area = storey.iter().map(|&t| triangles[t].area()).sum();
                (storey, area)
            })
            .collect();
        // How far a storey is from the height that is asked for: within a step all are alike.
        let away = |storey: &[usize]| {
            let distance = |&t: &usize| options.height_m.map_or(0.0, |h| (triangles[t].middle().y - h).abs());
            let least = storey.iter().map(distance).fold(f64::INFINITY, f64::min);
            (least / options.step_m) as u64
        };
        storeys.sort_by(|a, b| away(&a.0).cmp(&away(&b.0)).then(b.1.total_cmp(&a.1)));
        let mut storeys = storeys.into_iter();
        let (chosen, _) = storeys.next()?;
        let height = options.height_m.unwrap_or_else(|| level(&chosen, triangles, options.step_m));
        let others: Vec<(Vec<usize>, f64)> = storeys.filter(|(_, area)| *area >= WORTH_TELLING).collect();
        let told = others
            .iter()
            .take(5)
            .map(|(storey, area)| format!("{area:.0} m2 at {:.1} m", level(storey, triangles, options.step_m)));
        let told: Vec<String> = told.collect();
        if !told.is_empty() {
            let more = if others.len() > told.len() { ", ..." } else { "" };
            notes.push(format!("other floors were left out (height_m chooses): {}{more}", told.join(", ")));
        }
        let mut away = vec![None; triangles.len()];
        chosen.iter().for_each(|&t| away[t] = Some((triangles[t].middle().y - height).abs()));
        Some(Self { triangles: chosen, height, away })
    }

    /// Whether of two triangles above each other the first is more of the storey.
    pub fn comes_before(&self, first: usize, second: usize) -> bool {
        match (self.away[first], self.away[second]) {
            (Some(a), Some(b)) => (a, first) < (b, second),
            _ => false,
        }
    }
}

/// The height at which most of a floor is, to a step; the lower one of two that are as large.
fn level(storey: &[usize], triangles: &[Triangle], step: f64) -> f64 {
    let mut levels = std::collections::BTreeMap::<i64, (f64, f64)>::new();
    for triangle in storey.iter().map(|&t| &triangles[t]) {
        let (height, area) = (triangle.middle().y, triangle.area());
        let level = levels.entry((height / step).round() as i64).or_default();
        *level = (level.0 + area, level.1 + area * height);
    }
    let most = levels.values().fold(0.0, |most: f64, level| most.max(level.0));
    levels.values().find(|level| level.0 >= 0.99 * most).map_or(0.0, |level| level.1 / level.0)
}

/// Floors linked by steps, in the order of their first triangles.
fn linked(triangles: &[Triangle], index: &Index, step: f64) -> Vec<Vec<usize>> {
    let mut owner: Vec<usize> = (0..triangles.len()).collect();
    for (t, triangle) in triangles.iter().enumerate().filter(|(_, triangle)| triangle.template.is_some()) {
        for other in index.around(triangle, TOUCH) {
            if other > t && triangles[other].template.is_some() && touch(triangle, &triangles[other], step) {
                let (a, b) = (find(&mut owner, t), find(&mut owner, other));
                owner[a.max(b)] = a.min(b);
            }
        }
    }
    let mut storeys = std::collections::BTreeMap::<usize, Vec<usize>>::new();
    for t in (0..triangles.len()).filter(|&t| triangles[t].template.is_some()) {
        storeys.entry(find(&mut owner, t)).or_default().push(t);
    }
    storeys.into_values().collect()
}

/// Whether people can step from one triangle onto the other.
fn touch(a: &Triangle, b: &Triangle, step: f64) -> bool {
    let heights = over(&b.corners, a, TOUCH).into_iter().map(|p| a.below(p));
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    low <= step && high >= -step
}
