//! Domains that repeat: tiled, unrolled and checked; seams planted by hand are found.

mod common;

use std::sync::LazyLock;

use crowdquilt::check::{Report, check};
use crowdquilt::geom::{Obstacle, Periodic, Polygon, Waypoint};
use crowdquilt::patch::{PatchSet, cut_folder};
use crowdquilt::refine::refine_crowd;
use crowdquilt::stage::{Crowd, FragmentUse};
use crowdquilt::tiling::{Method, Options, Scene, Status, tile};
use glam::{Vec2, Vec3};

static SAMPLES: LazyLock<PatchSet> = LazyLock::new(|| {
    let folder = std::env::temp_dir().join(format!("crowdquilt-repeating-{}", std::process::id()));
    crowdquilt::samples::write(&folder, 1).unwrap();
    let set = cut_folder(&folder, None).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    set
});

/// A tile of 8 x 7 m that repeats in space and time.
static TILE: LazyLock<Crowd> = LazyLock::new(|| tiled(&scene("xzt"), 1));

fn scene(axes: &str) -> Scene {
    let region = Polygon::rectangle(Vec2::new(1.0, -2.0), Vec2::new(9.0, 5.0));
    let periodic = Periodic { x: axes.contains('x'), z: axes.contains('z'), t: axes.contains('t') };
    Scene { periodic, interaction: 0.25, ..Scene::new(region, 12.0, 14) }
}

fn tiled(scene: &Scene, seed: u64) -> Crowd {
    let outcome = tile(scene, &SAMPLES, &Options { seed, ..Options::default() }, &mut |_| true).unwrap();
    assert_eq!(outcome.status, Status::Perfect, "seed {seed}");
    outcome.crowd
}

fn assert_clean(crowd: &Crowd) {
    let report = check(crowd);
    assert!(report.ok(), "{report}");
}

fn failures(report: &Report) -> String {
    report.failures().map(|r| format!("{}: {}\n", r.row, r.value)).collect()
}

fn ground(p: Vec3) -> Vec2 {
    Vec2::new(p.x, p.z)
}

#[test]
fn every_combination_is_tiled_without_a_seam() {
    for axes in ["x", "z", "t", "xz", "xt", "zt", "xzt"] {
        let crowd = tiled(&scene(axes), 2);
        assert_clean(&crowd);
        let unrolled = crowd.unrolled(3, 3, 3);
        assert!(unrolled.domain.periodic.none());
        assert_clean(&unrolled);
        assert!(crowd.set.kinds.iter().all(|k| k.props.is_empty()), "boxes would have to be in two places");
        assert_eq!(Crowd::from_bytes(&crowd.to_bytes()).unwrap(), crowd, "{axes}");
    }
}

#[test]
fn patches_that_began_before_time_did_find_people_in_any_tile() {
    // More company than there can be: it is looked for everywhere, at the first tick too.
    let scene = Scene { interaction: 1.0, ..scene("xz") };
    for seed in 1..4 {
        let options = Options { seed, time_secs: 4.0, ..Options::default() };
        let crowd = tile(&scene, &SAMPLES, &options, &mut |_| true).unwrap().crowd;
        assert!(crowd.instances.len() > 50, "seed {seed}");
    }
}

#[test]
fn borders_are_crossed_and_laps_go_on_in_the_midst_of_things() {
    let crowd = &*TILE;
    let (low, high) = crowd.domain.region.bounds();
    let crosses = |p: &Vec3| ground(*p).cmplt(low).any() || ground(*p).cmpgt(high).any();
    let crossers = crowd.characters.iter().filter(|c| c.root.iter().any(crosses)).count();
    let lap = crowd.domain.last_frame as i32;
    let last = crowd.characters.iter().filter(|c| c.fragments.last().unwrap().end > lap).count();
    assert!(crossers >= 3 && last >= 8, "{crossers} cross a border, {last} are under way when the lap ends");
}

#[test]
fn people_of_one_patch_may_be_in_different_tiles() {
    let is_apart = |crowd: &Crowd| {
        let parts = || crowd.characters.iter().flat_map(|c| &c.fragments);
        let far =
            |f: &FragmentUse| parts().any(|g| g.instance == f.instance && g.points[0].distance(f.points[0]) > 4.5);
        parts().any(far)
    };
    let apart: Vec<Crowd> = (1..=12).map(|seed| tiled(&scene("xz"), seed)).filter(is_apart).collect();
    assert!(!apart.is_empty());
    apart.iter().for_each(assert_clean);
}

#[test]
fn everybody_of_the_endless_crowd_is_in_the_block() {
    let crowd = &*TILE;
    let unrolled = crowd.unrolled(3, 2, 2);
    let (low, high) = crowd.domain.region.bounds();
    let end = low + (high - low) * Vec2::new(3.0, 2.0);
    for frame in [0, 100, 500, 720] {
        let at = |c: &crowdquilt::stage::Character| ground(c.root[frame]);
        let inside = |p: &Vec2| p.cmpge(low).all() && p.cmplt(end).all();
        let found = unrolled.characters.iter().map(at).filter(inside).count();
        assert_eq!(found, 6 * crowd.characters.len(), "frame {frame}");
    }
    assert_eq!(unrolled.domain.last_frame, 2 * crowd.domain.last_frame);
    assert_eq!(unrolled.unrolled(3, 3, 3), unrolled, "nothing is left that repeats");
}

