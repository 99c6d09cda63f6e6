//! Where the patches of a world are, and which of them are near.

use std::collections::BTreeMap;

use glam::DVec2;

use super::Tables;

/// Places are whole numbers of this part of a metre: exact over millions of kilometres of `f64`, 2,000 km of `i32`.
pub const UNITS_PER_METRE: f64 = 1024.0;

/// Nobody looks further, metres: a world that repeats has no end.
const FARTHEST: f64 = 20_000.0;
/// Nor over more copies of a world than this, in either direction.
const MOST_COPIES: f64 = 100.0;

/// A patch at its place, or at one of its repetitions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Index of the patch.
    pub instance: u32,
    /// How far from its place, metres: zero unless the world repeats.
    pub shift: DVec2,
}

/// Patches by squares of ground.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Nearby {
    side: f64,
    repeat: Option<DVec2>,
    /// Radius of the largest patch about its origin.
    reach: f64,
    squares: BTreeMap<[i32; 2], Vec<u32>>,
    /// Least and greatest square in use, per axis.
    bounds: [[i32; 2]; 2],
}

impl Nearby {
    pub(super) fn new(tables: &Tables) -> Self {
        let reach = (0..tables.kinds()).map(|k| tables.kind(k).reach()).fold(0.0, f64::max);
        let repeat = tables.info.repeat.map(|r| DVec2::new(f64::from(r[0]), f64::from(r[1])) / UNITS_PER_METRE);
        let mut nearby = Self { side: (2.0 * reach).max(1.0), repeat, reach, ..Self::default() };
        nearby.bounds = [[i32::MAX; 2], [i32::MIN; 2]];
        for instance in 0..tables.instance_kinds.len() {
            let at = nearby.square(tables.place(instance));
            nearby.squares.entry(at).or_default().push(instance as u32);
            for (axis, &c) in at.iter().enumerate() {
                nearby.bounds[0][axis] = nearby.bounds[0][axis].min(c);
                nearby.bounds[1][axis] = nearby.bounds[1][axis].max(c);
            }
        }
        nearby
    }

    fn square(&self, place: DVec2) -> [i32; 2] {
        (place / self.side).floor().as_i64vec2().to_array().map(|c| c as i32)
    }

    /// All patches that reach into the disc of `radius` metres about `centre`, with their repetitions; a few beyond may be among
    /// them. The work is in proportion to the area asked for.
    pub fn within(&self, centre: DVec2, radius: f64) -> impl Iterator<Item = Spot> {
        let most = self.repeat.map_or(FARTHEST, |size| FARTHEST.min(MOST_COPIES * size.min_element()));
        let far = radius.clamp(0.0, most) + self.reach;
        self.shifts(centre, far).flat_map(move |shift| {
            let low = self.square(centre - shift - far);
            let high = self.square(centre - shift + far);
            let range = |axis: usize| low[axis].max(self.bounds[0][axis])..=high[axis].min(self.bounds[1][axis]);
            let rows = range(1);
            range(0)
                .flat_map(move |x| rows.clone().map(move |z| [x, z]))
                .filter_map(|square| self.squares.get(&square))
                .flat_map(move |instances| instances.iter().map(move |&instance| Spot { instance, shift }))
        })
    }

    /// Where repetitions begin that may come as near as `far` to `centre`.
    fn shifts(&self, centre: DVec2, far: f64) -> impl Iterator<Item = DVec2> {
        let size = self.repeat.unwrap_or(DVec2::INFINITY);
        let range = |c: f64, size: f64| if size.is_finite() { copies(c, size, far) } else { 0..=0 };
        let (columns, rows) = (range(centre.x, size.x), range(centre.y, size.y));
        rows.flat_map(move |z| columns.clone().map(move |x| [x, z])).map(move |[x, z]| {
            let along = |n: i64, size: f64| if n == 0 { 0.0 } else { n as f64 * size };
            DVec2::new(along(x, size.x), along(z, size.y))
        })
    }

    pub(super) fn bytes(&self) -> usize {
        self.squares.values().map(|v| 32 + 4 * v.capacity()).sum()
    }
}

/// Numbers of the copies of an interval of `size` that come within `far` of `c`.
fn copies(c: f64, size: f64, far: f64) -> std::ops::RangeInclusive<i64> {
    (((c - far) / size).floor() as i64 - 1)..=(((c + far) / size).floor() as i64 + 1)
}
