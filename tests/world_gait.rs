//! Full bodies in baked worlds: steps go on over borders and periods, planted feet stay.

use std::collections::HashMap;
use std::path::Path;
use std::sync::OnceLock;

use crowdquilt::check::world::check_world;
use crowdquilt::motion::{JOINT_COUNT, canonical, joint};
use crowdquilt::patch::PatchSet;
use crowdquilt::stage::World;
use crowdquilt::stage::world::{Gait, GaitTable, Person, Spot, Swing, Walking};
use crowdquilt::world::{Plan, gait_table, scenes, with_gait};
use glam::{DVec2, Quat, Vec2, Vec3};

fn table() -> GaitTable {
    static TABLE: OnceLock<GaitTable> = OnceLock::new();
    let make = || {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("gait");
        std::fs::create_dir_all(&folder).unwrap();
        crowdquilt::samples::write(&folder, 1).unwrap();
        gait_table(&PatchSet::from_folder(&folder).unwrap()).unwrap()
    };
    TABLE.get_or_init(make).clone()
}

fn city() -> World {
    let plan = Plan { versions: 2, ..scenes::city(8, true, 1).unwrap() };
    with_gait(&plan.bake("test", &plan.build().unwrap()).unwrap(), table()).unwrap()
}

/// Everybody's body at a time, in the world's frame.
fn bodies(world: &World, time: f64) -> HashMap<Person, Walking> {
    let moment = world.moment(time);
    let patch = |instance: usize| {
        let place = world.place(instance).as_vec2();
        let spot = Spot { instance: instance as u32, shift: DVec2::ZERO };
        let people = world.people_of(instance, [0, 0], &moment);
        people.zip(world.bodies(spot, time)).map(move |(who, b)| (who, Walking { place: b.place + place, ..b }))
    };
    (0..world.instances()).flat_map(patch).collect()
}

#[test]
fn cycles_of_the_captures_are_walks() {
    let table = table();
    assert!(table.speeds.len() >= 3, "{:?}", table.speeds);
    println!("speeds {:?} strides {:?}", table.speeds, table.strides);
    let fastest = table.speeds[table.speeds.len() - 1];
    for speed in [0.3, 0.8, 1.2, fastest, 2.0] {
        assert!((0.5..1.5).contains(&table.cadence(speed)), "{} cycles/s at {speed} m/s", table.cadence(speed));
    }
    // A pose after one whole cycle is the pose before.
    let (mut a, mut b) = ([Quat::IDENTITY; JOINT_COUNT], [Quat::IDENTITY; JOINT_COUNT]);
    for speed in [0.0, 0.5, 1.3] {
        let hips = table.pose(speed, 0.0, &mut a).distance(table.pose(speed, 0.9999, &mut b));
        assert!(hips < 1e-3, "{hips}");
        assert!(a.iter().zip(&b).all(|(p, q)| p.angle_between(*q) < 0.01));
    }
}

#[test]
fn steps_and_headings_go_on_over_borders_and_periods() {
    let world = city();
    for slot in 0..55 {
        let time = 3_597.0 + f64::from(slot) * 0.2;
        let (before, after) = (bodies(&world, time - 1e-5), bodies(&world, time + 1e-5));
        let stayed: Vec<(&Walking, &Walking)> =
            before.iter().filter_map(|(who, a)| Some((a, after.get(who)?))).collect();
        assert!(stayed.len() * 100 >= before.len() * 95);
        for (a, b) in stayed {
            let gap = (b.phase - a.phase + 0.5).rem_euclid(1.0) - 0.5;
            assert!(gap.abs() < 0.005, "{gap} of a cycle");
            let turn =
                (b.heading - a.heading + std::f32::consts::PI).rem_euclid(std::f32::consts::TAU) - std::f32::consts::PI;
            assert!(turn.abs() < 0.02, "{} degrees", turn.to_degrees());
        }
    }
}

/// Balls of both feet.
fn feet(body: &Walking, table: &GaitTable) -> [Vec3; 2] {
    let (mut pose, mut globals) = ([Quat::IDENTITY; JOINT_COUNT], Vec::new());
    let root = body.pose(table, &mut pose);
    canonical().globals(root, &pose, &mut globals);
    [globals[joint::LEFT_TOE].0, globals[joint::RIGHT_TOE].0]
}

/// Everybody's frames: the balls of the feet relative to the body, and the body.
type Seen = HashMap<Person, Vec<(usize, [Vec3; 2], Walking)>>;

