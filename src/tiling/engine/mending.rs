//! Final bodies are tested, and people led other ways where they are at fault.

use rand_chacha::ChaCha8Rng;

use super::super::bridge::Taste;
use super::super::draft::Draft;
use super::super::mend::{dissolve, mend, restand};
use super::super::outcome::Phase;
use super::super::rehearsal::Rehearsal;
use super::Engine;
use super::people::STAND;

/// Rounds after which patches of several people are given up for a fault.
const GENTLE_ROUNDS: usize = 6;
/// States expanded to mend a fault.
const MEND_EXPANSIONS: usize = 1500;
/// Rounds of mending.
const MEND_ROUNDS: usize = 30;

impl Engine<'_> {
    /// Mends, and where that cost more patches of several people than it may, puts new ones in and mends again.
    pub(super) fn finish(&mut self, refills: usize) -> Rehearsal {
        let mut rehearsal = Rehearsal::new(&self.crew.tracks);
        self.mend(&mut rehearsal);
        for _ in 0..refills {
            let (company, needed) = (self.crew.tracks.company(), self.company_of(self.crew.tracks.presence(), 1.0));
            if company as f32 >= needed || !rehearsal.faults.is_empty() {
                break;
            }
            // People may have been led other ways even if no patch found room.
            self.enrich(self.patience);
            rehearsal.repeat(&self.crew.tracks);
            self.mend(&mut rehearsal);
            if self.crew.tracks.company() <= company {
                break;
            }
        }
        rehearsal
    }

    /// Bridges anew where final bodies are at fault, until none are.
    pub(super) fn mend(&mut self, rehearsal: &mut Rehearsal) {
        let taste = Taste { expansions: MEND_EXPANSIONS, ..self.taste };
        for round in 0..MEND_ROUNDS {
            let faults = &rehearsal.faults;
            if faults.is_empty() || !self.goes_on(Phase::Mend) {
                return;
            }
            for fault in &rehearsal.faults {
                [fault.a, fault.b].into_iter().for_each(|track| self.crew.tracks.cut_away_from(track, fault.tick));
            }
            let gentle = round < GENTLE_ROUNDS;
            let propose = |i: usize, draft: &mut Draft, rng: &mut ChaCha8Rng| match gentle {
                true => mend(draft, faults[i], taste, rng),
                false => restand(draft, faults[i], STAND, rng)
                    .or_else(|| dissolve(draft, faults[i], taste, rng))
                    .or_else(|| mend(draft, faults[i], taste, rng)),
            };
            self.crew.work(faults.len(), propose, |_, _| true);
            rehearsal.repeat(&self.crew.tracks);
        }
    }
}
