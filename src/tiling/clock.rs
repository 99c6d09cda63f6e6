//! The time that a run has.

use std::time::{Duration, Instant};

use super::outcome::Progress;

/// How fast a long step of a run is forgotten when others are shorter.
const STEPS_FADE: f64 = 0.9;
/// Time between two reports of progress.
const REPORT_EVERY: Duration = Duration::from_millis(50);

/// Reports progress now and then and knows when to stop.
pub(super) struct Clock<'a> {
    start: Instant,
    last_report: Instant,
    limit: Duration,
    /// Seconds of it that are to be left for what comes later.
    pub(super) reserve: f64,
    /// When it was asked last, and how long a step takes from one time to the next, seconds.
    asked: Instant,
    step: f64,
    stopped: bool,
    /// How often it may still be asked, if that is bounded.
    left: Option<u64>,
    progress: &'a mut dyn FnMut(&Progress) -> bool,
}

impl<'a> Clock<'a> {
    pub(super) fn new(limit_secs: f64, progress: &'a mut dyn FnMut(&Progress) -> bool) -> Self {
        let now = Instant::now();
        Self {
            start: now,
            last_report: now,
            limit: Duration::from_secs_f64(limit_secs.max(0.0)),
            reserve: 0.0,
            asked: now,
            step: 0.0,
            stopped: false,
            left: None,
            progress,
        }
    }

    /// The same that is over after it was asked so often, if a number is given: work instead of time.
    pub(super) fn asked_at_most(self, times: Option<u64>) -> Self {
        Self { left: times, ..self }
    }

    /// False once time is up or the caller has had enough.
    pub(super) fn goes_on(&mut self, state: impl FnOnce() -> Progress) -> bool {
        let now = Instant::now();
        self.step = (now - self.asked).as_secs_f64().max(self.step * STEPS_FADE);
        self.asked = now;
        self.left = self.left.map(|left| left.saturating_sub(1));
        if !self.stopped && now - self.last_report >= REPORT_EVERY {
            self.last_report = now;
            let secs = self.secs();
            self.stopped = !(self.progress)(&Progress { secs, ..state() });
        }
        !self.is_over()
    }

    /// True once time is up or the caller has had enough.
    pub(super) fn is_over(&self) -> bool {
        self.stopped || self.left == Some(0) || self.secs() + self.step + self.reserve >= self.limit.as_secs_f64()
    }

    /// Part of the time that has gone.
    pub(super) fn gone(&self) -> f64 {
        self.secs() / self.limit.as_secs_f64().max(1e-9)
    }

    pub(super) fn secs(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }
}
