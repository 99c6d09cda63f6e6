//! Worlds from templates, checked by what shares no code with their solver.

use std::collections::{HashMap, HashSet};

use crowdquilt::check::world::{Placed, check_patch, check_tiles};
use crowdquilt::world::{Amount, Lattice, Limits, PatternType, Person, Plan, Prototype, Stream, Template, scenes};
use glam::Vec2;

fn assert_right(plan: &Plan, lattice: &Lattice) -> (f64, usize, usize) {
    let (columns, rows) = plan.size();
    let cells = (0..rows).flat_map(|z| (0..columns).map(move |x| [x as i64, z as i64]));
    let tiles: Vec<Placed> = cells
        .map(|cell| Placed {
            patch: lattice.patch(cell),
            origin: Vec2::new(cell[0] as f32, cell[1] as f32) * plan.side,
        })
        .collect();
    for tile in &tiles {
        let report = check_patch(tile.patch, &Limits::default());
        assert!(report.ok(), "at {}: {:?}", tile.origin, report.violations);
    }
    let torus = plan.endless.then(|| Vec2::new(columns as f32, rows as f32) * plan.side);
    let report = check_tiles(&tiles, torus, &Limits::default());
    assert!(report.ok(), "{:?}", report.violations);
    let objects = tiles.iter().map(|t| t.patch.frame.objects.len()).sum();
    (report.people, tiles.iter().map(|t| t.patch.frame.people.len()).sum(), objects)
}

#[test]
fn the_city_of_the_paper_is_as_populated_and_right() {
    let plan = scenes::city(32, false, 1).unwrap();
    let lattice = plan.build().unwrap();
    let (walkers, standing, objects) = assert_right(&plan, &lattice);
    assert!((2_000.0..3_000.0).contains(&walkers), "{walkers} walkers");
    assert!((120..240).contains(&standing), "{standing} endogenous people");
    assert!((200..400).contains(&objects), "{objects} static objects");
}

#[test]
fn the_street_of_the_paper_is_right_and_made_alike_in_any_order() {
    let plan = scenes::street(3).unwrap();
    let lattice = plan.build().unwrap();
    assert_right(&plan, &lattice);
    let (columns, rows) = plan.size();
    for index in (0..columns * rows).rev().step_by(7) {
        let (column, row) = (index % columns, index / columns);
        assert!(plan.patch(column, row).unwrap() == *lattice.patch([column as i64, row as i64]));
    }
    let patterns: HashSet<String> = (0..columns * rows)
        .flat_map(|i| lattice.patch([(i % columns) as i64, (i / columns) as i64]).frame.patterns.clone())
        .map(|p| format!("{p:?}"))
        .collect();
    // Ten: three of each of three types with their mirrors, and the empty one.
    assert_eq!(patterns.len(), 2 * 9 + 1);
}

#[test]
fn an_endless_street_is_the_same_when_one_comes_back_and_needs_no_more_memory() {
    let mut stream = Stream::new(scenes::street(5).unwrap()).unwrap();
    let far = 1_000_000_000_000;
    let here = |stream: &Stream| -> HashMap<[i64; 2], String> {
        stream.cells().map(|(cell, patch)| (*cell, format!("{patch:?}"))).collect()
    };
    assert_eq!(stream.look([far, 1], 2, usize::MAX), 0);
    let before = here(&stream);
    assert_eq!(before.len(), 25);
    // Away in small steps and back in one.
    for step in 1..8 {
        stream.look([far + step, 1], 2, usize::MAX);
        assert_eq!(stream.cells().count(), 25);
    }
    stream.look([far, 1], 2, usize::MAX);
    assert!(before == here(&stream));
    // Copies of the same cell differ.
    let (columns, _) = scenes::street(5).unwrap().size();
    let copies: HashSet<String> = (0..5).map(|copy| format!("{:?}", stream.make([copy * columns as i64, 1]))).collect();
    assert_eq!(copies.len(), 5);
}

#[test]
fn an_endless_street_has_no_seams_between_its_copies() {
    let plan = scenes::street(5).unwrap();
    let mut stream = Stream::new(plan.clone()).unwrap();
    let start = 16 * 1_000 - 4;
    stream.look([start, 1], 4, usize::MAX);
    let tiles: Vec<Placed> = stream
        .cells()
        .map(|(cell, patch)| Placed { patch, origin: Vec2::new((cell[0] - start) as f32, cell[1] as f32) * plan.side })
        .collect();
    let report = check_tiles(&tiles, None, &Limits::default());
    assert!(report.ok(), "{:?}", report.violations);
    assert!(report.crossings > 300, "{}", report.crossings);
    // Everybody is there once, and who stays in the window is the same person a moment later.
    let people = |time: f64| -> HashMap<Person, ([i64; 2], Vec2)> {
        let all: Vec<_> = stream.people(time).collect();
        let map: HashMap<_, _> = all.iter().map(|s| (s.person, (s.cell, s.place))).collect();
        assert_eq!(map.len(), all.len());
        map
    };
    let (now, later) = (people(1e6), people(1e6 + 0.05));
    let stayed = now.keys().filter(|person| later.contains_key(person)).count();
    assert!(stayed * 100 >= now.len() * 97, "{stayed} of {}", now.len());
    for (person, (cell, place)) in &now {
        let Some((next, there)) = later.get(person) else { continue };
        let step = Vec2::new((next[0] - cell[0]) as f32, (next[1] - cell[1]) as f32) * plan.side;
        assert!((*there + step).distance(*place) < 0.11);
    }
}

#[test]
fn maps_that_make_no_sense_are_refused_with_the_place() {
    let street = || Template::new("street", "stone").bordered("street", PatternType::mixed(1, 1));
    let fault = |map: &str, template: Template| {
        Plan::from_text(map, vec![('s', template)]).and_then(|plan| plan.build().map(|_| ())).unwrap_err().to_string()
    };
    let found = fault("ss\nsx", street());
    assert!(found.contains("line 2, column 2") && found.contains("found 'x'"), "{found}");
    let found = fault("ss\ns", street());
    assert!(found.contains("row 1") && found.contains("expected 1 cells"), "{found}");
    let found = fault("", street());
    assert!(found.contains("at least one cell"), "{found}");
    let found = fault("ss", street().bordered("moon", PatternType::empty()));
    assert!(found.contains("template \"street\"") && found.contains("\"moon\""), "{found}");
    let found = fault("s", street().furnished("tree", Prototype::Disc(-1.0), Amount::Number(1, 1)));
    assert!(found.contains("furnishing \"tree\"") && found.contains("radius above zero"), "{found}");
    let found = fault("s", street().furnished("tree", Prototype::Disc(0.1), Amount::Density(f32::NAN)));
    assert!(found.contains("furnishing \"tree\"") && found.contains("density"), "{found}");
    let found = fault("s", street().gathered("talk", (3, 1_000_000), Amount::Number(1, 1)));
    assert!(found.contains("gathering \"talk\"") && found.contains("sizes up to 12"), "{found}");
    let found = fault("s", street().bordered("street", PatternType::door(1, 1, -0.5, 0.5)));
    assert!(found.contains("border to \"street\"") && found.contains("fractions"), "{found}");
    let found = fault("ss", Template::new("street", "stone").bordered("street", PatternType::one_way_in(2)));
    assert!(found.contains("column 0, row 0") && found.contains("as many inputs as outputs"), "{found}");
    let found = fault("ss", Template::new("street", "stone").bordered("street", PatternType::mixed(300, 300)));
    assert!(found.contains("room for 600 crossings"), "{found}");
}
