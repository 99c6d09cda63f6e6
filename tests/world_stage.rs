//! Baked worlds: what they play is what was solved, at any time, and their files are refused when broken.

use std::collections::HashMap;

use crowdquilt::check::world::check_world;
use crowdquilt::stage::World;
use crowdquilt::stage::world::{Person, Roots, Spot, Tables};
use crowdquilt::world::{Lattice, Plan, scenes};
use glam::DVec2;

fn baked(plan: &Plan) -> (Lattice, World) {
    let lattice = plan.build().unwrap();
    let world = plan.bake("test", &lattice).unwrap();
    (lattice, world)
}

fn small_city() -> Plan {
    Plan { versions: 2, ..scenes::city(16, true, 1).unwrap() }
}

/// A patch of the small city in the middle of a street.
const STREET: usize = 7 * 16 + 3;

/// Everybody at a time, with place and velocity.
fn everybody(world: &World, time: f64) -> HashMap<Person, (DVec2, DVec2)> {
    let moment = world.moment(time);
    let mut roots = Roots::default();
    world.roots(&moment, DVec2::ZERO, &mut roots);
    let people = world.order().flat_map(|i| world.people_of(i, [0, 0], &moment));
    let places = (0..roots.len()).map(|i| {
        let [x, z, vx, vz] = [roots.x(), roots.z(), roots.vx(), roots.vz()].map(|list| f64::from(list[i]));
        (DVec2::new(x, z), DVec2::new(vx, vz))
    });
    let all: HashMap<_, _> = people.zip(places).collect();
    assert_eq!(all.len(), roots.len(), "everybody is somebody else");
    assert_eq!(all.len(), world.walkers(&moment));
    all
}

#[test]
fn a_baked_world_plays_what_was_solved() {
    let (lattice, world) = baked(&small_city());
    assert!(world.kinds() < world.instances() / 2, "{} kinds of {}", world.kinds(), world.instances());
    for time in [0.0, 3.217, 9.999, 10.05, -12.3, 3600.7] {
        let played = everybody(&world, time);
        let mut compared = 0;
        for cell in (0..16).flat_map(|x| (0..16).map(move |z| [x, z])) {
            for seen in lattice.people(cell, time) {
                // Patches hand over at the nearest slot, so who is right on a border may be in another copy by now.
                let Some((place, velocity)) = played.get(&seen.person) else { continue };
                let expected = DVec2::new(cell[0] as f64, cell[1] as f64) * 8.0 + seen.place.as_dvec2();
                let gap = place.distance(expected);
                assert!(gap < 3e-4, "{gap} m off at {time} s");
                assert!(velocity.distance(seen.velocity.as_dvec2()) < 3e-3);
                compared += 1;
            }
        }
        assert!(compared * 100 > played.len() * 97, "{compared} of {}", played.len());
    }
}

#[test]
fn nobody_jumps_at_borders_and_periods() {
    let (_, world) = baked(&small_city());
    // Right before and after instants at which slots end, where patches hand over and periods begin anew.
    for slot in 0..60 {
        let time = 7.0 + f64::from(slot) * 0.2;
        let (before, after) = (everybody(&world, time - 1e-5), everybody(&world, time + 1e-5));
        let stayed = before.iter().filter_map(|(who, a)| Some((a, after.get(who)?)));
        let mut count = 0;
        for (a, b) in stayed {
            assert!(a.0.distance(b.0) < 1e-3, "{} m", a.0.distance(b.0));
            assert!(a.1.distance(b.1) < 0.01, "{} m/s", a.1.distance(b.1));
            count += 1;
        }
        assert!(count * 100 >= before.len() * 97, "{count} of {}", before.len());
    }
}

