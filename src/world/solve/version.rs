//! Versions of a solved patch: the same patterns and connections, other ways inside.
//!
//! "Crowd Patches" (2009), section 7, and "Crowd Sculpting", section 4.4: versions make loops hard to see. With the same
//! state at the begin of the period (points of the curves around it are kept), versions may follow each other in any
//! order: places, velocities and accelerations fit. With the same connections walkers keep their identity, so that
//! copies of a world may differ in objects and ways and still be one world.

use rand_chacha::ChaCha8Rng;

use super::planner::Planner;
use super::{Options, Solution};
use crate::world::{CrowdPatch, FramePatch, Limits};
use crate::{Error, Result};

/// What a version has in common with the patch it is a version of, beside patterns and connections.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Common {
    /// Nothing else: objects may differ.
    Connections,
    /// Where everybody is and how they move at the begin of the period: versions can follow each other.
    State,
}

/// Another version of `patch` with the objects and people of `frame`, by `options.seed`.
///
/// # Errors
/// If `frame` cannot be solved by anybody, or outline or patterns are not those of `patch`.
pub fn vary(
    patch: &CrowdPatch,
    frame: &FramePatch,
    common: Common,
    limits: &Limits,
    options: &Options,
) -> Result<Solution> {
    if frame.outline != patch.frame.outline || frame.patterns != patch.frame.patterns {
        return Err(Error::invalid("patch", "version", "expected outline and patterns of the patch, found others"));
    }
    super::fill(frame, limits, options, |planner, rng| planner.run_version(patch, common, options, rng))
}

impl Planner {
    /// Searches for a version of `patch`. Returns who is not free, and the number of restarts.
    fn run_version(
        &mut self,
        patch: &CrowdPatch,
        common: Common,
        options: &Options,
        rng: &mut ChaCha8Rng,
    ) -> (Vec<usize>, u32) {
        let outputs: Vec<_> = patch.frame.outputs().collect();
        self.keep_connections = true;
        self.keep_state = common == Common::State;
        self.outputs.clear();
        for (j, walker) in patch.walkers.iter().enumerate() {
            let output = outputs.iter().position(|&port| port == walker.output).unwrap_or(0);
            self.outputs.push(output);
            self.pairing.set_laps(j, output, walker.laps);
        }
        let mut best = None;
        for restart in 0..=options.restarts {
            (0..self.tracks.len()).for_each(|j| self.begin_version(j, patch, rng));
            let bad = self.mend(options, rng);
            if bad.is_empty() {
                return (bad, restart);
            }
            self.keep_best(bad, &mut best);
        }
        (self.restore(best), options.restarts)
    }

    fn begin_version(&mut self, j: usize, patch: &CrowdPatch, rng: &mut ChaCha8Rng) {
        if self.keep_state {
            self.aim(j);
            let track = &mut self.tracks[j];
            let free = track.free.clone();
            let given = &patch.walkers[j].path.points[free.clone()];
            track.points[free].iter_mut().zip(given).for_each(|(point, given)| *point = given.as_dvec2());
            track.update_knots();
        } else {
            self.lay(j);
            self.settle(j);
        }
        self.kick(j, rng);
    }
}
