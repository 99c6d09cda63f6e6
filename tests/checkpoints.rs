//! Checkpoints: what was placed is there again, runs go on from it to the same end for any number of threads, and broken
//! files are refused by name.

mod common;

use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use common::plain_set;
use crowdquilt::check::check;
use crowdquilt::geom::{Periodic, Polygon};
use crowdquilt::patch::{PatchSet, cut_folder};
use crowdquilt::stage::Crowd;
use crowdquilt::tiling::{
    Checkpoint, Keep, Method, Options, Outcome, Scene, Session, Stage, Status, review, tile, tile_in,
};
use glam::Vec2;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

static SAMPLES: LazyLock<PatchSet> = LazyLock::new(|| {
    let folder = std::env::temp_dir().join(format!("crowdquilt-checkpoints-{}", std::process::id()));
    crowdquilt::samples::write(&folder, 1).unwrap();
    let set = cut_folder(&folder, None).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    set
});

/// A file that is removed with it.
struct Temporary(PathBuf);

impl Temporary {
    fn new(name: &str) -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        Self(std::env::temp_dir().join(format!("crowdquilt-{name}-{}-{number}.tiling", std::process::id())))
    }

    fn keep(&self) -> Keep<'_> {
        Keep { path: &self.0, every_secs: 0.05, patches: None }
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// A run that is stopped at its `reports`-th report; what was kept of it when it ended.
fn stopped(scene: &Scene, set: &PatchSet, reports: usize, name: &str) -> Checkpoint {
    let (file, mut told) = (Temporary::new(name), 0);
    let session = Session { keep: Some(file.keep()), ..Session::default() };
    let mut progress = |_: &_| {
        told += 1;
        told < reports
    };
    let outcome = tile_in(session, scene, set, &Options::default(), &mut progress).unwrap();
    assert_eq!(outcome.unkept, None);
    Checkpoint::load(&file.0).unwrap()
}

fn on(
    from: &Checkpoint,
    scene: &Scene,
    set: &PatchSet,
    time_secs: f64,
    keep: Option<Keep>,
) -> crowdquilt::Result<Outcome> {
    let options = Options { seed: from.seed, time_secs, method: Method::Engine };
    tile_in(Session { from: Some(from), keep, steps: None }, scene, set, &options, &mut |_| true)
}

/// What is kept of a run that goes on for no time at all.
fn kept_again(from: &Checkpoint, set: &PatchSet, name: &str) -> Checkpoint {
    let file = Temporary::new(name);
    on(from, &from.scene, set, 0.0, Some(file.keep())).unwrap();
    let mut again = Checkpoint::load(&file.0).unwrap();
    again.reached.secs = from.reached.secs;
    again
}

fn example(name: &str) -> Scene {
    Scene::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("examples/scenes/{name}.toml"))).unwrap()
}

#[test]
fn every_piece_of_every_kind_of_scene_is_there_again() {
    for name in ["static-3", "dynamic", "sources", "hopping", "boxes", "keyframing", "repeating-tile", "endless-tile"] {
        let scene = example(name);
        let kept = stopped(&scene, &SAMPLES, 5, name);
        assert_eq!(kept.scene, scene);
        assert_eq!(Checkpoint::from_bytes(&kept.to_bytes()).unwrap(), kept);
        if kept.stage() < Stage::Mend {
            assert_eq!(kept_again(&kept, &SAMPLES, &format!("{name}-again")), kept, "{name}");
        }
        if !["sources", "boxes", "keyframing", "endless-tile"].contains(&name) {
            continue;
        }
        // Through to the end, and on to a perfect one.
        let outcome = on(&kept, &scene, &SAMPLES, 120.0, None).unwrap();
        let report = check(&outcome.crowd);
        println!(
            "{name}: {} people kept, {:?} with {}",
            kept.reached.people,
            outcome.status,
            outcome.crowd.characters.len()
        );
        assert!(report.ok(), "{name}: {report}");
        assert!(outcome.crowd.characters.len() >= kept.reached.people);
        assert_eq!(outcome.status, Status::Perfect, "{name}");
    }
}