fn seen(world: &World, table: &GaitTable, frames: usize, step: f64) -> Seen {
    let mut seen = Seen::new();
    for frame in 0..frames {
        for (who, body) in bodies(world, 3_000.0 + frame as f64 * step) {
            let at = Vec3::new(body.place.x, 0.0, body.place.y);
            let relative = feet(&body, table).map(|ball| ball - at);
            seen.entry(who).or_default().push((frame, relative, body));
        }
    }
    seen
}

#[test]
fn a_planted_foot_stays() {
    let (world, table) = (city(), table());
    let (mut slips, mut jumps, mut misses) = (Vec::new(), Vec::new(), Vec::new());
    for (_, way) in seen(&world, &table, 400, 1.0 / 60.0) {
        for foot in 0..2 {
            let mut stance: Option<(Vec2, f32)> = None;
            for pair in way.windows(2).filter(|pair| pair[0].0 + 1 == pair[1].0) {
                let [a, b] = [&pair[0], &pair[1]].map(|(_, balls, body)| {
                    let led = body.feet.unwrap()[foot].ball;
                    misses.push(led.distance(balls[foot]));
                    (Vec2::new(balls[foot].x, balls[foot].z) + body.place, balls[foot].y, body)
                });
                if b.2.place.distance(a.2.place) > 0.2 {
                    stance = None;
                    continue;
                }
                jumps.push(a.0.distance(b.0) * 60.0);
                let low = b.0.distance(a.0) * 60.0 < 0.06 && b.1 < 0.05;
                stance = match (low, stance) {
                    (true, Some((from, slip))) => Some((from, slip.max(b.0.distance(from)))),
                    (true, None) => Some((b.0, 0.0)),
                    (false, ended) => {
                        slips.extend(ended.map(|(_, slip)| slip));
                        None
                    }
                };
            }
        }
    }
    let at = |list: &mut Vec<f32>, share: f64| {
        list.sort_by(f32::total_cmp);
        list[((list.len() - 1) as f64 * share) as usize]
    };
    for (name, list) in [("slides", &mut slips), ("speeds", &mut jumps), ("misses", &mut misses)] {
        let found = [0.5, 0.9, 0.99, 0.999, 1.0].map(|share| at(list, share));
        println!("{name}: {found:.4?} of {}", list.len());
    }
    // A stance begins and ends at 0.06 m/s here, which is what is left of sliding.
    assert!(slips.len() > 1_000 && at(&mut slips, 0.5) < 3e-3 && at(&mut slips, 0.99) < 0.01);
    assert!(at(&mut jumps, 1.0) < 10.0, "{} m/s", at(&mut jumps, 1.0));
    assert!(at(&mut misses, 0.999) < 1e-3, "feet fall short of their places by {} m", at(&mut misses, 0.999));
}

#[test]
fn who_stands_does_not_shuffle() {
    let table = table();
    let (mut still, mut pose) = (Vec::new(), [Quat::IDENTITY; JOINT_COUNT]);
    // Standing, a footprint is where the standing foot is, whatever the phase.
    for i in 0..table.phases {
        table.pose(0.0, i as f32 / table.phases as f32, &mut pose);
        still.push(pose);
    }
    assert!(still.iter().all(|p| p.iter().zip(&still[0]).all(|(a, b)| a.angle_between(*b) < 1e-3)));
    let heights: Vec<f32> = table.swings[..table.phases].iter().map(|pair| pair[0].height).collect();
    assert!(heights.iter().all(|h| (h - heights[0]).abs() < 1e-6));
}

#[test]
fn the_check_looks_at_feet() {
    let world = city();
    let report = check_world(&world);
    println!("{report}");
    assert!(report.ok(), "{report}");
    let failing = |change: &dyn Fn(&mut Gait)| {
        let mut tables = world.tables().clone();
        change(tables.gait.as_mut().unwrap());
        let report = check_world(&World::new(tables).unwrap());
        report.failures().map(|row| row.row.clone()).collect::<Vec<_>>().join(", ")
    };
    let each = |gait: &mut Gait, change: &dyn Fn(f32, &mut Swing)| {
        let phases = gait.table.phases;
        for (i, pair) in gait.table.swings.iter_mut().enumerate() {
            pair.iter_mut().for_each(|swing| change((i % phases) as f32 / phases as f32, swing));
        }
    };
    let cases = [
        (failing(&|g| each(g, &|at, s| s.share += 0.006 * (at * std::f32::consts::TAU).sin())), "planted foot slides"),
        (failing(&|g| each(g, &|at, s| s.share = at)), "walking without a planted foot"),
        (failing(&|g| each(g, &|_, s| s.height -= 0.05)), "foot below the floor"),
        (failing(&|g| g.crossing_phases.iter_mut().step_by(7).for_each(|p| *p = (*p + 0.1) % 1.0)), "hands over"),
    ];
    for (found, expected) in cases {
        assert!(found.contains(expected), "expected {expected:?} in {found:?}");
    }
}

