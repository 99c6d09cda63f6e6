//! Walkers who go somewhere: rounds of crossings that lead from one place to another and back.
//!
//! Beyond "Crowd Patches" (2009), whose people wander. Which input leads to which output is free within a patch, so a round of
//! crossings is chosen first (the quickest, by walking speed), and the patches on it are solved with its connections. Every
//! crossing is passed once per period: a round that takes m periods carries m people, who go there and back for ever.

mod net;

use std::collections::BTreeMap;

use glam::Vec2;
use rand::RngExt;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::goal_solve::{Connections, holds};
use super::{CrowdPatch, FramePatch, Plan};
use crate::Result;
use crate::stage::world::mix;
pub(super) use net::Net;

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

/// A place of a map or an area.
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

/// The rounds of a plan or an area, and what follows from them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Rounds {
    /// Those that were found.
    pub found: Vec<Round>,
    /// Input and output of every connection that must be, by cell.
    pub connections: BTreeMap<usize, Vec<(usize, usize)>>,
}

impl Rounds {
    /// The rounds for `goals`; `cells_of` are the cells of a place, at least one.
    pub(super) fn find(goals: &[Goal], seed: u64, cells_of: impl Fn(&Spot) -> Vec<usize>, mut net: Net) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(mix(seed, u64::from_le_bytes(*b"   goals")));
        let mut rounds = Self::default();
        for (goal, wish) in goals.iter().enumerate() {
            let (from, to) = (cells_of(&wish.from), cells_of(&wish.to));
            for _ in 0..wish.rounds {
                // Another pair of places if there is no way between these.
                let mut draw = |cells: &[usize]| cells[rng.random_range(0..cells.len())];
                let found = (0..4).find_map(|_| net.round(draw(&from), draw(&to)));
                let Some((steps, there)) = found else { break };
                net.take(&steps, &mut rounds.connections);
                rounds.found.push(Round { goal, steps: steps.into_iter().map(|s| (s.cell, s.input)).collect(), there });
            }
        }
        rounds
    }

    /// The connections that a cell must have.
    pub(super) fn of_cell(&self, cell: usize) -> &Connections {
        self.connections.get(&cell).map_or(&[], Vec::as_slice)
    }

    /// What became of `goals`, in words, where that is not what they ask for; by the patch of every cell.
    pub(super) fn notes<'a>(&self, goals: &[Goal], patch: impl Fn(usize) -> &'a CrowdPatch) -> Vec<String> {
        let kept = |step: &(usize, usize)| holds(patch(step.0), self.of_cell(step.0));
        let note = |(goal, wish): (usize, &Goal)| {
            let found = self.found.iter().filter(|round| round.goal == goal);
            let kept = found.filter(|round| round.steps.iter().all(kept)).count();
            let text = format!("goal {}: {kept} of {} rounds have a way there and back", goal + 1, wish.rounds);
            (kept < wish.rounds).then_some(text)
        };
        goals.iter().enumerate().filter_map(note).collect()
    }
}

/// What is wrong with goals on `ground`, if anything: which, and what.
pub(super) fn goal_problem(
    goals: &[Goal],
    ground: &str,
    cells_of: impl Fn(&Spot) -> Vec<usize>,
) -> Option<(usize, String)> {
    let odd = |spot: &Spot| cells_of(spot).is_empty().then(|| format!("expected a place on {ground}, found {spot:?}"));
    goals.iter().enumerate().find_map(|(index, goal)| {
        let problem = odd(&goal.from).or_else(|| odd(&goal.to));
        Some((index, problem?))
    })
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
        Ok(Rounds::find(&self.goals, self.seed, |spot| self.cells_of(spot), self.net()?))
    }

    /// All crossings of the map. None leads over its border, so that rounds come back to where they began also where the map
    /// repeats.
    fn net(&self) -> Result<Net> {
        let (columns, rows) = self.size();
        let beyond = |cell: usize, edge: usize| {
            let (column, row) = (cell % columns, cell / columns);
            let other = match edge {
                0 if row > 0 => cell - columns,
                1 if column + 1 < columns => cell + 1,
                2 if row + 1 < rows => cell + columns,
                3 if column > 0 => cell - 1,
                _ => return None,
            };
            Some((other, (edge + 2) % 4))
        };
        let all = || 0..columns * rows;
        let frames =
            all().map(|cell| self.frame(cell % columns, cell / columns)).collect::<Result<Vec<FramePatch>>>()?;
        let beyond = all().map(|cell| (0..4).map(|edge| beyond(cell, edge)).collect()).collect();
        let single = |cell: usize| self.repeats_of(self.cells[cell / columns][cell % columns]) == 1;
        Ok(Net::new(frames, beyond, all().map(single).collect()))
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
        goal_problem(&self.goals, "the map", |spot| self.cells_of(spot))
    }
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
