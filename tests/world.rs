//! Crowd patches, checked by what shares no code with their solver.

use crowdquilt::check::world::{Placed, check_patch, check_tiles};
use crowdquilt::world::{CrowdPatch, FramePatch, Lattice, Limits, Options, Pattern, PatternType, solve};
use glam::Vec2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

fn solved(frame: &FramePatch, seed: u64) -> CrowdPatch {
    let options = Options { seed, ..Options::default() };
    let solution = solve(frame, &Limits::default(), &options).unwrap();
    assert!(solution.ok(), "seed {seed}: walkers {:?} are stuck", solution.bad);
    solution.patch
}

fn assert_right(n: usize, seeds: std::ops::Range<u64>) {
    let violations: Vec<String> = seeds
        .into_par_iter()
        .flat_map_iter(|seed| {
            let frame = FramePatch::sample(n, seed).unwrap();
            let report = check_patch(&solved(&frame, seed), &Limits::default());
            report.violations.into_iter().map(move |v| format!("seed {seed}: {v}"))
        })
        .collect();
    assert!(
        violations.is_empty(),
        "{} violations, the first: {:?}",
        violations.len(),
        &violations[..violations.len().min(8)]
    );
}

#[test]
fn a_thousand_patches_of_sixteen_walkers_are_right() {
    assert_right(16, 0..1_000);
}

#[test]
#[ignore = "a minute"]
fn ten_thousand_patches_of_sixteen_walkers_are_right() {
    assert_right(16, 10_000..20_000);
}

#[test]
fn small_and_dense_patches_are_right() {
    assert_right(4, 0..100);
    assert_right(8, 0..100);
    assert_right(30, 0..60);
}

#[test]
fn the_same_seed_gives_the_same_patch_and_another_seed_another_version() {
    let frame = FramePatch::sample(16, 7).unwrap();
    assert!(solved(&frame, 1) == solved(&frame, 1));
    let (first, second) = (solved(&frame, 1), solved(&frame, 2));
    assert_eq!(first.frame, second.frame);
    assert!(first.walkers != second.walkers);
}

/// Tiles of a torus whose borders carry random patterns and their mirrors.
fn torus(side: usize, per_border: usize) -> Vec<CrowdPatch> {
    let (length, period) = (8.0, 10.0);
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let kind = PatternType::mixed(per_border, per_border);
    let mut pattern = || kind.generate(length, period, &Limits::default(), &mut rng).unwrap();
    // Borders to the right of and above every tile.
    let right: Vec<Pattern> = (0..side * side).map(|_| pattern()).collect();
    let above: Vec<Pattern> = (0..side * side).map(|_| pattern()).collect();
    let at = |x: usize, z: usize| (z % side) * side + x % side;
    (0..side * side)
        .into_par_iter()
        .map(|tile| {
            let (x, z) = (tile % side, tile / side);
            let patterns = vec![
                above[at(x, z + side - 1)].mirror(),
                right[tile].clone(),
                above[tile].clone(),
                right[at(x + side - 1, z)].mirror(),
            ];
            let outline = [(0.0, 0.0), (length, 0.0), (length, length), (0.0, length)];
            let outline = outline.map(|(x, z)| Vec2::new(x, z)).to_vec();
            solved(&FramePatch { outline, patterns, objects: Vec::new(), people: Vec::new() }, tile as u64)
        })
        .collect()
}

#[test]
fn nobody_touches_across_borders_on_a_torus() {
    let side = 16;
    let patches = torus(side, 4);
    let origin = |tile: usize| Vec2::new((tile % side) as f32, (tile / side) as f32) * 8.0;
    let tiles: Vec<Placed> = patches.iter().enumerate().map(|(i, patch)| Placed { patch, origin: origin(i) }).collect();
    let report = check_tiles(&tiles, Some(Vec2::splat(8.0 * side as f32)), &Limits::default());
    assert_eq!(report.violations, Vec::<String>::new());
    assert_eq!(report.crossings, side * side * 16);
    assert!(report.closest >= 0.5 && report.closest < 0.6, "{}", report.closest);
    assert!(report.people > 2_000.0, "{}", report.people);
}

#[test]
fn walkers_keep_place_speed_and_identity_over_ten_thousand_crossings() {
    let lattice = Lattice::new(4, 4, Vec2::splat(8.0), torus(4, 4)).unwrap();
    for walker in 0..lattice.patch([0, 0]).walkers.len() {
        let (mut cell, mut walker, mut period) = ([0_i64, 0], walker, -3_i64);
        let who = lattice.person(cell, walker, period);
        for _ in 0..10_000 {
            let here = &lattice.patch(cell).walkers[walker];
            let leave = lattice.patch(cell).presence(here).1;
            let (next_cell, next_walker, laps) = lattice.next(cell, walker);
            let there = &lattice.patch(next_cell).walkers[next_walker];
            let enter = lattice.patch(next_cell).presence(there).0;
            assert!((leave - f64::from(laps) * 10.0 - enter).abs() < 1e-4);
            let step = Vec2::new((next_cell[0] - cell[0]) as f32, (next_cell[1] - cell[1]) as f32) * 8.0;
            let gap = here.path.position(leave).distance(there.path.position(enter) + step);
            assert!(gap < 1e-3, "{gap} m");
            assert!(here.path.velocity(leave).distance(there.path.velocity(enter)) < 0.1);
            (cell, walker, period) = (next_cell, next_walker, period + i64::from(laps));
            assert_eq!(lattice.person(cell, walker, period), who);
        }
    }
}

#[test]
fn everybody_is_somebody_else_and_stays_at_any_time() {
    let lattice = Lattice::new(4, 4, Vec2::splat(8.0), torus(4, 4)).unwrap();
    let all = |time: f64| -> Vec<_> {
        let cells = (-6..6).flat_map(|x| (-6..6).map(move |z| [x + 1_000_000_000, z]));
        cells.flat_map(|cell| lattice.people(cell, time).collect::<Vec<_>>()).collect()
    };
    for time in [-77.7, 0.0, 3_600.0, 1e7 + 0.25] {
        let people = all(time);
        let different: std::collections::HashSet<_> = people.iter().map(|s| s.person).collect();
        assert_eq!(different.len(), people.len());
        // A moment later nearly all are still there, moved by no more than they can walk.
        let later: std::collections::HashMap<_, _> = all(time + 0.1).into_iter().map(|s| (s.person, s)).collect();
        let place = |s: &crowdquilt::world::Sighting| {
            s.place + Vec2::new((s.cell[0] - 1_000_000_000) as f32, s.cell[1] as f32) * 8.0
        };
        let moved: Vec<f32> =
            people.iter().filter_map(|s| Some(place(s).distance(place(later.get(&s.person)?)))).collect();
        assert!(moved.len() * 100 > people.len() * 98, "{} of {}", moved.len(), people.len());
        assert!(moved.iter().all(|&m| m < 0.2), "{moved:?}");
    }
}
