//! Proximity with reaction, and synchronicity (eq. 5).

use std::f32::consts::FRAC_PI_6;

use super::body::Body;
use super::event::{EventKind, Sign};
use super::options::EpisodeOptions;
use super::thresholds::Thresholds;
use crate::motion::FPS;

/// Two people who both just act noticeably see each other if they look this far past each other, radians. What counts
/// is the sum of the two angles, as in eq. 5, and who acts more strongly may look farther away.
const LOOKS: f32 = FRAC_PI_6;

/// Two people of a take over the time they share, and what is asked of them.
pub(super) struct Couple<'a> {
    pub people: [usize; 2],
    pub bodies: [&'a Body; 2],
    pub thresholds: &'a Thresholds,
    pub options: &'a EpisodeOptions,
}

impl Couple<'_> {
    /// Number of frames that both have.
    pub fn frames(&self) -> usize {
        self.bodies[0].len().min(self.bodies[1].len())
    }

    /// Distance of the hips on the ground, metres.
    pub fn apart(&self, frame: usize) -> f32 {
        self.bodies[0].places[frame].distance(self.bodies[1].places[frame])
    }

    /// How many times above its threshold the stronger action of the two is.
    pub fn reaction(&self, frame: usize) -> f32 {
        let [a, b] = self.bodies.map(|body| self.thresholds.ratio(body, frame));
        a.max(b)
    }

    /// How many times above its threshold the synchronicity is; 0 where not both act, or they are out of sight.
    pub fn synchronicity(&self, frame: usize) -> f32 {
        let [a, b] = self.bodies;
        let ratios = self.bodies.map(|body| self.thresholds.ratio(body, frame));
        if self.apart(frame) > self.options.sight {
            return 0.0;
        }
        let seen = (-a.gaze_angle(frame, b) - b.gaze_angle(frame, a)).exp();
        match self.options.synchronicity {
            Some(fixed) => a.variation[frame] * b.variation[frame] * seen / fixed.max(f32::MIN_POSITIVE),
            None if ratios[0] < 1.0 || ratios[1] < 1.0 => 0.0,
            None => ratios[0] * ratios[1] * seen * (2.0 * LOOKS).exp(),
        }
    }

    /// Times over which they are near each other and somebody reacts.
    pub fn proximity(&self) -> Vec<Sign> {
        let (near, threshold) = (self.options.near, 1.0);
        self.signs(EventKind::Proximity, |f| self.apart(f) < near && self.reaction(f) >= threshold)
    }

    /// Times over which both act and see each other.
    pub fn synchronous(&self) -> Vec<Sign> {
        self.signs(EventKind::Synchronicity, |f| self.synchronicity(f) >= 1.0)
    }

    fn signs(&self, kind: EventKind, holds: impl Fn(usize) -> bool) -> Vec<Sign> {
        let (mut found, mut begin) = (Vec::new(), None);
        let shortest = self.options.min_seconds * FPS;
        for frame in 0..=self.frames() {
            if frame < self.frames() && holds(frame) {
                begin.get_or_insert(frame);
            } else if let Some(begin) = begin.take().filter(|&b| (frame - 1 - b) as f32 >= shortest) {
                found.push(Sign { kind, people: self.people, begin, end: frame - 1, touching: Vec::new() });
            }
        }
        found
    }
}
