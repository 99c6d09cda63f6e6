//! When checkpoints are written: every so many seconds and when a search ends. Where one cannot be written the run goes
//! on without, and tells at its end.

use std::path::Path;
use std::time::{Duration, Instant};

use super::super::tracks::Tracks;
use super::{About, Agenda, Checkpoint};

/// Writing may take this part of the time: a large tiling is written more seldom.
const SHARE: u32 = 50;

/// Where checkpoints of a run are written.
#[derive(Clone, Copy, Debug)]
pub struct Keep<'a> {
    /// The file.
    pub path: &'a Path,
    /// Seconds from one to the next.
    pub every_secs: f64,
    /// What the patch set is called, for whoever goes on.
    pub patches: Option<&'a str>,
}

/// Writes the checkpoints of a run.
pub(in super::super) struct Keeper<'a> {
    keep: Option<(Keep<'a>, About)>,
    /// When the next is due.
    due: Instant,
    problem: Option<String>,
}

impl<'a> Keeper<'a> {
    /// Writes none if `keep` is none.
    pub fn new(keep: Option<Keep<'a>>, about: impl FnOnce(Keep<'a>) -> About) -> Self {
        let due = Instant::now() + keep.map_or(Duration::ZERO, |k| every(&k));
        Self { keep: keep.map(|keep| (keep, about(keep))), due, problem: None }
    }

    /// Writes none.
    pub fn none() -> Self {
        Self { keep: None, due: Instant::now(), problem: None }
    }

    /// True if it is time for one.
    pub fn is_due(&self) -> bool {
        self.keep.is_some() && Instant::now() >= self.due
    }

    /// Writes one.
    pub fn write(&mut self, tracks: &Tracks, agenda: &Agenda, secs: f64) {
        let Some((keep, about)) = &self.keep else { return };
        let begin = Instant::now();
        self.problem = Checkpoint::of(tracks, agenda.clone(), about, secs).save(keep.path).err().map(|e| e.to_string());
        self.due = Instant::now() + every(keep).max(begin.elapsed() * SHARE);
    }

    /// Why the last one could not be written.
    pub fn into_problem(self) -> Option<String> {
        self.problem
    }
}

fn every(keep: &Keep) -> Duration {
    Duration::try_from_secs_f64(keep.every_secs).unwrap_or(Duration::MAX / 4)
}
