//! Crowd patches, checked by what shares no code with their solver.

use crowdquilt::check::world::{Placed, check_patch, check_tiles};
use crowdquilt::world::{
    Common, CrowdPatch, FramePatch, Lattice, Limits, Method, Options, Pattern, PatternType, Shape, StaticObject, solve,
    vary,
};
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
#[ignore = "half a minute"]
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
fn convex_polygons_of_all_kinds_are_right() {
    let limits = Limits::default();
    for corners in 3..=8 {
        for seed in 0..12 {
            let angle = |i: usize| i as f32 * std::f32::consts::TAU / corners as f32;
            // Stretched, so that corners differ.
            let radius = 8.0 + seed as f32 * 0.5;
            let outline =
                (0..corners).map(|i| Vec2::from_angle(angle(i) + 0.1) * Vec2::new(1.25, 1.0) * radius).collect();
            let types = vec![PatternType::mixed(2, 2); corners];
            let mut frame = FramePatch::random(outline, 7.0 + seed as f32, &types, &limits, seed).unwrap();
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            for _ in 0..4 {
                let size = Vec2::new(2.0, 0.6);
                frame.scatter_object("bench", |at, angle| Shape::oblong(at, size, angle), &limits, &mut rng);
            }
            frame.scatter_person("stand", 0.4, &limits, &mut rng);
            let report = check_patch(&solved(&frame, seed), &limits);
            assert!(report.ok(), "{corners} corners, seed {seed}: {:?}", report.violations);
        }
    }
}

fn square() -> FramePatch {
    FramePatch::random_square(8.0, 10.0, &[PatternType::mixed(2, 2); 4], 1).unwrap()
}

fn refused(change: impl FnOnce(&mut FramePatch)) -> String {
    let mut frame = square();
    change(&mut frame);
    solve(&frame, &Limits::default(), &Options::default()).unwrap_err().to_string()
}

#[test]
fn frames_nobody_can_solve_are_refused_with_the_place() {
    let tree = |x: f32, z: f32| StaticObject { name: "tree".into(), shape: Shape::disc(Vec2::new(x, z), 0.5) };
    let cases = [
        (refused(|f| f.outline.truncate(2)), "at least 3 corners"),
        (refused(|f| f.outline.reverse()), "counter-clockwise"),
        (refused(|f| f.outline[2] = Vec2::new(1.0, 1.0)), "convex"),
        (refused(|f| f.outline[2] = Vec2::new(f32::NAN, 1.0)), "corner 2 is not a finite point"),
        (refused(|f| f.outline.iter_mut().for_each(|p| *p *= 0.0)), "distinct corners"),
        (refused(|f| f.outline.iter_mut().for_each(|p| *p += 1e9)), "corners"),
        (refused(|f| f.patterns.truncate(3)), "a pattern for each of 4 edges, found 3"),
        (refused(|f| f.patterns[1].length = 7.0), "edge 1: expected a pattern of length 8 m, found 7"),
        (refused(|f| f.patterns[1].period = 11.0), "edge 1: expected period 10 s, found 11"),
        (refused(|f| f.patterns.iter_mut().for_each(|p| p.period = 1e9)), "expected a period from 2 to 300 s"),
        (refused(|f| f.patterns[2].inputs[0].across = 0.0), "edge 2: input 0"),
        (refused(|f| f.patterns[2].inputs[0].across = 0.1), "m/s across"),
        (refused(|f| f.patterns[0].inputs[1] = f.patterns[0].inputs[0]), "edge 0: expected walkers 0.6 m apart"),
        (refused(|f| f.patterns[3].inputs.truncate(1)), "as many inputs as outputs, found 7 and 8"),
        (refused(|f| f.objects.push(tree(8.0, 4.0))), "object \"tree\": expected it inside the outline"),
        (refused(|f| f.objects.push(tree(f32::INFINITY, 4.0))), "object \"tree\": expected a finite centre"),
    ];
    for (found, expected) in cases {
        assert!(found.contains(expected), "expected {expected:?} in {found:?}");
    }
    let place = square().patterns[0].inputs[0].place;
    assert!(refused(|f| f.objects.push(tree(place, 0.6))).contains("off the crossings of edge 0"));
}

#[test]
fn the_particles_of_the_paper_collide() {
    let free = (0..40).filter(|&seed| {
        let frame = FramePatch::sample(16, seed).unwrap();
        let options = Options { seed, method: Method::Particles, ..Options::default() };
        let patch = solve(&frame, &Limits::default(), &options).unwrap().patch;
        check_patch(&patch, &Limits::default()).collision_free(&Limits::default())
    });
    assert!(free.count() < 10);
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

#[test]
fn versions_with_the_same_state_can_follow_each_other() {
    let limits = Limits::default();
    for seed in 0..40 {
        let frame = FramePatch::sample(16, seed).unwrap();
        let base = solved(&frame, seed);
        let version = vary(&base, &frame, Common::State, &limits, &Options { seed, ..Options::default() }).unwrap();
        assert!(version.ok(), "seed {seed}: {:?}", version.bad);
        assert!(check_patch(&version.patch, &limits).ok());
        let mut differ = 0;
        for (a, b) in base.walkers.iter().zip(&version.patch.walkers) {
            assert_eq!((a.input, a.output, a.laps), (b.input, b.output, b.laps));
            let (begin, end) = a.path.span();
            for lap in (begin / 10.0).ceil() as i32..=(end / 10.0).floor() as i32 {
                let time = f64::from(lap) * 10.0;
                assert!(a.path.position(time).distance(b.path.position(time)) < 1e-5);
                assert!(a.path.velocity(time).distance(b.path.velocity(time)) < 1e-4);
                assert!(a.path.acceleration(time).distance(b.path.acceleration(time)) < 1e-3);
            }
            differ += usize::from(a.path.points.iter().zip(&b.path.points).any(|(p, q)| p.distance(*q) > 0.1));
        }
        assert!(differ > 4, "only {differ} of 16 walkers go another way");
    }
}

#[test]
fn other_objects_leave_connections_as_they_are() {
    let limits = Limits::default();
    let mut solved_versions = 0;
    for seed in 0..40 {
        let frame = FramePatch::sample(12, seed).unwrap();
        let base = solved(&frame, seed);
        let mut other = FramePatch { objects: Vec::new(), people: Vec::new(), ..frame };
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        other.scatter_object("tree", |at, _| Shape::disc(at, 0.3), &limits, &mut rng);
        let version =
            vary(&base, &other, Common::Connections, &limits, &Options { seed, ..Options::default() }).unwrap();
        if version.ok() {
            solved_versions += 1;
            assert!(check_patch(&version.patch, &limits).ok());
            let ends =
                |patch: &CrowdPatch| patch.walkers.iter().map(|w| (w.input, w.output, w.laps)).collect::<Vec<_>>();
            assert_eq!(ends(&base), ends(&version.patch));
        }
    }
    assert!(solved_versions >= 38, "{solved_versions} of 40");
}
