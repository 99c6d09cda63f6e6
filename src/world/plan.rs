//! Template maps: which template is where, and the world that follows from it.
//!
//! "Crowd Patches" (2009), sections 5.1 and 5.2. Every patch is a function of the plan, the seed and its place alone: patches
//! can be made in any order, by any process, now or when a camera comes near, and are always the same.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::Vec2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::goal_solve::{Connections, solve_with};
use super::lattice::rectangle;
use super::periods::unroll;
use super::survey::Survey;
use super::{Common, CrowdPatch, FramePatch, Goal, Lattice, Limits, Options, Pattern, PatternType, Template, vary};
use crate::stage::world::mix;
use crate::{Error, Result};

/// Attempts to furnish and solve a patch; the last is without objects.
const ATTEMPTS: u64 = 4;

/// A map of templates on a grid of square cells.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// The templates.
    pub templates: Vec<Template>,
    /// Template of every cell, row by row, the first row at z = 0; all rows are as long.
    pub cells: Vec<Vec<usize>>,
    /// Side of a cell, metres.
    #[serde(default = "side")]
    pub side: f32,
    /// Period, seconds.
    #[serde(default = "period")]
    pub period: f32,
    /// Whether the map repeats for ever in both directions; else nobody crosses its outer border.
    #[serde(default)]
    pub endless: bool,
    /// How many patterns there are of each type; few make patches easier to share, many less alike.
    #[serde(default = "patterns")]
    pub patterns: u64,
    /// How many versions there are of patches with the same template and patterns, so that a large world shares a few kinds; 0
    /// if every cell is unlike all others.
    #[serde(default)]
    pub versions: u64,
    /// How often patches of every template repeat in a period; once where nothing is said.
    #[serde(default)]
    pub repeats: Vec<u32>,
    /// Who goes where on purpose.
    #[serde(default)]
    pub goals: Vec<Goal>,
    /// Same seed, same world.
    #[serde(default)]
    pub seed: u64,
}

fn side() -> f32 {
    8.0
}

fn period() -> f32 {
    10.0
}

fn patterns() -> u64 {
    4
}

impl Plan {
    /// A plan from lines of characters, the last line at z = 0 as on a map with z up, by a palette of characters and
    /// templates. Other settings are the defaults.
    ///
    /// # Errors
    /// If a character is not in the palette, or lines differ in length: names line and column.
    pub fn from_text(map: &str, palette: Vec<(char, Template)>) -> Result<Self> {
        let (keys, templates): (Vec<char>, Vec<Template>) = palette.into_iter().unzip();
        let mut cells = Vec::new();
        for (line, text) in map.lines().map(str::trim).filter(|l| !l.is_empty()).enumerate() {
            let find = |(column, c): (usize, char)| {
                keys.iter().position(|&k| k == c).ok_or_else(|| {
                    let place = format!("line {}, column {}", line + 1, column + 1);
                    Error::invalid("map", place, format!("expected one of {keys:?}, found {c:?}"))
                })
            };
            cells.push(text.chars().enumerate().map(find).collect::<Result<Vec<usize>>>()?);
        }
        cells.reverse();
        let plan = Self {
            templates,
            cells,
            side: side(),
            period: period(),
            endless: false,
            patterns: patterns(),
            versions: 0,
            repeats: Vec::new(),
            goals: Vec::new(),
            seed: 0,
        };
        plan.validate()?;
        Ok(plan)
    }

    /// Whether the plan makes sense.
    ///
    /// # Errors
    /// Names the first cell, template or border that does not.
    pub fn validate(&self) -> Result<()> {
        let columns = self.cells.first().map_or(0, Vec::len);
        if columns == 0 {
            return Err(Error::invalid("map", "cells", "expected at least one cell, found none"));
        }
        for (row, cells) in self.cells.iter().enumerate() {
            if cells.len() != columns {
                let problem = format!("expected {columns} cells as in the first row, found {}", cells.len());
                return Err(Error::invalid("map", format!("row {row}"), problem));
            }
            if let Some(bad) = cells.iter().find(|&&t| t >= self.templates.len()) {
                let problem = format!("expected a template below {}, found {bad}", self.templates.len());
                return Err(Error::invalid("map", format!("row {row}"), problem));
            }
        }
        for (index, template) in self.templates.iter().enumerate() {
            let problem = template.problems().into_iter().next().or_else(|| self.repeats_problem(index));
            if let Some(problem) = problem {
                return Err(Error::invalid("map", format!("template {:?}", template.name), problem));
            }
            let known = |name: &&String| self.templates.iter().any(|t| t.name == **name);
            if let Some(name) = template.borders.keys().find(|name| !known(name)) {
                let problem = format!("expected a border to one of the templates, found {name:?}");
                return Err(Error::invalid("map", format!("template {:?}", template.name), problem));
            }
        }
        match self.goal_problem() {
            Some((goal, problem)) => Err(Error::invalid("map", format!("goal {}", goal + 1), problem)),
            None => Ok(()),
        }
    }

