//! Full bodies in baked worlds: steps go on over borders and periods, planted feet stay.

use std::collections::HashMap;
use std::path::Path;
use std::sync::OnceLock;

use crowdquilt::motion::{JOINT_COUNT, canonical, joint};
use crowdquilt::patch::PatchSet;
use crowdquilt::stage::World;
use crowdquilt::stage::world::{GaitTable, Person, Spot, Walking};
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

/// Who walks past a minute's frames, with the balls of its feet and its body.
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
                let low = b.0.distance(a.0) * 60.0 < 0.15 && b.1 < 0.05;
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
    for (name, list) in [("slips", &mut slips), ("speeds", &mut jumps), ("misses", &mut misses)] {
        let found = [0.5, 0.9, 0.99, 0.999, 1.0].map(|share| at(list, share));
        println!("{name}: {found:.4?} of {}", list.len());
    }
    assert!(slips.len() > 1_000);
}

#[test]
fn worlds_with_bodies_come_back_from_their_files() {
    let world = city();
    let bytes = world.to_bytes();
    assert!(World::from_bytes(&bytes).unwrap() == world);
    let refused = |change: &dyn Fn(&mut crowdquilt::stage::world::Gait)| {
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
        (refused(&|g| g.cycle_paces.clear()), "cycle_paces"),
    ];
    for (found, expected) in cases {
        assert!(found.contains(expected), "expected {expected:?} in {found:?}");
    }
}
