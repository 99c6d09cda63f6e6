//! A walker's way through a patch: a uniform cubic B-spline over a time grid common to all walkers.
//!
//! On one grid every pair of walkers meets knot by knot, differences of control points bound speed and acceleration
//! exactly, and no way-point has to be split at the end of the period as in the 2009 paper (eq. 4, 5): a path simply
//! lasts as long as it takes, and is played by everybody who is on it at the same time, one period apart.

use glam::Vec2;

/// A place on the ground as a function of time.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Path {
    /// Seconds from one control point to the next.
    pub step: f32,
    /// Control point 0 is at time `first * step`; at least four control points.
    pub first: i32,
    /// Control points, metres, in the patch's frame.
    pub points: Vec<Vec2>,
}

impl Path {
    /// First and last instant the curve is defined at, seconds.
    pub fn span(&self) -> (f32, f32) {
        ((self.first + 1) as f32 * self.step, (self.first + self.points.len() as i32 - 2) as f32 * self.step)
    }

    /// Place at `time` (seconds since the begin of the period the walker came in), held at the ends of the span.
    pub fn position(&self, time: f64) -> Vec2 {
        self.blend(time, |u| {
            let v = 1.0 - u;
            [v * v * v, (3.0 * u - 6.0) * u * u + 4.0, ((-3.0 * u + 3.0) * u + 3.0) * u + 1.0, u * u * u]
                .map(|w| w / 6.0)
        })
    }

    /// Velocity at `time` in m/s.
    pub fn velocity(&self, time: f64) -> Vec2 {
        let inv = 1.0 / self.step;
        self.blend(time, |u| {
            let v = 1.0 - u;
            [-0.5 * v * v, (1.5 * u - 2.0) * u, (-1.5 * u + 1.0) * u + 0.5, 0.5 * u * u].map(|w| w * inv)
        })
    }

    /// Acceleration at `time` in m/s2.
    pub fn acceleration(&self, time: f64) -> Vec2 {
        let inv = 1.0 / (self.step * self.step);
        self.blend(time, |u| [1.0 - u, 3.0 * u - 2.0, 1.0 - 3.0 * u, u].map(|w| w * inv))
    }

    fn blend(&self, time: f64, weights: impl Fn(f32) -> [f32; 4]) -> Vec2 {
        let last = self.points.len() as f64 - 3.0;
        let at = (time / f64::from(self.step) - f64::from(self.first) - 1.0).clamp(0.0, last);
        let knot = at.floor().min(last - 1.0);
        let near = &self.points[knot as usize..];
        weights((at - knot) as f32).iter().zip(near).map(|(&w, &p)| p * w).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve() -> Path {
        let points = (0..9).map(|i| Vec2::new(i as f32 * 0.3, (i * i % 5) as f32 * 0.1)).collect();
        Path { step: 0.2, first: -3, points }
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let path = curve();
        let (begin, end) = path.span();
        assert!((begin + 0.4).abs() < 1e-6 && (end - 0.8).abs() < 1e-6);
        for i in 1..60 {
            let (t, e) = (f64::from(begin) + f64::from(i) * 0.02 - 0.003, 1e-3);
            let slope = (path.position(t + e) - path.position(t - e)) / (2.0 * e as f32);
            assert!(slope.distance(path.velocity(t)) < 2e-3, "at {t}");
            let bend = (path.velocity(t + e) - path.velocity(t - e)) / (2.0 * e as f32);
            assert!(bend.distance(path.acceleration(t)) < 2e-1, "at {t}");
        }
    }

    #[test]
    fn control_points_on_a_line_are_a_uniform_motion() {
        let points = (0..8).map(|i| Vec2::new(1.0, 2.0) + Vec2::new(0.26, 0.02) * i as f32).collect();
        let path = Path { step: 0.2, first: 5, points };
        assert!(path.position(1.5).distance(Vec2::new(1.0, 2.0) + Vec2::new(1.3, 0.1) * 0.5) < 1e-5);
        assert!(path.velocity(1.7).distance(Vec2::new(1.3, 0.1)) < 1e-5);
    }
}
