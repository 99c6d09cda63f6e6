//! A set that makes itself does not depend on where captures lie, which way round, what people are called, in which order
//! files come, or which hand is which.

use std::path::{Path, PathBuf};

use crowdquilt::motion::bvh;
use crowdquilt::motion::retarget;
use crowdquilt::motion::take::{TakeFile, TakePerson};
use crowdquilt::patch::{Made, MakeOptions, PatchKind, make};
use crowdquilt::samples::{self, Take};
use glam::{Quat, Vec3};

/// A folder of its own that goes when dropped.
struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Takes of one, two and three people that do all kinds of things.
const TAKES: [&str; 12] = [
    "idle",
    "wave",
    "pivot-90",
    "start-stop",
    "start-stop-90",
    "walk-1.15",
    "turn-60",
    "handshake-walk",
    "high-five-stand",
    "bow-stand",
    "talk-walk",
    "trio-greet-stand",
];

/// The samples as raw captures: nothing says where to cut.
fn raw() -> Vec<Take> {
    let mut takes = samples::generate(1);
    takes.retain(|t| TAKES.contains(&t.file.name.as_str()));
    for t in &mut takes {
        t.file = TakeFile {
            ports: vec![],
            patches: vec![],
            contacts: vec![],
            plants: vec![],
            props: vec![],
            ..t.file.clone()
        };
    }
    takes
}

/// The set that is made of takes written to a folder.
fn made(name: &str, takes: &[Take]) -> Made {
    let path = std::env::temp_dir().join(format!("crowdquilt-invariance-{}-{name}", std::process::id()));
    let folder = Folder(path);
    std::fs::create_dir_all(&folder.0).unwrap();
    takes.iter().for_each(|t| write(&folder.0, t));
    make(&[&folder.0], &MakeOptions::default()).unwrap()
}

fn write(folder: &Path, take: &Take) {
    for (person, clip) in take.file.people.iter().zip(&take.clips) {
        std::fs::write(folder.join(&person.file), bvh::write(clip)).unwrap();
    }
    std::fs::write(folder.join(format!("{}.take.json", take.file.name)), take.file.to_json()).unwrap();
}

/// What a kind is, whatever it is called: everybody's ports, length, begin, way and turn to the centimetre and degree, and
/// who touches.
fn outline(made: &Made, kind: &PatchKind) -> String {
    let group = |g: u32| made.set.groups[g as usize].name.as_str();
    let people = kind.fragments.iter().map(|f| {
        let path = &f.motion.path;
        let last = path.len() - 1;
        let way = path.at(0).inverse().then(path.at(last));
        let figures = [way.position.x, way.position.y, way.heading].map(|v| (v * 20.0).round() + 0.0);
        format!("{} {} {} {} {figures:?}", group(f.entry_group), group(f.exit_group), f.begin, path.len())
    });
    let mut people: Vec<String> = people.collect();
    people.sort();
    let mut contacts: Vec<String> = kind.contacts.iter().map(|c| format!("{}-{}", c.begin, c.end)).collect();
    contacts.sort();
    format!("{people:?} {contacts:?} {:?} {}", kind.core, kind.labels.join(" "))
}

fn outlines(made: &Made) -> Vec<String> {
    let mut all: Vec<String> = made.set.kinds.iter().map(|k| outline(made, k)).collect();
    all.sort();
    all
}

fn groups(made: &Made) -> Vec<String> {
    let mut names: Vec<String> = made.set.groups.iter().map(|g| g.name.clone()).collect();
    names.sort();
    names
}

/// Asserts that two sets hold the same kinds and groups, and the same boundaries were chosen.
fn same(a: &Made, b: &Made) {
    assert_eq!(groups(a), groups(b));
    let (one, other) = (outlines(a), outlines(b));
    let missing: Vec<&String> = one.iter().filter(|o| !other.contains(o)).collect();
    assert!(one == other, "{} and {} kinds; missing: {missing:#?}", one.len(), other.len());
}

/// A turn about the vertical, and a way over the ground.
fn placed(take: &Take, turn: f32, by: Vec3) -> Take {
    let mut take = take.clone();
    let turn = Quat::from_rotation_y(turn);
    for clip in &mut take.clips {
        let joints = clip.skeleton.joints.len();
        clip.root.iter_mut().for_each(|p| *p = turn * *p + by);
        clip.rotations.iter_mut().step_by(joints).for_each(|q| *q = turn * *q);
    }
    take
}

#[test]
fn where_takes_lie_and_which_way_round_does_not_matter() {
    let takes = raw();
    let before = made("placed-a", &takes);
    assert!(
        before.set.kinds.len() >= 40 && before.set.kinds.iter().any(|k| k.people() == 3),
        "{}",
        before.set.kinds.len()
    );
    let moved: Vec<Take> =
        takes.iter().enumerate().map(|(i, t)| placed(t, 0.0, Vec3::new(i as f32, 0.0, -2.0))).collect();
    same(&before, &made("placed-b", &moved));
    let turned: Vec<Take> = takes.iter().enumerate().map(|(i, t)| placed(t, 0.4 + i as f32, Vec3::X)).collect();
    same(&before, &made("placed-c", &turned));
}

#[test]
fn what_people_and_takes_are_called_and_their_order_do_not_matter() {
    let takes = raw();
    let before = made("named-a", &takes);
    let renamed = takes.iter().enumerate().map(|(i, t)| {
        let mut take = t.clone();
        // The last comes first, and people swap places.
        take.file.name = format!("{:02}-somebody", 90 - i);
        let people =
            (0..take.clips.len()).map(|p| TakePerson { file: format!("{i}-person-{p}.bvh"), ..Default::default() });
        take.file.people = people.collect();
        take.clips.reverse();
        take
    });
    same(&before, &made("named-b", &renamed.collect::<Vec<_>>()));
}

/// The clip seen in a mirror.
fn mirrored(take: &Take) -> Take {
    let mut take = take.clone();
    for clip in &mut take.clips {
        let joints = &clip.skeleton.joints;
        let other = |name: &str| match (name.strip_prefix("left_"), name.strip_prefix("right_")) {
            (Some(rest), _) => format!("right_{rest}"),
            (_, Some(rest)) => format!("left_{rest}"),
            _ => name.to_owned(),
        };
        let twins: Vec<usize> = joints.iter().map(|j| clip.skeleton.find(&other(&j.name)).unwrap()).collect();
        let seen = |q: Quat| Quat::from_xyzw(q.x, -q.y, -q.z, q.w);
        let frames = clip.rotations.chunks_exact(joints.len());
        clip.rotations = frames.flat_map(|pose| twins.iter().map(|&j| seen(pose[j])).collect::<Vec<_>>()).collect();
        clip.root.iter_mut().for_each(|p| p.x = -p.x);
    }
    take
}

#[test]
fn in_the_mirror_kinds_and_their_mirrored_copies_swap() {
    let takes = raw();
    let seen: Vec<Take> = takes.iter().map(mirrored).collect();
    // The mirror is one: hands are where they were, on the other side.
    let (a, b) = (retarget::take(&takes[0].clips).unwrap(), retarget::take(&seen[0].clips).unwrap());
    assert!(
        a[0].path
            .points
            .iter()
            .zip(&b[0].path.points)
            .all(|(p, q)| (p.x + q.x).abs() < 1e-3 && (p.y - q.y).abs() < 1e-3)
    );
    same(&made("mirror-a", &takes), &made("mirror-b", &seen));
}
