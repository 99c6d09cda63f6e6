//! What tests of composed patches share: clips of the generated samples, edits of a file, crowds tiled with a patch.
#![allow(dead_code)]

use std::sync::LazyLock;

use crowdquilt::check::check;
use crowdquilt::geom::Polygon;
use crowdquilt::motion::retarget;
use crowdquilt::patch::compose::compose;
use crowdquilt::patch::{CutOptions, PatchKind, PatchSet, Source, cut};
use crowdquilt::stage::Crowd;
use crowdquilt::tiling::{Options, Scene, Status, tile};
use crowdquilt::{Result, samples};
use glam::Vec2;

/// The samples of seed 1.
pub static SOURCES: LazyLock<Vec<Source>> = LazyLock::new(|| {
    let source = |take: samples::Take| Source {
        origin: "sample".into(),
        motions: retarget::take(&take.clips).unwrap(),
        take: take.file,
    };
    samples::generate(1).into_iter().map(source).collect()
});

/// The patch that a file composes of the samples.
pub fn made(text: &str) -> Result<PatchKind> {
    compose(text, &SOURCES, &mut Vec::new())
}

/// The patches cut out of the samples.
pub fn sample_set() -> PatchSet {
    cut(&SOURCES, &CutOptions::default()).unwrap()
}

/// A file with bytes replaced, each at a place given as a share of its length.
pub fn edited(text: &str, edits: &[(f32, u8)]) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for &(place, byte) in edits {
        let at = (place * bytes.len() as f32) as usize;
        bytes[at] = byte;
    }
    String::from_utf8(bytes).unwrap()
}

/// A crowd, perfect and checked, of the samples' patches of one person and of the one that a file composes, in a square of
/// so many metres; and the composed patch's name.
pub fn crowd_with(text: &str, side: f32, people: usize, seconds: f32, interaction: f32) -> (Crowd, String) {
    let mut set = sample_set();
    set.kinds.retain(|k| k.people() == 1);
    let kind = compose(text, &SOURCES, &mut set.groups).unwrap();
    let name = kind.name.clone();
    set.kinds.push(kind);
    assert!(set.validate().is_empty(), "{:?}", set.validate());
    let scene = Scene {
        region: Polygon::rectangle(Vec2::ZERO, Vec2::splat(side)),
        characters: people,
        duration_secs: seconds,
        interaction,
        ..Scene::demo()
    };
    let options = Options { seed: 1, time_secs: 120.0, ..Options::default() };
    let outcome = tile(&scene, &set, &options, &mut |_| true).unwrap();
    let report = check(&outcome.crowd);
    assert!(report.ok(), "{name}\n{report}");
    assert_eq!(outcome.status, Status::Perfect, "{name}");
    (outcome.crowd, name)
}
