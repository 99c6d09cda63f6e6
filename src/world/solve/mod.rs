//! Leads walkers through a frame-patch without collisions, within the limits of walking.
//!
//! "Crowd Patches" (2009), section 4.3 steers particles and smooths afterwards, which keeps neither distances nor
//! accelerations. Departures: curves over the whole period are optimised (Gauss-Newton on control points, one walker
//! after the other), every test is conservative between samples, and what does not come free is kicked to the other
//! side, gets another output, or is connected anew.

mod contact;
mod follow;
mod own;
mod particles;
mod planner;
mod repair;
mod system;
mod track;
mod version;

use glam::Vec2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::frame::FramePatch;
use super::pairing::Pairing;
use super::{CrowdPatch, Limits, Path, Walker};
use crate::{Error, Result};
pub(super) use follow::follow;
use planner::Planner;
pub use version::{Common, vary};

/// How walkers are led through a patch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Curves that keep all limits.
    #[default]
    Curves,
    /// The particles of the 2009 paper; they collide.
    Particles,
}

pub(super) use planner::STEP;

/// What to spend on a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Same seed, same patch; other seeds are other versions of the patch.
    pub seed: u64,
    /// How to do it.
    pub method: Method,
    /// How often to begin again with another connection of inputs to outputs.
    pub restarts: u32,
    /// How often to mend what is left before beginning again.
    pub rounds: u32,
    /// How often every walker's curve is improved before mending.
    pub sweeps: u32,
}

impl Default for Options {
    fn default() -> Self {
        Self { seed: 0, method: Method::Curves, restarts: 60, rounds: 12, sweeps: 14 }
    }
}

/// What came out.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// The patch; free of collisions if `bad` is empty.
    pub patch: CrowdPatch,
    /// Walkers that touch somebody or something, or walk beyond the limits.
    pub bad: Vec<usize>,
    /// How often connections were drawn anew.
    pub restarts: u32,
    /// Curves computed.
    pub solves: u64,
}

impl Solution {
    /// Whether all walkers keep all limits.
    pub fn ok(&self) -> bool {
        self.bad.is_empty()
    }
}

/// Fills `frame` with walkers: one from every input to an output, never back over the same edge if that can be.
///
/// Not finding a way for everybody is no error: [`Solution::bad`] says for whom.
///
/// # Errors
/// If the frame cannot be solved by anybody ([`FramePatch::problems`]): names the first problem.
pub fn solve(frame: &FramePatch, limits: &Limits, options: &Options) -> Result<Solution> {
    solve_connected(frame, &[], limits, options)
}

/// The same where some inputs have to lead to some outputs, if that can be.
pub(super) fn solve_connected(
    frame: &FramePatch,
    connections: &[(usize, usize)],
    limits: &Limits,
    options: &Options,
) -> Result<Solution> {
    fill(frame, limits, options, |planner, rng| {
        connections.iter().for_each(|&(input, output)| planner.pairing.require(input, output));
        match options.method {
            Method::Curves => planner.run(options, rng),
            Method::Particles => (planner.run_particles(rng), 0),
        }
    })
}

/// Fills `frame` by `search`, which returns who is left and how often it began again.
fn fill(
    frame: &FramePatch,
    limits: &Limits,
    options: &Options,
    search: impl FnOnce(&mut Planner, &mut ChaCha8Rng) -> (Vec<usize>, u32),
) -> Result<Solution> {
    if let Some(problem) = frame.problems(limits).into_iter().next() {
        return Err(Error::invalid("patch", "frame", problem));
    }
    let obstacles = frame.obstacles(limits);
    let pairing = Pairing::new(frame, limits, &obstacles);
    let mut planner = Planner::new(frame, limits, obstacles, pairing);
    let (bad, restarts) = search(&mut planner, &mut ChaCha8Rng::seed_from_u64(options.seed));
    let patch = CrowdPatch { frame: frame.clone(), walkers: walkers(frame, &planner) };
    Ok(Solution { patch, bad, restarts, solves: planner.solves })
}

fn walkers(frame: &FramePatch, planner: &Planner) -> Vec<Walker> {
    let outputs: Vec<_> = frame.outputs().collect();
    let walker = |(input, port)| {
        let output = planner.output_of(input);
        let track = &planner.tracks[input];
        let points = track.points.iter().map(|p| Vec2::new(p.x as f32, p.y as f32)).collect();
        let path = Path { step: planner.step as f32, first: track.first, points };
        Walker { input: port, output: outputs[output], laps: planner.pairing.laps(input, output), path, role: None }
    };
    frame.inputs().enumerate().map(walker).collect()
}
