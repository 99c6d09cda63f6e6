//! Walkers who go somewhere: rounds of crossings that lead from one place to another and back.
//!
//! Beyond "Crowd Patches" (2009), whose people wander. Which input leads to which output is free within a patch, so a round of
//! crossings is chosen first (the quickest, by walking speed), and the patches on it are solved with its connections. Every
//! crossing is passed once per period: a round that takes m periods carries m people, who go there and back for ever.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use glam::Vec2;
use rand::RngExt;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::{FramePatch, Plan, Port};
use crate::Result;
use crate::stage::world::mix;

/// Speed that rounds are planned with, m/s; who has to be faster is let through a period later.
const PACE: f32 = 1.3;
/// Least time in a patch, seconds.
const LEAST: f32 = 4.0;
/// A round of a longer way is none.
const MOST_STEPS: usize = 100_000;

/// People who go from one place to another, and back.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Goal {
    /// Where they come from.
    pub from: Spot,
    /// Where they go to.
    pub to: Spot,
    /// How many rounds there should be. Each carries as many people as it takes periods.
    pub rounds: usize,
}

/// A place of a map.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Spot {
    /// The patch at a place, metres.
    At(Vec2),
    /// Any patch of a template, by its name.
    Template(String),
}

/// A round that was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Round {
    /// Which goal it is for.
    pub goal: usize,
    /// Cell and input of every patch on the way there and back, from the first on.
    pub steps: Vec<(usize, usize)>,
    /// Which of the steps is in the patch that is the goal.
    pub there: usize,
}

/// The rounds of a plan, and what follows from them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Rounds {
    /// Those that were found.
    pub found: Vec<Round>,
    /// Input and output of every connection that must be, by cell.
    pub connections: BTreeMap<usize, Vec<(usize, usize)>>,
}

impl Plan {
    /// The rounds for the plan's goals: a function of the plan.
    ///
    /// # Errors
    /// As [`Plan::frame`].
    pub fn rounds(&self) -> Result<Rounds> {
        if self.goals.is_empty() || self.goal_problem().is_some() {
            return Ok(Rounds::default());
        }
        let mut net = Net::new(self)?;
        let mut rng = ChaCha8Rng::seed_from_u64(mix(self.seed, u64::from_le_bytes(*b"   goals")));
        let mut rounds = Rounds::default();
        for (goal, wish) in self.goals.iter().enumerate() {
            let (from, to) = (self.cells_of(&wish.from), self.cells_of(&wish.to));
            for _ in 0..wish.rounds {
                // Another pair of places if there is no way between these.
                let mut draw = |cells: &[usize]| cells[rng.random_range(0..cells.len())];
                let found = (0..4).find_map(|_| net.round(draw(&from), draw(&to)));
                let Some((steps, there)) = found else { break };
                net.take(&steps, &mut rounds.connections);
                rounds.found.push(Round { goal, steps: steps.into_iter().map(|s| (s.cell, s.input)).collect(), there });
            }
        }
        Ok(rounds)
    }

    /// Cells of a place.
    fn cells_of(&self, spot: &Spot) -> Vec<usize> {
        let (columns, rows) = self.size();
        let all = || (0..columns * rows).map(|cell| (cell, cell % columns, cell / columns));
        match spot {
            Spot::Template(name) => {
                all().filter(|&(_, c, r)| self.template(c, r).name == *name).map(|(cell, ..)| cell).collect()
            }
            Spot::At(place) => {
                let at = (*place / self.side).floor();
                all().filter(|&(_, c, r)| at == Vec2::new(c as f32, r as f32)).map(|(cell, ..)| cell).collect()
            }
        }
    }

    /// What is wrong with the goals, if anything: which, and what.
    pub(super) fn goal_problem(&self) -> Option<(usize, String)> {
        let odd = |spot: &Spot| {
            self.cells_of(spot).is_empty().then(|| format!("expected a place on the map, found {spot:?}"))
        };
        self.goals.iter().enumerate().find_map(|(index, goal)| {
            let problem = odd(&goal.from).or_else(|| odd(&goal.to));
            Some((index, problem?))
        })
    }
}

/// A connection: in a cell, from an input to an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Step {
    cell: usize,
    input: usize,
    output: usize,
}

/// All crossings of a map, and which of them are taken.
struct Net {
    columns: usize,
    frames: Vec<FramePatch>,
    inputs: Vec<Vec<Port>>,
    outputs: Vec<Vec<Port>>,
    /// Of every cell, inputs and outputs that are on a round.
    taken: Vec<[Vec<bool>; 2]>,
    rows: usize,
    /// Whether connections of a cell can be chosen: not if it repeats within a period.
    free: Vec<bool>,
}

impl Net {
    fn new(plan: &Plan) -> Result<Self> {
        let (columns, rows) = plan.size();
        let frames: Vec<FramePatch> =
            (0..columns * rows).map(|cell| plan.frame(cell % columns, cell / columns)).collect::<Result<_>>()?;
        let inputs: Vec<Vec<Port>> = frames.iter().map(|f| f.inputs().collect()).collect();
        let outputs: Vec<Vec<Port>> = frames.iter().map(|f| f.outputs().collect()).collect();
        let free = |(a, b): (&Vec<Port>, &Vec<Port>)| [vec![false; a.len()], vec![false; b.len()]];
        let taken = inputs.iter().zip(&outputs).map(free).collect();
        let single = |cell: usize| plan.repeats_of(plan.cells[cell / columns][cell % columns]) == 1;
        let free = (0..columns * rows).map(single).collect();
        Ok(Self { columns, rows, frames, inputs, outputs, taken, free })
    }

