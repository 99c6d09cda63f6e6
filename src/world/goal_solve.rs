//! Patches some of whose connections are given.

use super::{CrowdPatch, FramePatch, Limits, Options, Port, Solution, solve_connected};
use crate::Result;

/// Input and output of every connection that a patch must have, as they are counted over all edges.
pub(super) type Connections = [(usize, usize)];

/// Whether a patch has these connections.
pub(super) fn holds(patch: &CrowdPatch, connections: &Connections) -> bool {
    let outputs: Vec<Port> = patch.frame.outputs().collect();
    let leads = |&(input, output): &(usize, usize)| {
        patch.walkers.get(input).zip(outputs.get(output)).is_some_and(|(walker, port)| walker.output == *port)
    };
    connections.iter().all(leads)
}

/// Fills `frame` with walkers, some of whose ways are given; a solution that does not have them is as good as none.
pub(super) fn solve_with(
    frame: &FramePatch,
    connections: &Connections,
    limits: &Limits,
    options: &Options,
) -> Result<Option<CrowdPatch>> {
    let solution = solve_connected(frame, connections, limits, options)?;
    Ok(Some(solution).filter(|s| Solution::ok(s) && holds(&s.patch, connections)).map(|s| s.patch))
}
