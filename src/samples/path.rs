//! The root path: where the middle of the body is to be and where it heads, from speeds, turns and shifts.

use glam::Vec2;

use super::timeline::{ease, ramp};
use crate::geom::{Ground, Turn};

const RATE: f32 = 240.0;

/// What drives a path. Times in seconds.
#[derive(Clone, Debug, Default)]
pub(super) struct PathPlan {
    /// Forward speed at times in order, eased between.
    pub speeds: Vec<(f32, f32)>,
    /// Heading gained from one time to another, eased.
    pub turns: Vec<(f32, f32, f32)>,
    /// Displacement from one time to another, eased, in the frame the path has at the first.
    pub shifts: Vec<(f32, f32, Vec2)>,
}

impl PathPlan {
    fn speed(&self, t: f32) -> f32 {
        let i = self.speeds.partition_point(|k| k.0 <= t);
        match (i.checked_sub(1).map(|i| self.speeds[i]), self.speeds.get(i)) {
            (Some((t0, v0)), Some(&(t1, v1))) => v0 + (v1 - v0) * ease((t - t0) / (t1 - t0)),
            (Some((_, v)), None) | (None, Some(&(_, v))) => v,
            (None, None) => 0.0,
        }
    }

    fn heading(&self, t: f32) -> f32 {
        self.turns.iter().map(|&(t0, t1, angle)| angle * ramp(t, t0, t1)).sum()
    }

    /// The path from 0 to `end` seconds, carried by `world_from_path`.
    pub fn build(&self, end: f32, world_from_path: Ground) -> Path {
        let count = (end * RATE).ceil() as usize + 2;
        let shifts: Vec<_> =
            self.shifts.iter().map(|&(t0, t1, d)| (t0, t1, Turn::from_angle(self.heading(t0)).apply(d))).collect();
        let mut walked = Vec2::ZERO;
        let mut path = Path { samples: Vec::with_capacity(count), speeds: Vec::with_capacity(count) };
        for i in 0..count {
            let t = i as f32 / RATE;
            let heading = self.heading(t);
            let shifted: Vec2 = shifts.iter().map(|&(t0, t1, d)| d * ramp(t, t0, t1)).sum();
            path.samples.push(world_from_path.then(Ground::new(walked + shifted, heading)));
            path.speeds.push(self.speed(t));
            let middle = t + 0.5 / RATE;
            walked += Turn::from_angle(self.heading(middle)).apply(Vec2::Y) * self.speed(middle) / RATE;
        }
        path
    }
}

/// A sampled path.
#[derive(Clone, Debug)]
pub(super) struct Path {
    samples: Vec<Ground>,
    speeds: Vec<f32>,
}

impl Path {
    fn locate(&self, t: f32) -> (usize, f32) {
        let x = (t * RATE).clamp(0.0, (self.samples.len() - 1) as f32);
        let i = (x as usize).min(self.samples.len() - 2);
        (i, x - i as f32)
    }

    /// Where the path is and heads at `t`.
    pub fn at(&self, t: f32) -> Ground {
        let (i, u) = self.locate(t);
        let (a, b) = (self.samples[i], self.samples[i + 1]);
        Ground::new(a.position.lerp(b.position, u), a.heading + (b.heading - a.heading) * u)
    }

    /// The planned walking speed at `t`.
    pub fn speed(&self, t: f32) -> f32 {
        let (i, u) = self.locate(t);
        self.speeds[i] + (self.speeds[i + 1] - self.speeds[i]) * u
    }
}
