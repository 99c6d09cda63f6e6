//! Cells become patches: furnished, solved in parallel, calmed where no way is found, joined and baked.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::Area;
use super::cells::Cell;
use super::patterns::{Border, borders, calm};
use crate::stage::World;
use crate::stage::world::{Identities, Link, TemplateInfo, UNITS_PER_METRE, WalkLimits, WorldInfo, mix};
use crate::world::{CrowdPatch, FramePatch, Limits, Options, Pattern, Placement, bake, solve};
use crate::{Error, Result};

/// Rounds of calming borders; in the last all people of those left give up.
const ROUNDS: u32 = 6;

pub(super) fn world(
    area: &Area,
    name: &str,
    cells: &[Cell],
    notes: &mut Vec<String>,
    progress: &(dyn Fn(usize, usize) -> bool + Sync),
) -> Result<World> {
    let mut borders = borders(area, cells);
    let mut patches: Vec<Option<CrowdPatch>> = vec![None; cells.len()];
    let mut calmed = BTreeSet::new();
    for round in 0..=ROUNDS {
        let frames = frames(area, cells, &borders);
        solve_missing(area, cells, frames, &mut patches, round, progress)?;
        let left: Vec<usize> = (0..cells.len()).filter(|&cell| patches[cell].is_none()).collect();
        if left.is_empty() {
            break;
        }
        for border in borders.iter_mut().filter(|b| left.contains(&b.first.0) || left.contains(&b.second.0)) {
            border.calm = if round + 2 >= ROUNDS { 20 } else { border.calm };
            calm(area, cells, border);
            calmed.insert(border.first);
            (patches[border.first.0], patches[border.second.0]) = (None, None);
        }
    }
    if !calmed.is_empty() {
        notes.push(format!("fewer people than wished for cross {} of {} borders", calmed.len(), borders.len()));
    }
    let quiet = borders.iter().filter(|b| b.pattern.is_empty()).count();
    if quiet > 0 {
        notes.push(format!("nobody crosses {quiet} of {} borders: too short, or corners too sharp", borders.len()));
    }
    let patches: Option<Vec<CrowdPatch>> = patches.into_iter().collect();
    let patches = patches.ok_or_else(|| Error::invalid("area", "cells", "expected a way through every cell"))?;
    baked(area, name, cells, &patches)
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

fn solve_missing(
    area: &Area,
    cells: &[Cell],
    frames: Vec<FramePatch>,
    patches: &mut [Option<CrowdPatch>],
    round: u32,
    progress: &(dyn Fn(usize, usize) -> bool + Sync),
) -> Result<()> {
    let (total, done) = (frames.len(), AtomicUsize::new(patches.iter().flatten().count()));
    let missing: Vec<(usize, FramePatch)> =
        frames.into_iter().enumerate().filter(|(i, _)| patches[*i].is_none()).collect();
    let solved: Result<Vec<(usize, Option<CrowdPatch>)>> = missing
        .into_par_iter()
        .map(|(index, frame)| {
            let patch = patch(area, cells[index].template, index, frame, round);
            let done = done.fetch_add(usize::from(patch.is_some()), Ordering::Relaxed) + 1;
            if progress(done.min(total), total) { Ok((index, patch)) } else { Err(Error::Stopped) }
        })
        .collect();
    for (index, patch) in solved? {
        patches[index] = patch;
    }
    Ok(())
}

/// A cell filled with walkers: with objects if that can be, else without.
fn patch(area: &Area, template: usize, index: usize, bare: FramePatch, round: u32) -> Option<CrowdPatch> {
    let limits = Limits::default();
    if bare.patterns.iter().all(Pattern::is_empty) && !bare.problems(&limits).is_empty() {
        // A sliver that nobody crosses needs no way.
        return Some(CrowdPatch { frame: bare, walkers: Vec::new() });
    }
    let seed = mix(mix(area.seed, index as u64), u64::from(round));
    for attempt in 0..3 {
        let mut frame = bare.clone();
        if attempt < 2 {
            area.templates[template].furnish(&mut frame, &limits, &mut ChaCha8Rng::seed_from_u64(mix(seed, attempt)));
        }
        let options = Options { seed: mix(seed, !attempt), restarts: 8, ..Options::default() };
        if let Some(solution) = solve(&frame, &limits, &options).ok().filter(super::super::Solution::ok) {
            return Some(solution.patch);
        }
    }
    None
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
