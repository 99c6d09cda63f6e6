//! Which input leads to which output, and how long it takes.
//!
//! "Crowd Patches" (2009), section 4.3 connects at random. Departure: the connection of least total cost, where a pair
//! costs what its plain curve would: odd speed, acceleration, objects in the way. Pairs over one and the same edge are
//! used only if no connection does without.

use glam::DVec2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::assign::Assignment;
use super::frame::Line;
use super::route::route;
use super::shape::Obstacle;
use super::{FramePatch, Limits};

/// Speed people like to walk at, m/s.
const COMFORT: f64 = 1.3;
/// Fastest mean speed of a connection, m/s.
const FASTEST: f64 = 1.6;
/// Greatest acceleration of its plain curve, m/s2.
const HARDEST: f64 = 1.6;
/// Least time between the straight parts, seconds.
const SHORTEST: f64 = 2.0;
/// Cost of going back over the edge one came by.
const SAME_EDGE: f64 = 1e4;
/// Cost of another connection than one that must be.
const REQUIRED: f64 = 1e7;
/// Cost of an object on the straight way.
const BLOCKED: f64 = 1.0;

/// All connections that are possible, with their costs.
#[derive(Clone, Debug, Default)]
pub(super) struct Pairing {
    /// Lines of the inputs, edge by edge.
    pub inputs: Vec<Line>,
    /// Lines of the outputs.
    pub outputs: Vec<Line>,
    cost: Vec<f64>,
    laps: Vec<u32>,
    noisy: Vec<f64>,
    assignment: Assignment,
}

impl Pairing {
    /// The connections of `frame`.
    pub fn new(frame: &FramePatch, limits: &Limits, obstacles: &[Obstacle]) -> Self {
        let inputs: Vec<Line> = frame.inputs().map(|p| frame.line(p, true, limits)).collect();
        let outputs: Vec<Line> = frame.outputs().map(|p| frame.line(p, false, limits)).collect();
        let period = f64::from(frame.period());
        let pairs = inputs.iter().flat_map(|a| outputs.iter().map(move |b| (a, b)));
        let mut via = Vec::new();
        let (cost, laps) = pairs.map(|(a, b)| connect(a, b, period, obstacles, &mut via)).unzip();
        Self { inputs, outputs, cost, laps, ..Self::default() }
    }

    /// How many people cross.
    pub fn len(&self) -> usize {
        self.inputs.len()
    }

    /// Cost of leading `input` to `output`.
    pub fn cost(&self, input: usize, output: usize) -> f64 {
        self.cost[input * self.len() + output]
    }

    /// Makes it unlikely that `input` is led to `output` again.
    pub fn avoid(&mut self, input: usize, output: usize, cost: f64) {
        let n = self.len();
        self.cost[input * n + output] += cost;
    }

    /// Leads `input` to `output` and nowhere else, whatever it costs.
    pub fn require(&mut self, input: usize, output: usize) {
        for other in (0..self.len()).filter(|&other| other != output) {
            self.avoid(input, other, REQUIRED);
        }
    }

    /// Periods between them.
    pub fn laps(&self, input: usize, output: usize) -> u32 {
        self.laps[input * self.len() + output]
    }

    /// Prescribes the periods between them.
    pub fn set_laps(&mut self, input: usize, output: usize, laps: u32) {
        let n = self.len();
        self.laps[input * n + output] = laps;
    }

    /// The output of every input into `columns`: of least cost, give or take `noise`.
    pub fn assign(&mut self, noise: f64, rng: &mut ChaCha8Rng, columns: &mut Vec<usize>) {
        self.noisy.clear();
        self.noisy.extend(self.cost.iter().map(|c| c + noise * rng.random::<f64>()));
        let n = self.inputs.len();
        self.assignment.solve(&self.noisy, n, columns);
    }
}

/// Cost of a connection and the periods it takes.
fn connect(a: &Line, b: &Line, period: f64, obstacles: &[Obstacle], via: &mut Vec<DVec2>) -> (f64, u32) {
    let (from, to) = (a.at(a.time + a.reach), b.at(b.time - b.reach));
    let way = length(from, to, obstacles, via);
    let blocked = !via.is_empty();
    let at_least = (way / FASTEST).max(SHORTEST) + a.reach + b.reach;
    let first = ((a.time + at_least - b.time) / period).ceil().max(0.0) as u32;
    let cost = |laps: u32| plain_cost(a, b, b.time + f64::from(laps) * period - a.time, way, to - from);
    // A longer stay bends less; two more periods are enough for any pair.
    let laps = (first..first + 2).find(|&k| cost(k).1 <= HARDEST).unwrap_or(first + 2);
    let odd = if a.edge == b.edge { SAME_EDGE } else { 0.0 } + if blocked { BLOCKED } else { 0.0 };
    (cost(laps).0 + odd, laps)
}

/// Length of the way past the objects.
fn length(from: DVec2, to: DVec2, obstacles: &[Obstacle], via: &mut Vec<DVec2>) -> f64 {
    route(from, to, obstacles, &|_| true, via);
    let corners = || std::iter::once(from).chain(via.iter().copied()).chain(std::iter::once(to));
    corners().zip(corners().skip(1)).map(|(p, q)| p.distance(q)).sum()
}

/// Cost and greatest acceleration of the cubic from one straight part to the other.
fn plain_cost(a: &Line, b: &Line, secs: f64, length: f64, way: DVec2) -> (f64, f64) {
    let secs = secs - a.reach - b.reach;
    let begin = 6.0 * way / (secs * secs) - (4.0 * a.velocity + 2.0 * b.velocity) / secs;
    let end = -6.0 * way / (secs * secs) + (2.0 * a.velocity + 4.0 * b.velocity) / secs;
    let acceleration = begin.length().max(end.length());
    let speed = length / secs;
    (6.0 * (speed - COMFORT).powi(2) + 0.5 * acceleration * acceleration, acceleration)
}
