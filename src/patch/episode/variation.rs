//! How much a person moves around a frame: the variation of eq. 4, in a sliding window.

use glam::Vec3;

use crate::motion::{Motion, pose};

/// V of eq. 4 at every frame, square metres: over all pairs of frames of the window `[i - half, i + half]`, the sum of
/// their squared pose distance ([`pose::distance`], which ignores where on the ground and which way round).
///
/// Windows that an end of the motion cuts short are scaled to a whole one's number of pairs, so that values compare.
/// Every pair is measured once: O(frames x half) instead of the formula's O(frames x half squared).
pub fn variation(motion: &Motion, half: usize) -> Vec<f32> {
    let clouds: Vec<Cloud> = (0..motion.len()).map(|f| Cloud::new(pose::points(motion, f))).collect();
    let reach = 2 * half;
    let apart = |i: usize, k: usize| f64::from(clouds[i].squared_distance(&clouds[k]));
    // The distances of each frame to those after it, as far as a window can hold both.
    let band: Vec<Vec<f64>> =
        (0..clouds.len()).map(|i| (i + 1..clouds.len().min(i + reach + 1)).map(|k| apart(i, k)).collect()).collect();
    slide(&band, half).into_iter().map(|v| v as f32).collect()
}

/// Sums over windows: the pairs of a frame that enters are added, those of one that leaves taken away.
fn slide(band: &[Vec<f64>], half: usize) -> Vec<f64> {
    let frames = band.len();
    let pair = |i: usize, k: usize| band[i][k - i - 1];
    let whole = (half * (2 * half + 1)) as f64;
    let (mut first, mut end, mut sum) = (0, 0, 0.0);
    let mut out = Vec::with_capacity(frames);
    for centre in 0..frames {
        while end < frames && end <= centre + half {
            // Leave before entering, so that a pair farther apart than the window is never asked for.
            if end > first + 2 * half {
                sum -= (first + 1..end).map(|k| pair(first, k)).sum::<f64>();
                first += 1;
            }
            sum += (first..end).map(|i| pair(i, end)).sum::<f64>();
            end += 1;
        }
        while first + half < centre {
            sum -= (first + 1..end).map(|k| pair(first, k)).sum::<f64>();
            first += 1;
        }
        let count = end - first;
        let pairs = (count * (count - 1) / 2) as f64;
        out.push(if pairs > 0.0 { sum.max(0.0) * whole / pairs } else { 0.0 });
    }
    out
}

/// A body's points about their middle on the ground, with what all distances share.
struct Cloud {
    points: Vec<Vec3>,
    /// Sum of the squared distances on the ground from the middle.
    spread: f32,
}

impl Cloud {
    fn new(mut points: Vec<Vec3>) -> Self {
        let mean = (points.iter().sum::<Vec3>() / points.len().max(1) as f32).with_y(0.0);
        points.iter_mut().for_each(|p| *p -= mean);
        let spread = points.iter().map(|p| p.x * p.x + p.z * p.z).sum();
        Self { points, spread }
    }

    /// [`pose::cloud_distance`] squared, in one pass: about the middles, the best turn leaves on the ground both spreads
    /// less twice the length of the complex sum of products.
    fn squared_distance(&self, other: &Self) -> f32 {
        let (mut along, mut across, mut up) = (0.0, 0.0, 0.0);
        for (p, q) in self.points.iter().zip(&other.points) {
            along += p.x * q.x + p.z * q.z;
            across += p.x * q.z - p.z * q.x;
            up += (p.y - q.y) * (p.y - q.y);
        }
        let ground = self.spread + other.spread - 2.0 * f32::hypot(along, across);
        (ground.max(0.0) + up) / self.points.len().max(1) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::testing::{standing, walking};

    /// Eq. 4 as it is written.
    fn formula(motion: &Motion, i: usize, half: usize) -> f32 {
        let (first, last) = (i.saturating_sub(half), (i + half).min(motion.len() - 1));
        let (mut sum, mut pairs) = (0.0, 0);
        for j in first..=last {
            for k in j + 1..=last {
                sum += pose::distance(motion, j, motion, k).powi(2);
                pairs += 1;
            }
        }
        if pairs == 0 { 0.0 } else { sum * (half * (2 * half + 1)) as f32 / pairs as f32 }
    }

    #[test]
    fn the_sliding_window_is_the_formula() {
        let walk = walking(1.5);
        for half in [0, 1, 3, 8, 60] {
            let fast = variation(&walk, half);
            assert_eq!(fast.len(), walk.len());
            for (i, &v) in fast.iter().enumerate() {
                let slow = formula(&walk, i, half);
                assert!((v - slow).abs() <= 1e-3 * slow + 1e-4, "half {half} frame {i}: {v} {slow}");
            }
        }
    }

    #[test]
    fn a_walk_varies_and_standing_does_not() {
        let (walk, stand) = (variation(&walking(2.0), 8), variation(&standing(2.0), 8));
        let least = walk.iter().copied().fold(f32::INFINITY, f32::min);
        assert!(least > 0.05 && stand.iter().all(|&v| v < 1e-3), "{least} {stand:?}");
        assert!(variation(&walking(0.0), 8) == [0.0] && variation(&Motion::default(), 8).is_empty());
    }
}