    /// Cell and input on the other side of an output; none over the border of the map, so that rounds come back to where they
    /// began also where the map repeats.
    fn beyond(&self, cell: usize, output: usize) -> Option<(usize, usize)> {
        let port = self.outputs[cell][output];
        let (column, row) = (cell % self.columns, cell / self.columns);
        let other = match port.edge {
            0 if row > 0 => cell - self.columns,
            1 if column + 1 < self.columns => cell + 1,
            2 if row + 1 < self.rows => cell + self.columns,
            3 if column > 0 => cell - 1,
            _ => return None,
        };
        let twin = Port { edge: (port.edge + 2) % 4, index: port.index };
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
    fn round(&self, from: usize, to: usize) -> Option<(Vec<Step>, usize)> {
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
    fn take(&mut self, steps: &[Step], connections: &mut BTreeMap<usize, Vec<(usize, usize)>>) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{Layout, WorldScene, scenes};
    use glam::DVec2;

    fn city(goals: Vec<Goal>) -> Plan {
        Plan { goals, ..scenes::city(16, true, 2).unwrap() }
    }

    fn goal(from: Spot, to: Spot, rounds: usize) -> Goal {
        Goal { from, to, rounds }
    }

    #[test]
    fn people_go_there_and_back_for_ever() {
        let here = Spot::At(Vec2::new(4.0, 60.0));
        let plan = city(vec![
            goal(here, Spot::At(Vec2::new(100.0, 60.0)), 2),
            goal(Spot::Template("entrance".into()), Spot::Template("place".into()), 2),
        ]);
        let rounds = plan.rounds().unwrap();
        assert_eq!(rounds.found.len(), 4, "{rounds:?}");
        let scene = WorldScene { name: "goals".into(), layout: Layout::Map(plan.clone()) };
        let built = scene.build(&|_, _| true).unwrap();
        let (world, identities) = (&built.world, &built.world.tables().identities);
        let mut kept = 0;
        for round in &rounds.found {
            // All crossings of the round are on one cycle, and no others: so it leads there and back.
            let crossing = |&(cell, input): &(usize, usize)| world.first_crossing(cell) + input;
            let cycle = identities.cycle(crossing(&round.steps[0]));
            let on: Vec<usize> = round.steps.iter().map(crossing).filter(|&c| identities.cycle(c) == cycle).collect();
            let all = (0..world.first_crossing(255)).filter(|&c| identities.cycle(c) == cycle).count();
            if on.len() < round.steps.len() || all > on.len() {
                continue;
            }
            kept += 1;
            assert_eq!(identities.around(cycle).1, [0, 0]);
            // Somebody sets out in every period and gets there without haste or delay.
            let (from, to) = (round.steps[0].0, round.steps[round.there].0);
            let journey = world.journey(from, to, 1000.0).unwrap();
            assert!((1000.0..1010.0 + 1e-6).contains(&journey.departure), "{journey:?}");
            let centre = |cell: usize| world.place(cell);
            let metres = centre(from).distance(centre(to));
            let speed = metres / (journey.arrival - journey.departure);
            assert!((0.3..1.6).contains(&speed), "{metres} m at {speed} m/s");
        }
        assert!(kept >= 3, "{kept} of 4 rounds hold; {:?}", built.notes);
        assert_eq!(built.notes.is_empty(), kept == 4);
        assert!(crate::check::world::check_world(world).ok());
    }

    #[test]
    fn a_journey_is_what_is_seen() {
        let plan = city(vec![goal(Spot::At(Vec2::new(4.0, 60.0)), Spot::At(Vec2::new(68.0, 60.0)), 1)]);
        let built = WorldScene { name: "x".into(), layout: Layout::Map(plan) }.build(&|_, _| true).unwrap();
        let world = &built.world;
        let (from, to) =
            (world.patch_at(DVec2::new(4.0, 60.0)).unwrap(), world.patch_at(DVec2::new(68.0, 60.0)).unwrap());
        assert_eq!((from, to), (112, 120));
        for earliest in [-50.0, 0.0, 12_345.6] {
            let journey = world.journey(from, to, earliest).unwrap();
            // Patches hand over at the nearest slot: a tenth of a second away at most.
            let there = |patch: usize, secs: f64| {
                world.people_of(patch, [0, 0], &world.moment(secs)).any(|p| p == journey.person)
            };
            assert!(there(from, journey.departure + 0.11) && !there(from, journey.departure - 0.11));
            assert!(there(to, journey.arrival + 0.11) && !there(to, journey.arrival - 0.11));
            assert!(journey.departure >= earliest && journey.arrival > journey.departure);
        }
    }

    #[test]
    fn goals_that_are_nowhere_are_named() {
        let plan = city(vec![goal(Spot::At(Vec2::splat(4.0)), Spot::Template("moon".into()), 1)]);
        let error = plan.build().unwrap_err().to_string();
        assert!(error.contains("goal 1") && error.contains("moon"), "{error}");
    }

    #[test]
    fn what_is_not_on_a_round_is_as_before() {
        let plain = city(Vec::new()).build().unwrap();
        let plan = city(vec![goal(Spot::At(Vec2::new(4.0, 60.0)), Spot::At(Vec2::new(36.0, 60.0)), 1)]);
        let (rounds, goals) = (plan.rounds().unwrap(), plan.build().unwrap());
        assert_eq!(rounds.found.len(), 1);
        let cells = (0..256).filter(|cell| !rounds.connections.contains_key(cell));
        let at = |cell: usize| [(cell % 16) as i64, (cell / 16) as i64];
        let same = cells.clone().filter(|&cell| plain.patch(at(cell)) == goals.patch(at(cell))).count();
        assert_eq!(same, cells.count());
    }
}
