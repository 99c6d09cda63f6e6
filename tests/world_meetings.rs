//! Interaction-rich patches: people come in over the border, meet, and go out over another one, on time.

use std::path::Path;
use std::sync::OnceLock;

use crowdquilt::check::world::check_world;
use crowdquilt::motion::{JOINT_COUNT, canonical, joint};
use crowdquilt::patch::PatchSet;
use crowdquilt::stage::World;
use crowdquilt::stage::world::{Spot, UNITS_PER_METRE};
use crowdquilt::world::{Layout, Shard, Site, WorldScene, gait_table, with_gait};
use glam::{DVec2, Quat, Vec3};

fn set() -> &'static PatchSet {
    static SET: OnceLock<PatchSet> = OnceLock::new();
    SET.get_or_init(|| {
        if let Some(file) = std::env::var_os("CROWDQUILT_SET") {
            return PatchSet::load(Path::new(&file)).unwrap();
        }
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("meetings");
        std::fs::create_dir_all(&folder).unwrap();
        crowdquilt::samples::write(&folder, 1).unwrap();
        PatchSet::from_folder(&folder).unwrap()
    })
}

fn world() -> &'static World {
    static WORLD: OnceLock<World> = OnceLock::new();
    WORLD.get_or_init(|| {
        let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/worlds/meeting.toml"));
        let (scene, notes) = WorldScene::load(file).unwrap().with_acts(set());
        println!("{notes:?}");
        let begin = std::time::Instant::now();
        let Layout::Map(plan) = &scene.layout else { panic!("a map") };
        for (column, row) in [(1, 1), (3, 1), (1, 3), (3, 3)] {
            let patch = plan.patch(column, row).unwrap();
            let acting = patch.walkers.iter().filter(|w| w.role.is_some()).count();
            println!(
                "{column}, {row}: {acting} of {} act, {:.2} s",
                patch.walkers.len(),
                begin.elapsed().as_secs_f64()
            );
        }
        let world = scene.build(&|_, _| true).unwrap().world;
        println!("built after {:.2} s", begin.elapsed().as_secs_f64());
        with_gait(&world, gait_table(set()).unwrap()).unwrap()
    })
}

/// Walkers of all kinds who do something: kind and walker.
fn acting(world: &World) -> Vec<(usize, usize)> {
    let walkers = |kind: usize| (0..world.kind(kind).walkers()).map(move |walker| (kind, walker));
    (0..world.kinds()).flat_map(walkers).filter(|&(kind, walker)| world.walker_act(kind, walker).is_some()).collect()
}

#[test]
fn people_meet_and_the_world_passes_its_check() {
    let world = world();
    let found = acting(world);
    println!("{} of {} walkers act", found.len(), (0..world.kinds()).map(|k| world.kind(k).walkers()).sum::<usize>());
    let report = check_world(world);
    for row in &report.rows {
        println!("{:50} {:9.5} of {:9.5} {} {}", row.row, row.value, row.limit, row.unit, row.place);
    }
    assert!(found.len() >= 8, "{}", found.len());
    assert!(report.rows.iter().all(|r| r.ok));
}

#[test]
fn nobody_goes_back_over_the_edge_they_came_by() {
    let world = world();
    for kind in 0..world.kinds() {
        let patterns = world.kind(kind).patterns();
        let edges = |of: &dyn Fn(&crowdquilt::stage::world::Pattern) -> usize| -> Vec<usize> {
            patterns.iter().enumerate().flat_map(|(edge, p)| vec![edge; of(p)]).collect()
        };
        let (ins, outs) = (edges(&|p| p.inputs.len()), edges(&|p| p.outputs.len()));
        for (walker, (output, _)) in world.kind(kind).ways().enumerate() {
            if world.walker_act(kind, walker).is_some() {
                assert_ne!(ins[walker], outs[output], "kind {kind}, walker {walker}");
            }
        }
    }
}

/// Hips of everybody in a patch at a time, and joints, by who it is.
fn bodies(world: &World, instance: usize, time: f64) -> Vec<((usize, i64), Vec<Vec3>)> {
    let spot = Spot { instance: instance as u32, shift: DVec2::ZERO };
    let (mut pose, mut globals) = ([Quat::IDENTITY; JOINT_COUNT], Vec::new());
    let moment = world.moment(time);
    let all = world.walkers_of(instance, &moment).zip(world.bodies(spot, time)).collect::<Vec<_>>();
    all.into_iter()
        .map(|(who, walking)| {
            let hips = world.walker_body(spot, who, &walking, time, &mut pose);
            canonical().globals(hips, &pose, &mut globals);
            (who, globals.iter().map(|g| g.0).collect())
        })
        .collect()
}

