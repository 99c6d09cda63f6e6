//! How long it takes to end a run: final bodies, their test and their builds. Measured with some of the people when a part
//! of the time has gone, so that search leaves time for it on any machine.

use std::time::Instant;

use super::bake::Chains;
use super::builds::people;
use super::faults::faults;
use super::rehearsal::perform;

/// People with whom it is measured.
const SAMPLE: usize = 32;
/// It is measured when so much of the time has gone, and again while there were much fewer people than these.
const WHEN: f64 = 0.2;
const AGAIN: usize = 8;
/// Builds of people among neighbours give way to each other, which takes three times as long as with few (7,000 people
/// on 120 x 120 m); mending takes some time as well.
const RESERVE: [f64; 2] = [1.2, 3.3];

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
        let begin = Instant::now();
        let played = perform(some);
        faults(some, &played, &vec![true; count]);
        let rehearsed = begin.elapsed().as_secs_f64();
        people(some, &played.bodies, &played.props, seed);
        let all = begin.elapsed().as_secs_f64();
        self.per_person = [rehearsed / count as f64, (all - rehearsed) / count as f64];
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
