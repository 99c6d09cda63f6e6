//! A crew works out changes to the tiling side by side and makes those that still can be made, in the order in which they
//! were asked for. How many are worked out at once depends on the scene alone and each has its own stream of random
//! numbers, so the number of threads changes nothing but the time.

use std::sync::Mutex;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::draft::{Desk, Draft};
use super::swept::Swept;
use super::tracks::{Change, Tracks};

/// Ground on which about one change at a time finds room, m^2.
const ROOM: f32 = 16.0;
/// Fewest and most changes worked out at once.
const FEWEST: usize = 8;
const MOST: usize = 256;

/// The tiling and who works on it.
pub(super) struct Crew<'a> {
    /// The tiling.
    pub tracks: Tracks<'a>,
    /// How many changes are worked out at once: few enough that they seldom meet.
    pub batch: usize,
    /// What all randomness comes from.
    pub seed: u64,
    desks: Mutex<Vec<Desk>>,
    /// Changes worked out so far: each has a stream of random numbers of its own.
    drawn: u64,
}

impl<'a> Crew<'a> {
    /// A crew for an empty tiling. `area` in m^2.
    pub fn new(tracks: Tracks<'a>, area: f32, seed: u64) -> Self {
        let batch = ((area / ROOM) as usize).clamp(FEWEST, MOST);
        Self { tracks, batch, seed, desks: Mutex::default(), drawn: 0 }
    }

    /// Changes worked out so far.
    pub fn drawn(&self) -> u64 {
        self.drawn
    }

    /// The same, so many changes having been worked out by an earlier run.
    pub fn going_on(self, drawn: u64) -> Self {
        Self { drawn, ..self }
    }

    /// Works `count` changes out and makes those that are found and wanted; for each whether it was made.
    pub fn work(
        &mut self,
        count: usize,
        propose: impl Fn(usize, &mut Draft, &mut ChaCha8Rng) -> Option<()> + Sync,
        mut wanted: impl FnMut(&Tracks, &Change) -> bool,
    ) -> Vec<bool> {
        let found = self.find(count, propose);
        let mut made = |change: Change| wanted(&self.tracks, &change) && self.tracks.apply(change);
        found.into_iter().map(|change| change.is_some_and(&mut made)).collect()
    }

    /// The same, but no more than `most` are made: those first that newly sweep the least ground for the company they bring.
    pub fn work_best(
        &mut self,
        (count, most): (usize, usize),
        swept: &mut Swept,
        propose: impl Fn(usize, &mut Draft, &mut ChaCha8Rng) -> Option<()> + Sync,
        wanted: impl Fn(&Tracks, &Change) -> bool,
    ) -> Vec<bool> {
        let found = self.find(count, propose).into_iter().enumerate();
        let mut found: Vec<(f32, usize, Change)> =
            found.filter_map(|(i, change)| change.map(|change| (swept.price(&change), i, change))).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut made, mut left) = (vec![false; count], most);
        for (_, i, change) in found {
            let cells = swept.newly(&change);
            if left > 0 && wanted(&self.tracks, &change) && self.tracks.apply(change) {
                swept.take(&cells);
                (made[i], left) = (true, left - 1);
            }
        }
        made
    }

    fn find(
        &mut self,
        count: usize,
        propose: impl Fn(usize, &mut Draft, &mut ChaCha8Rng) -> Option<()> + Sync,
    ) -> Vec<Option<Change>> {
        let this = &*self;
        let found = (0..count).into_par_iter().with_max_len(1).map(|i| this.propose(i, &propose)).collect();
        self.drawn += count as u64;
        found
    }

    /// Works one change out in as many ways as are worked out at once, and makes the first that is found.
    pub fn work_one(&mut self, propose: impl Fn(&mut Draft, &mut ChaCha8Rng) -> Option<()> + Sync) -> bool {
        let version = self.tracks.version();
        self.work(FEWEST, |_, draft, rng| propose(draft, rng), |tracks, _| tracks.version() == version).contains(&true)
    }

    fn propose(
        &self,
        i: usize,
        propose: &(impl Fn(usize, &mut Draft, &mut ChaCha8Rng) -> Option<()> + Sync),
    ) -> Option<Change> {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        rng.set_stream(self.drawn + i as u64);
        let mut desk = self.desks.lock().expect("nobody panics with it").pop().unwrap_or_default();
        let mut draft = Draft::new(&self.tracks, &mut desk);
        let found = propose(i, &mut draft, &mut rng).map(|()| draft.finish());
        self.desks.lock().expect("nobody panics with it").push(desk);
        found
    }
}
