//! The least-squares problem of one walker's free control points, all others being fixed.
//!
//! Unknown are the moves of the points. Every term is the square of something linear in up to three neighbouring
//! points, so the normal matrix has a narrow band.

use glam::DVec2;

use super::track::Track;
use crate::world::band::{self, Row};

/// Shares of the points k - 1, k, k + 1 in knot k.
const KNOT: [f64; 3] = [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0];
/// Shares in the second difference at k.
const BEND: [f64; 3] = [1.0, -2.0, 1.0];

/// Weight that no other has any force against.
const NAIL: f64 = 1e9;

/// Normal matrix and right side, kept from one solve to the next for their memory.
#[derive(Clone, Debug, Default)]
pub(super) struct System {
    rows: Vec<Row>,
    right: Vec<f64>,
    begin: usize,
    end: usize,
}

impl System {
    /// Begins with terms that hold every point of `track` where it is, and those that make its curve even.
    pub fn begin(&mut self, track: &Track, hold: f64) {
        (self.begin, self.end) = (track.free.start, track.free.end);
        let size = 2 * (self.end - self.begin);
        self.rows.clear();
        self.rows.resize(size, [hold, 0.0, 0.0, 0.0, 0.0, 0.0]);
        self.right.clear();
        self.right.resize(size, 0.0);
        for k in track.moving_knots() {
            self.even(k, 1.0, track.bend(k));
        }
    }

    /// Adds weight x |bend at k - wanted|^2, given `excess` = bend now - wanted.
    pub fn even(&mut self, k: usize, weight: f64, excess: DVec2) {
        for (i, &ci) in BEND.iter().enumerate() {
            let Some(row) = self.row(k + i) else { continue };
            let scaled = weight * ci;
            self.right[row] -= scaled * excess.x;
            self.right[row + 1] -= scaled * excess.y;
            for (j, &cj) in BEND[..=i].iter().enumerate() {
                if k + j > self.begin {
                    self.rows[row][2 * (i - j)] += scaled * cj;
                    self.rows[row + 1][2 * (i - j)] += scaled * cj;
                }
            }
        }
    }

    /// Adds weight x |step from k to k + 1 - wanted|^2, given `excess` = step now - wanted.
    pub fn slow(&mut self, k: usize, weight: f64, excess: DVec2) {
        let [from, to] = [self.row(k + 1), self.row(k + 2)];
        for (row, sign) in [(from, -1.0), (to, 1.0)] {
            let Some(row) = row else { continue };
            for (axis, value) in [excess.x, excess.y].into_iter().enumerate() {
                self.right[row + axis] -= weight * sign * value;
                self.rows[row + axis][0] += weight;
                if sign > 0.0 && from.is_some() {
                    self.rows[row + axis][2] -= weight;
                }
            }
        }
    }

    /// Adds weight x (gap - normal . move of knot k)^2.
    pub fn push(&mut self, k: usize, weight: f64, normal: DVec2, gap: f64) {
        let n = [normal.x, normal.y];
        for i in 0..3 {
            let Some(row) = self.row(k + i) else { continue };
            for (axis, &n_axis) in n.iter().enumerate() {
                let scaled = weight * KNOT[i] * n_axis;
                self.right[row + axis] += scaled * gap;
                for (j, &cj) in KNOT[..=i].iter().enumerate() {
                    if k + j > self.begin {
                        for (other, &n_other) in n.iter().enumerate().take(if i == j { axis + 1 } else { 2 }) {
                            self.rows[row + axis][2 * (i - j) + axis - other] += scaled * cj * n_other;
                        }
                    }
                }
            }
        }
    }

    /// Holds point `k` where it is.
    pub fn nail(&mut self, k: usize) {
        let row = 2 * (k - self.begin);
        self.right[row..row + 2].fill(0.0);
        self.rows[row..row + 2].iter_mut().for_each(|row| row[0] += NAIL);
    }

    /// First row of the point before `above`, if that is free.
    fn row(&self, above: usize) -> Option<usize> {
        (above > self.begin && above <= self.end).then(|| 2 * (above - 1 - self.begin))
    }

    /// Solves and moves the points of `track`, no point further than `most`.
    pub fn apply(&mut self, track: &mut Track, most: f64) {
        band::solve(&mut self.rows, &mut self.right);
        for (k, point) in track.points[self.begin..self.end].iter_mut().enumerate() {
            *point += DVec2::new(self.right[2 * k], self.right[2 * k + 1]).clamp_length_max(most);
        }
        track.update_knots();
    }
}
