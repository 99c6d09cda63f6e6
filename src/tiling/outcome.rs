//! What a tiling run is asked for and what it answers.

use crate::stage::Crowd;

/// Which algorithm tiles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// The project's engine: seed, enrich, mend.
    #[default]
    Engine,
    /// Algorithms 1 and 2 of "Tiling Motion Patches" as published.
    Paper,
}

/// Settings of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Which algorithm.
    pub method: Method,
    /// The same seed gives the same crowd.
    pub seed: u64,
    /// Longest time for search and final bodies, in seconds.
    pub time_secs: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { method: Method::Engine, seed: 1, time_secs: 60.0 }
    }
}

/// What a run is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Adding people (engine), or Algorithm 1 (paper).
    Seed,
    /// Putting in patches of several people.
    Enrich,
    /// Removing danglings: Algorithm 2 (paper).
    Close,
    /// Testing final bodies and bridging anew where they interpenetrate.
    Mend,
}

/// How far a run is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// What it is doing.
    pub phase: Phase,
    /// Placed patches.
    pub patches: usize,
    /// People.
    pub characters: usize,
    /// Ports without a partner.
    pub danglings: usize,
    /// Share of the people's time in patches of two or more.
    pub multi_person_share: f32,
    /// Energy of the tiling, equation 6.
    pub energy: f32,
    /// Seconds since the start.
    pub secs: f64,
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Status {
    /// No dangling, no interpenetration, all wishes met.
    Perfect,
    /// No dangling and no interpenetration, but a wish is unmet: which and why.
    Short(String),
    /// Danglings or interpenetrations are left: how many and why.
    Imperfect(String),
}

/// The best tiling of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The crowd.
    pub crowd: Crowd,
    /// How the run ended.
    pub status: Status,
    /// Ports without a partner.
    pub danglings: usize,
    /// Pairs of people who interpenetrate.
    pub interpenetrations: usize,
    /// Seconds it took.
    pub solve_secs: f64,
    /// Why the last checkpoint could not be written, if so.
    pub unkept: Option<String>,
}
