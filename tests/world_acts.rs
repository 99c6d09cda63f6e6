//! People who stay do something: real motion, looped over the period, within their discs.

use std::path::Path;
use std::sync::OnceLock;

use crowdquilt::check::world::check_world;
use crowdquilt::motion::{JOINT_COUNT, body_capsules, canonical};
use crowdquilt::patch::PatchSet;
use crowdquilt::stage::World;
use crowdquilt::stage::world::Spot;
use crowdquilt::world::WorldScene;
use glam::{DVec2, Quat, Vec2, Vec3};

fn set() -> &'static PatchSet {
    static SET: OnceLock<PatchSet> = OnceLock::new();
    SET.get_or_init(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("acts");
        std::fs::create_dir_all(&folder).unwrap();
        crowdquilt::samples::write(&folder, 1).unwrap();
        PatchSet::from_folder(&folder).unwrap()
    })
}

const SCENE: &str = r#"
period_secs = 10.0
cell_m = 10.0
map = """
pp
pp
"""

[[templates]]
name = "place"
key = "p"
people = [
    { name = "talk", group = [2, 3], number = [1, 1] },
    { name = "sit", group = [1, 1], number = [1, 1] },
    { name = "look at a shop window", group = [1, 1], number = [1, 1] },
]
borders.place = { type = "mixed", in = 2, out = 2 }
"#;

fn world() -> &'static World {
    static WORLD: OnceLock<World> = OnceLock::new();
    WORLD.get_or_init(|| {
        let scene = WorldScene::from_toml(SCENE, Path::new(".")).unwrap();
        let (scene, notes) = scene.with_acts(set());
        assert_eq!(notes, Vec::<String>::new());
        scene.build(&|_, _| true).unwrap().world
    })
}

/// Everybody who stays: the patch and the number in it.
fn everybody(world: &World) -> impl Iterator<Item = (Spot, usize)> {
    (0..world.instances()).flat_map(|instance| {
        let spot = Spot { instance: instance as u32, shift: DVec2::ZERO };
        (0..world.kind(world.kind_of(instance)).stayers().len()).map(move |index| (spot, index))
    })
}

fn joints(world: &World, spot: Spot, index: usize, time: f64) -> Vec<(Vec3, Quat)> {
    let (mut pose, mut globals) = ([Quat::IDENTITY; JOINT_COUNT], Vec::new());
    let hips = world.stayer_body(spot, index, time, &mut pose).expect("an act");
    canonical().globals(hips, &pose, &mut globals);
    globals
}

/// How far the joint that is farthest from where it was is.
fn apart(a: &[(Vec3, Quat)], b: &[(Vec3, Quat)]) -> f32 {
    a.iter().zip(b).map(|(p, q)| p.0.distance(q.0)).fold(0.0, f32::max)
}

#[test]
fn everybody_has_an_act_and_moves_in_it() {
    let world = world();
    assert!(world.stayers() >= 12, "{}", world.stayers());
    for (spot, index) in everybody(world) {
        let first = joints(world, spot, index, 0.0);
        let moved = |i: i32| apart(&first, &joints(world, spot, index, f64::from(i) * 0.2));
        let far = (0..50).map(moved).fold(0.0, f32::max);
        let name = world.kind(world.kind_of(spot.instance as usize)).stayers().nth(index).unwrap().name;
        assert!(far > 0.02, "{} hardly moves: {far} m", world.info().names[name as usize]);
    }
}

#[test]
fn bodies_stay_in_their_discs_at_all_times() {
    let world = world();
    for (spot, index) in everybody(world) {
        let stayer = world.kind(world.kind_of(spot.instance as usize)).stayers().nth(index).unwrap();
        for i in 0..400 {
            let mut capsules = Vec::new();
            body_capsules(&joints(world, spot, index, f64::from(i) * 0.0251), &mut capsules);
            for c in &capsules {
                let reach = |p: Vec3| Vec2::new(p.x, p.z).distance(stayer.place) + c.radius;
                assert!(reach(c.a).max(reach(c.b)) < stayer.radius + 2e-3, "{spot:?} {index} at {i}");
            }
        }
    }
}

#[test]
fn the_pose_is_a_function_of_the_time_and_goes_on_over_the_period() {
    let world = world();
    let period = f64::from(world.info().period_secs);
    let apart =
        |a: &[(Vec3, Quat)], b: &[(Vec3, Quat)]| a.iter().zip(b).map(|(p, q)| p.0.distance(q.0)).fold(0.0, f32::max);
    for (spot, index) in everybody(world) {
        for time in [0.0, 3.217, 9.999] {
            let now = joints(world, spot, index, time);
            for laps in [-3.0, 1.0, 360.0] {
                assert!(apart(&now, &joints(world, spot, index, time + laps * period)) < 1e-4);
            }
        }
        // No step of a 30th of a second over the end is larger than the largest elsewhere.
        let step = |t: f64| apart(&joints(world, spot, index, t), &joints(world, spot, index, t + 1.0 / 30.0));
        let most = (0..280).map(|i| step(f64::from(i) / 30.0)).fold(0.0, f32::max);
        assert!(step(period - 1.0 / 60.0) < most + 1e-3, "{spot:?} {index}");
    }
}