    /// Columns and rows.
    pub fn size(&self) -> (usize, usize) {
        (self.cells.first().map_or(0, Vec::len), self.cells.len())
    }

    /// The template at a column and row.
    pub fn template(&self, column: usize, row: usize) -> &Template {
        &self.templates[self.cells[row][column]]
    }

    /// Outline and patterns at a column and row, without objects.
    ///
    /// # Errors
    /// If a pattern finds no room on its border.
    pub fn frame(&self, column: usize, row: usize) -> Result<FramePatch> {
        let (columns, rows) = self.size();
        let (left, below) = ((column + columns - 1) % columns, (row + rows - 1) % rows);
        let patterns = vec![
            self.border(column, below, 2)?.mirror(),
            self.border(column, row, 1)?,
            self.border(column, row, 2)?,
            self.border(left, row, 1)?.mirror(),
        ];
        Ok(FramePatch { outline: rectangle(Vec2::splat(self.side)), patterns, objects: Vec::new(), people: Vec::new() })
    }

    /// The pattern on the right (edge 1) or upper (edge 2) border of a cell, as the cell sees it.
    fn border(&self, column: usize, row: usize, edge: usize) -> Result<Pattern> {
        match self.border_key(column, row, edge) {
            Some(key) => {
                // One of a few patterns of the type, as the template that comes first sees it.
                let [first, second, variant, mirrored] = key;
                let seed = [first, second, variant].into_iter().fold(self.seed, mix);
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                let kind = self.border_type(first as usize, second as usize).unwrap_or(PatternType::empty());
                let times = self.border_repeats(first as usize, second as usize);
                let once = kind.generate(self.side, self.period / times as f32, &Limits::default(), &mut rng)?;
                let pattern = if times == 1 { once } else { once.repeated(times, self.period) };
                Ok(if mirrored == 0 { pattern } else { pattern.mirror() })
            }
            None => Ok(Pattern::empty(self.side, self.period)),
        }
    }

    /// What decides the pattern on a cell's right or upper border: the two templates, which of a few patterns, and whether the cell
    /// sees its mirror image; none if nobody crosses.
    fn border_key(&self, column: usize, row: usize, edge: usize) -> Option<[u64; 4]> {
        let (columns, rows) = self.size();
        let outer = if edge == 1 { column + 1 == columns } else { row + 1 == rows };
        let (right, above) = if edge == 1 { ((column + 1) % columns, row) } else { (column, (row + 1) % rows) };
        let (here, there) = (self.cells[row][column], self.cells[above][right]);
        let place = [edge, column, row].into_iter().fold(self.seed, |hash, part| mix(hash, part as u64));
        self.border_type(here.min(there), here.max(there)).filter(|_| self.endless || !outer)?;
        let [first, second] = [here.min(there), here.max(there)].map(|index| index as u64);
        Some([first, second, place % self.patterns.max(1), u64::from(here > there)])
    }

    /// What decides all of a cell: cells of the same key have the same patch.
    pub(super) fn cell_key(&self, column: usize, row: usize) -> u64 {
        let (columns, rows) = self.size();
        let (left, below) = ((column + columns - 1) % columns, (row + rows - 1) % rows);
        let borders = [(column, below, 2), (column, row, 1), (column, row, 2), (left, row, 1)];
        let borders = borders.map(|(column, row, edge)| self.border_key(column, row, edge));
        let place = mix(mix(self.seed, column as u64), row as u64);
        let template = self.template(column, row);
        let bare = template.furnishings.is_empty() && template.gatherings.is_empty();
        if self.versions == 0 && !(bare && borders.iter().all(Option::is_none)) {
            return place;
        }
        let version = if bare && borders.iter().all(Option::is_none) { 0 } else { place % self.versions };
        let parts = borders.iter().flat_map(|b| b.unwrap_or([u64::MAX; 4]));
        parts.chain([self.cells[row][column] as u64, version]).fold(!self.seed, mix)
    }

    /// Pattern type between two templates, as the first sees it.
    fn border_type(&self, first: usize, second: usize) -> Option<PatternType> {
        let [a, b] = [first, second].map(|index| &self.templates[index]);
        a.borders.get(&b.name).copied().or_else(|| b.borders.get(&a.name).map(PatternType::mirror))
    }

