//! A fragment in use, beside the capture it was made from, and the map between their times.

use glam::Vec2;

use crate::geom::Ground;
use crate::patch::{Fragment, PatchKind};
use crate::stage::{Crowd, FragmentUse};

/// One fragment of one character's chain.
#[derive(Clone, Copy)]
pub(super) struct Part<'a> {
    /// Index of the character.
    pub character: usize,
    /// Its place in the character's chain.
    pub index: usize,
    /// The deformed path and its times.
    pub used: &'a FragmentUse,
    /// The kind of its instance.
    pub kind: &'a PatchKind,
    /// The capture.
    pub source: &'a Fragment,
}

/// All fragments in use, by character, then in order of time.
pub(super) fn parts(crowd: &Crowd) -> Vec<Part<'_>> {
    let mut all = Vec::new();
    for (character, c) in crowd.characters.iter().enumerate() {
        all.extend(c.fragments.iter().enumerate().map(|(index, used)| Part::new(crowd, character, index, used)));
    }
    all
}

impl<'a> Part<'a> {
    fn new(crowd: &'a Crowd, character: usize, index: usize, used: &'a FragmentUse) -> Self {
        let kind = &crowd.set.kinds[crowd.instances[used.instance as usize].kind as usize];
        Self { character, index, used, kind, source: &kind.fragments[used.role as usize] }
    }

    /// Crowd frames per source frame.
    pub(super) fn rate(&self) -> f64 {
        (self.used.end - self.used.begin) as f64 / (self.used.points.len() - 1) as f64
    }

    /// The crowd's time (in frames) of a moment on the patch's clock (in source frames).
    pub(super) fn frame_at_clock(&self, clock: f64) -> f64 {
        self.used.begin as f64 + (clock - self.source.begin as f64) * self.rate()
    }

    /// The moment on the patch's clock (in source frames) at a frame of the crowd.
    pub(super) fn clock_at_frame(&self, frame: f64) -> f64 {
        self.source.begin as f64 + (frame - self.used.begin as f64) / self.rate()
    }

    /// Frames of the crowd that lie in this fragment and in the domain's time, both ends included.
    pub(super) fn visible(&self, last_frame: u32) -> std::ops::Range<u32> {
        let first = self.used.begin.max(0) as u32;
        first..self.used.end.saturating_add(1).clamp(0, last_frame as i32 + 1) as u32
    }

    /// Ground point of the deformed path at a frame of the crowd, between samples by interpolation.
    pub(super) fn point_at(&self, frame: f64) -> Vec2 {
        let last = self.used.points.len() - 1;
        let at = (self.clock_at_frame(frame) - self.source.begin as f64).clamp(0.0, last as f64);
        let i = (at as usize).min(last - 1);
        self.used.points[i].lerp(self.used.points[i + 1], (at - i as f64) as f32)
    }

    /// The deformed path's local frame at a moment of the patch's clock that is a source frame of this fragment.
    pub(super) fn deformed_at(&self, clock: u32) -> Ground {
        let i = (clock - self.source.begin) as usize;
        Ground::new(self.used.points[i], self.used.headings[i])
    }

    /// The capture's local frame at the same moment.
    pub(super) fn captured_at(&self, clock: u32) -> Ground {
        self.source.motion.path.at((clock - self.source.begin) as usize)
    }

    /// First and last source frame on the patch's clock.
    pub(super) fn clock_range(&self) -> (u32, u32) {
        (self.source.begin, self.source.begin + self.source.motion.len() as u32 - 1)
    }

    /// For the places of a report.
    pub(super) fn name(&self) -> String {
        format!(
            "character {}, fragment {} ({} of instance {})",
            self.character, self.index, self.kind.name, self.used.instance
        )
    }
}
