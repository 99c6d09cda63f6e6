//! The engine, from patch sets to checked crowds.

mod common;

use std::path::{Path, PathBuf};

use crowdquilt::check::{self, check};
use crowdquilt::geom::Polygon;
use crowdquilt::patch::{PatchSet, cut_folder};
use crowdquilt::refine::refine_crowd;
use crowdquilt::samples;
use crowdquilt::stage::Crowd;
use crowdquilt::tiling::{Options, Outcome, Scene, Status, tile};
use glam::Vec2;

fn options(seed: u64) -> Options {
    Options { seed, time_secs: 120.0, ..Options::default() }
}

fn run(scene: &Scene, set: &PatchSet, seed: u64) -> Outcome {
    tile(scene, set, &options(seed), &mut |_| true).unwrap()
}

fn sample_set() -> PatchSet {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("sample-takes");
    samples::write(&folder, 1).unwrap();
    cut_folder(&folder, None).unwrap()
}

fn assert_clean(outcome: &Outcome) {
    let report = check(&outcome.crowd);
    assert!(report.ok(), "{report}");
    assert_eq!((outcome.danglings, outcome.interpenetrations), (0, 0));
}

#[test]
fn the_demo_holds_its_promise_for_ten_seeds() {
    let set = sample_set();
    for seed in 1..=10 {
        let outcome = run(&Scene::demo(), &set, seed);
        let summary = check::summary(&outcome.crowd);
        println!("seed {seed}: {:?} in {:.2} s, {summary:?}", outcome.status, outcome.solve_secs);
        assert_clean(&outcome);
        assert!(summary.characters >= 70, "seed {seed}: {summary:?}");
        assert!(summary.instances >= 800, "seed {seed}: {summary:?}");
        assert!(summary.multi_person_share >= 0.25, "seed {seed}: {summary:?}");
    }
}

#[test]
fn walls_and_obstacles_are_kept_clear_of() {
    let corners = [(0.0, 0.0), (9.0, 0.0), (9.0, 4.0), (5.0, 4.0), (5.0, 9.0), (0.0, 9.0)];
    let mut scene = Scene::demo();
    scene.region = Polygon::new(corners.map(|(x, z)| Vec2::new(x, z)).to_vec()).unwrap();
    scene.obstacles = vec![Polygon::rectangle(Vec2::new(2.0, 2.0), Vec2::new(3.2, 2.8)).into()];
    scene.characters = 12;
    scene.duration_secs = 12.0;
    scene.interaction = 0.1;
    let outcome = run(&scene, &sample_set(), 4);
    assert_clean(&outcome);
    assert_eq!(outcome.crowd.characters.len(), 12);
}

#[test]
fn the_same_seed_gives_the_same_bytes_for_any_number_of_threads() {
    let set = common::plain_set();
    let mut scene = Scene::demo();
    scene.characters = 30;
    let bytes = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&scene, &set, 7).crowd.to_bytes())
    };
    let one = bytes(1);
    assert!(one == bytes(2), "1 and 2 threads differ");
    assert!(one == bytes(8), "1 and 8 threads differ");
    assert!(one != run(&scene, &set, 8).crowd.to_bytes(), "the seed has no effect");
}

#[test]
fn a_stopped_run_keeps_a_perfect_tiling() {
    let set = common::plain_set();
    let mut reports = 0;
    let outcome = tile(&Scene::demo(), &set, &options(1), &mut |_| {
        reports += 1;
        reports < 3
    })
    .unwrap();
    assert_eq!(reports, 3, "progress is told until it stops the run");
    assert!(matches!(outcome.status, Status::Short(_) | Status::Imperfect(_)), "{:?}", outcome.status);
    assert_eq!(outcome.danglings, 0);
    let dangling = check(&outcome.crowd).rows.into_iter().find(|r| r.row.contains("dangling")).unwrap();
    assert!(dangling.ok);
}

#[test]
fn an_exit_that_nothing_can_follow_is_named() {
    let mut set = common::plain_set();
    set.groups.push(crowdquilt::patch::PoseGroup { name: "upside_down".into() });
    set.kinds[0].fragments[0].exit_group = set.groups.len() as u32 - 1;
    let message = tile(&Scene::demo(), &set, &options(1), &mut |_| true).unwrap_err().to_string();
    assert!(message.contains(&set.kinds[0].name) && message.contains("upside_down"), "{message}");
}

#[test]
fn obstacles_that_fill_the_region_are_named() {
    let mut scene = Scene::demo();
    scene.obstacles = vec![Polygon::rectangle(Vec2::splat(-1.0), Vec2::splat(13.0)).into()];
    let message = tile(&scene, &common::plain_set(), &options(1), &mut |_| true).unwrap_err().to_string();
    assert!(message.contains("room"), "{message}");
}

#[test]
fn real_captures_make_a_perfect_crowd() {
    let Some(captures) = mocap() else {
        println!("SKIPPED: no captures (set CROWDQUILT_MOCAP to a folder of CMU captures)");
        return;
    };
    let takes = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/cmu");
    let set = cut_folder(&takes, Some(&captures)).unwrap();
    let scene = Scene::load(&takes.join("plaza.toml")).unwrap();
    for seed in 1..=5 {
        let outcome = run(&scene, &set, seed);
        println!(
            "seed {seed}: {:?} in {:.2} s, {:?}",
            outcome.status,
            outcome.solve_secs,
            check::summary(&outcome.crowd)
        );
        assert_clean(&outcome);
        assert_eq!(outcome.status, Status::Perfect, "seed {seed}");
        assert!(outcome.crowd.characters.len() >= 50);
    }
}

#[test]
fn files_keep_sets_and_crowds_bit_by_bit_and_bodies_can_be_made_anew() {
    let set = sample_set();
    assert!(PatchSet::from_bytes(&set.to_bytes()).unwrap() == set, "the set changes when it is saved");
    let scene = Scene { characters: 12, interaction: 0.1, duration_secs: 8.0, ..Scene::demo() };
    let crowd = run(&scene, &set, 3).crowd;
    assert!(Crowd::from_bytes(&crowd.to_bytes()).unwrap() == crowd, "the crowd changes when it is saved");
    assert!(refine_crowd(&crowd) == crowd, "bodies made anew from the fragments differ");
}

fn mocap() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = std::env::var_os("CROWDQUILT_MOCAP").map_or_else(|| root.join("../shared/mocap"), PathBuf::from);
    folder.join("index.csv").exists().then_some(folder)
}
