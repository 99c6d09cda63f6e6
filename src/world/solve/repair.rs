//! What to do when improving the curves one by one gets stuck.

use glam::DVec2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::Options;
use super::planner::{Planner, at_begin};
use super::track::Track;

/// Share of stuck walkers that swap outputs; the others are kicked aside.
const SWAP: f64 = 0.3;

/// How far walkers are kicked (standard deviation), metres.
const KICK: f64 = 0.3;

/// Half the length of a kick in knots.
const REACH: f64 = 7.0;
/// Cost of a connection that breaks the limits even without other walkers.
const UNWALKABLE: f64 = 30.0;
/// Cost of a connection somebody got stuck on.
const STUCK: f64 = 2.0;
/// Of so many restarts all but the first keep the curves whose connections stay.
const AFRESH: u32 = 6;
/// Noise of costs, growing with every restart.
const NOISE: f64 = 0.6;

/// What a restart came to.
#[derive(Clone, Debug)]
pub(super) struct Attempt {
    bad: Vec<usize>,
    outputs: Vec<usize>,
    tracks: Vec<Track>,
}

impl Planner {
    /// Searches until all walkers are free or the options are spent. Returns who is not, for the best attempt, and the
    /// number of restarts.
    pub fn run(&mut self, options: &Options, rng: &mut ChaCha8Rng) -> (Vec<usize>, u32) {
        let mut best = None;
        for restart in 0..=options.restarts {
            if restart % AFRESH == 0 {
                self.outputs.clear();
                self.outputs.resize(self.tracks.len(), usize::MAX);
            }
            self.connect(NOISE * f64::from((restart / AFRESH).min(3) + 1), rng);
            let bad = self.mend(options, rng);
            if bad.is_empty() {
                return (bad, restart);
            }
            bad.iter().for_each(|&j| self.pairing.avoid(j, self.outputs[j], STUCK));
            self.keep_best(bad, &mut best);
        }
        (self.restore(best), options.restarts)
    }

    /// Remembers the present attempt if fewer are `bad` than in `best`.
    pub fn keep_best(&self, bad: Vec<usize>, best: &mut Option<Attempt>) {
        if best.as_ref().is_none_or(|best| bad.len() < best.bad.len()) {
            *best = Some(Attempt { bad, outputs: self.outputs.clone(), tracks: self.tracks.clone() });
        }
    }

    /// Goes back to the best attempt; returns who is not free in it.
    pub fn restore(&mut self, best: Option<Attempt>) -> Vec<usize> {
        let Some(best) = best else { return Vec::new() };
        (self.outputs, self.tracks) = (best.outputs, best.tracks);
        best.bad
    }

    /// Connects all inputs to outputs, avoiding connections that cannot be walked even alone. Who keeps its output keeps
    /// its curve.
    fn connect(&mut self, noise: f64, rng: &mut ChaCha8Rng) {
        let mut outputs = Vec::new();
        for _ in 0..4 {
            self.pairing.assign(noise, rng, &mut outputs);
            let mut again = false;
            for (j, &output) in outputs.iter().enumerate() {
                if self.outputs[j] != output {
                    self.outputs[j] = output;
                    self.lay(j);
                    if !self.settle(j) {
                        self.pairing.avoid(j, output, UNWALKABLE);
                        again = true;
                    }
                }
            }
            if !again {
                break;
            }
        }
    }

    /// Relaxes and repairs by turns, going back where that made it worse; returns who is left.
    pub fn mend(&mut self, options: &Options, rng: &mut ChaCha8Rng) -> Vec<usize> {
        self.relax(options.sweeps);
        let mut bad = self.bad();
        for _ in 0..options.rounds {
            if bad.is_empty() {
                break;
            }
            let before = (self.outputs.clone(), self.tracks.clone());
            for &j in &bad {
                if !self.keep_connections && rng.random::<f64>() < SWAP { self.swap(j, rng) } else { self.kick(j, rng) }
            }
            self.relax(options.sweeps);
            let now = self.bad();
            if now.len() <= bad.len() {
                bad = now;
            } else {
                (self.outputs, self.tracks) = before;
                (0..self.tracks.len()).for_each(|j| self.touch(j));
            }
        }
        bad
    }

    /// Walkers that do not keep all limits.
    pub fn bad(&mut self) -> Vec<usize> {
        (0..self.tracks.len()).filter(|&j| !self.is_free(j)).collect()
    }

    /// Exchanges the output of walker `j` with that of the partner of least cost of a few.
    fn swap(&mut self, j: usize, rng: &mut ChaCha8Rng) {
        let n = self.tracks.len();
        let cost = |i: usize| {
            let (a, b) = (self.outputs[i], self.outputs[j]);
            self.pairing.cost(i, b) + self.pairing.cost(j, a) - self.pairing.cost(i, a) - self.pairing.cost(j, b)
        };
        let partner = (0..4).map(|_| rng.random_range(0..n)).filter(|&i| i != j);
        let Some(i) = partner.min_by(|&a, &b| cost(a).total_cmp(&cost(b))) else { return };
        if cost(i) > 100.0 {
            return self.kick(j, rng);
        }
        self.outputs.swap(i, j);
        self.lay(i);
        self.lay(j);
    }

    /// Bends the curve of walker `j` somewhere, to either side.
    pub fn kick(&mut self, j: usize, rng: &mut ChaCha8Rng) {
        let size = KICK * (0..4).map(|_| rng.random::<f64>() - 0.5).sum::<f64>() * 3.0_f64.sqrt();
        let push = DVec2::from_angle(rng.random::<f64>() * std::f64::consts::TAU) * size;
        let track = &mut self.tracks[j];
        let free = track.free.clone();
        if free.is_empty() {
            return;
        }
        let middle = rng.random_range(free.clone()) as f64;
        let (nailed, grid) = (self.keep_state, self.grid());
        let track = &mut self.tracks[j];
        for k in free {
            if nailed && at_begin(track, k, grid) {
                continue;
            }
            let far = (k as f64 - middle) / REACH;
            if far.abs() < 1.0 {
                track.points[k] += push * (1.0 - far * far).powi(2);
            }
        }
        track.update_knots();
        self.touch(j);
    }
}
