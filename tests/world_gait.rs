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

#[test]
fn a_planted_foot_stays() {
    let (world, table) = (city(), table());
    let mut slips = Vec::new();
    for step in 0..30 {
        let time = 10.0 + f64::from(step) * 0.337;
        let (now, later) = (bodies(&world, time), bodies(&world, time + 0.05));
        for (who, a) in &now {
            let Some(b) = later.get(who).filter(|b| b.place.distance(a.place) < 0.2) else { continue };
            let (before, after) = (feet(a, &table), feet(b, &table));
            // The foot that is lower at both times.
            let low = |feet: &[Vec3; 2]| usize::from(feet[1].y < feet[0].y);
            if low(&before) == low(&after) && before[low(&before)].y < 0.04 {
                let (p, q) = (before[low(&before)], after[low(&after)]);
                slips.push(Vec2::new(q.x - p.x, q.z - p.z).length() / 0.05);
            }
        }
    }
    slips.sort_by(f32::total_cmp);
    let at = |share: f64| slips[((slips.len() - 1) as f64 * share) as usize];
    println!("planted feet slip: median {:.3}, 90 % {:.3}, most {:.3} m/s", at(0.5), at(0.9), at(1.0));
    assert!(slips.len() > 1_000);
    assert!(at(0.5) < 0.15 && at(0.9) < 0.5, "{} {}", at(0.5), at(0.9));
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
