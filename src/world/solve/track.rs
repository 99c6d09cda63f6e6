//! A walker while its way is being found.

use std::ops::Range;

use glam::DVec2;

use crate::world::frame::Line;

/// Control points of one walker on the common grid, double precision.
#[derive(Clone, Debug)]
pub(super) struct Track {
    /// Where and when it comes in.
    pub entry: Line,
    /// Where and when it goes out, on its own clock.
    pub exit: Line,
    /// Grid index of control point 0.
    pub first: i32,
    /// Control points that may move; all others lie on the lines of entry and exit.
    pub free: Range<usize>,
    /// Control points.
    pub points: Vec<DVec2>,
    /// Places at the knots: `knots[k]` at grid index `first + k`.
    pub knots: Vec<DVec2>,
}

impl Track {
    /// A track without any point, to be `aim`ed.
    pub fn new(line: Line) -> Self {
        Self { entry: line, exit: line, first: 0, free: 0..0, points: Vec::new(), knots: Vec::new() }
    }

    /// Makes it lead from `entry` to `exit`; free points are not set yet.
    pub fn aim(&mut self, entry: Line, exit: Line, step: f64) {
        self.entry = entry;
        self.exit = exit;
        // A segment from knot k to k + 1 uses the points k - 1 to k + 2.
        self.first = ((entry.time - entry.reach) / step).floor() as i32 - 1;
        let last = ((exit.time + exit.reach) / step).ceil() as i32 + 1;
        let straight_until = ((entry.time + entry.reach) / step).floor() as i32 + 2;
        let straight_from = ((exit.time - exit.reach) / step).ceil() as i32 - 2;
        let begin = (straight_until + 1 - self.first) as usize;
        self.free = begin..((straight_from - self.first).max(0) as usize).max(begin);
        self.points.clear();
        for index in self.first..=last {
            let time = f64::from(index) * step;
            let line = if index <= straight_until { &self.entry } else { &self.exit };
            self.points.push(line.at(time));
        }
        self.knots.clear();
        self.knots.extend_from_slice(&self.points);
    }

    /// Grid index after the last.
    pub fn end(&self) -> i32 {
        self.first + self.points.len() as i32
    }

    /// Second difference at point `k`: acceleration times the step squared, exact at the knot.
    #[inline]
    pub fn bend(&self, k: usize) -> DVec2 {
        self.points[k - 1] - 2.0 * self.points[k] + self.points[k + 1]
    }

    /// Recomputes the knots that the free points have a share in.
    pub fn update_knots(&mut self) {
        for k in self.moving_knots() {
            self.knots[k] = (self.points[k - 1] + 4.0 * self.points[k] + self.points[k + 1]) / 6.0;
        }
    }

    /// Knots that depend on free points.
    pub fn moving_knots(&self) -> Range<usize> {
        self.free.start - 1..self.free.end + 1
    }

    /// How far the curve leaves the chord between knots `k` and `k + 1` at most.
    #[inline]
    pub fn sag(&self, k: usize) -> f64 {
        (self.bend(k).length_squared().max(self.bend(k + 1).length_squared())).sqrt() / 8.0
    }
}

impl Track {
    /// Puts the free points at even speed on the way from `from` over `via` to `to`, which lasts from `begin` to `end`
    /// on the grid.
    pub fn follow(&mut self, from: DVec2, to: DVec2, via: &[DVec2], begin: f64, end: f64) {
        let corner = |i: usize| if i == 0 { from } else { via.get(i - 1).copied().unwrap_or(to) };
        let length: f64 = (0..=via.len()).map(|i| corner(i).distance(corner(i + 1))).sum();
        let (mut leg, mut walked) = (0, 0.0);
        for k in self.free.clone() {
            let along = length * ((f64::from(self.first + k as i32) - begin) / (end - begin)).clamp(0.0, 1.0);
            while leg < via.len() && along > walked + corner(leg).distance(corner(leg + 1)) {
                walked += corner(leg).distance(corner(leg + 1));
                leg += 1;
            }
            let (a, b) = (corner(leg), corner(leg + 1));
            self.points[k] = a.lerp(b, ((along - walked) / a.distance(b).max(1e-9)).clamp(0.0, 1.0));
        }
        self.update_knots();
    }

    /// The moving knot nearest to `place`.
    pub fn nearest_knot(&self, place: DVec2) -> usize {
        let distance = |k: &usize| self.knots[*k].distance_squared(place);
        self.moving_knots().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(self.free.start)
    }
}
