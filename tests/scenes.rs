//! The example scenes: each loads, is tiled, and holds every row of the check.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use crowdquilt::check::check;
use crowdquilt::geom::Obstacle;
use crowdquilt::motion::FPS;
use crowdquilt::patch::{PatchSet, cut_folder};
use crowdquilt::stage::Crowd;
use crowdquilt::tiling::{Method, Options, Outcome, Scene, Status, tile};
use glam::{Vec2, Vec3};

static SAMPLES: LazyLock<PatchSet> = LazyLock::new(|| {
    let folder = std::env::temp_dir().join(format!("crowdquilt-scenes-{}", std::process::id()));
    crowdquilt::samples::write(&folder, 1).unwrap();
    let set = cut_folder(&folder, None).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    set
});

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scenes")
}

fn load(name: &str) -> Scene {
    Scene::load(&folder().join(format!("{name}.toml"))).unwrap()
}

fn run(scene: &Scene, seed: u64, method: Method) -> Outcome {
    tile(scene, &SAMPLES, &Options { method, seed, time_secs: 120.0 }, &mut |_| true).unwrap()
}

fn clean(name: &str, seed: u64) -> Outcome {
    let outcome = run(&load(name), seed, Method::Engine);
    let report = check(&outcome.crowd);
    println!("{name}, seed {seed}: {:?} in {:.2} s", outcome.status, outcome.solve_secs);
    assert!(report.ok(), "{name}: {report}");
    outcome
}

#[test]
fn every_scene_loads() {
    let files: Vec<PathBuf> = std::fs::read_dir(folder()).unwrap().map(|f| f.unwrap().path()).collect();
    assert!(files.len() >= 7);
    for file in files.iter().filter(|f| f.extension().is_some_and(|e| e == "toml")) {
        let text = std::fs::read_to_string(file).unwrap();
        Scene::from_toml(&text).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        // Each says how it is run.
        let name = file.file_stem().unwrap().to_str().unwrap();
        assert!(text.contains(&format!("crowdquilt tile samples --scene examples/scenes/{name}.toml")), "{name}");
    }
}

#[test]
fn static_of_the_five_densities_and_a_denser_one() {
    for (density, people) in [(1, 16), (2, 34), (3, 48), (4, 60), (5, 70), (6, 288)] {
        let outcome = clean(&format!("static-{density}"), 1);
        assert_eq!(outcome.status, Status::Perfect);
        assert_eq!(outcome.crowd.characters.len(), people);
    }
}

fn hips(crowd: &Crowd) -> impl Iterator<Item = (f32, Vec3)> {
    let of = |c: &crowdquilt::stage::Character| {
        let begin = c.begin;
        c.root.iter().enumerate().map(move |(f, r)| ((begin as usize + f) as f32 / FPS, *r)).collect::<Vec<_>>()
    };
    crowd.characters.iter().flat_map(of)
}

/// How often somebody's hips are over an obstacle, in frames.
fn frames_over(crowd: &Crowd, obstacle: &Obstacle) -> usize {
    let over = |&(secs, p): &(f32, Vec3)| {
        let seen = obstacle.place(secs).inverse().apply(Vec2::new(p.x, p.z));
        obstacle.outline.signed_distance(seen) < 0.0
    };
    hips(crowd).filter(over).count()
}

#[test]
fn short_obstacles_are_jumped_over_and_tall_ones_are_not() {
    let outcome = clean("dynamic", 1);
    assert_eq!(outcome.status, Status::Perfect);
    let crowd = &outcome.crowd;
    let [low, tall] = &crowd.domain.obstacles[..] else { panic!("two obstacles") };
    let jumps = crowd.instances.iter().filter(|i| crowd.set.kinds[i.kind as usize].labels.iter().any(|l| l == "jump"));
    println!("{} jumps, {} frames over the low obstacle", jumps.clone().count(), frames_over(crowd, low));
    assert!(jumps.count() > 0 && frames_over(crowd, low) > 5, "nobody jumps");
    assert_eq!(frames_over(crowd, tall), 0);
}

#[test]
fn preferences_lead_people_round_the_fountain() {
    let scene = load("fountain");
    let mut plain = scene.clone();
    plain.preference.terms.clear();
    // How far people go clockwise round the fountain per second, on average, and their mean distance from its middle.
    let course = |scene: &Scene| {
        let outcome = run(scene, 2, Method::Engine);
        assert!(check(&outcome.crowd).ok());
        let (mut way, mut away, mut frames) = (0.0, 0.0, 0);
        for c in &outcome.crowd.characters {
            for w in c.root.windows(2) {
                let [a, b] = [w[0], w[1]].map(|p| Vec2::new(p.x, p.z) - Vec2::splat(7.0));
                way += (b - a).dot(Vec2::new(a.y, -a.x).normalize_or_zero());
                away += a.length();
                frames += 1;
            }
        }
        (way / frames as f32 * FPS, away / frames as f32)
    };
    let ((wanted, near), (chance, far)) = (course(&scene), course(&plain));
    println!("round the fountain {wanted:.2} m/s at {near:.2} m; without wishes {chance:.2} m/s at {far:.2} m");
    assert!(wanted > chance.abs() + 0.1, "{wanted} m/s against {chance} m/s");
    assert!(near < far - 0.2, "{near} m against {far} m");
}

