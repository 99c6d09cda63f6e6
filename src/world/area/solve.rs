//! Cells become patches: furnished, solved in any order, calmed where no way is found, joined and baked.

use std::collections::BTreeSet;

use glam::DVec2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::cells::{self, Cell};
use super::patterns::{Border, borders, calm};
use super::{Area, Built, repair};
use crate::stage::World;
use crate::stage::world::{Identities, Link, TemplateInfo, UNITS_PER_METRE, WalkLimits, WorldInfo, mix};
use crate::world::goal::{Net, goal_problem};
use crate::world::goal_solve::{Connections, solve_with};
use crate::world::{CrowdPatch, FramePatch, Limits, Options, Pattern, Placement, Rounds, Spot, bake};
use crate::{Error, Result};

/// Rounds of calming borders; in the last all people of those left give up.
const ROUNDS: u32 = 6;

/// The cells of an area on their way to patches, round by round: borders of cells that find no way get calmer, and the cells on
/// both their sides are solved again. When all have ways, those that people with a goal pass are solved once more. All of it
/// follows from the area and from which cells failed in which round.
#[derive(Clone, Debug)]
pub(in crate::world) struct Works {
    cells: Vec<Cell>,
    borders: Vec<Border>,
    frames: Vec<FramePatch>,
    calmed: BTreeSet<(usize, usize)>,
    notes: Vec<String>,
    round: u32,
    /// The round in which every cell was solved the last time.
    solved_in: Vec<u32>,
    /// Rounds of people with a goal, once they are known.
    rounds: Option<Rounds>,
}

impl Works {
    /// Repairs and cuts the ground.
    pub fn new(area: &Area) -> Result<Self> {
        let mut notes = area.notes.clone();
        let walkable = repair::repair(&area.grounds, area.side.into(), &mut notes)?;
        let cells = cells::cut(&walkable, area.side.into(), &mut notes)?;
        if let Some((goal, problem)) = goal_problem(&area.goals, "the ground", |spot| cells_of(area, &cells, spot)) {
            return Err(Error::invalid("area", format!("goal {}", goal + 1), problem));
        }
        let borders = borders(area, &cells);
        let frames = frames(area, &cells, &borders);
        let solved_in = vec![0; cells.len()];
        Ok(Self { cells, borders, frames, calmed: BTreeSet::new(), notes, round: 0, solved_in, rounds: None })
    }

    /// Every cell with its present patterns, without objects.
    pub fn frames(&self) -> &[FramePatch] {
        &self.frames
    }

    /// The patch of a cell; none if no way is found. A cell without a way for people with a goal stays as it was.
    pub fn solve(&self, area: &Area, cell: usize) -> Option<CrowdPatch> {
        let given = self.rounds.as_ref().map_or(&[][..], |rounds| rounds.of_cell(cell));
        let seed = mix(mix(area.seed, cell as u64), u64::from(self.solved_in[cell]));
        let patch = |connections| patch(area, self.cells[cell].template, &self.frames[cell], connections, seed);
        Some(given).filter(|given| !given.is_empty()).and_then(patch).or_else(|| patch(&[]))
    }

    /// Ends a round in which some cells failed. Returns the cells of the next.
    pub fn next(&mut self, area: &Area, failed: &[usize]) -> Result<Vec<usize>> {
        if failed.is_empty() {
            return Ok(self.send_on_rounds(area));
        }
        if self.round == ROUNDS {
            return Err(Error::invalid("area", "cells", "expected a way through every cell"));
        }
        let mut again: BTreeSet<usize> = failed.iter().copied().collect();
        let touched = |border: &&mut Border| failed.contains(&border.first.0) || failed.contains(&border.second.0);
        for border in self.borders.iter_mut().filter(touched) {
            border.calm = if self.round + 2 >= ROUNDS { 20 } else { border.calm };
            calm(area, &self.cells, border);
            self.calmed.insert(border.first);
            again.extend([border.first.0, border.second.0]);
        }
        self.frames = frames(area, &self.cells, &self.borders);
        self.round += 1;
        again.iter().for_each(|&cell| self.solved_in[cell] = self.round);
        Ok(again.into_iter().collect())
    }

    /// Chooses the rounds of people with a goal, when all patterns are settled. Returns the cells that they pass.
    fn send_on_rounds(&mut self, area: &Area) -> Vec<usize> {
        if area.goals.is_empty() || self.rounds.is_some() {
            return Vec::new();
        }
        let beyond = self.cells.iter().map(|cell| cell.beyond.clone()).collect();
        let net = Net::new(self.frames.clone(), beyond, vec![true; self.cells.len()]);
        let rounds = Rounds::find(&area.goals, area.seed, |spot| cells_of(area, &self.cells, spot), net);
        let passed = rounds.connections.keys().copied().collect();
        self.rounds = Some(rounds);
        passed
    }

