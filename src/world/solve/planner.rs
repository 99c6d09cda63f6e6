//! Tracks of all walkers of a patch, and the improvement of one against all others.

use glam::DVec2;

use super::contact::{self, Push, ROOM};
use super::own::Ground;
use super::system::System;
use super::track::Track;
use crate::world::Limits;
use crate::world::frame::FramePatch;
use crate::world::pairing::Pairing;
use crate::world::route::route;
use crate::world::shape::Obstacle;

/// Seconds between knots, about.
pub(in crate::world) const STEP: f64 = 0.2;
/// Weight of keeping apart, beside the squares of second differences.
const PUSH: f64 = 3.0;
/// Weight of what is over the limits of acceleration and turning.
const EXCESS: f64 = 20.0;
/// Weight of what is over the limit of speed.
const HASTE: f64 = 3.0;
/// Weight of staying where it is.
const HOLD: f64 = 0.003;
/// No point moves further in one solve, metres.
const MOST: f64 = 0.6;

/// State of the search; memory is kept from one attempt to the next.
#[derive(Clone, Debug)]
pub(super) struct Planner {
    /// Who can go where.
    pub pairing: Pairing,
    /// Output of every input.
    pub outputs: Vec<usize>,
    /// One per input.
    pub tracks: Vec<Track>,
    /// Surroundings.
    pub ground: Ground,
    /// Seconds between knots.
    pub step: f64,
    /// Curves computed so far.
    pub solves: u64,
    /// Whether outputs must not be swapped.
    pub keep_connections: bool,
    /// Whether points around the begin of the period must not move.
    pub keep_state: bool,
    /// Knots per period.
    grid: i32,
    apart: f64,
    /// When a track moved last, and when it was last found free of all others.
    moved: Vec<u64>,
    found_free: Vec<u64>,
    clock: u64,
    system: System,
    pushes: Vec<Push>,
    via: Vec<DVec2>,
}

impl Planner {
    /// Ready to connect and plan.
    pub fn new(frame: &FramePatch, limits: &Limits, obstacles: Vec<Obstacle>, pairing: Pairing) -> Self {
        let grid = (f64::from(frame.period()) / STEP).round().max(1.0);
        let step = f64::from(frame.period()) / grid;
        let ground = Ground::new(frame, limits, obstacles, step);
        let n = pairing.len();
        let tracks = pairing.inputs.iter().map(|&line| Track::new(line)).collect();
        Self {
            pairing,
            outputs: Vec::new(),
            tracks,
            ground,
            step,
            solves: 0,
            keep_connections: false,
            keep_state: false,
            grid: grid as i32,
            apart: 2.0 * f64::from(limits.radius),
            moved: vec![0; n],
            found_free: vec![0; n],
            clock: 0,
            system: System::default(),
            pushes: Vec::new(),
            via: Vec::new(),
        }
    }

    /// Where `input` leads.
    pub fn output_of(&self, input: usize) -> usize {
        self.outputs[input]
    }

    /// Knots per period.
    pub fn grid(&self) -> i32 {
        self.grid
    }

    /// Distance of centres at which bodies touch.
    pub fn apart(&self) -> f64 {
        self.apart
    }

    /// Makes the track of walker `j` lead to its output.
    pub fn aim(&mut self, j: usize) {
        let output = self.outputs[j];
        let period = f64::from(self.grid) * self.step;
        let exit = self.pairing.outputs[output].later(f64::from(self.pairing.laps(j, output)) * period);
        self.tracks[j].aim(self.pairing.inputs[j], exit, self.step);
    }