#[test]
fn all_runs_on_from_a_checkpoint_end_alike() {
    let kept = stopped(&Scene::demo(), &SAMPLES, 4, "alike");
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| on(&kept, &kept.scene, &SAMPLES, 120.0, None).unwrap().crowd.to_bytes())
    };
    let one = run(1);
    assert_eq!(one, run(2));
    assert!(check(&Crowd::from_bytes(&one).unwrap()).ok());
}

#[test]
fn a_finished_tiling_becomes_denser() {
    let sparse = Scene { characters: 30, ..Scene::demo() };
    let kept = stopped(&sparse, &SAMPLES, usize::MAX, "denser");
    assert_eq!((kept.stage(), kept.reached.people), (Stage::Mend, 30));
    assert_eq!(review(&kept, &sparse, &SAMPLES).unwrap().status, Status::Perfect);
    let dense = Scene { characters: 60, ..sparse };
    assert!(
        matches!(review(&kept, &dense, &SAMPLES).unwrap().status, Status::Short(why) if why.starts_with("30 of 60"))
    );
    let outcome = on(&kept, &dense, &SAMPLES, 120.0, None).unwrap();
    assert_eq!((outcome.status, outcome.crowd.characters.len()), (Status::Perfect, 60));
    assert!(check(&outcome.crowd).ok());
}

#[test]
fn keeping_changes_nothing_and_the_time_limit_holds() {
    let file = Temporary::new("nothing");
    let session = Session { keep: Some(Keep { every_secs: 0.0, ..file.keep() }), ..Session::default() };
    let (scene, set) = (Scene { characters: 20, ..Scene::demo() }, plain_set());
    let kept = tile_in(session, &scene, &set, &Options::default(), &mut |_| true).unwrap();
    let plain = tile(&scene, &set, &Options::default(), &mut |_| true).unwrap();
    assert_eq!(kept.crowd.to_bytes(), plain.crowd.to_bytes());
    let nowhere = Keep { path: Path::new("/nowhere/at/all.tiling"), every_secs: 0.0, patches: None };
    let session = Session { keep: Some(nowhere), ..Session::default() };
    let unkept = tile_in(session, &scene, &set, &Options::default(), &mut |_| true).unwrap();
    assert!(unkept.unkept.unwrap().contains("/nowhere/at/all.tiling") && unkept.status == Status::Perfect);
}

/// A small tiling of the plain set.
fn small(periodic: Periodic) -> Checkpoint {
    let scene =
        Scene { periodic, interaction: 0.0, ..Scene::new(Polygon::rectangle(Vec2::ZERO, Vec2::splat(6.0)), 6.0, 5) };
    stopped(&scene, &plain_set(), usize::MAX, &format!("small-{}", u8::from(periodic.t)))
}

fn refusal(bytes: &[u8]) -> String {
    Checkpoint::from_bytes(bytes).expect_err("expected to be refused").to_string()
}

#[test]
fn damaged_files_are_refused() {
    let bytes = small(Periodic::default()).to_bytes();
    for n in 0..bytes.len() {
        assert!(Checkpoint::from_bytes(&bytes[..n]).is_err(), "cut at {n}");
    }
    for at in 0..bytes.len() {
        let mut flipped = bytes.clone();
        flipped[at] ^= 1 << (at % 8);
        assert!(Checkpoint::from_bytes(&flipped).is_err(), "flipped at {at}");
    }
    let mut newer = bytes.clone();
    newer[8] = 2;
    assert!(refusal(&newer).contains("expected version 1, found 2"));
    assert!(refusal(b"CQCROWD\0").contains("CQTILNG"));
    let end = bytes.len() - 20;
    let mut damaged = bytes.clone();
    damaged[end] ^= 1;
    assert!(refusal(&damaged).contains("the file is damaged"), "{}", refusal(&damaged));
}