/// What everybody of a world does at some time: places, and joints of hips and legs, metres.
#[derive(serde::Serialize, serde::Deserialize)]
struct Played {
    time: f64,
    places: Vec<[f32; 2]>,
    joints: Vec<Vec<f32>>,
}

fn played(world: &World, time: f64) -> Played {
    let table = &world.tables().gait.as_ref().unwrap().table;
    let (mut pose, mut globals) = ([Quat::IDENTITY; JOINT_COUNT], Vec::new());
    let mut played = Played { time, places: Vec::new(), joints: Vec::new() };
    let round = |v: f32| (v * 1e4).round() / 1e4;
    for instance in 0..world.instances() as u32 {
        let origin = world.place(instance as usize).as_vec2();
        for body in world.bodies(Spot { instance, shift: DVec2::ZERO }, time) {
            let root = body.pose(table, &mut pose) + Vec3::new(origin.x, 0.0, origin.y);
            canonical().globals(root, &pose, &mut globals);
            played.places.push((body.place + origin).to_array().map(round));
            played.joints.push(globals[..9].iter().flat_map(|(at, _)| at.to_array().map(round)).collect());
        }
    }
    played
}

/// The viewer's test reads the same two files. `CROWDQUILT_GOLDEN=write` writes them anew, after a change of the format.
#[test]
fn the_golden_world_plays_as_it_did() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("studio/test/golden");
    let (file, numbers) = (folder.join("feet.world"), folder.join("feet.json"));
    let times = [0.3, 2.71, 5.0, 9.97, -3.4, 3_601.9];
    if std::env::var("CROWDQUILT_GOLDEN").is_ok_and(|v| v == "write") {
        let plan = scenes::city(2, true, 1).unwrap();
        let world = with_gait(&plan.bake("feet", &plan.build().unwrap()).unwrap(), table()).unwrap();
        world.save(&file).unwrap();
        let all: Vec<Played> = times.iter().map(|&time| played(&world, time)).collect();
        std::fs::write(&numbers, serde_json::to_string(&all).unwrap()).unwrap();
    }
    let world = World::load(&file).unwrap();
    let golden: Vec<Played> = serde_json::from_str(&std::fs::read_to_string(&numbers).unwrap()).unwrap();
    assert_eq!(golden.len(), times.len());
    for expected in golden {
        let found = played(&world, expected.time);
        assert_eq!((found.places.len(), found.joints.len()), (expected.places.len(), expected.joints.len()));
        for (a, b) in found.joints.iter().flatten().zip(expected.joints.iter().flatten()) {
            assert!((a - b).abs() < 1e-3, "{a} instead of {b} at {} s", expected.time);
        }
    }
}

#[test]
fn worlds_with_bodies_come_back_from_their_files() {
    let world = city();
    let bytes = world.to_bytes();
    assert!(World::from_bytes(&bytes).unwrap() == world);
    let refused = |change: &dyn Fn(&mut Gait)| {
        let mut tables = world.tables().clone();
        change(tables.gait.as_mut().unwrap());
        World::new(tables).unwrap_err().to_string()
    };
    let cases = [
        (refused(&|g| g.steps.truncate(5)), "gait_steps"),
        (refused(&|g| g.headings.push(0)), "gait_headings"),
        (refused(&|g| g.table.speeds[1] = f32::NAN), "gait_speeds"),
        (refused(&|g| g.table.phases = 7), "gait_hips"),
        (refused(&|g| g.table.rotations[3].x = f32::INFINITY), "gait_rotations"),
        (refused(&|g| g.crossing_phases[0] = f32::NAN), "crossing_phases"),
        (refused(&|g| g.crossing_paces.clear()), "crossing_paces"),
        (refused(&|g| g.crossing_paces[0] = 0.0), "crossing_paces"),
        (refused(&|g| g.table.prints.truncate(1)), "gait_prints"),
        (refused(&|g| g.table.prints[0][1].x = f32::NAN), "gait_prints"),
        (refused(&|g| g.table.swings.clear()), "gait_swings"),
        (refused(&|g| g.table.swings[9][0].share = 7.0), "gait_swings"),
    ];
    for (found, expected) in cases {
        assert!(found.contains(expected), "expected {expected:?} in {found:?}");
    }
}