    /// The world of all patches.
    pub fn bake(mut self, area: &Area, name: &str, patches: &[CrowdPatch]) -> Result<Built> {
        let borders = self.borders.len();
        if !self.calmed.is_empty() {
            self.notes.push(format!("fewer people than wished for cross {} of {borders} borders", self.calmed.len()));
        }
        let quiet = self.borders.iter().filter(|b| b.pattern.is_empty()).count();
        if quiet > 0 {
            self.notes.push(format!("nobody crosses {quiet} of {borders} borders: too short, or corners too sharp"));
        }
        if let Some(rounds) = &self.rounds {
            self.notes.extend(rounds.notes(&area.goals, |cell| &patches[cell]));
        }
        Ok(Built { world: baked(area, name, &self.cells, patches)?, notes: self.notes })
    }
}

/// Middle of a cell: the origin of its frame, on whole units.
fn origin(cell: &Cell) -> DVec2 {
    let mean = cell.corners.iter().sum::<DVec2>() / cell.corners.len() as f64;
    (mean * UNITS_PER_METRE).round() / UNITS_PER_METRE
}

/// Every cell with the patterns of its borders, without objects.
fn frames(area: &Area, cells: &[Cell], borders: &[Border]) -> Vec<FramePatch> {
    let frame = |cell: &Cell| {
        let outline: Vec<_> = cell.corners.iter().map(|&p| (p - origin(cell)).as_vec2()).collect();
        let side = |i: usize| outline[i].distance(outline[(i + 1) % outline.len()]);
        let patterns = (0..outline.len()).map(|i| Pattern::empty(side(i), area.period)).collect();
        FramePatch { outline, patterns, objects: Vec::new(), people: Vec::new() }
    };
    let mut frames: Vec<FramePatch> = cells.iter().map(frame).collect();
    for border in borders {
        frames[border.first.0].patterns[border.first.1] = border.pattern.clone();
        frames[border.second.0].patterns[border.second.1] = border.pattern.mirror();
    }
    frames
}

/// Cells of a place.
fn cells_of(area: &Area, cells: &[Cell], spot: &Spot) -> Vec<usize> {
    let fits = |cell: &Cell| match spot {
        Spot::Template(name) => area.templates[cell.template].name == *name,
        Spot::At(place) => cell.contains(place.as_dvec2()),
    };
    (0..cells.len()).filter(|&index| fits(&cells[index])).collect()
}

/// A cell filled with walkers, some of whose ways are given: with objects if that can be, else without.
fn patch(area: &Area, template: usize, bare: &FramePatch, connections: &Connections, seed: u64) -> Option<CrowdPatch> {
    let limits = Limits::default();
    if bare.patterns.iter().all(Pattern::is_empty) && !bare.problems(&limits).is_empty() {
        // A sliver that nobody crosses needs no way.
        return Some(CrowdPatch { frame: bare.clone(), walkers: Vec::new() });
    }
    let solved = |attempt: u64| {
        let mut frame = bare.clone();
        if attempt < 2 {
            area.templates[template].furnish(&mut frame, &limits, &mut ChaCha8Rng::seed_from_u64(mix(seed, attempt)));
        }
        let options = Options { seed: mix(seed, !attempt), restarts: 8, ..Options::default() };
        solve_with(&frame, connections, &limits, &options).ok().flatten()
    };
    (0..3).find_map(solved)
}

/// Who goes where: the same crossing of the mirrored pattern.
fn links(cells: &[Cell], patches: &[CrowdPatch]) -> Vec<Option<Link>> {
    let first: Vec<usize> = patches
        .iter()
        .scan(0, |sum, patch| {
            let begin = *sum;
            *sum += patch.walkers.len();
            Some(begin)
        })
        .collect();
    let mut links = Vec::new();
    for (cell, patch) in cells.iter().zip(patches) {
        for walker in &patch.walkers {
            links.push(cell.beyond[walker.output.edge].map(|(other, edge)| {
                let before: usize = patches[other].frame.patterns[..edge].iter().map(|p| p.inputs.len()).sum();
                Link { to: first[other] + before + walker.output.index, laps: walker.laps, shift: [0, 0] }
            }));
        }
    }
    links
}

fn baked(area: &Area, name: &str, cells: &[Cell], patches: &[CrowdPatch]) -> Result<World> {
    let info = WorldInfo {
        name: name.into(),
        seed: area.seed,
        limits: WalkLimits::from(&Limits::default()),
        templates: area
            .templates
            .iter()
            .map(|t| TemplateInfo { name: t.name.clone(), ground: t.ground.clone() })
            .collect(),
        ..WorldInfo::default()
    };
    let kinds: Vec<(&CrowdPatch, u32)> = patches.iter().zip(cells).map(|(p, cell)| (p, cell.template as u32)).collect();
    let place = |(kind, cell): (usize, &Cell)| Placement { kind, origin: origin(cell), turn: 0.0 };
    let placements: Vec<Placement> = cells.iter().enumerate().map(place).collect();
    bake(info, &kinds, &placements, Identities::new(&links(cells, patches)))
}
