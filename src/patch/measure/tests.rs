//! Measured labels against how the samples are scripted, moved, turned and in the mirror.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::LazyLock;

use super::*;
use crate::geom::Ground;
use crate::motion::retarget;
use crate::motion::testing::{standing, walking};
use crate::patch::{CutOptions, PatchSet, Source, cut, mirrored};
use crate::samples;

static SAMPLES: LazyLock<PatchSet> = LazyLock::new(|| {
    let source = |t: samples::Take| {
        let motions = retarget::take(&t.clips).unwrap();
        Source { origin: PathBuf::from(&t.file.name), take: t.file, motions }
    };
    let sources: Vec<Source> = samples::generate(1).into_iter().map(source).collect();
    cut(&sources, &CutOptions { mirror: false, ..CutOptions::default() }).unwrap()
});

fn alone(motion: crate::motion::Motion) -> PatchKind {
    let fragment = Fragment { motion, begin: 0, entry_group: 0, exit_group: 0 };
    PatchKind { fragments: vec![fragment], ..PatchKind::default() }
}

#[test]
fn a_walk_and_standing_are_measured() {
    let walk = alone(walking(2.0)).measures();
    // 0.6 m in 16 frames.
    assert!((walk.speed - 1.125).abs() < 1e-3 && (walk.fastest - 1.125).abs() < 1e-3, "{walk:?}");
    assert!((walk.seconds - 2.0).abs() < 1e-4 && walk.people == 1 && walk.props == 0 && walk.turn_deg == 0.0);
    // 2.25 m of way, and the body before and behind it.
    assert!((1.25..1.65).contains(&walk.radius), "{walk:?}");
    assert_eq!(walk.words, ["walk"]);
    let stand = alone(standing(2.0)).measures();
    assert!((0.25..0.6).contains(&stand.radius), "{stand:?}");
    assert_eq!((stand.words, stand.speed, stand.fastest), (vec!["stand"], 0.0, 0.0));
    let mut run = walking(2.0);
    run.path.points.iter_mut().for_each(|p| *p *= 2.5);
    assert_eq!(alone(run).measures().words, ["run"]);
    let empty = PatchKind::default().measures();
    assert_eq!((empty.people, empty.radius, empty.words.len()), (0, 0.0, 0));
    assert_eq!(alone(crate::motion::Motion::default()).measures().words, ["stand"]);
}

#[test]
fn words_are_what_the_samples_were_scripted_to_do() {
    let expected: BTreeMap<&str, &[&str]> = [
        ("idle-1.5", &["stand"] as &[&str]),
        ("wave", &["stand"]),
        ("walk-1.15-cycle", &["walk"]),
        ("step-left", &["step"]),
        ("pivot-90", &["stand", "turn"]),
        ("sit", &["step", "low"]),
        ("tie-shoe", &["stand", "low"]),
        ("take-up", &["stand", "low", "prop"]),
        ("carry-walk-cycle", &["walk", "prop"]),
        ("carry-start", &["walk", "start", "prop"]),
        ("carry-stop", &["walk", "stop", "prop"]),
        ("handshake-stand", &["stand", "together", "contact"]),
        ("high-five-passing", &["walk", "together", "contact"]),
        ("push-stand", &["stand", "step", "together", "contact"]),
        ("talk-stand", &["stand", "together"]),
        ("trio-greet-stand", &["stand", "together"]),
        ("pass-box-stand", &["stand", "together", "prop"]),
        // Those who walk up enter and leave walking.
        ("handshake-walk", &["walk", "turn", "together", "contact"]),
    ]
    .into();
    let measured: BTreeMap<&str, Measures> = SAMPLES.kinds.iter().map(|k| (k.name.as_str(), k.measures())).collect();
    for (name, words) in expected {
        let found = measured.get(name).unwrap_or_else(|| panic!("no {name} among {:?}", measured.keys()));
        assert_eq!(found.words, words, "{name}: {found:?}");
    }
    let turn = |name: &str| measured[name].turn_deg;
    assert!((turn("pivot-90") - 90.0).abs() < 2.0 && (turn("pivot-180") - 180.0).abs() < 2.0);
    let pair = &measured["handshake-stand"];
    // They stand 0.88 m apart.
    assert!((0.44..1.0).contains(&pair.radius), "{pair:?}");
}

#[test]
fn every_kind_says_whether_it_is_together_touches_or_has_props() {
    for kind in &SAMPLES.kinds {
        let found = kind.measures();
        let says = |word: &str| found.words.contains(&word);
        assert_eq!(says("together"), kind.people() > 1, "{}", kind.name);
        assert_eq!(says("contact"), !kind.contacts.is_empty(), "{}", kind.name);
        assert_eq!(says("prop"), kind.labels.iter().any(|l| l == "carry"), "{}", kind.name);
        assert!(["stand", "step", "walk", "run"].iter().any(|w| says(w)), "{}", kind.name);
        assert!(found.speed <= found.fastest + 1e-4 && found.radius > 0.2, "{}: {found:?}", kind.name);
    }
}

#[test]
fn place_direction_and_mirror_do_not_matter() {
    let close = |a: f32, b: f32| (a - b).abs() <= 0.003 * a.abs() + 1e-3;
    for kind in SAMPLES.kinds.iter().step_by(5) {
        let before = kind.measures();
        let by = Ground::new(Vec2::new(3.0, -8.0), 2.2);
        let mut moved = kind.clone();
        for f in &mut moved.fragments {
            f.motion.path.points.iter_mut().for_each(|p| *p = by.apply(*p));
            f.motion.path.headings.iter_mut().for_each(|h| *h += by.heading);
        }
        moved.props.iter_mut().for_each(|p| (p.before, p.after) = (None, None));
        let mut bare = kind.clone();
        bare.props.iter_mut().for_each(|p| (p.before, p.after) = (None, None));
        let (here, there, mirror) =
            (bare.measures(), moved.measures(), mirrored(kind, &mut SAMPLES.groups.clone()).measures());
        assert!(close(here.radius, there.radius) && close(before.radius, mirror.radius), "{}", kind.name);
        assert!(close(before.speed, there.speed) && close(before.fastest, mirror.fastest), "{}", kind.name);
        assert!(close(before.turn_deg, there.turn_deg) && close(before.turn_deg, -mirror.turn_deg), "{}", kind.name);
        assert_eq!((&before.words, &before.words), (&there.words, &mirror.words), "{}", kind.name);
    }
}
