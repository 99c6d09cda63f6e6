//! Episodes: what happens between people in raw captures, found by itself ("Tiling Motion Patches" 2013, section 4.1).
//!
//! Three reasons make an event: bodies touch (`contact`); people are near and one reacts, by the variation of eq. 4
//! (`variation`, `thresholds`); or both act and see each other, by eq. 5 (`attention`). Signs that are near each other in
//! space and time are merged (`merge`); events give the constraints of patches (`constraints`).

mod attention;
mod body;
mod constraints;
mod contact;
mod event;
mod merge;
mod options;
mod report;
#[cfg(test)]
mod scripted;
mod signals;
#[cfg(test)]
mod tests;
mod thresholds;
mod variation;

use attention::Couple;
use body::Body;
pub use constraints::{Constraints, Placement};
pub use event::{Event, EventKind, Region, Sign, Touching};
pub use options::EpisodeOptions;
pub use report::{Detection, PairReport};
pub use signals::{PairSignals, PersonSignals, Signals};
pub use thresholds::Thresholds;
pub use variation::variation;

use crate::motion::Motion;

/// The events of one take: its people's motions on one clock (see [`crate::patch::load_take`]).
pub fn detect(motions: &[Motion], options: &EpisodeOptions) -> Detection {
    detect_all(&[motions], options).remove(0)
}

/// The events of every take of a collection, with thresholds chosen from all of it. O(frames x window) and for every
/// two people of a take O(frames), the most for those within reach of each other.
pub fn detect_all(takes: &[&[Motion]], options: &EpisodeOptions) -> Vec<Detection> {
    let bodies: Vec<Body> = takes.iter().flat_map(|t| t.iter()).map(|m| Body::new(m, options.half_window)).collect();
    let thresholds = Thresholds::of(&bodies, options);
    let mut rest = bodies.as_slice();
    let each = takes.iter().map(|take| {
        let (own, others) = rest.split_at(take.len());
        rest = others;
        detect_one(own, thresholds, options)
    });
    each.collect()
}

fn detect_one(bodies: &[Body], thresholds: Thresholds, options: &EpisodeOptions) -> Detection {
    let (mut signs, mut pairs) = (Vec::new(), Vec::new());
    let mut signals = Signals { people: bodies.iter().map(PersonSignals::of).collect(), pairs: Vec::new() };
    for a in 0..bodies.len() {
        for b in a + 1..bodies.len() {
            let couple = Couple { people: [a, b], bodies: [&bodies[a], &bodies[b]], thresholds: &thresholds, options };
            let (mut own, gap) = contact::signs(couple.people, couple.bodies, options);
            own.extend(couple.proximity());
            own.extend(couple.synchronous());
            pairs.push(PairReport::of(&couple, &own));
            signals.pairs.push(PairSignals::of(&couple, gap));
            signs.extend(own);
        }
    }
    let events = merge::events(signs, bodies, options);
    Detection { events, pairs, frames: bodies.iter().map(Body::len).collect(), thresholds, signals }
}