#[test]
fn another_set_and_other_scenes_are_refused() {
    let kept = small(Periodic::default());
    let told = |set: &PatchSet, scene: &Scene| on(&kept, scene, set, 0.0, None).unwrap_err().to_string();
    let mut other = plain_set();
    other.kinds[0].labels.push("other".into());
    assert!(told(&other, &kept.scene).contains("patch set"));
    let longer = Scene { duration_secs: 9.0, ..kept.scene.clone() };
    assert!(told(&plain_set(), &longer).contains("person 0: expected a life that fills the scene's time"));
    let round = Scene { periodic: Periodic { t: true, ..Periodic::default() }, ..kept.scene.clone() };
    assert!(told(&plain_set(), &round).contains("comes round"));
    let paper = Options { method: Method::Paper, ..Options::default() };
    let session = Session { from: Some(&kept), ..Session::default() };
    assert!(
        tile_in(session, &kept.scene, &plain_set(), &paper, &mut |_| true).unwrap_err().to_string().contains("engine")
    );
}

/// Where an array of a container begins, in bytes.
fn array_at(bytes: &[u8], name: &str) -> usize {
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let header: serde_json::Value = serde_json::from_slice(&bytes[24..24 + length]).unwrap();
    24 + length + header["arrays"][name]["offset"].as_u64().unwrap() as usize
}

fn forged(bytes: &[u8], at: usize, word: [u8; 4]) -> Vec<u8> {
    let mut forged = bytes.to_vec();
    forged[at..at + 4].copy_from_slice(&word);
    Checkpoint::sign(&mut forged);
    forged
}

#[test]
fn forged_numbers_are_named() {
    let kept = small(Periodic::default());
    let bytes = kept.to_bytes();
    let played = array_at(&bytes, "played");
    let kind = forged(&bytes, played, 999u32.to_le_bytes());
    assert!(refusal(&kind).contains("person 0, piece 0: expected one of") && refusal(&kind).contains("999"));
    let nan = forged(&bytes, array_at(&bytes, "ways"), f32::NAN.to_le_bytes());
    assert!(refusal(&nan).contains("person 0, piece 0: expected finite places"));
    let time = forged(&bytes, array_at(&bytes, "times"), i32::MAX.to_le_bytes());
    assert!(refusal(&time).contains("expected an end after the beginning"));
    let lives = forged(&bytes, array_at(&bytes, "lives"), u32::MAX.to_le_bytes());
    assert!(refusal(&lives).contains("arrays"));
    // What only the set tells.
    let resumed = |bytes: &[u8]| {
        let kept = Checkpoint::from_bytes(bytes).unwrap();
        on(&kept, &kept.scene, &plain_set(), 0.0, None).unwrap_err().to_string()
    };
    assert!(
        resumed(&forged(&bytes, played + 4, 7u32.to_le_bytes())).contains("expected one of 1 roles, found number 7")
    );
    let away = forged(&bytes, array_at(&bytes, "ways"), 3.5f32.to_le_bytes());
    assert!(resumed(&away).contains("person 0, piece 1: expected it to begin at"), "{}", resumed(&away));
}

#[test]
fn whatever_is_forged_nothing_panics() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let (mut refused, mut played) = (0, 0);
    for kept in [small(Periodic::default()), small(Periodic { t: true, ..Periodic::default() })] {
        let bytes = kept.to_bytes();
        let first = array_at(&bytes, "lives");
        for _ in 0..150 {
            let mut odd = bytes.clone();
            for _ in 0..rng.random_range(1..4) {
                let at = first + 4 * rng.random_range(0..(bytes.len() - first) / 4 - 2);
                let word = [rng.next_u32(), rng.random_range(0..20), rng.random_range(-9.0f32..9.0).to_bits()]
                    [rng.random_range(0..3)];
                odd = forged(&odd, at, word.to_le_bytes());
            }
            let outcome = Checkpoint::from_bytes(&odd).and_then(|kept| on(&kept, &kept.scene, &plain_set(), 0.0, None));
            if outcome.is_ok() { played += 1 } else { refused += 1 }
        }
    }
    println!("{refused} refused, {played} played");
    assert!(refused > 200);
}