    /// The solved patch at a column and row: a function of the plan and the place. Objects that leave no way through are
    /// placed anew, and left out in the end.
    ///
    /// # Errors
    /// If the patterns have no room, are not balanced, or no way is found even without objects.
    pub fn patch(&self, column: usize, row: usize) -> Result<CrowdPatch> {
        self.connected(column, row, self.rounds()?.of_cell(row * self.size().0 + column))
    }

    /// The same with some connections given; without them if no way is found with them.
    pub(super) fn connected(&self, column: usize, row: usize, connections: &Connections) -> Result<CrowdPatch> {
        let (full, times) = (self.frame(column, row)?, self.repeats_of(self.cells[row][column]));
        let bare = if times == 1 { full.clone() } else { full.once(times) };
        let place =
            connections.iter().fold(self.cell_key(column, row), |hash, c| mix(mix(hash, c.0 as u64), c.1 as u64));
        // Where nobody finds a way to meet, or some are on their way to somewhere, people walk through.
        let meeting = self.template(column, row).meeting.as_ref().filter(|_| times == 1 && connections.is_empty());
        if let Some(patch) = meeting.and_then(|m| m.patch(&bare, &Limits::default(), place)) {
            return Ok(patch);
        }
        let cell = || format!("column {column}, row {row}");
        for given in if connections.is_empty() { vec![connections] } else { vec![connections, &[]] } {
            for attempt in 0..ATTEMPTS {
                let frame = self.furnished(&bare, column, row, mix(place, attempt), attempt + 1 == ATTEMPTS);
                let found = solve_with(&frame, given, &Limits::default(), &self.options(place, attempt))
                    .map_err(|e| Error::invalid("map", cell(), e.to_string()))?;
                if let Some(patch) = found {
                    return Ok(if times == 1 { patch } else { unroll(patch, &full, times) });
                }
            }
        }
        let template = &self.template(column, row).name;
        Err(Error::invalid("map", cell(), format!("expected a way through every patch, found none for {template:?}")))
    }

    /// Another version of `patch` (of the cell at a column and row) for the `copy` of the map: objects and ways differ,
    /// patterns and connections do not. A function of the plan and the place. `patch` itself if no version is found soon.
    pub fn version(&self, patch: &CrowdPatch, column: usize, row: usize, copy: [i64; 2]) -> CrowdPatch {
        if copy == [0, 0] || patch.walkers.iter().all(|w| w.role.is_some()) {
            return patch.clone();
        }
        let place = [column as u64, row as u64, copy[0] as u64, copy[1] as u64].into_iter().fold(!self.seed, mix);
        let mut bare = patch.frame.clone();
        bare.objects.clear();
        bare.people.clear();
        for attempt in 0..3 {
            // In the end other ways past the same objects will do.
            let other = || self.furnished(&bare, column, row, mix(place, attempt), false);
            let (frame, common) =
                if attempt < 2 { (other(), Common::Connections) } else { (patch.frame.clone(), Common::State) };
            let options = Options { restarts: 0, rounds: 3, ..self.options(place, attempt) };
            let version = vary(patch, &frame, common, &Limits::default(), &options);
            if let Some(version) = version.ok().filter(super::Solution::ok) {
                return version.patch;
            }
        }
        patch.clone()
    }

    fn furnished(&self, bare: &FramePatch, column: usize, row: usize, seed: u64, empty: bool) -> FramePatch {
        let mut frame = bare.clone();
        if !empty {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            self.template(column, row).furnish(&mut frame, &Limits::default(), &mut rng);
        }
        frame
    }

    fn options(&self, place: u64, attempt: u64) -> Options {
        Options { seed: mix(place, !attempt), restarts: 12, ..Options::default() }
    }

    /// All patches, joined; on all cores, the result does not depend on their number.
    ///
    /// # Errors
    /// As [`Self::patch`].
    pub fn build(&self) -> Result<Lattice> {
        self.build_watched(&|_, _| true)
    }

    /// The same; `progress` is told how many of how many patches are done, and stops the work by returning false.
    ///
    /// # Errors
    /// As [`Self::patch`], and if it was stopped.
    pub fn build_watched(&self, progress: &(dyn Fn(usize, usize) -> bool + Sync)) -> Result<Lattice> {
        let survey = Survey::new(self)?;
        let done = AtomicUsize::new(0);
        let make = |kind: usize| {
            let patch = survey.solve(self, kind)?;
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            if progress(done, survey.kinds()) { Ok(patch) } else { Err(Error::Stopped) }
        };
        let kinds: Result<Vec<CrowdPatch>> = (0..survey.kinds()).into_par_iter().map(make).collect();
        survey.join(self, kinds?)
    }
}
