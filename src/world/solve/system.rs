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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::frame::Line;
    use proptest::prelude::*;

    fn track(points: Vec<(f64, f64)>) -> Track {
        let line = Line { edge: 0, place: DVec2::ZERO, velocity: DVec2::X, time: 0.0, reach: 0.1 };
        let points: Vec<DVec2> = points.into_iter().map(|(x, z)| DVec2::new(x, z)).collect();
        let mut track = Track { free: 3..points.len() - 3, knots: points.clone(), points, ..Track::new(line) };
        track.update_knots();
        track
    }

    proptest! {
        /// The solution is where the sum of squares, written out, is flat in every direction.
        #[test]
        fn the_solution_is_the_least_sum_of_squares(
            points in prop::collection::vec((-1.0f64..1.0, -1.0f64..1.0), 9..16),
            push in (3usize..6, 0.1f64..9.0, 0.0f64..6.2, -0.5f64..0.5),
            even in (3usize..6, 0.1f64..9.0, -0.5f64..0.5, -0.5f64..0.5),
            slow in (2usize..6, 0.1f64..9.0, -0.5f64..0.5, -0.5f64..0.5),
        ) {
            let before = track(points);
            let normal = DVec2::from_angle(push.2);
            let (excess, haste) = (DVec2::new(even.2, even.3), DVec2::new(slow.2, slow.3));
            let step = |t: &Track, k: usize| t.points[k + 1] - t.points[k];
            let sum = |t: &Track| {
                let held: f64 = t.free.clone().map(|k| (t.points[k] - before.points[k]).length_squared()).sum();
                let bends: f64 = t.moving_knots().map(|k| t.bend(k).length_squared()).sum();
                0.1 * held + bends
                    + push.1 * (push.3 - normal.dot(t.knots[push.0] - before.knots[push.0])).powi(2)
                    + even.1 * (t.bend(even.0) - before.bend(even.0) + excess).length_squared()
                    + slow.1 * (step(t, slow.0) - step(&before, slow.0) + haste).length_squared()
            };
            let mut system = System::default();
            system.begin(&before, 0.1);
            system.push(push.0, push.1, normal, push.3);
            system.even(even.0, even.1, excess);
            system.slow(slow.0, slow.1, haste);
            let mut solved = before.clone();
            system.apply(&mut solved, f64::INFINITY);
            for k in solved.free.clone() {
                for axis in [DVec2::X, DVec2::Y] {
                    let moved = |by: f64| {
                        let mut other = solved.clone();
                        other.points[k] += axis * by;
                        other.update_knots();
                        sum(&other)
                    };
                    prop_assert!((moved(1e-4) - moved(-1e-4)).abs() < 1e-9 * (1.0 + sum(&solved)));
                }
            }
        }
    }

    #[test]
    fn nailed_points_stay() {
        let before = track((0..10).map(|i| (f64::from(i), f64::from(i * i % 3))).collect());
        let (mut system, mut solved) = (System::default(), before.clone());
        system.begin(&before, 0.1);
        system.nail(4);
        system.apply(&mut solved, f64::INFINITY);
        assert!(solved.points[4].distance(before.points[4]) < 1e-8);
        assert!(solved.points[5].distance(before.points[5]) > 1e-3);
    }
}