#[test]
fn all_patches_together_play_what_each_does() {
    let (_, world) = baked(&Plan { versions: 1, patterns: 1, ..scenes::city(24, true, 1).unwrap() });
    assert!(world.instances() >= 4 * world.kinds(), "{} kinds of {}", world.kinds(), world.instances());
    let origin = DVec2::new(17.3, -250.0);
    for time in [0.05, 4.4, 9.9999, -7.7] {
        let (moment, mut all, mut each) = (world.moment(time), Roots::default(), Roots::default());
        world.roots(&moment, origin, &mut all);
        let spots = world.order().map(|instance| Spot { instance: instance as u32, shift: DVec2::ZERO });
        world.roots_of(&moment, spots, origin, &mut each);
        // To the bit.
        assert!(all.len() > 500 && all.x() == each.x() && all.z() == each.z());
        assert!(all.vx() == each.vx() && all.vz() == each.vz());
    }
}

#[test]
fn who_is_near_is_found_in_any_copy() {
    let (_, world) = baked(&small_city());
    let size = 16.0 * 8.0;
    let centre = DVec2::new(3.0 * size + 1.0, -7.0 * size + 60.0);
    let (moment, mut near, mut all) = (world.moment(5.0), Roots::default(), Roots::default());
    world.roots_of(&moment, world.nearby().within(centre, 30.0), centre, &mut near);
    world.roots(&moment, DVec2::ZERO, &mut all);
    let own = centre - DVec2::new(3.0, -7.0) * size;
    let wrapped = |v: f64| v - (v / size).round() * size;
    let inside = |x: f64, z: f64| x.hypot(z) < 30.0;
    let expected = (0..all.len())
        .filter(|&i| inside(wrapped(f64::from(all.x()[i]) - own.x), wrapped(f64::from(all.z()[i]) - own.y)))
        .count();
    let found = (0..near.len()).filter(|&i| inside(near.x()[i].into(), near.z()[i].into())).count();
    assert!(expected > 50);
    assert_eq!(found, expected);
}

#[test]
fn the_check_of_a_baked_world_holds() {
    for endless in [true, false] {
        let (_, world) = baked(&Plan { versions: 2, ..scenes::city(16, endless, 1).unwrap() });
        let report = check_world(&world);
        assert!(report.ok(), "{report}");
        assert_eq!(report.rows.len(), 9);
    }
}

#[test]
fn the_check_of_a_baked_world_finds_what_was_changed() {
    let (_, world) = baked(&small_city());
    let failing = |change: &dyn Fn(&mut Tables)| {
        let mut tables = world.tables().clone();
        change(&mut tables);
        let report = check_world(&World::new(tables).unwrap());
        report.failures().map(|row| row.row.clone()).collect::<Vec<_>>().join(", ")
    };
    let cases = [
        (
            failing(&|t| t.rows.iter_mut().skip(5_000).step_by(3_001).for_each(|v| *v = v.saturating_add(4_000))),
            "acceleration",
        ),
        (failing(&|t| t.instance_places[2 * STREET + 1] += 700), "place where a patch hands over"),
        (failing(&|t| t.instance_places.swap(2 * STREET, 2 * STREET + 6)), "people lost between patches"),
        (failing(&|t| t.stayers.iter_mut().skip(3).step_by(4).for_each(|r| *r += 1.2)), "walkers enter objects"),
        (failing(&|t| t.info.limits.radius = 0.4), "walkers enter each other"),
        (failing(&|t| t.info.limits.speed = 1.5), "speed"),
        (failing(&|t| t.instance_phases[STREET] = 25), "people lost between patches"),
    ];
    for (found, expected) in cases {
        assert!(found.contains(expected), "expected {expected:?} in {found:?}");
    }
}

#[test]
fn the_way_of_a_walker_is_the_one_played() {
    let (lattice, world) = baked(&small_city());
    for (kind, patch) in lattice.kinds().iter().enumerate().take(20) {
        for (index, walker) in patch.walkers.iter().enumerate() {
            let (enter, leave) = patch.presence(walker);
            let middle = 0.5 * (enter + leave);
            let (place, velocity) = world.way(kind, index, middle).unwrap();
            assert!(place.distance(walker.path.position(middle) - 4.0) < 3e-4);
            assert!(velocity.distance(walker.path.velocity(middle)) < 3e-3);
            assert_eq!((world.way(kind, index, enter - 0.2), world.way(kind, index, leave + 0.2)), (None, None));
        }
    }
}

