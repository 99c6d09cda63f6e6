//! What a deformation asks of motion paths: how far every frame is from the capture.

use super::Limits;
use super::strand::STANDING_EDGE;
use super::web::{Deformed, Thread};
use crate::geom::wrap_angle;
use crate::motion::FPS;

/// The worst of one measure, and where.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Most {
    /// How much.
    pub value: f32,
    /// Index of the thread.
    pub role: usize,
    /// Frame of the thread; the measure is between it and the next.
    pub frame: usize,
}

/// The worst of every limited measure over all frames.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Strain {
    /// Change of an edge's length, metres.
    pub stretch: Most,
    /// Change of the heading's increment, radians.
    pub bend: Most,
    /// Angle between where a walking body goes and where its heading would have it go, radians.
    pub slip: Most,
    /// Change of a frame's duration, seconds.
    pub time: Most,
}

/// A limit that is broken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Broken {
    /// What is limited.
    pub measure: &'static str,
    /// Unit of `found` and `limit`.
    pub unit: &'static str,
    /// The worst.
    pub found: f32,
    /// What is allowed.
    pub limit: f32,
    /// Where it was found.
    pub at: Most,
}

impl Strain {
    pub(super) fn of(threads: &[Thread], deformed: &Deformed) -> Self {
        let mut strain = Self::default();
        for (role, (thread, path)) in threads.iter().zip(&deformed.paths).enumerate() {
            let own = &thread.path;
            for i in 0..own.len().saturating_sub(1) {
                let (was, now) = (own.points[i + 1] - own.points[i], path.points[i + 1] - path.points[i]);
                let turned = |i: usize| wrap_angle(path.headings[i] - own.headings[i]);
                let at = |value: f32| Most { value, role, frame: i };
                strain.stretch.offer(at((now.length() - was.length()).abs()));
                strain.bend.offer(at(wrap_angle(turned(i + 1) - turned(i)).abs()));
                if was.length() > STANDING_EDGE {
                    let mean = turned(i) + 0.5 * wrap_angle(turned(i + 1) - turned(i));
                    let direction = |edge: glam::Vec2| edge.x.atan2(edge.y);
                    strain.slip.offer(at(wrap_angle(direction(now) - direction(was) - mean).abs()));
                }
                let ticks = &deformed.ticks[role];
                strain.time.offer(at((ticks[i + 1] - ticks[i] - 1.0).abs() / FPS));
            }
        }
        strain
    }

    /// The first limit that is broken, of stretch, bend, slip and time.
    pub fn broken(&self, limits: &Limits) -> Option<Broken> {
        let degrees = f32::to_degrees;
        let all = [
            ("stretch", "m", self.stretch, limits.stretch, self.stretch.value, limits.stretch),
            ("bend", "deg", self.bend, limits.bend, degrees(self.bend.value), degrees(limits.bend)),
            ("slip", "deg", self.slip, limits.slip, degrees(self.slip.value), degrees(limits.slip)),
            ("change time", "s", self.time, limits.time + 1e-5, self.time.value, limits.time),
        ];
        all.into_iter()
            .find(|(_, _, most, limit, ..)| most.value > *limit)
            .map(|(measure, unit, at, _, found, limit)| Broken { measure, unit, found, limit, at })
    }
}

impl Most {
    fn offer(&mut self, other: Self) {
        if other.value > self.value {
            *self = other;
        }
    }
}
