//! How far a motion path may be deformed.

/// Limits of path deformation per source frame at 30 fps (paper section 5.1).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Limits {
    /// Largest change of an edge's length, metres per frame.
    pub stretch: f32,
    /// Largest change of the heading's increment, radians per frame.
    pub bend: f32,
    /// Largest change of a frame's duration, seconds per frame.
    pub time: f32,
    /// Largest angle between where a walking body goes and where the deformed heading would have it go, radians.
    pub slip: f32,
}

impl Limits {
    /// The default: 1.4 cm, 3 degrees, 0.011 s, and 14 degrees of slip.
    pub const TIGHT: Self = Self { stretch: 0.014, bend: 3.0 * DEG, time: 0.011, slip: 14.0 * DEG };
    /// As published: 3 cm, 7 degrees, 0.018 s; slip is not limited there.
    pub const PUBLISHED: Self = Self { stretch: 0.03, bend: 7.0 * DEG, time: 0.018, slip: 180.0 * DEG };

    /// Fewest and most ticks that `frames` source frames (one less intervals) may last.
    pub fn tick_range(&self, frames: usize) -> (i32, i32) {
        let intervals = (frames - 1) as f32;
        let ratio = self.time * crate::motion::FPS;
        let shortest = (intervals * (1.0 - ratio)).ceil().max(1.0);
        (shortest as i32, (intervals * (1.0 + ratio)).floor().max(shortest) as i32)
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self::TIGHT
    }
}

const DEG: f32 = std::f32::consts::PI / 180.0;
