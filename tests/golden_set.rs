//! The patch-set file that the studio's reader is tested against (`studio/test/golden`) is what Rust writes.
//!
//! `CROWDQUILT_GOLDEN=write cargo test --release --test golden_set` writes it anew, after a change of the format.

use std::path::PathBuf;

use crowdquilt::geom::Upright;
use crowdquilt::motion::{BodyPart, FPS, JOINT_COUNT, Motion, MotionPath};
use crowdquilt::patch::{Contact, Fragment, PatchKind, PatchProp, PatchSet, PoseGroup, PropHold, Touch};
use glam::{Quat, Vec2, Vec3};
use serde_json::{Value, json};

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("studio/test/golden")
}

/// A number from -1 to 1 that looks random.
fn noise(seed: usize) -> f32 {
    let mixed = (seed as u32).wrapping_add(1).wrapping_mul(0x9e37_79b1);
    let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x2c1b_3c6d);
    (mixed >> 8) as f32 / (1u32 << 23) as f32 - 1.0
}

/// Somebody whose joints are all turned, on a path that is neither straight nor along an axis.
fn motion(seed: usize, frames: usize) -> Motion {
    let mut motion = Motion { path: MotionPath::default(), ..Motion::default() };
    for f in 0..frames {
        let t = f as f32 / FPS;
        motion.path.points.push(Vec2::new(0.7 * t + noise(seed), 1.1 * t - 0.4 * t * t + noise(seed + 1)));
        motion.path.headings.push(2.5 * noise(seed + 2) + 0.9 * t);
        motion.heights.push(0.92 + 0.02 * t);
        for j in 0..JOINT_COUNT {
            let n = |k: usize| noise(seed * 977 + j * 3 + k);
            let axis = Vec3::new(n(0), n(1), n(2)).try_normalize().unwrap_or(Vec3::Y);
            motion.rotations.push(Quat::from_axis_angle(axis, 0.5 * n(3) + 0.3 * t));
        }
    }
    motion
}

fn fragment(seed: usize, begin: u32, frames: usize, entry_group: u32, exit_group: u32) -> Fragment {
    Fragment { motion: motion(seed, frames), begin, entry_group, exit_group }
}

fn taken_up_and_put_down() -> PatchProp {
    let rest = |x: f32| Upright { middle: Vec3::new(x, 0.15, 0.4), heading: 0.3 * x };
    PatchProp {
        name: "parcel".into(),
        size: [0.3, 0.25, 0.2],
        grip: [0.05, 0.1],
        holds: vec![PropHold { role: 0, begin: 2, end: 4 }],
        sat: vec![],
        before: Some(rest(0.5)),
        after: Some(rest(1.5)),
    }
}

fn passed() -> PatchProp {
    PatchProp {
        name: "box".into(),
        size: [0.4, 0.3, 0.3],
        grip: [-0.02, 0.08],
        holds: vec![PropHold { role: 1, begin: 0, end: 7 }, PropHold { role: 0, begin: 5, end: 10 }],
        sat: vec![],
        before: None,
        after: None,
    }
}

fn set() -> PatchSet {
    let touch = |role, part| Touch { role, part };
    let contact = Contact { a: touch(0, BodyPart::RightHand), b: touch(1, BodyPart::Torso), begin: 4, end: 9 };
    let alone = PatchKind {
        name: "step".into(),
        labels: vec!["walk".into(), "slow".into()],
        fragments: vec![fragment(1, 0, 7, 0, 1)],
        props: vec![taken_up_and_put_down()],
        ..PatchKind::default()
    };
    let pair = PatchKind {
        name: "meet".into(),
        labels: vec!["friendly".into()],
        fragments: vec![fragment(2, 2, 9, 1, 2), fragment(3, 0, 12, 2, 0)],
        contacts: vec![contact],
        core: Some((3, 10)),
        props: vec![passed()],
        mirrored: true,
    };
    let groups = ["stand", "walk_left", "walk_right"].map(|name| PoseGroup { name: name.into() });
    PatchSet { groups: groups.to_vec(), kinds: vec![alone, pair], study: None }
}

