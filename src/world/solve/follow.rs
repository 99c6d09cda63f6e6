//! The way of a walker who is where a motion has it at every time, as near as the limits of walking allow.
//!
//! One least-squares problem: knots at their wanted places, a curve that is even, and rows for what is over a limit, which
//! weigh the more the longer they are. What is wanted stays the same from round to round, so nothing drifts.

use glam::{DVec2, Vec2};

use super::contact::Push;
use super::own::Ground;
use super::planner::STEP;
use super::system::System;
use super::track::Track;
use crate::world::frame::{FramePatch, Line};
use crate::world::{Limits, Path};

/// Weight of a knot at its wanted place, beside the squares of second differences: hips that sway are smoothed over about
/// half a second.
const WANTED: f64 = 0.5;
/// Rounds, weight of what is over a limit at first, and how it grows from round to round where it still is.
const ROUNDS: usize = 60;
const FIRST: f64 = 2.0;
const GROWTH: f64 = 1.4;
const HEAVIEST: f64 = 1e5;
/// Keeps rows regular.
const HOLD: f64 = 1e-6;

/// The way through an empty frame-patch from `entry` to `exit` that is nearest to the places `wanted` at times (seconds) and keeps
/// the limits; `None` if none is found.
pub(in crate::world) fn follow(
    frame: &FramePatch,
    limits: &Limits,
    [entry, exit]: [Line; 2],
    wanted: impl Fn(f64) -> DVec2,
) -> Option<Path> {
    let period = f64::from(frame.period());
    let step = period / (period / STEP).round().max(1.0);
    let ground = Ground::new(frame, limits, Vec::new(), step);
    let mut track = Track::new(entry);
    track.aim(entry, exit, step);
    if track.free.is_empty() {
        return None;
    }
    let time = |k: usize, track: &Track| f64::from(track.first + k as i32) * step;
    for k in track.free.clone() {
        track.points[k] = wanted(time(k, &track));
    }
    track.update_knots();
    let mut rows = Rows { bends: vec![0.0; track.points.len()], steps: vec![0.0; track.points.len()], borders: vec![] };
    for _ in 0..ROUNDS {
        let mut system = System::default();
        system.begin(&track, HOLD);
        for k in track.moving_knots() {
            let gap = wanted(time(k, &track)) - track.knots[k];
            system.push(k, WANTED, DVec2::X, gap.x);
            system.push(k, WANTED, DVec2::Y, gap.y);
        }
        rows.add(&ground, &track, &mut system);
        system.apply(&mut track, f64::INFINITY);
        if ground.keeps(&track) {
            let points = track.points.iter().map(|p| Vec2::new(p.x as f32, p.y as f32)).collect();
            return Some(Path { step: step as f32, first: track.first, points });
        }
    }
    None
}

/// Weights of what was over a limit: of bends by knot, of steps by point, of pushes off borders.
struct Rows {
    bends: Vec<f64>,
    steps: Vec<f64>,
    borders: Vec<(Push, f64)>,
}

impl Rows {
    /// Adds what is over a limit, or was in an earlier round.
    fn add(&mut self, ground: &Ground, track: &Track, system: &mut System) {
        let heavier = |weight: &mut f64| *weight = (*weight * GROWTH).clamp(FIRST, HEAVIEST);
        for k in track.moving_knots() {
            let (excess, haste) = (ground.excess(track, k), ground.haste(track, k));
            excess.is_some().then(|| heavier(&mut self.bends[k]));
            haste.is_some().then(|| heavier(&mut self.steps[k]));
            if self.bends[k] > 0.0 {
                system.even(k, self.bends[k], excess.unwrap_or_default());
            }
            if self.steps[k] > 0.0 {
                system.slow(k, self.steps[k], haste.unwrap_or_default());
            }
        }
        let mut near = Vec::new();
        ground.pushes(track, &mut near);
        for push in near {
            match self.borders.iter_mut().find(|(old, _)| old.knot == push.knot && old.normal == push.normal) {
                Some((old, weight)) => {
                    *old = push;
                    heavier(weight);
                }
                None => self.borders.push((push, FIRST)),
            }
        }
        for (push, weight) in &mut self.borders {
            system.push(push.knot, *weight, push.normal, push.gap);
            push.gap = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::Pattern;

    /// Who walks in from the left, stands for two seconds swaying, starts at once and leaves on the right.
    fn wanted(time: f64) -> DVec2 {
        let gone = if time < 3.0 { time.min(2.0) } else { time - 1.0 };
        DVec2::new(1.3 * gone, 4.0 + 0.04 * (5.5 * time).sin())
    }

    #[test]
    fn who_starts_at_once_is_followed_within_the_limits() {
        let square = [[0.0, 0.0], [8.0, 0.0], [8.0, 8.0], [0.0, 8.0]].map(Vec2::from).to_vec();
        let patterns = square.iter().map(|_| Pattern::empty(8.0, 10.0)).collect();
        let frame = FramePatch { outline: square, patterns, objects: vec![], people: vec![] };
        let line = |edge: usize, x: f64, time: f64| Line {
            edge,
            place: DVec2::new(x, 4.0),
            velocity: DVec2::new(1.3, 0.0),
            time,
            reach: 0.25,
        };
        let limits = Limits::default();
        let ends = [line(3, 0.0, 0.0), line(1, 8.0, 8.0 / 1.3 + 1.0)];
        let path = follow(&frame, &limits, ends, wanted).expect("a way");
        let mut worst = 0.0f64;
        for i in 0..700 {
            let time = f64::from(i) * 0.01;
            assert!(path.acceleration(time).length() < limits.acceleration, "at {time}");
            assert!(path.velocity(time).length() < limits.speed, "at {time}");
            worst = worst.max(path.position(time).as_dvec2().distance(wanted(time)));
        }
        assert!((0.05..0.2).contains(&worst), "{worst}");
    }
}
