//! Wang tiles: planes of any size, checked whole.

mod common;

use std::sync::LazyLock;

use crowdquilt::check::check;
use crowdquilt::geom::Polygon;
use crowdquilt::patch::{PatchSet, cut_folder};
use crowdquilt::stage::{Character, Crowd};
use crowdquilt::tiling::{Method, Options, Outcome, Scene, Status, Wang, tile};
use glam::Vec2;

static SAMPLES: LazyLock<PatchSet> = LazyLock::new(|| {
    let folder = std::env::temp_dir().join(format!("crowdquilt-wang-{}", std::process::id()));
    crowdquilt::samples::write(&folder, 1).unwrap();
    let set = cut_folder(&folder, None).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    set
});

/// Tiles of 9 m between two corners, counted in tiles.
fn scene(low: [f32; 2], high: [f32; 2], characters_per_tile: usize) -> Scene {
    let wang = Wang { tile: 9.0, colours: 2, variants: 1 };
    let (low, high) = (Vec2::from(low), Vec2::from(high));
    let tiles = (high - low).element_product() as usize;
    let region = Polygon::rectangle(low * wang.tile, high * wang.tile);
    Scene { wang: Some(wang), interaction: 0.2, ..Scene::new(region, 10.0, characters_per_tile * tiles) }
}

fn run(scene: &Scene, set: &PatchSet, seed: u64) -> Outcome {
    tile(scene, set, &Options { seed, time_secs: 600.0, ..Options::default() }, &mut |_| true).unwrap()
}

#[test]
fn three_by_three_tiles_are_perfect_and_hold_every_row_of_the_check() {
    let scene = scene([0.0, 0.0], [3.0, 3.0], 28);
    let outcome = run(&scene, &SAMPLES, 1);
    let report = check(&outcome.crowd);
    assert!(report.ok(), "{report}");
    assert_eq!(outcome.status, Status::Perfect);
    let crowd = outcome.crowd;
    assert_eq!(crowd.characters.len(), 28 * 9);
    let tile_at = |c: &Character, frame: usize| (Vec2::new(c.root[frame].x, c.root[frame].z) / 9.0).floor();
    let cross = |c: &&Character| (0..c.root.len()).any(|f| tile_at(c, f) != tile_at(c, 0));
    let crossing = crowd.characters.iter().filter(cross).count();
    println!("{crossing} of {} people go from tile to tile", crowd.characters.len());
    assert!(crossing >= 2 * 12, "{crossing}");
    // Whoever is in a file is as they are in memory.
    let again = Crowd::from_bytes(&crowd.to_bytes()).unwrap();
    assert!(check(&again).ok());
}

#[test]
fn threads_change_nothing() {
    let scene = scene([-1.0, 0.0], [1.0, 2.0], 20);
    let bytes = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&scene, &common::plain_set(), 4).crowd.to_bytes())
    };
    assert!(bytes(1) == bytes(3));
}

/// The ways of those who never leave a tile, from its corner.
fn residents(crowd: &Crowd, place: Vec2) -> Vec<Vec<Vec2>> {
    let corner = place * 9.0;
    let way = |c: &Character| c.root.iter().map(|p| Vec2::new(p.x, p.z) - corner).collect::<Vec<_>>();
    let stays = |w: &Vec<Vec2>| w.iter().all(|p| p.min_element() >= 0.0 && p.max_element() <= 9.0);
    crowd.characters.iter().map(way).filter(stays).collect()
}

#[test]
fn a_place_has_the_same_tile_in_every_region_that_it_is_inside_of() {
    let set = common::plain_set();
    let crowd = |low, high| run(&scene(low, high, 20), &set, 6).crowd;
    let (one, other) = (crowd([0.0, 0.0], [3.0, 3.0]), crowd([-1.0, 0.0], [3.0, 4.0]));
    let same = |place: Vec2| {
        let (a, b) = (residents(&one, place), residents(&other, place));
        // Hips follow legs, and legs follow whose they are.
        let close = |v: &Vec<Vec2>, w: &Vec<Vec2>| v.iter().zip(w).all(|(p, q)| p.distance(*q) < 0.02);
        assert!(a.len() > 5);
        a.len() == b.len() && a.iter().zip(&b).all(|(v, w)| close(v, w))
    };
    assert!(same(Vec2::ONE));
    // At the rim nobody crosses.
    assert!(!same(Vec2::new(0.0, 1.0)));
}

#[test]
fn what_tiles_cannot_do_is_refused_by_name() {
    let mut scene = scene([0.0, 0.0], [2.0, 2.0], 10);
    let told = |scene: &Scene, method: Method| {
        let options = Options { method, ..Options::default() };
        tile(scene, &common::plain_set(), &options, &mut |_| true).unwrap_err().to_string()
    };
    assert!(told(&scene, Method::Paper).contains("wang"));
    scene.periodic.t = true;
    let problem = told(&scene, Method::Engine);
    assert!(problem.contains("periodic") && problem.contains("wang"), "{problem}");
    // So many cannot cross an edge without meeting.
    scene.periodic.t = false;
    scene.characters = 4 * 4000;
    let problem = told(&scene, Method::Engine);
    assert!(problem.contains("room") && problem.contains("cross"), "{problem}");
}

#[test]
fn all_problems_of_a_file_are_told_with_their_lines() {
    let text = "region = [[0, 0], [25, 0], [25, 20], [0, 20]]\nduration_secs = 20\ndensity = 0.4\nperiodic = [\"t\"]\n\
                obstacles = [[[1, 1], [2, 1], [2, 2]]]\n\n[wang]\ntile = 10\ncolours = 2\n";
    let problem = Scene::from_toml(text).unwrap_err().to_string();
    for told in ["line 1", "whole tiles of 10 m", "[25, 20]", "line 4: periodic", "line 5", "obstacle"] {
        assert!(problem.contains(told), "{told}: {problem}");
    }
    let wrong = "region = [[0, 0], [20, 0], [20, 20], [0, 20]]\nduration_secs = 20\ndensity = 0.4\n[wang]\ntile = 3\n\
                 colours = 0\nvariant = 2\n";
    let problem = Scene::from_toml(wrong).unwrap_err().to_string();
    for told in ["line 5", "from 8 to 100", "line 6", "colours", "line 7", "variant"] {
        assert!(problem.contains(told), "{told}: {problem}");
    }
}

#[test]
fn the_example_is_what_it_says() {
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scenes/wang.toml");
    let scene = Scene::load(&file).unwrap();
    assert_eq!((scene.characters, scene.wang), (4000, Some(Wang { tile: 10.0, colours: 4, variants: 2 })));
}