#[test]
fn bodies_never_leap_and_are_the_same_after_hours() {
    let world = world();
    let kinds: Vec<usize> = acting(world).into_iter().map(|a| a.0).collect();
    let period = f64::from(world.info().period_secs);
    let (mut leap, mut drift) = (0.0f32, 0.0f32);
    for instance in (0..world.instances()).filter(|&i| kinds.contains(&world.kind_of(i))) {
        for i in 0..300 {
            let time = f64::from(i) / 30.0;
            let (now, next) = (bodies(world, instance, time), bodies(world, instance, time + 1.0 / 30.0));
            for (who, joints) in &now {
                if let Some((_, then)) = next.iter().find(|n| n.0 == *who) {
                    leap = joints.iter().zip(then).map(|(a, b)| a.distance(*b)).fold(leap, f32::max);
                }
            }
            let later = bodies(world, instance, time + 360.0 * period);
            for ((who, joints), (again, then)) in now.iter().zip(&later) {
                assert_eq!((who.0, who.1 + 360), *again);
                drift = joints.iter().zip(then).map(|(a, b)| a.distance(*b)).fold(drift, f32::max);
            }
        }
    }
    println!("greatest step of a joint {leap:.3} m, drift after an hour {drift:.6} m, units of {UNITS_PER_METRE}");
    // 9 m/s: a foot that swings while walk and clip fade into each other.
    assert!(leap < 0.3 && drift < 2e-3, "{leap} {drift}");
}

/// Where walk and clip fade into each other a foot stands nearly always: the slower one's ball hardly moves.
#[test]
fn feet_stay_where_walk_and_clip_fade_into_each_other() {
    let world = world();
    let kinds: Vec<usize> = acting(world).into_iter().map(|a| a.0).collect();
    let mut speeds = Vec::new();
    for instance in (0..world.instances()).filter(|&i| kinds.contains(&world.kind_of(i))) {
        for i in 0..600 {
            let (time, step) = (f64::from(i) / 60.0, 1.0 / 60.0);
            let next = bodies(world, instance, time + step);
            for (who, joints) in bodies(world, instance, time) {
                let kind = world.kind_of(instance);
                let (Some((_, [_, enter, leave])), Some((_, then))) =
                    (world.walker_act(kind, who.0), next.iter().find(|n| n.0 == who))
                else {
                    continue;
                };
                let slot = f64::from(world.info().period_secs) / f64::from(world.info().slots);
                let own = time + f64::from(world.tables().instance_phases[instance]) * slot
                    - who.1 as f64 * f64::from(world.info().period_secs);
                if (own - enter).min(leave - own) < 1.0 && own > enter && own < leave {
                    let speed = |toe: usize| joints[toe].distance(then[toe]) / step as f32;
                    speeds.push(speed(joint::LEFT_TOE).min(speed(joint::RIGHT_TOE)));
                }
            }
        }
    }
    speeds.sort_by(f32::total_cmp);
    let at = |share: f32| speeds[(share * (speeds.len() - 1) as f32) as usize];
    println!(
        "slower foot in fades: median {:.3}, 90 % {:.3}, 99 % {:.3} m/s of {}",
        at(0.5),
        at(0.9),
        at(0.99),
        speeds.len()
    );
    assert!(at(0.5) < 0.03 && at(0.9) < 0.3, "{} {}", at(0.5), at(0.9));
}

/// Writes joints for a look from outside, if a folder is named.
#[test]
fn joints_for_pictures() {
    let Some(folder) = std::env::var_os("CROWDQUILT_ACTS") else { return };
    let world = world();
    let kinds: Vec<usize> = acting(world).into_iter().map(|a| a.0).collect();
    let mut text = String::new();
    for instance in (0..world.instances()).filter(|&i| kinds.contains(&world.kind_of(i))) {
        for i in 0..300 {
            for ((walker, lap), joints) in bodies(world, instance, f64::from(i) / 30.0) {
                let all: Vec<f32> = joints.iter().flat_map(|p| p.to_array()).collect();
                let act = world.walker_act(world.kind_of(instance), walker).is_some();
                text += &format!(
                    "{{\"patch\":{instance},\"frame\":{i},\"walker\":{walker},\"lap\":{lap},\"act\":{act},\"joints\":{all:?}}}\n"
                );
            }
        }
    }
    std::fs::write(Path::new(&folder).join("meetings.jsonl"), text).unwrap();
}

/// Who builds elsewhere is sent the scene, and sends patches back: nothing of what people do is lost on the way.
#[test]
fn scenes_and_patches_travel_with_what_people_do() {
    let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/worlds/meeting.toml"));
    let (scene, _) = WorldScene::load(file).unwrap().with_acts(set());
    let arrived = WorldScene::from_bytes(&scene.to_bytes()).unwrap();
    let mut site = Site::new(&scene).unwrap();
    while !site.left().is_empty() {
        let elsewhere = Site::after(&arrived, site.failures()).unwrap();
        let shard = Shard::solve(&elsewhere, site.left(), 2, &|_| true).unwrap();
        site.take(Shard::from_bytes(&shard.to_bytes()).unwrap()).unwrap();
        site.end_round().unwrap();
    }
    let there = with_gait(&site.bake().unwrap().world, gait_table(set()).unwrap()).unwrap();
    assert!(!acting(&there).is_empty());
    assert!(there.to_bytes() == world().to_bytes(), "other bytes");
}
