//! The published baseline on a plain patch set.

mod common;

use crowdquilt::check::{Limits, check_with};
use crowdquilt::stage::Crowd;
use crowdquilt::tiling::{Method, Options, Outcome, Phase, Progress, Scene, Status, tile};

fn run(scene: &Scene, seed: u64, progress: &mut dyn FnMut(&Progress) -> bool) -> Outcome {
    let options = Options { method: Method::Paper, seed, time_secs: 30.0 };
    tile(scene, &common::plain_set(), &options, progress).unwrap()
}

fn small() -> Scene {
    Scene { characters: 30, ..Scene::demo() }
}

/// Entries and exits inside the domain's time that lead nowhere, counted in the crowd itself.
fn loose_ends(crowd: &Crowd) -> usize {
    let loose = |c: &crowdquilt::stage::Character| {
        let (first, last) = (c.fragments.first().unwrap(), c.fragments.last().unwrap());
        usize::from(first.begin > 0) + usize::from(last.end <= crowd.domain.last_frame as i32)
    };
    crowd.characters.iter().map(loose).sum()
}

#[test]
fn the_crowd_keeps_the_contract() {
    for seed in 1..4 {
        let outcome = run(&small(), seed, &mut |_| true);
        let crowd = &outcome.crowd;
        eprintln!(
            "seed {seed}: {:?} {} characters {} instances in {:.2} s",
            outcome.status,
            crowd.characters.len(),
            crowd.instances.len(),
            outcome.solve_secs
        );
        assert!(!matches!(outcome.status, Status::Imperfect(_)), "{:?}", outcome.status);
        assert_eq!((outcome.danglings, outcome.interpenetrations, loose_ends(crowd)), (0, 0, 0));
        assert!(crowd.characters.len() >= 20);
        assert!(crowd.instances.iter().any(|i| crowd.set.kinds[i.kind as usize].people() == 2));
        let report = check_with(crowd, &Limits::default());
        assert!(report.ok(), "{report}");
    }
}

#[test]
fn a_run_that_is_stopped_tells_its_danglings_truly() {
    let scene = Scene { characters: 150, ..Scene::demo() };
    let outcome = run(&scene, 1, &mut |p| p.phase != Phase::Close);
    assert!(matches!(&outcome.status, Status::Imperfect(why) if why.contains("dangling")), "{:?}", outcome.status);
    assert!(outcome.danglings > 0);
    assert_eq!(outcome.danglings, loose_ends(&outcome.crowd));
    let bytes = outcome.crowd.to_bytes();
    assert_eq!(loose_ends(&Crowd::from_bytes(&bytes).unwrap()), outcome.danglings);
}

#[test]
fn the_same_seed_gives_the_same_crowd_on_any_number_of_threads() {
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&Scene { characters: 15, ..small() }, 7, &mut |_| true).crowd.to_bytes())
    };
    assert!(on(1) == on(3));
}

#[test]
fn obstacles_are_kept_out_of() {
    let mut scene = Scene { characters: 20, ..small() };
    let (low, high) = (glam::Vec2::new(4.0, 5.0), glam::Vec2::new(7.0, 6.5));
    scene.obstacles.push(crowdquilt::geom::Polygon::rectangle(low, high).into());
    let outcome = run(&scene, 2, &mut |_| true);
    assert!(!matches!(outcome.status, Status::Imperfect(_)), "{:?}", outcome.status);
    for root in outcome.crowd.characters.iter().flat_map(|c| &c.root) {
        let p = glam::Vec2::new(root.x, root.z);
        assert!(scene.obstacles[0].outline.signed_distance(p) > 0.1, "{p}");
    }
}