/// Where the joints are at some frames of every role.
fn positions(set: &PatchSet) -> Value {
    let mut all = Vec::new();
    for (k, kind) in set.kinds.iter().enumerate() {
        for (r, f) in kind.fragments.iter().enumerate() {
            for frame in [0, 3, f.motion.len() - 1] {
                let mut globals = Vec::new();
                f.motion.globals(frame, &mut globals);
                let joints: Vec<[f32; 3]> = globals.iter().map(|(p, _)| p.to_array()).collect();
                all.push(json!({ "kind": k, "role": r, "frame": frame, "joints": joints }));
            }
        }
    }
    let measures: Vec<_> = set.kinds.iter().map(PatchKind::measures).collect();
    json!({ "bodies": all, "boxes": boxes(set), "measures": measures })
}

/// Where the boxes are at every frame at which they are there.
fn boxes(set: &PatchSet) -> Value {
    let mut all = Vec::new();
    for (k, kind) in set.kinds.iter().enumerate() {
        let last = kind.fragments.iter().map(|f| f.begin + f.motion.len() as u32).max().unwrap();
        for frame in 0..last {
            if let Some(at) = kind.props[0].place(kind, frame) {
                let place = [at.middle.x, at.middle.y, at.middle.z, at.heading];
                all.push(json!({ "kind": k, "frame": frame, "joints": [place] }));
            }
        }
    }
    Value::Array(all)
}

#[test]
fn the_studios_golden_set_is_what_rust_writes() {
    let bytes = set().to_bytes();
    // What a file holds: rotations are rounded.
    let set = PatchSet::from_bytes(&bytes).unwrap();
    let (file, places) = (folder().join("kinds.patches"), folder().join("kinds.json"));
    if std::env::var("CROWDQUILT_GOLDEN").is_ok_and(|v| v == "write") {
        std::fs::create_dir_all(folder()).unwrap();
        std::fs::write(&file, &bytes).unwrap();
        std::fs::write(&places, serde_json::to_string(&positions(&set)).unwrap() + "\n").unwrap();
    }
    let filed = PatchSet::load(&file).unwrap();
    assert_eq!(filed.groups, set.groups);
    for (a, b) in filed.kinds.iter().zip(&set.kinds) {
        let outline =
            |k: &PatchKind| (k.name.clone(), k.labels.clone(), k.contacts.clone(), k.props.clone(), k.core, k.mirrored);
        assert_eq!(outline(a), outline(b));
    }
    let told: Value = serde_json::from_str(&std::fs::read_to_string(&places).unwrap()).unwrap();
    let numbers = |v: &Value| -> Vec<f64> {
        let places = ["bodies", "boxes"].map(|key| v[key].as_array().unwrap()).into_iter().flatten();
        let joints = places.flat_map(|p| p["joints"].as_array().unwrap());
        joints.flat_map(|j| j.as_array().unwrap()).map(|n| n.as_f64().unwrap()).collect()
    };
    let words = |v: &Value| v["measures"].as_array().unwrap().iter().map(|m| m["words"].clone()).collect::<Vec<_>>();
    let figures = |v: &Value| -> Vec<f64> {
        let kinds = v["measures"].as_array().unwrap().iter();
        kinds
            .flat_map(|m| ["seconds", "speed", "fastest", "radius", "turn_deg"].map(|f| m[f].as_f64().unwrap()))
            .collect()
    };
    for places in [positions(&filed), positions(&set)] {
        assert_eq!(words(&places), words(&told));
        assert!(figures(&places).iter().zip(figures(&told)).all(|(a, b)| (a - b).abs() < 0.01));
        let (a, b) = (numbers(&places), numbers(&told));
        assert_eq!(a.len(), b.len());
        // Another machine's sines may differ in their last bits.
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 2e-4));
    }
}
