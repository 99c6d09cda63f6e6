//! The solved crowd patch.

use glam::Vec2;

use super::{FramePatch, Path, Role};

/// A crossing of a patch: an input or an output, by context.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
pub struct Port {
    /// Which edge of the patch.
    pub edge: usize,
    /// Which of the pattern's inputs (or outputs).
    pub index: usize,
}

/// Somebody who crosses the patch, once per period.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Walker {
    /// Where it comes in.
    pub input: Port,
    /// Where it goes out.
    pub output: Port,
    /// How many periods later than the period it came in the time of its output is.
    pub laps: u32,
    /// Its way. Time 0 is the begin of the period it came in; it reaches a body's width beyond both borders.
    pub path: Path,
    /// What it does on it, if it does not just walk: a clip in the patch's frame.
    #[serde(default)]
    pub role: Option<Role>,
}

/// A frame-patch filled with walkers.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CrowdPatch {
    /// Outline, patterns and objects.
    pub frame: FramePatch,
    /// Who crosses it; one per input, in the order of edges and inputs.
    pub walkers: Vec<Walker>,
}

impl CrowdPatch {
    /// When `walker` is inside the borders: from its input to its output, seconds.
    pub fn presence(&self, walker: &Walker) -> (f64, f64) {
        let pattern = |port: Port| &self.frame.patterns[port.edge];
        let input = pattern(walker.input).inputs[walker.input.index];
        let output = pattern(walker.output).outputs[walker.output.index];
        let period = f64::from(self.frame.period());
        (f64::from(input.time), f64::from(output.time) + f64::from(walker.laps) * period)
    }

    /// Everybody inside at `time` (seconds, any): index of the walker, which period it came in, place, velocity.
    /// O(walkers).
    pub fn at(&self, time: f64) -> impl Iterator<Item = (usize, i64, Vec2, Vec2)> {
        let period = f64::from(self.frame.period());
        self.walkers.iter().enumerate().flat_map(move |(index, walker)| {
            let (enter, leave) = self.presence(walker);
            let first = ((time - leave) / period).floor() as i64 + 1;
            let last = ((time - enter) / period).floor() as i64;
            (first..=last).map(move |lap| {
                let own = time - lap as f64 * period;
                (index, lap, walker.path.position(own), walker.path.velocity(own))
            })
        })
    }

    /// People inside on average, those who stay included.
    pub fn population(&self) -> f64 {
        let inside: f64 = self.walkers.iter().map(|w| self.presence(w)).map(|(enter, leave)| leave - enter).sum();
        inside / f64::from(self.frame.period()) + self.frame.people.len() as f64
    }
}