#[test]
fn the_world_passes_its_check_and_a_broken_one_does_not() {
    let world = world();
    let report = check_world(world);
    for row in &report.rows {
        println!("{:45} {:9.5} of {:9.5} {} {}", row.row, row.value, row.limit, row.unit, row.place);
    }
    assert!(report.rows.iter().all(|r| r.ok));
    let worst = |change: &dyn Fn(&mut crowdquilt::stage::world::Tables), row: &str| {
        let mut tables = world.tables().clone();
        change(&mut tables);
        let report = check_world(&World::new(tables).unwrap());
        !report.rows.iter().find(|r| r.row == row).unwrap().ok
    };
    assert!(worst(&|t| t.stayers[3] -= 0.05, "bodies of who stays leave their discs"));
    let shove = |t: &mut crowdquilt::stage::world::Tables| {
        // The clip glides aside, so that only the way back to its begin is a leap.
        let acts = t.acts.as_mut().unwrap();
        let n = acts.ends[0] as usize;
        (0..n).for_each(|f| acts.roots[3 * f] += 0.2 * f as f32 / n as f32);
    };
    assert!(worst(&shove, "hips leap where an act begins again"));
    assert!(worst(&|t| t.acts.as_mut().unwrap().steps[0] *= 1.01, "acts do not end with the period"));
}

#[test]
fn the_street_is_as_sound_with_acts() {
    let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/worlds/street.toml"));
    let (scene, notes) = WorldScene::load(file).unwrap().with_acts(set());
    assert_eq!(notes, Vec::<String>::new());
    let world = scene.build(&|_, _| true).unwrap().world;
    assert!(world.tables().acts.is_some());
    let report = check_world(&world);
    let bad: Vec<_> = report.rows.iter().filter(|r| !r.ok).map(|r| (&r.row, r.value)).collect();
    assert!(bad.is_empty(), "{bad:?}");
}

#[test]
fn a_file_keeps_acts_and_refuses_broken_ones() {
    let world = world();
    let again = World::from_bytes(&world.to_bytes()).unwrap();
    assert_eq!(again.tables().acts, world.tables().acts);
    let broken = |change: &dyn Fn(&mut crowdquilt::stage::world::Acts)| {
        let mut tables = world.tables().clone();
        change(tables.acts.as_mut().unwrap());
        World::new(tables).unwrap_err().to_string()
    };
    assert!(broken(&|a| a.stayers[0] = 10_000).contains("stayer_acts"));
    assert!(broken(&|a| a.ends[0] = 0).contains("act_ends"));
    assert!(broken(&|a| a.steps[0] = 0.0).contains("act_steps"));
    assert!(broken(&|a| a.roots[5] = f32::NAN).contains("act_roots"));
    assert!(broken(&|a| a.rotations[..4].fill(0)).contains("act_rotations"));
}

/// Writes joints for a look from outside, if a folder is named.
#[test]
fn joints_for_pictures() {
    let Some(folder) = std::env::var_os("CROWDQUILT_ACTS") else { return };
    let world = world();
    let mut text = String::new();
    for (spot, index) in everybody(world) {
        let stayer = world.kind(world.kind_of(spot.instance as usize)).stayers().nth(index).unwrap();
        for i in 0..60 {
            let all: Vec<f32> =
                joints(world, spot, index, f64::from(i) / 6.0).iter().flat_map(|j| j.0.to_array()).collect();
            let name = &world.info().names[stayer.name as usize];
            text += &format!(
                "{{\"patch\":{},\"index\":{index},\"name\":{name:?},\"radius\":{},\"place\":[{},{}],\"joints\":{all:?}}}\n",
                spot.instance, stayer.radius, stayer.place.x, stayer.place.y
            );
        }
    }
    std::fs::write(Path::new(&folder).join("acts.jsonl"), text).unwrap();
}

/// Somebody alone who waits.
const ALONE: &str = r#"
period_secs = 6.0
map = "p"

[[templates]]
name = "place"
key = "p"
people = [{ name = "wait", group = [1, 1], number = [1, 1] }]
"#;

#[derive(serde::Serialize, serde::Deserialize)]
struct Moment {
    time: f64,
    joints: Vec<f32>,
}

/// The committed file is what the viewer's tests read as well (`studio/test/acts.test.ts`).
#[test]
fn a_committed_file_plays_what_it_always_played() {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/files"));
    if std::env::var_os("CROWDQUILT_WRITE_FILES").is_some() {
        let scene = WorldScene::from_toml(ALONE, Path::new(".")).unwrap().with_acts(set()).0;
        let world = scene.build(&|_, _| true).unwrap().world;
        world.save(&folder.join("acts.world")).unwrap();
        let moments: Vec<Moment> = [0.0, 1.234, 5.99, 3607.5].map(|time| moment(&world, time)).into();
        std::fs::write(folder.join("acts.world.json"), serde_json::to_string(&moments).unwrap()).unwrap();
    }
    let world = World::load(&folder.join("acts.world")).unwrap();
    let text = std::fs::read_to_string(folder.join("acts.world.json")).unwrap();
    for expected in serde_json::from_str::<Vec<Moment>>(&text).unwrap() {
        let found = moment(&world, expected.time).joints;
        assert_eq!(found.len(), 3 * JOINT_COUNT);
        assert!(found.iter().zip(&expected.joints).all(|(a, b)| (a - b).abs() < 1e-4), "at {} s", expected.time);
    }
}

fn moment(world: &World, time: f64) -> Moment {
    let (spot, index) = everybody(world).next().expect("somebody");
    let place = world.place(0).as_vec2();
    let all = joints(world, spot, index, time);
    let joints = all.iter().flat_map(|j| (j.0 + Vec3::new(place.x, 0.0, place.y)).to_array()).collect();
    Moment { time, joints }
}
