//! Further patches of several people where people pass near each other.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::super::bridge::Taste;
use super::super::draft::Draft;
use super::super::enrich::enrich;
use super::super::outcome::Phase;
use super::super::tracks::Window;
use super::Engine;

/// Failures per person in a row after which people are led other ways.
const STIR_AFTER: usize = 14;
/// Ticks before and after a piece that are then bridged anew.
const STIR_TICKS: i32 = 45;
/// Tries per person in the sweep through time, and how far ahead of it patches are put, ticks.
const SWEEP_TRIES: usize = 60;
const SWEEP_TICKS: i32 = 30;

impl Engine<'_> {
    /// Adds patches of several people until there is as much company as wished for: once through time from its
    /// beginning, when what comes after is free, then wherever there is room.
    pub(super) fn enrich(&mut self, patience: usize) {
        let (people, last) = (self.crew.tracks.tracks.len(), self.crew.tracks.domain.horizon - SWEEP_TICKS / 2);
        if self.crew.tracks.library.multi.is_empty() || people == 0 {
            return;
        }
        let (wish, tries, taste) = (self.company_wish(), SWEEP_TRIES * people, self.taste);
        let (mut done, mut failures, mut since_stir) = (0, 0, 0);
        while self.crew.tracks.company() < wish && failures < patience * people && self.goes_on(Phase::Enrich) {
            let ticks = |i: usize| match (done + i) * last as usize / tries {
                tick if tick < last as usize => tick as i32..(tick as i32 + SWEEP_TICKS).min(last),
                _ => 0..last,
            };
            let count = self.crew.batch;
            let made = self.crew.work(
                count,
                |i, draft, rng| enrich(draft, ticks(i), taste, rng),
                |tracks, _| tracks.company() < wish,
            );
            done += count;
            (failures, since_stir) = if made.contains(&true) { (0, 0) } else { (failures + count, since_stir + count) };
            if since_stir > STIR_AFTER * people {
                since_stir = 0;
                self.crew.work(people, |track, draft, rng| stir(draft, track, taste, rng), |_, _| true);
            }
        }
    }
}

/// Leads somebody another way for some seconds: new neighbours meet.
fn stir(draft: &mut Draft, track: usize, taste: Taste, rng: &mut ChaCha8Rng) -> Option<()> {
    let tracks = draft.base;
    let from = rng.random_range(0..tracks.tracks[track].len());
    if !tracks.is_loose(tracks.tracks[track][from]) {
        return None;
    }
    let window = tracks.widen(Window { track, from, to: from + 1 }, STIR_TICKS);
    draft.hide(window);
    draft.bridge_window(window, taste, rng)
}