#[test]
fn where_and_when_a_tile_begins_changes_nothing() {
    for (by, frames) in [(Vec2::new(3.3, -20.0), 0), (Vec2::ZERO, 100), (Vec2::new(-0.7, 4.1), 355)] {
        let shifted = TILE.shifted(by, frames);
        assert_clean(&shifted);
        assert_eq!(shifted.characters.len(), TILE.characters.len());
        assert_eq!(shifted.domain.periodic, TILE.domain.periodic);
    }
    let mut broken = TILE.clone();
    overlap(&mut broken);
    for (by, frames) in [(Vec2::ZERO, 0), (Vec2::new(2.0, 1.0), 200)] {
        assert!(!check(&broken.shifted(by, frames)).ok());
    }
}

#[test]
fn refined_again_it_is_the_same() {
    let again = refine_crowd(&TILE);
    assert_eq!(again.domain, TILE.domain);
    for (a, b) in again.characters.iter().zip(&TILE.characters) {
        let apart = a.root.iter().zip(&b.root).map(|(p, q)| p.distance(*q)).fold(0.0, f32::max);
        assert!(apart < 1e-3 && a.begin == b.begin && a.frames() == b.frames(), "{apart}");
    }
}

#[test]
fn the_last_frame_goes_on_into_the_first() {
    let torus = TILE.domain.torus();
    for c in &TILE.characters {
        let n = c.frames();
        assert_eq!((c.begin, n), (0, TILE.domain.last_frame as usize + 1));
        assert!(torus.nearest3(c.root[n - 1] - c.root[0]).length() < 1e-4);
        let steps = [c.root[1] - c.root[0], c.root[n - 1] - c.root[n - 2]];
        assert!(steps[0].distance(steps[1]) < 0.012, "{steps:?}");
    }
}

/// Whoever is last is put where the image of somebody else across the border in x is.
fn overlap(crowd: &mut Crowd) {
    let period = crowd.domain.torus().period();
    let other = crowd.characters[0].root.clone();
    let c = crowd.characters.last_mut().unwrap();
    let by = other[30] - c.root[30] + Vec3::new(period.x, 0.0, 0.0);
    c.root.iter_mut().for_each(|p| *p += Vec3::new(by.x, 0.0, by.z));
    c.fragments.iter_mut().flat_map(|f| &mut f.points).for_each(|p| *p += ground(by));
}

#[test]
fn seams_planted_by_hand_are_found() {
    let mut across = TILE.clone();
    overlap(&mut across);
    let found = failures(&check(&across));
    assert!(found.contains("border: bodies of different patches overlap"), "{found}");

    let mut jump = TILE.clone();
    let c = &mut jump.characters[3];
    let n = c.frames();
    c.root[n - 1].x += 0.05;
    let found = failures(&check(&jump));
    assert!(found.contains("seam in time: from the last to the first place: 0.05"), "{found}");

    let mut slide = TILE.clone();
    let c = &mut slide.characters[5];
    // Over the last second all of a person slides 5 cm away, to be back at the first frame of the next lap.
    let n = c.frames();
    (0..30).for_each(|k| c.root[n - 31 + k].z += 0.05 * k as f32 / 30.0);
    let found = failures(&check(&slide));
    assert!(found.contains("seam in time: joint"), "{found}");

    let mut turned = TILE.clone();
    let c = &mut turned.characters[2];
    let k = c.rotations.len() - crowdquilt::motion::JOINT_COUNT + 5;
    c.rotations[k] = glam::Quat::from_rotation_x(0.1) * c.rotations[k];
    let found = failures(&check(&turned));
    assert!(found.contains("seam in time: from the last to the first pose"), "{found}");

    let mut stranger = TILE.clone();
    let late = stranger.characters.iter().position(|c| c.fragments.last().unwrap().end > 360).unwrap();
    stranger.characters[late].fragments.last_mut().unwrap().end += 4;
    let found = failures(&check(&stranger));
    assert!(found.contains("seam in time: chains that do not go on"), "{found}");

    let mut short = TILE.clone();
    short.domain.last_frame -= 1;
    let found = failures(&check(&short));
    assert!(found.contains("tiles and laps that cannot repeat"), "{found}");
}

#[test]
fn obstacles_repeat_too() {
    let mut scene = scene("xzt");
    scene.characters = 8;
    scene.interaction = 0.1;
    scene.obstacles.push(Polygon::rectangle(Vec2::new(8.4, 0.0), Vec2::new(9.6, 1.0)).into());
    let at = |secs: f32, x: f32| Waypoint { secs, position: Vec2::new(x, 3.0), heading: 0.0 };
    let outline = Polygon::rectangle(Vec2::splat(-0.3), Vec2::splat(0.3));
    // It goes on into the next tile, where it is when the next lap begins.
    scene.obstacles.push(Obstacle { outline, height: None, path: vec![at(0.0, 2.0), at(12.0, 10.0)] });
    let crowd = tiled(&scene, 1);
    assert_clean(&crowd);
    assert_clean(&crowd.shifted(Vec2::new(2.0, 1.0), 77));
    let inside = crowd.unrolled(3, 3, 3).domain.obstacles;
    assert!(inside.iter().filter(|o| o.path.is_empty()).count() >= 9);
}

#[test]
fn what_cannot_repeat_is_refused() {
    let problem = |scene: &Scene, method: Method| {
        let options = Options { method, ..Options::default() };
        tile(scene, &common::plain_set(), &options, &mut |_| true).unwrap_err().to_string()
    };
    assert!(problem(&scene("x"), Method::Paper).contains("periodic"));
    let mut narrow = scene("z");
    narrow.region = Polygon::rectangle(Vec2::ZERO, Vec2::new(20.0, 4.0));
    assert!(problem(&narrow, Method::Engine).contains("at least 6 m along z"));
    let mut crowd = TILE.clone();
    crowd.domain.region.points[2].x += 1.0;
    assert!(Crowd::from_bytes(&crowd.to_bytes()).unwrap_err().to_string().contains("rectangle"));
}
