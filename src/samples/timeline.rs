//! Time: minimum-jerk easing, pulses that rise, hold and fall, and smoothing over a window.

use std::f32::consts::TAU;

/// The minimum-jerk course from 0 to 1 over u in [0, 1] (Flash and Hogan 1985), flat outside.
pub(super) fn ease(u: f32) -> f32 {
    let u = u.clamp(0.0, 1.0);
    u * u * u * (10.0 + u * (6.0 * u - 15.0))
}

/// [`ease`] from `t0` to `t1`.
pub(super) fn ramp(t: f32, t0: f32, t1: f32) -> f32 {
    if t1 <= t0 { f32::from(t >= t1) } else { ease((t - t0) / (t1 - t0)) }
}

pub(super) fn lerp(a: f32, b: f32, u: f32) -> f32 {
    a + (b - a) * u
}

/// A weight that rises over the first two times, holds, and falls over the last two (seconds).
#[derive(Clone, Copy, Debug)]
pub(super) struct Span(pub [f32; 4]);

impl Span {
    pub fn weight(&self, t: f32) -> f32 {
        let [a, b, c, d] = self.0;
        ramp(t, a, b) * (1.0 - ramp(t, c, d))
    }
}

/// A cubic through keys (position, value, slope); the ends' values outside.
pub(super) fn hermite(keys: &[(f32, f32, f32)], u: f32) -> f32 {
    let i = keys.partition_point(|k| k.0 <= u).clamp(1, keys.len() - 1);
    let ((u0, v0, d0), (u1, v1, d1)) = (keys[i - 1], keys[i]);
    let (h, s) = (u1 - u0, ((u - u0) / (u1 - u0)).clamp(0.0, 1.0));
    let (s2, s3) = (s * s, s * s * s);
    v0 * (2.0 * s3 - 3.0 * s2 + 1.0) + d0 * h * (s3 - 2.0 * s2 + s) + v1 * (3.0 * s2 - 2.0 * s3) + d1 * h * (s3 - s2)
}

/// `values` averaged with a Gaussian of standard deviation `sigma` (in samples); the ends are held.
pub(super) fn blur(values: &[f32], sigma: f32) -> Vec<f32> {
    let reach = (3.0 * sigma).ceil() as isize;
    let kernel: Vec<f32> = (-reach..=reach).map(|k| (-0.5 * (k as f32 / sigma).powi(2)).exp()).collect();
    let sum: f32 = kernel.iter().sum();
    let last = values.len() as isize - 1;
    (0..=last)
        .map(|i| {
            let window = (-reach..=reach).map(|k| values[(i + k).clamp(0, last) as usize]);
            window.zip(&kernel).map(|(v, k)| v * k).sum::<f32>() / sum
        })
        .collect()
}

/// A smooth, slow wander in about [-1, 1] made of three sines whose phases come from `seed`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wander([f32; 3]);

impl Wander {
    pub fn new(rng: &mut impl rand::Rng) -> Self {
        Self(std::array::from_fn(|_| unit(rng) * TAU))
    }

    pub fn at(&self, t: f32) -> f32 {
        let rates = [0.23, 0.41, 0.67];
        let sum: f32 = self.0.iter().zip(rates).map(|(phase, rate)| (TAU * rate * t + phase).sin()).sum();
        sum / 2.2
    }
}

/// A uniform number in [0, 1).
pub(super) fn unit(rng: &mut impl rand::Rng) -> f32 {
    (rng.next_u32() >> 8) as f32 / (1 << 24) as f32
}

/// A uniform number in [-1, 1).
pub(super) fn signed(rng: &mut impl rand::Rng) -> f32 {
    2.0 * unit(rng) - 1.0
}