    /// Begins the track of walker `j` anew: past the objects, else straight, as even as can be.
    pub fn lay(&mut self, j: usize) {
        self.aim(j);
        let (entry, exit) = (self.tracks[j].entry, self.tracks[j].exit);
        let (leave, arrive) = (entry.time + entry.reach, exit.time - exit.reach);
        let (from, to) = (entry.at(leave), exit.at(arrive));
        let ground = &self.ground;
        let inside = |p: DVec2| ground.borders.iter().all(|b| (p - b.begin).dot(b.inward) > ground.radius);
        route(from, to, &ground.obstacles, &inside, &mut self.via);
        let track = &mut self.tracks[j];
        track.follow(from, to, &self.via, leave / self.step, arrive / self.step);
        self.system.begin(track, 1e-6);
        let targets = self.via.iter().map(|&via| (track.nearest_knot(via), via));
        for (knot, via) in targets {
            let gap = via - track.knots[knot];
            self.system.push(knot, 0.3, DVec2::X, gap.x);
            self.system.push(knot, 0.3, DVec2::Y, gap.y);
        }
        self.system.apply(track, f64::INFINITY);
        self.solves += 1;
        self.touch(j);
    }

    /// Improves walker `j` as if alone; returns whether it keeps its own limits then.
    pub fn settle(&mut self, j: usize) -> bool {
        for _ in 0..8 {
            if self.ground.keeps(&self.tracks[j]) {
                return true;
            }
            self.pushes.clear();
            self.yield_to_pushes(j);
        }
        self.ground.keeps(&self.tracks[j])
    }

    /// Notes that track `j` moved.
    pub fn touch(&mut self, j: usize) {
        self.clock += 1;
        self.moved[j] = self.clock;
    }

    /// Whether walker `j` keeps its own limits and touches nobody.
    pub fn is_free(&mut self, j: usize) -> bool {
        let since = self.found_free[j];
        let a = &self.tracks[j];
        let anew = self.moved[j] > since;
        if anew && !self.ground.keeps(a) {
            return false;
        }
        for (i, b) in self.tracks.iter().enumerate() {
            if !anew && self.moved[i] <= since {
                continue;
            }
            if !contact::shifts(a, b, self.grid)
                .all(|shift| i == j && shift == 0 || contact::free(a, b, shift, self.apart))
            {
                return false;
            }
        }
        self.found_free[j] = self.clock;
        true
    }

    /// Improves every walker that is not free, up to `sweeps` times. Returns whether all are free.
    pub fn relax(&mut self, sweeps: u32) -> bool {
        for _ in 0..sweeps {
            let mut all = true;
            for j in 0..self.tracks.len() {
                if !self.is_free(j) {
                    all = false;
                    self.improve(j);
                }
            }
            if all {
                return true;
            }
        }
        false
    }

    /// Moves walker `j` towards keeping all limits, the others staying where they are.
    fn improve(&mut self, j: usize) {
        self.pushes.clear();
        let track = &self.tracks[j];
        for (i, other) in self.tracks.iter().enumerate() {
            for shift in contact::shifts(track, other, self.grid) {
                if i != j || shift != 0 {
                    contact::pushes(track, other, shift, self.apart + ROOM, &mut self.pushes);
                }
            }
        }
        self.yield_to_pushes(j);
    }

    /// Moves walker `j` as the pushes of others and its own limits want it.
    fn yield_to_pushes(&mut self, j: usize) {
        self.ground.pushes(&self.tracks[j], &mut self.pushes);
        let track = &mut self.tracks[j];
        self.system.begin(track, HOLD);
        for push in self.pushes.iter().filter(|p| track.moving_knots().contains(&p.knot)) {
            self.system.push(push.knot, PUSH, push.normal, push.gap);
        }
        for k in track.moving_knots() {
            if let Some(excess) = self.ground.excess(track, k) {
                self.system.even(k, EXCESS, excess);
            }
            if let Some(excess) = self.ground.haste(track, k) {
                self.system.slow(k, HASTE, excess);
            }
        }
        if self.keep_state {
            track.free.clone().filter(|&k| at_begin(track, k, self.grid)).for_each(|k| self.system.nail(k));
        }
        self.system.apply(track, MOST);
        self.solves += 1;
        self.touch(j);
    }
}

/// Whether point `k` has a share in the curve at the begin of a period.
pub(super) fn at_begin(track: &Track, k: usize, grid: i32) -> bool {
    (track.first + k as i32 + 1).rem_euclid(grid) <= 2
}
