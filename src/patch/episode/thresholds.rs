//! From which variation on somebody acts noticeably: chosen from the captures' own distribution.
//!
//! The paper chose its threshold of eq. 4 by trial and error. One number does not do: limbs swing more in a plain walk
//! than in most gestures. So who travels is compared with those who travel, and who stays in place with those who do.

use super::body::Body;
use super::options::EpisodeOptions;

/// Least noticeable mean difference of two poses of a window, metres (root mean square over the body).
const LEAST: f32 = 0.02;
/// Someone in place acts when poses differ this many times more than in the quietest quarter of the frames.
const LOUDER: f32 = 2.0;
/// Who is faster than this somewhere around travels, m/s on the ground.
const TRAVELS: f32 = 0.5;

/// What counts: how near is near, and variations (eq. 4) above which somebody acts noticeably, square metres.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Thresholds {
    /// Surfaces nearer than this touch, metres.
    pub touch_gap: f32,
    /// People whose hips are nearer than this are near each other, metres.
    pub near: f32,
    /// Of who stays in place: poses differ by 2 cm in the mean, and twice as much as in their quietest quarter.
    pub in_place: f32,
    /// Of who travels: more than 1.5 interquartile ranges above the upper quartile of all who do, and never below
    /// that of who stays.
    pub travelling: f32,
}

impl Thresholds {
    /// The thresholds of a collection.
    pub(super) fn of(bodies: &[Body], options: &EpisodeOptions) -> Self {
        let (touch_gap, near) = (options.touch_gap, options.near);
        if let Some(fixed) = options.variation {
            return Self { touch_gap, near, in_place: fixed, travelling: fixed };
        }
        let (mut stay, mut travel) = (Vec::new(), Vec::new());
        for body in bodies {
            for (frame, &v) in body.variation.iter().enumerate() {
                if Self::travels(body, frame) { travel.push(v) } else { stay.push(v) }
            }
        }
        let w = options.half_window as f32;
        let least = w * (2.0 * w + 1.0) * LEAST * LEAST;
        let in_place = least.max(LOUDER * LOUDER * quantile(&mut stay, 0.25));
        let (lower, upper) = (quantile(&mut travel, 0.25), quantile(&mut travel, 0.75));
        Self { touch_gap, near, in_place, travelling: in_place.max(upper + 1.5 * (upper - lower)) }
    }

    /// Whether somebody counts as travelling at a frame.
    pub(super) fn travels(body: &Body, frame: usize) -> bool {
        body.speeds[frame] > TRAVELS
    }

    /// How many times above the threshold somebody's variation is at a frame.
    pub(super) fn ratio(&self, body: &Body, frame: usize) -> f32 {
        let limit = if Self::travels(body, frame) { self.travelling } else { self.in_place };
        body.variation[frame] / limit.max(f32::MIN_POSITIVE)
    }
}

/// The value that this share of all is at most; 0 of none.
fn quantile(values: &mut [f32], share: f32) -> f32 {
    values.sort_by(f32::total_cmp);
    match values.len().checked_sub(1) {
        Some(last) => values[(last as f32 * share).round() as usize],
        None => 0.0,
    }
}
