//! Numbers on a grid over the ground, in between bilinear.

use glam::Vec2;

/// Numbers on a grid; outside, the nearest of them.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Grid {
    /// Where the first number is, metres.
    pub origin: Vec2,
    /// Distance from one to the next, metres.
    pub cell: f32,
    /// Numbers along x.
    pub columns: usize,
    /// Row by row, each along x; rows follow each other along z.
    pub values: Vec<f32>,
}

impl Grid {
    /// The places of the numbers of a grid from `low` to `high` with nodes at most `cell` apart, in order.
    pub fn nodes(low: Vec2, high: Vec2, cell: f32) -> (usize, Vec<Vec2>) {
        let count = ((high - low) / cell).ceil().max(Vec2::ONE);
        let (columns, rows) = (count.x as usize + 1, count.y as usize + 1);
        let node = |i: usize| low + Vec2::new((i % columns) as f32, (i / columns) as f32) * cell;
        (columns, (0..columns * rows).map(node).collect())
    }

    /// The number at a place. O(1).
    pub fn at(&self, p: Vec2) -> f32 {
        let rows = self.values.len() / self.columns;
        let last = Vec2::new((self.columns - 1) as f32, (rows - 1) as f32);
        let at = ((p - self.origin) / self.cell).clamp(Vec2::ZERO, last);
        let (x, z) = (at.x as usize, at.y as usize);
        let (right, up) = ((x + 1).min(self.columns - 1), (z + 1).min(rows - 1));
        let t = at - Vec2::new(x as f32, z as f32);
        let value = |x: usize, z: usize| self.values[z * self.columns + x];
        let across = |z: usize| value(x, z) + (value(right, z) - value(x, z)) * t.x;
        across(z) + (across(up) - across(z)) * t.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_is_kept_and_the_border_goes_on() {
        let f = |p: Vec2| 2.0 * p.x - 0.5 * p.y + 1.0;
        let (low, high) = (Vec2::new(-1.0, 2.0), Vec2::new(3.2, 5.1));
        let (columns, nodes) = Grid::nodes(low, high, 0.5);
        assert!(nodes.last().unwrap().cmpge(high).all());
        let grid = Grid { origin: low, cell: 0.5, columns, values: nodes.into_iter().map(f).collect() };
        for p in [low, Vec2::new(0.3, 4.2), high] {
            assert!((grid.at(p) - f(p)).abs() < 1e-5, "{p}");
        }
        assert_eq!(grid.at(Vec2::new(-9.0, 3.0)), grid.at(Vec2::new(-1.0, 3.0)));
    }
}