#[test]
fn keyframed_patches_are_where_they_were_placed() {
    let scene = load("keyframing");
    let outcome = clean("keyframing", 1);
    assert_eq!(outcome.status, Status::Perfect);
    let crowd = &outcome.crowd;
    for placed in &scene.placed {
        let kind = crowd.set.kinds.iter().position(|k| k.name == placed.kind).unwrap();
        let tick = (placed.secs * FPS).round() as i32;
        let found = (0..crowd.instances.len()).filter(|&i| crowd.instances[i].kind as usize == kind).any(|i| {
            let uses = crowd.characters.iter().flat_map(|c| &c.fragments).filter(|f| f.instance as usize == i);
            let exact = |f: &crowdquilt::stage::FragmentUse| {
                let source = &crowd.set.kinds[kind].fragments[f.role as usize];
                let wanted = placed.at.then(source.motion.path.at(0));
                f.begin == tick + source.begin as i32 && f.points[0].distance(wanted.position) < 1e-3
            };
            let exact: Vec<bool> = uses.map(exact).collect();
            exact.len() == 10 && exact.iter().all(|&e| e)
        });
        assert!(found, "{placed:?} is not there");
    }
    assert_eq!(crowd.instances.iter().filter(|i| crowd.set.kinds[i.kind as usize].people() == 10).count(), 3);
}

#[test]
fn tiles_that_repeat_have_no_seam() {
    for (name, people) in [("repeating-tile", 55), ("endless", 48), ("endless-tile", 40)] {
        let outcome = clean(name, 1);
        assert_eq!(outcome.status, Status::Perfect);
        assert_eq!(outcome.crowd.characters.len(), people);
        assert_eq!(outcome.crowd.domain.periodic, load(name).periodic);
    }
}

#[test]
fn people_come_in_at_sources_and_go_out_at_sinks() {
    let scene = load("sources");
    let outcome = clean("sources", 1);
    assert_eq!(outcome.status, Status::Perfect);
    let crowd = outcome.crowd;
    assert_eq!(crowd.characters.len(), scene.people());
    let coming: usize = scene.sources.iter().map(|s| s.times.len()).sum();
    let late = || crowd.characters.iter().filter(|c| c.begin > 0);
    let gone = crowd.characters.iter().filter(|c| c.end() < crowd.domain.last_frame).count();
    println!("{} come in, {gone} go out", late().count());
    assert_eq!(late().count(), coming);
    assert!(gone > coming / 3, "{gone}");
    for c in late() {
        let frame = scene.sources.iter().flat_map(|s| &s.times).any(|t| (t * FPS).round() as u32 == c.begin);
        assert!(frame, "nobody was to come at frame {}", c.begin);
    }
    // Elsewhere they would dangle.
    let mut moved = crowd;
    for gate in moved.domain.sources.iter_mut().chain(&mut moved.domain.sinks) {
        *gate = crowdquilt::geom::Gate { from: Vec2::splat(6.0), to: Vec2::splat(6.0), ..gate.clone() };
    }
    let report = check(&moved);
    let row = report.failures().find(|r| r.row == "dangling ports").expect("they dangle");
    assert_eq!(row.value as usize, coming + gone);
}

#[test]
fn teams_line_up_and_bump_only_opponents() {
    let scene = load("hopping");
    let outcome = clean("hopping", 1);
    assert_eq!(outcome.status, Status::Perfect);
    let crowd = &outcome.crowd;
    assert_eq!(crowd.characters.len(), 30);
    let team = |c: &crowdquilt::stage::Character| {
        let first = c.fragments[0].points[0];
        scene.teams.iter().position(|t| t.start.signed_distance(first) <= 0.0).expect("in the place of a team")
    };
    let teams: Vec<usize> = crowd.characters.iter().map(team).collect();
    assert_eq!(teams.iter().filter(|&&t| t == 0).count(), 15);
    let mut bumps = 0;
    for i in 0..crowd.instances.len() {
        let kind = &crowd.set.kinds[crowd.instances[i].kind as usize];
        assert!(kind.labels.iter().any(|l| l == "hop"), "{}", kind.name);
        let plays = |c: usize| crowd.characters[c].fragments.iter().any(|f| f.instance as usize == i);
        let who: Vec<usize> = (0..30).filter(|&c| plays(c)).collect();
        if kind.people() == 2 {
            assert_ne!(teams[who[0]], teams[who[1]], "fellows bump at instance {i}");
            bumps += 1;
        }
    }
    println!("{bumps} bumps");
    assert!(bumps > 10, "{bumps}");
    // Nobody hops where nobody asked for it.
    assert!(clean("static-1", 2).crowd.set.kinds.iter().all(|k| k.labels.iter().all(|l| l != "hop")));
}

#[test]
fn box_movers_are_busy_with_boxes() {
    let outcome = clean("boxes", 5);
    assert_eq!(outcome.status, Status::Perfect);
    let crowd = &outcome.crowd;
    let (mut busy, mut all) = (0, 0);
    let mut kinds = std::collections::BTreeSet::new();
    for f in crowd.characters.iter().flat_map(|c| &c.fragments) {
        let kind = &crowd.set.kinds[crowd.instances[f.instance as usize].kind as usize];
        all += f.end - f.begin;
        if kind.labels.iter().any(|l| l == "carry" || l == "sit") {
            busy += f.end - f.begin;
            kinds.insert(kind.name.trim_end_matches("-mirror"));
        }
    }
    println!(
        "{} kinds with boxes, {:.2} of the time, {} boxes",
        kinds.len(),
        busy as f32 / all as f32,
        crowd.props.len()
    );
    assert!(kinds.len() >= 13 && 3 * busy > 2 * all && crowd.props.len() > 10, "{kinds:?}, {busy} of {all}");
}
