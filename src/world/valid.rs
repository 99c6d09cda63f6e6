//! Whether a frame-patch can be filled by anybody: sizes, patterns, objects, corners.

use glam::Vec2;

use super::frame::Line;
use super::shape::{Obstacle, convex_problem};
use super::spacing::{self, STRAIGHT_SECS};
use super::{Border, FramePatch, Limits, Pattern, Shape};
use crate::{Error, Result};

/// Largest patch, metres from its first corner.
const LARGEST: f32 = 150.0;
/// Periods a patch can have, seconds.
const PERIODS: std::ops::RangeInclusive<f32> = 2.0..=300.0;

impl FramePatch {
    /// All that is wrong with it, each with its place; empty if walkers can be led through it.
    pub fn problems(&self, limits: &Limits) -> Vec<String> {
        if let Err(error) = check_outline(&self.outline, self.patterns.len()) {
            return vec![error.to_string()];
        }
        let mut found = self.size_problems();
        for (edge, pattern) in self.patterns.iter().enumerate() {
            found.extend(self.pattern_problems(edge, pattern, limits).map(|p| format!("edge {edge}: {p}")));
        }
        found.extend(super::pattern::balanced(&self.patterns).err().map(|e| e.to_string()));
        if found.is_empty() {
            found.extend(self.object_problems(limits));
            found.extend(self.corner_problems(limits));
        }
        found
    }

    /// Sizes nobody means: they would only eat memory and time.
    fn size_problems(&self) -> Vec<String> {
        let far = self.outline.iter().map(|p| p.distance(self.outline[0])).fold(0.0, f32::max);
        let most = self.outline.iter().map(|p| p.abs().max_element()).fold(0.0, f32::max);
        let mut found = Vec::new();
        if far > LARGEST {
            found.push(format!("expected a patch of at most {LARGEST} m, found {far} m"));
        }
        if most > 10.0 * LARGEST {
            found.push(format!("expected coordinates near the patch's own origin, found {most} m"));
        }
        if !PERIODS.contains(&self.period()) {
            found.push(format!(
                "expected a period from {} to {} s, found {}",
                PERIODS.start(),
                PERIODS.end(),
                self.period()
            ));
        }
        found
    }

    /// The first walkers who meet near a corner before either can step aside, or whose bodies reach over the next edge.
    fn corner_problems(&self, limits: &Limits) -> Vec<String> {
        let inputs = self.inputs().map(|port| self.line(port, true, limits));
        let lines: Vec<Line> = inputs.chain(self.outputs().map(|port| self.line(port, false, limits))).collect();
        let borders: Vec<Border> = (0..self.outline.len()).map(|edge| self.border(edge)).collect();
        let mut found = Vec::new();
        for (i, a) in lines.iter().enumerate() {
            if !found.is_empty() {
                break;
            }
            let others = borders.iter().enumerate().filter(|&(edge, _)| edge != a.edge);
            let cut = others.filter(|(_, b)| {
                // The deep end of the straight part is before the time of an output, after that of an input.
                let deep = if a.velocity.dot(borders[a.edge].inward) > 0.0 { a.reach } else { -a.reach };
                let depth = |s: f64| (a.at(a.time + s) - b.begin).dot(b.inward);
                depth(0.0).min(depth(deep)) < f64::from(spacing::least_depth(limits))
            });
            found.extend(cut.map(|(edge, _)| format!("a crossing of edge {} is too near to edge {edge}", a.edge)));
            for b in lines[i + 1..].iter().filter(|b| b.edge != a.edge && b.place.distance_squared(a.place) < 16.0) {
                if straight_distance(a, b, f64::from(self.period())) < 2.0 * f64::from(limits.radius) {
                    found.push(format!("two crossings of edges {} and {} collide at their corner", a.edge, b.edge));
                }
            }
        }
        found
    }

    fn pattern_problems(&self, edge: usize, pattern: &Pattern, limits: &Limits) -> impl Iterator<Item = String> {
        let mut found = pattern.problems();
        let length = self.border(edge).length as f32;
        if (pattern.length - length).abs() > 1e-3 {
            found.push(format!("expected a pattern of length {length} m, found {}", pattern.length));
        }
        if pattern.period != self.period() {
            found.push(format!("expected period {} s, found {}", self.period(), pattern.period));
        }
        if found.is_empty() {
            found = spacing::problems(pattern, limits);
        }
        found.into_iter()
    }

    fn object_problems(&self, limits: &Limits) -> Vec<String> {
        let shapes = self.objects.iter().map(|o| (&o.name, o.shape.clone()));
        let people = self.people.iter().map(|p| (&p.name, Shape::disc(p.position, p.radius)));
        let mut found = Vec::new();
        for (name, shape) in shapes.chain(people) {
            let problem = shape.problem().or_else(|| self.misplaced(&shape, limits));
            found.extend(problem.map(|problem| format!("object {name:?}: {problem}")));
        }
        found
    }

    /// Why an object must not be where it is: outside, or where people cross a border.
    pub(super) fn misplaced(&self, shape: &Shape, limits: &Limits) -> Option<String> {
        let own = Obstacle::new(shape, 0.0);
        for edge in 0..self.outline.len() {
            let border = self.border(edge);
            if (own.support(-border.inward) - border.begin).dot(border.inward) < -1e-4 {
                return Some(format!("expected it inside the outline, it reaches over edge {edge}"));
            }
        }
        let grown = Obstacle::new(shape, f64::from(limits.radius));
        let ports = self.inputs().map(|p| (p, true)).chain(self.outputs().map(|p| (p, false)));
        for (port, inward) in ports {
            let line = self.line(port, inward, limits);
            let secs = f64::from(STRAIGHT_SECS);
            if !grown.clear(line.at(line.time - secs), line.at(line.time + secs), f64::from(spacing::GAP)) {
                return Some(format!("expected it off the crossings of edge {}, found it on one", port.edge));
            }
        }
        None
    }
}

/// Least distance of two walkers while both are on the straight parts of different edges.
fn straight_distance(a: &Line, b: &Line, period: f64) -> f64 {
    let lag = (b.time - a.time) - ((b.time - a.time) / period).round() * period;
    let (begin, end) = ((-a.reach).max(lag - b.reach), a.reach.min(lag + b.reach));
    if begin > end {
        return f64::INFINITY;
    }
    let apart = |s: f64| a.at(a.time + s) - b.at(b.time + s - lag);
    let (from, v) = (apart(begin), a.velocity - b.velocity);
    let nearest = (-from.dot(v) / v.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, end - begin);
    (from + v * nearest).length()
}

pub(super) fn check_outline(outline: &[Vec2], patterns: usize) -> Result<()> {
    let problem = convex_problem(outline).or_else(|| {
        (outline.len() != patterns)
            .then(|| format!("expected a pattern for each of {} edges, found {patterns}", outline.len()))
    });
    problem.map_or(Ok(()), |problem| Err(Error::invalid("patch", "outline", problem)))
}
