//! The plane of tiles: which colour an edge has and which tile lies somewhere, each known by itself.

use glam::Vec2;

use crate::tiling::{Scene, Wang};

/// Sides of a tile: towards -x, +x, -z, +z.
pub(in crate::tiling) const SIDES: usize = 4;

/// Along which axis people go who cross an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Across {
    /// The edge runs along z.
    X,
    /// The edge runs along x.
    Z,
}

/// What a tile is: the colours of its sides, none at the rim of the region, and which of its variants.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Key {
    /// By side.
    pub sides: [Option<u32>; SIDES],
    /// Which of those with these sides.
    pub variant: u32,
}

/// A rectangle of the plane of tiles. Places of tiles are counted from the origin of the plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    wang: Wang,
    seed: u64,
    first: [i64; 2],
    /// How many tiles along x and z.
    pub count: [i64; 2],
}

impl Plane {
    /// The plane of a scene whose region is made of whole tiles.
    pub fn new(scene: &Scene, wang: Wang, seed: u64) -> Self {
        let (low, high) = scene.region.bounds();
        let whole = |v: f32| f64::from(v / wang.tile).round() as i64;
        let (first, last) = ([whole(low.x), whole(low.y)], [whole(high.x), whole(high.y)]);
        Self { wang, seed, first, count: [last[0] - first[0], last[1] - first[1]] }
    }

    /// The tiles, row by row.
    pub fn places(self) -> impl Iterator<Item = [i64; 2]> {
        let [columns, rows] = self.count;
        (0..rows).flat_map(move |k| (0..columns).map(move |i| [i, k])).map(move |at| self.absolute(at))
    }

    /// Number of a tile in the order of [`Plane::places`].
    pub fn index(self, [i, k]: [i64; 2]) -> usize {
        ((k - self.first[1]) * self.count[0] + i - self.first[0]) as usize
    }

    fn absolute(self, [i, k]: [i64; 2]) -> [i64; 2] {
        [i + self.first[0], k + self.first[1]]
    }

    /// The tile at a place.
    pub fn key(self, [i, k]: [i64; 2]) -> Key {
        let sides = [
            self.colour(Across::X, [i, k]),
            self.colour(Across::X, [i + 1, k]),
            self.colour(Across::Z, [i, k]),
            self.colour(Across::Z, [i, k + 1]),
        ];
        let variant = draw(self.seed, [2, i as u64, k as u64], self.wang.variants);
        Key { sides, variant }
    }

    /// The colour of the edge at the lower end of a tile; none at the rim.
    fn colour(self, across: Across, [i, k]: [i64; 2]) -> Option<u32> {
        let (at, first, count) = match across {
            Across::X => (i, self.first[0], self.count[0]),
            Across::Z => (k, self.first[1], self.count[1]),
        };
        let inner = at > first && at < first + count;
        inner.then(|| draw(self.seed, [across as u64, i as u64, k as u64], self.wang.colours))
    }

    /// The lower corner of a tile, metres.
    pub fn corner(self, [i, k]: [i64; 2]) -> Vec2 {
        Vec2::new(i as f32, k as f32) * self.wang.tile
    }
}

impl Key {
    /// What everything of this tile is drawn from.
    pub fn seed(self, seed: u64) -> u64 {
        let side = |c: Option<u32>| c.map_or(0, |c| u64::from(c) + 1);
        let sides = self.sides.into_iter().fold(0, |sum, c| sum << 16 | side(c));
        mix(mix(seed ^ mix(sides)) ^ u64::from(self.variant))
    }
}

/// One of `count`, by a hash of some numbers.
fn draw(seed: u64, numbers: [u64; 3], count: u32) -> u32 {
    let hash = numbers.into_iter().fold(mix(seed), |sum, n| mix(sum ^ n));
    (hash % u64::from(count)) as u32
}

/// The finalizer of SplitMix64: every bit of the answer depends on every bit of the question.
pub(super) fn mix(n: u64) -> u64 {
    let n = n.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let n = (n ^ (n >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let n = (n ^ (n >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    n ^ (n >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Polygon;

    fn plane(low: Vec2, high: Vec2, seed: u64) -> Plane {
        let wang = Wang { tile: 10.0, colours: 2, variants: 3 };
        Plane::new(&Scene::new(Polygon::rectangle(low, high), 20.0, 1), wang, seed)
    }

    #[test]
    fn neighbours_agree_on_their_edge_and_the_rim_is_closed() {
        let plane = plane(Vec2::new(-30.0, 20.0), Vec2::new(50.0, 90.0), 5);
        let [columns, rows] = plane.count;
        assert_eq!([columns, rows], [8, 7]);
        for (n, [i, k]) in plane.places().enumerate() {
            assert_eq!(plane.index([i, k]), n);
            let sides = plane.key([i, k]).sides;
            assert_eq!(sides.map(|c| c.is_none()), [i == -3, i == 4, k == 2, k == 8]);
            if i < 4 {
                assert_eq!(sides[1], plane.key([i + 1, k]).sides[0]);
            }
            if k < 8 {
                assert_eq!(sides[3], plane.key([i, k + 1]).sides[2]);
            }
        }
    }

    #[test]
    fn a_place_has_the_same_tile_whatever_lies_around_it() {
        let (small, large) =
            (plane(Vec2::ZERO, Vec2::splat(60.0), 9), plane(Vec2::splat(-100.0), Vec2::splat(90.0), 9));
        let inner: Vec<[i64; 2]> = small.places().filter(|at| at.iter().all(|&n| n > 0 && n < 5)).collect();
        assert!(inner.len() == 16 && inner.into_iter().all(|at| small.key(at) == large.key(at)));
    }

    #[test]
    fn all_combinations_are_about_as_frequent() {
        let plane = plane(Vec2::ZERO, Vec2::splat(1000.0), 1);
        let mut counts = std::collections::BTreeMap::new();
        for at in plane.places().filter(|at| at.iter().all(|&n| n > 0 && n < 99)) {
            *counts.entry(plane.key(at)).or_insert(0) += 1;
        }
        assert_eq!(counts.len(), 16 * 3);
        assert!(counts.values().all(|&n| (140..270).contains(&n)), "{counts:?}");
    }
}
