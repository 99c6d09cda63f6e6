//! How long it takes to end a run: final bodies, their test and their builds. Measured with some of the people when a part
//! of the time has gone, so that search leaves time for it on any machine.

use std::time::Instant;

use super::bake::Chains;
use super::builds::people;
use super::rehearsal::Rehearsal;

/// People with whom it is measured.
const SAMPLE: usize = 32;
/// How often.
const TIMES: usize = 2;
/// It is measured when so much of the time has gone, and again while there were much fewer people than these.
const WHEN: f64 = 0.2;
const AGAIN: usize = 8;
/// Times what was measured for the rehearsal, after which some mending follows, and for the builds, of which more give way
/// where everybody has neighbours.
const RESERVE: [f64; 2] = [1.3, 1.4];

/// Seconds per person for the rehearsal and for what comes after it.
#[derive(Default)]
pub(super) struct Pace {
    per_person: [f64; 2],
    measured_with: usize,
}

impl Pace {
    /// True if it is worth while to measure it now.
    pub fn is_wanted(&self, gone: f64, people: usize) -> bool {
        gone > WHEN && people > 0 && self.measured_with < people.min(SAMPLE).div_ceil(AGAIN)
    }

    /// Measures it.
    pub fn measure(&mut self, chains: Chains, seed: u64) {
        let some = Chains { lists: &chains.lists[..chains.lists.len().min(SAMPLE)], ..chains };
        let count = some.lists.len();
        // The least of some times: what else the machine does at the moment is not to cost people.
        let mut least = [f64::INFINITY; 2];
        for _ in 0..TIMES {
            let begin = Instant::now();
            let rehearsal = Rehearsal::of(some);
            let rehearsed = begin.elapsed().as_secs_f64();
            people(some, &rehearsal.played, &rehearsal.encounters, seed);
            let dressed = begin.elapsed().as_secs_f64() - rehearsed;
            least = [least[0].min(rehearsed), least[1].min(dressed)];
        }
        self.per_person = least.map(|secs| secs / count as f64);
        self.measured_with = count;
    }

    /// What so many people will take after the search.
    pub fn ending(&self, people: usize) -> f64 {
        people as f64 * (RESERVE[0] * self.per_person[0] + RESERVE[1] * self.per_person[1])
    }

    /// What so many people will take after the mending.
    pub fn baking(&self, people: usize) -> f64 {
        people as f64 * RESERVE[1] * self.per_person[1]
    }
}
