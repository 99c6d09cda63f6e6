//! Patch sets that make themselves: of real captures (see `mocap`) and of the samples without their annotation.

mod mocap;

use std::collections::BTreeSet;
use std::path::Path;

use crowdquilt::check::check;
use crowdquilt::motion::take::TakeFile;
use crowdquilt::patch::{Made, MakeOptions, PatchKind, PatchSet, make};
use crowdquilt::samples;
use crowdquilt::tiling::{Options, Scene, Status, tile};

fn own(set: &PatchSet) -> impl Iterator<Item = &PatchKind> {
    set.kinds.iter().filter(|k| !k.mirrored)
}

fn captured() -> Option<Made> {
    let folder = mocap::folder()?;
    let start = std::time::Instant::now();
    let made = make(&[folder.join("index.csv")], &MakeOptions::default()).unwrap();
    println!("made in {:.2} s", start.elapsed().as_secs_f64());
    Some(made)
}

#[test]
fn raw_captures_make_a_set_of_many_kinds_and_few_pose_groups() {
    let Some(made) = captured() else { return };
    let alone = own(&made.set).filter(|k| k.people() == 1).count();
    let together = own(&made.set).filter(|k| k.people() > 1).count();
    println!("{alone} kinds of one person, {together} of several, {} groups", made.set.groups.len());
    assert!(alone + together >= 43 && alone >= 27 && together >= 16);
    assert!(made.set.groups.len() <= 4, "{:?}", made.set.groups);
    assert!(made.set.validate().is_empty());
}

#[test]
fn the_handshake_is_one_event_and_one_patch() {
    let Some(made) = captured() else { return };
    let take = made.takes.iter().position(|t| t.take.name == "18_01-19_01").unwrap();
    let annotation = made.annotation.as_ref().unwrap();
    assert_eq!((annotation.found[take].events.len(), made.takes[take].take.patches.len()), (1, 1));
}

/// The six salsa takes: most of the time is in patches of two, and what one ends with others begin with.
#[test]
fn dances_are_covered_by_patches_that_can_follow_one_another() {
    let Some(made) = captured() else { return };
    let annotation = made.annotation.as_ref().unwrap();
    let (mut covered, mut frames) = (0.0, 0);
    for (i, t) in made.takes.iter().enumerate().filter(|(_, t)| t.take.description == "salsa dance") {
        let length = annotation.found[i].frames[0];
        println!("{}: {:.0} % of {length} frames", t.take.name, 100.0 * made.together(i));
        covered += made.together(i) * length as f32;
        frames += length;
    }
    println!("all dances: {:.1} % of {frames} frames", 100.0 * covered / frames as f32);
    assert!(frames > 5000 && covered >= 0.6 * frames as f32);
    let dances: Vec<&PatchKind> = made.set.kinds.iter().filter(|k| k.labels.iter().any(|l| l == "salsa")).collect();
    let entries: BTreeSet<u32> = dances.iter().flat_map(|k| &k.fragments).map(|f| f.entry_group).collect();
    let follows = |k: &&&PatchKind| k.fragments.iter().all(|f| entries.contains(&f.exit_group));
    assert_eq!(dances.iter().filter(follows).count(), dances.len());
}

#[test]
fn a_set_of_raw_captures_tiles_perfectly() {
    let Some(made) = captured() else { return };
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/cmu/plaza.toml");
    let scene = Scene::load(&scene).unwrap();
    for seed in [1, 2, 3] {
        let outcome = tile(&scene, &made.set, &Options { seed, ..Options::default() }, &mut |_| true).unwrap();
        let (people, report) = (outcome.crowd.characters.len(), check(&outcome.crowd));
        println!("seed {seed}: {:?}, {people} people in {:.2} s", outcome.status, outcome.solve_secs);
        assert_eq!(outcome.status, Status::Perfect, "seed {seed}");
        let failed: Vec<_> = report.rows.iter().filter(|r| !r.ok).collect();
        assert!(failed.is_empty() && people >= 54, "seed {seed}: {people} people, {failed:?}");
    }
}

/// The samples with everything taken from their take files that says where to cut.
fn bare(folder: &Path) {
    samples::write(folder, 1).unwrap();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.to_string_lossy().ends_with(".take.json") {
            let take = TakeFile::load(&path).unwrap();
            let take = TakeFile { ports: vec![], patches: vec![], contacts: vec![], ..take };
            std::fs::write(&path, take.to_json()).unwrap();
        }
    }
}

#[test]
fn samples_without_annotation_annotate_themselves_the_same_each_time() {
    let folder = tempfolder("bare");
    bare(&folder);
    let made = make(&[&folder], &MakeOptions::default()).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    let (alone, together): (Vec<_>, Vec<_>) = own(&made.set).partition(|k| k.people() == 1);
    println!("{} kinds of one person, {} of several, {:?}", alone.len(), together.len(), made.set.groups);
    assert!(alone.len() >= 27 && together.len() >= 16);
    // Somebody takes the box up and puts it down, so that those who hand it over can come and go.
    let walks = ["walk_left", "walk_right", "stand", "carry_stand"];
    assert!(walks.iter().all(|w| made.set.groups.iter().any(|g| g.name == *w)), "{:?}", made.set.groups);
    // Every take of several people whose people do something together has a patch of it, or a reason why not.
    for (i, t) in made.takes.iter().enumerate().filter(|(_, t)| t.take.people.len() > 1) {
        assert!(made.together(i) > 0.0 || !made.notes(i).is_empty(), "{}", t.take.name);
    }
}

fn tempfolder(name: &str) -> std::path::PathBuf {
    let folder = std::env::temp_dir().join(format!("crowdquilt-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}