#[test]
fn a_world_file_comes_back_as_it_was() {
    let (_, world) = baked(&small_city());
    let bytes = world.to_bytes();
    let back = World::from_bytes(&bytes).unwrap();
    assert!(back == world);
    assert!(back.to_bytes() == bytes);
}

#[test]
fn the_first_version_of_the_file_is_still_read() {
    let world = World::load(std::path::Path::new("tests/files/v1.world")).unwrap();
    assert_eq!((world.info().name.as_str(), world.instances(), world.tables().gait.is_some()), ("fixture", 4, true));
    assert!(check_world(&world).ok());
}

#[test]
fn shared_kinds_need_little_memory() {
    let plan = Plan { versions: 1, patterns: 1, ..scenes::city(64, false, 1).unwrap() };
    let (_, world) = baked(&plan);
    let people = world.walkers(&world.moment(0.0)) + world.stayers();
    let each = world.bytes() as f64 / people as f64;
    assert!(people > 8_000 && each < 64.0, "{people} people, {each} bytes each");
}

#[test]
fn broken_world_files_are_refused() {
    let plan = scenes::city(4, true, 1).unwrap();
    let bytes = baked(&plan).1.to_bytes();
    for cut in (0..bytes.len()).step_by(if cfg!(debug_assertions) { 211 } else { 13 }) {
        assert!(World::from_bytes(&bytes[..cut]).is_err(), "cut at {cut}");
    }
    for (from, to, expected) in [
        ("CQWORLD", "CQWORLT", "magic"),
        ("\"slots\":50", "\"slots\":40", "world"),
        ("\"page\":10", "\"page\":00", "JSON"),
        ("\"page\":10", "\"page\":11", "world"),
        ("\"period_secs\":10.0", "\"period_secs\":-1.0", "period_secs"),
        ("\"lanes\":{", "\"laned\":{", "array lanes"),
    ] {
        let at = bytes.windows(from.len()).position(|w| w == from.as_bytes()).unwrap_or_else(|| panic!("no {from}"));
        let mut broken = bytes.clone();
        broken[at..at + to.len()].copy_from_slice(to.as_bytes());
        let found = World::from_bytes(&broken).unwrap_err().to_string();
        assert!(found.contains(expected), "{from}: {found}");
    }
}

#[test]
fn tables_that_contradict_each_other_are_refused() {
    let (_, world) = baked(&scenes::city(4, true, 1).unwrap());
    let refused = |change: &dyn Fn(&mut crowdquilt::stage::world::Tables)| {
        let mut tables = world.tables().clone();
        change(&mut tables);
        World::new(tables).unwrap_err().to_string()
    };
    let cases = [
        (refused(&|t| t.rows.truncate(10)), "rows"),
        (refused(&|t| t.lanes.swap(0, 5)), "page 0, kind 0"),
        (refused(&|t| t.lanes[3] = 0xffff), "page 0, kind 0: not what can be: a lane of walker 65535"),
        (refused(&|t| t.instance_kinds[0] = 1_000), "instance_kinds"),
        (refused(&|t| t.instance_phases[0] = 50), "instance_phases"),
        (refused(&|t| t.instance_turns[2] = f32::NAN), "instance_turns"),
        (refused(&|t| t.edges[0] = 10_000), "kind 0: not what can be: pattern 10000"),
        (refused(&|t| t.walkers[0] = 5_000), "kind 0"),
        (refused(&|t| t.crossings[1] = -1.0), "crossings 0"),
        (refused(&|t| t.corners[0] = f32::INFINITY), "corners"),
        (refused(&|t| t.corners[0] = 1e5), "corners: not what can be: Some(100000.0) m from the middle"),
        (refused(&|t| t.kinds[1] = 1_000_000), "kinds"),
        (refused(&|t| t.info.slots = 60_000), "lane_ends"),
        (refused(&|t| t.info.repeat = Some([0, 8192])), "repeat"),
    ];
    for (found, expected) in cases {
        assert!(found.contains(expected), "expected {expected:?} in {found:?}");
    }
}
