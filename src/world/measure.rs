//! How long patches take: what the benchmark prints.

use std::time::Instant;

use super::{CrowdPatch, FramePatch, Limits, Method, Options, Plan, Stream, solve};
use crate::Result;

/// Figures of patches of one size.
#[derive(Clone, Debug)]
pub struct Creation {
    /// Inputs (and outputs) of every patch.
    pub walkers: usize,
    /// Milliseconds per patch, ascending: the least of three runs, as other processes take the core now and then.
    pub millis: Vec<f64>,
    /// Patches whose walkers keep all limits.
    pub solved: usize,
    /// Curves computed, of all patches.
    pub solves: u64,
    /// Connections drawn anew, of all patches.
    pub restarts: u64,
    /// The patches.
    pub patches: Vec<CrowdPatch>,
}

impl Creation {
    /// Milliseconds that a `share` of the patches stays below.
    pub fn quantile(&self, share: f64) -> f64 {
        let last = self.millis.len().saturating_sub(1);
        self.millis.get((last as f64 * share.clamp(0.0, 1.0)) as usize).copied().unwrap_or(f64::NAN)
    }
}

/// Solves `patches` random test patches ([`FramePatch::sample`]) of `walkers` inputs and outputs on one core.
///
/// # Errors
/// If there is no room for so many walkers.
pub fn measure_creation(method: Method, walkers: usize, patches: u64) -> Result<Creation> {
    let mut found = Creation { walkers, millis: Vec::new(), solved: 0, solves: 0, restarts: 0, patches: Vec::new() };
    for seed in 0..patches {
        let frame = FramePatch::sample(walkers, seed)?;
        let options = Options { seed, method, ..Options::default() };
        let mut least = f64::INFINITY;
        for run in 0..3 {
            let begin = Instant::now();
            let solution = solve(&frame, &Limits::default(), &options)?;
            least = least.min(begin.elapsed().as_secs_f64() * 1e3);
            if run == 0 {
                found.solved += usize::from(solution.ok());
                found.solves += solution.solves;
                found.restarts += u64::from(solution.restarts);
                found.patches.push(solution.patch);
            }
        }
        found.millis.push(least);
    }
    found.millis.sort_by(f64::total_cmp);
    Ok(found)
}

/// Figures of a walk through an endless world.
#[derive(Clone, Debug)]
pub struct Walk {
    /// Milliseconds of every frame in which patches were made, ascending.
    pub frames: Vec<f64>,
    /// Most patches there were at a time.
    pub resident: usize,
    /// Patches made.
    pub made: usize,
}

/// Walks `metres` along x through the endless world of `plan`, on one core: patches within `reach` cells of the camera are
/// made, at most `budget` in a frame, those behind forgotten.
///
/// # Errors
/// As [`Plan::build`].
pub fn measure_walk(plan: &Plan, metres: f32, reach: i64, budget: usize) -> Result<Walk> {
    let mut stream = Stream::new(plan.clone())?;
    let mut walk = Walk { frames: Vec::new(), resident: 0, made: 0 };
    for column in 0..(metres / plan.side).ceil() as i64 {
        loop {
            let begin = Instant::now();
            let missing = stream.look([column, 1], reach, budget);
            walk.frames.push(begin.elapsed().as_secs_f64() * 1e3);
            walk.resident = walk.resident.max(stream.cells().count());
            if missing == 0 {
                break;
            }
        }
        walk.made += if column == 0 { stream.cells().count() } else { 2 * reach as usize + 1 };
    }
    walk.frames.sort_by(f64::total_cmp);
    Ok(walk)
}
