//! Crowd patches, checked by what shares no code with their solver.

use crowdquilt::check::world::{Placed, check_patch, check_tiles};
use crowdquilt::world::{CrowdPatch, FramePatch, Limits, Options, Pattern, PatternType, solve};
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
    assert!(violations.is_empty(), "{} violations, the first: {:?}", violations.len(), &violations[..violations.len().min(8)]);
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
