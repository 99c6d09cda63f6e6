//! All crossings of patches that are joined, and the quickest rounds through them.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use crate::world::{FramePatch, Port};

/// Speed that rounds are planned with, m/s; who has to be faster is let through a period later.
const PACE: f32 = 1.3;
/// Least time in a patch, seconds.
const LEAST: f32 = 4.0;
/// A round of a longer way is none.
const MOST_STEPS: usize = 100_000;

/// A connection: in a cell, from an input to an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::world) struct Step {
    pub cell: usize,
    pub input: usize,
    pub output: usize,
}

/// All crossings of joined patches, and which of them are taken.
pub(in crate::world) struct Net {
    frames: Vec<FramePatch>,
    /// Cell and edge on the other side of every edge of every cell.
    beyond: Vec<Vec<Option<(usize, usize)>>>,
    inputs: Vec<Vec<Port>>,
    outputs: Vec<Vec<Port>>,
    /// Of every cell, inputs and outputs that are on a round.
    taken: Vec<[Vec<bool>; 2]>,
    /// Whether connections of a cell can be chosen: not if it repeats within a period.
    free: Vec<bool>,
}

impl Net {
    /// `beyond` says cell and edge on the other side of every edge, where there is one; `free` which cells may be passed.
    pub fn new(frames: Vec<FramePatch>, beyond: Vec<Vec<Option<(usize, usize)>>>, free: Vec<bool>) -> Self {
        let inputs: Vec<Vec<Port>> = frames.iter().map(|f| f.inputs().collect()).collect();
        let outputs: Vec<Vec<Port>> = frames.iter().map(|f| f.outputs().collect()).collect();
        let none = |(a, b): (&Vec<Port>, &Vec<Port>)| [vec![false; a.len()], vec![false; b.len()]];
        let taken = inputs.iter().zip(&outputs).map(none).collect();
        Self { frames, beyond, inputs, outputs, taken, free }
    }

    /// Cell and input on the other side of an output.
    fn beyond(&self, cell: usize, output: usize) -> Option<(usize, usize)> {
        let port = self.outputs[cell][output];
        let (other, edge) = self.beyond[cell][port.edge]?;
        let twin = Port { edge, index: port.index };
        self.inputs[other].iter().position(|&p| p == twin).map(|input| (other, input))
    }

    /// Seconds from an input to an output, at a walk.
    fn secs(&self, cell: usize, input: usize, output: usize) -> f32 {
        let frame = &self.frames[cell];
        let (a, b) = (self.inputs[cell][input], self.outputs[cell][output]);
        let (from, to) = (frame.patterns[a.edge].inputs[a.index], frame.patterns[b.edge].outputs[b.index]);
        let place = |edge: usize, along: f32| {
            let (begin, end) = (frame.outline[edge], frame.outline[(edge + 1) % frame.outline.len()]);
            begin + (end - begin).normalize() * along
        };
        let least = (place(a.edge, from.place).distance(place(b.edge, to.place)) / PACE).max(LEAST);
        let (period, wait) = (frame.period(), to.time - from.time);
        wait + ((least - wait) / period).ceil().max(0.0) * period
    }

    /// Whether the other people of a cell can still all leave by other edges than they came, once these are taken as well.
    fn leaves_ways(&self, cell: usize, input: usize, output: usize) -> bool {
        let [inputs, outputs] = &self.taken[cell];
        let mut edges = vec![0_usize; self.frames[cell].patterns.len()];
        let free = |taken: &[bool], own: usize| {
            taken.iter().enumerate().filter(move |&(i, t)| !t && i != own).map(|(i, _)| i).collect::<Vec<_>>()
        };
        let (left, leaving) = (free(inputs, input), free(outputs, output));
        left.iter().for_each(|&i| edges[self.inputs[cell][i].edge] += 1);
        leaving.iter().for_each(|&o| edges[self.outputs[cell][o].edge] += 1);
        edges.iter().all(|&count| count <= left.len())
    }

    /// The connections that an input may have.
    fn steps(&self, cell: usize, input: usize) -> impl Iterator<Item = Step> + '_ {
        let edge = self.inputs[cell][input].edge;
        let outputs = 0..self.outputs[cell].len();
        let open = move |&output: &usize| {
            self.free[cell]
                && self.outputs[cell][output].edge != edge
                && !self.taken[cell][1][output]
                && self.leaves_ways(cell, input, output)
        };
        outputs.filter(open).map(move |output| Step { cell, input, output })
    }

    /// A round from a cell to another and back: its steps, and which of them is there.
    pub fn round(&self, from: usize, to: usize) -> Option<(Vec<Step>, usize)> {
        let inputs = (0..self.inputs[from].len()).filter(|&i| !self.taken[from][0][i]);
        inputs.filter(|_| from != to).find_map(|input| {
            let away = self.quickest((from, input), &[], |at| at.0 == to)?;
            let last = away.last()?;
            let there = self.beyond(last.cell, last.output)?;
            let back = self.quickest(there, &away, |at| at == (from, input))?;
            let count = away.len();
            Some((away.into_iter().chain(back).collect(), count))
        })
    }

    /// The quickest way from a crossing to one that is a `goal`, through cells that are not on the way `before`.
    fn quickest(
        &self,
        begin: (usize, usize),
        before: &[Step],
        goal: impl Fn((usize, usize)) -> bool,
    ) -> Option<Vec<Step>> {
        // No cell twice on a round: connections within a cell would have to be weighed against each other.
        let used = |cell: usize| before.iter().skip(1).any(|step| step.cell == cell);
        let mut best: BTreeMap<(usize, usize), (u32, Option<Step>)> = BTreeMap::from([(begin, (0, None))]);
        let mut queue = BinaryHeap::from([Reverse((0_u32, begin))]);
        while let Some(Reverse((cost, at))) = queue.pop() {
            if at != begin && goal(at) {
                return Some(trace(&best, at));
            }
            if best[&at].0 < cost || best.len() > MOST_STEPS {
                continue;
            }
            for step in self.steps(at.0, at.1) {
                let Some(next) = self.beyond(step.cell, step.output) else { continue };
                let closes = goal(next);
                let free = !self.taken[next.0][0][next.1] && (closes || !(used(next.0) || next.0 == begin.0));
                let cost = cost + (self.secs(step.cell, step.input, step.output) * 1000.0) as u32;
                if free && best.get(&next).is_none_or(|&(known, _)| cost < known) {
                    best.insert(next, (cost, Some(step)));
                    queue.push(Reverse((cost, next)));
                }
            }
        }
        None
    }

    /// Takes the connections of a round.
    pub fn take(&mut self, steps: &[Step], connections: &mut BTreeMap<usize, Vec<(usize, usize)>>) {
        for step in steps {
            self.taken[step.cell][0][step.input] = true;
            self.taken[step.cell][1][step.output] = true;
            connections.entry(step.cell).or_default().push((step.input, step.output));
        }
    }
}

/// The steps that led to a crossing.
fn trace(best: &BTreeMap<(usize, usize), (u32, Option<Step>)>, end: (usize, usize)) -> Vec<Step> {
    let mut steps: Vec<Step> = std::iter::successors(best[&end].1, |step| best[&(step.cell, step.input)].1).collect();
    steps.reverse();
    steps
}
