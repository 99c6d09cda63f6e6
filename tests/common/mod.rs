//! A small patch set made of plain paths and a stiff body: enough for tiling, quick to build.

use crowdquilt::geom::Ground;
use crowdquilt::motion::{JOINT_COUNT, Motion, MotionPath, joint};
use crowdquilt::patch::{Fragment, PatchKind, PatchSet, PoseGroup};
use glam::{Quat, Vec2};

const STAND: u32 = 0;
const LEFT: u32 = 1;
const RIGHT: u32 = 2;

/// A motion along `frames` frames at a speed (m/s, over time in 0..1) and a total turn.
fn motion(frames: usize, from: Ground, speed: impl Fn(f32) -> f32, turn: f32) -> Motion {
    let mut path = MotionPath::default();
    let mut at = from;
    for f in 0..frames {
        path.points.push(at.position);
        path.headings.push(at.heading);
        let t = (f as f32 + 0.5) / (frames - 1) as f32;
        at = at.then(Ground::new(Vec2::new(0.0, speed(t) / 30.0), turn / (frames - 1) as f32));
    }
    let mut pose = [Quat::IDENTITY; JOINT_COUNT];
    pose[joint::LEFT_ARM] = Quat::from_rotation_z(-1.4);
    pose[joint::RIGHT_ARM] = Quat::from_rotation_z(1.4);
    Motion { path, heights: vec![0.935; frames], rotations: pose.repeat(frames), plants: vec![] }
}

fn single(name: &str, groups: (u32, u32), motion: Motion) -> PatchKind {
    let fragment = Fragment { motion, begin: 0, entry_group: groups.0, exit_group: groups.1 };
    PatchKind {
        name: name.into(),
        labels: vec![],
        fragments: vec![fragment],
        contacts: vec![],
        core: None,
        ..PatchKind::default()
    }
}

/// Two people who walk up to each other, stand a while and leave.
fn meeting(name: &str, stand_frames: usize, turn: f32) -> PatchKind {
    let person = |side: f32| {
        let heading = if side > 0.0 { 0.0 } else { std::f32::consts::PI };
        let total = 30 + stand_frames + 30;
        let (a, b) = (30.0 / total as f32, (30 + stand_frames) as f32 / total as f32);
        let speed = move |t: f32| {
            if t < a {
                1.2 * (1.0 - t / a)
            } else if t > b {
                1.2 * (t - b) / (1.0 - b)
            } else {
                0.0
            }
        };
        let mut m = motion(total, Ground::new(Vec2::new(0.05 * side, -side * 2.2), heading), speed, 0.0);
        for f in 0..total {
            let late = ((f as f32 / total as f32 - b) / (1.0 - b)).max(0.0);
            m.path.headings[f] += turn * late;
            if late > 0.0 {
                let step = Ground::new(m.path.points[f - 1], m.path.headings[f - 1]);
                m.path.points[f] = step.apply(Vec2::new(0.0, 1.2 * late / 30.0));
            }
        }
        Fragment { motion: m, begin: 0, entry_group: LEFT, exit_group: RIGHT }
    };
    PatchKind {
        name: name.into(),
        labels: vec![],
        fragments: vec![person(1.0), person(-1.0)],
        contacts: vec![],
        core: Some((30, 30 + stand_frames as u32)),
        ..PatchKind::default()
    }
}

/// The set.
pub fn plain_set() -> PatchSet {
    let walk = |v: f32| move |_: f32| v;
    let mut kinds = Vec::new();
    for (i, v) in [0.8, 1.15, 1.45].into_iter().enumerate() {
        for (from, to) in [(LEFT, RIGHT), (RIGHT, LEFT)] {
            kinds.push(single(&format!("half-{i}-{from}"), (from, to), motion(18, Ground::IDENTITY, walk(v), 0.0)));
        }
        kinds.push(single(&format!("cycle-{i}"), (LEFT, LEFT), motion(35, Ground::IDENTITY, walk(v), 0.0)));
    }
    for turn in [-1.5f32, -1.0, -0.5, 0.5, 1.0, 1.5] {
        kinds.push(single(&format!("turn{turn}"), (LEFT, LEFT), motion(35, Ground::IDENTITY, walk(1.0), turn)));
        kinds.push(single(&format!("pivot{turn}"), (STAND, STAND), motion(30, Ground::IDENTITY, walk(0.0), turn)));
    }
    for (group, name) in [(LEFT, "left"), (RIGHT, "right")] {
        let (up, down) = (|t: f32| 1.1 * t, |t: f32| 1.1 * (1.0 - t));
        kinds.push(single(&format!("start-{name}"), (STAND, group), motion(30, Ground::IDENTITY, up, 0.0)));
        kinds.push(single(&format!("stop-{name}"), (group, STAND), motion(30, Ground::IDENTITY, down, 0.0)));
    }
    for frames in [20, 40] {
        kinds.push(single(&format!("idle-{frames}"), (STAND, STAND), motion(frames, Ground::IDENTITY, walk(0.0), 0.0)));
    }
    for (i, turn) in [-1.2, 1.2, -0.7, 0.7].into_iter().enumerate() {
        kinds.push(meeting(&format!("meeting-{i}"), 40 + 10 * i, turn));
    }
    let groups = ["stand", "walk_left", "walk_right"].map(|name| PoseGroup { name: name.into() }).to_vec();
    PatchSet { groups, kinds, study: None }
}
