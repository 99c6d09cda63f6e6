//! Retargeting from rigs made from the canonical one by renaming, resting otherwise, and scaling.

use glam::{EulerRot, Quat, Vec3};

use super::{take, to_canonical};
use crate::motion::skeleton::joint::*;
use crate::motion::{Clip, FPS, JOINT_COUNT, canonical};

/// A person who glides, turns about and swings all limbs, on the canonical skeleton at 30 fps; no foot is ever planted.
fn lively() -> Clip {
    let skeleton = canonical().clone();
    let frames = 40;
    let mut root = Vec::new();
    let mut rotations = Vec::new();
    for frame in 0..frames {
        let t = frame as f32 / FPS;
        root.push(Vec3::new(0.4 * t, 0.935, 3.0 * t));
        rotations.push(Quat::from_rotation_y(0.8 * t + 0.1));
        for joint in 1..JOINT_COUNT {
            let phase = t * 3.0 + joint as f32;
            let swing = if (LEFT_UP_LEG..=RIGHT_TOE).contains(&joint) { 0.15 } else { 0.5 };
            rotations.push(Quat::from_euler(EulerRot::XYZ, swing * phase.sin(), 0.1 * phase.cos(), 0.2 * phase.sin()));
        }
    }
    Clip { name: "lively".into(), skeleton, fps: FPS, root, rotations }
}

/// The same motion on a rig that rests turned: joint `j` of the new rig has the frame `old frame * rest[j]`.
fn rest_otherwise(clip: &Clip, rest: impl Fn(usize) -> Quat) -> Clip {
    let mut out = clip.clone();
    let parent = |j: usize| clip.skeleton.joints[j].parent.map(&rest).unwrap_or_default();
    for (j, joint) in out.skeleton.joints.iter_mut().enumerate() {
        joint.offset = parent(j).inverse() * joint.offset;
        joint.tip = joint.tip.map(|tip| rest(j).inverse() * tip);
    }
    for (i, q) in out.rotations.iter_mut().enumerate() {
        let j = i % JOINT_COUNT;
        *q = parent(j).inverse() * *q * rest(j);
    }
    out
}

fn assert_same_joints(a: &Clip, b: &crate::motion::Motion, tolerance: f32) {
    let (mut x, mut y) = (Vec::new(), Vec::new());
    let mut floor = Vec3::ZERO;
    for frame in 0..a.frames() {
        a.globals(frame, &mut x);
        b.globals(frame, &mut y);
        if frame == 0 {
            floor = y[HIPS].0 - x[HIPS].0;
            assert!(floor.x.abs() < 1e-4 && floor.z.abs() < 1e-4, "{floor}");
        }
        for j in 0..JOINT_COUNT {
            let gap = (x[j].0 + floor - y[j].0).length();
            assert!(gap < tolerance, "frame {frame}, {}: {gap} m", canonical().joints[j].name);
        }
    }
}

#[test]
fn canonical_motion_stays_as_it_is() {
    let clip = lively();
    let motion = to_canonical(&clip).unwrap();
    assert_eq!(motion.len(), clip.frames());
    assert_same_joints(&clip, &motion, 1e-4);
}

#[test]
fn another_rest_pose_gives_the_same_motion() {
    let clip = lively();
    // Legs spread by 20 degrees, feet rolled along; arms down.
    let rest = |j: usize| match j {
        LEFT_UP_LEG..=LEFT_TOE => Quat::from_rotation_z(-0.35),
        RIGHT_UP_LEG..=RIGHT_TOE => Quat::from_rotation_z(0.35),
        LEFT_ARM..=LEFT_HAND => Quat::from_rotation_z(1.5),
        RIGHT_ARM..=RIGHT_HAND => Quat::from_rotation_z(-1.5),
        _ => Quat::IDENTITY,
    };
    assert_same_joints(&clip, &to_canonical(&rest_otherwise(&clip, rest)).unwrap(), 1e-3);
}

#[test]
fn scale_does_not_matter_and_people_of_a_take_share_it() {
    let small = |factor: f32| {
        let mut clip = lively();
        clip.root.iter_mut().for_each(|p| *p *= factor);
        clip.skeleton.joints.iter_mut().for_each(|j| j.offset *= factor);
        clip
    };
    assert_same_joints(&lively(), &to_canonical(&small(0.8)).unwrap(), 1e-3);
    let pair = take(&[small(0.8), small(1.25)]).unwrap();
    let shared = 0.5 * (1.0 / 0.8 + 1.0 / 1.25);
    for (motion, factor) in pair.iter().zip([0.8, 1.25]) {
        let end = small(factor).root[39];
        assert!((motion.path.points[39] - glam::Vec2::new(end.x, end.z) * shared).length() < 0.02);
    }
}

#[test]
fn resampling_keeps_times() {
    let slow = lively();
    let mut fast = slow.clone();
    fast.fps = 2.0 * FPS;
    let motion = to_canonical(&fast).unwrap();
    assert_eq!(motion.len(), 20);
    assert!((motion.path.points[10] - glam::Vec2::new(slow.root[20].x, slow.root[20].z)).length() < 1e-3);
}

#[test]
fn absurd_sizes_are_named() {
    let says = |clip: Clip, text: &str| {
        let found = to_canonical(&clip).unwrap_err().to_string();
        assert!(found.contains(text), "{found}");
    };
    let mut far = lively();
    far.root[7].x = 1e30;
    says(far, "frame 7: expected hips within");
    let mut lost = lively();
    lost.root[3].y = f32::NAN;
    says(lost, "frame 3: expected hips within");
    let mut dwarf = lively();
    dwarf.skeleton.joints.iter_mut().for_each(|j| j.offset *= 1e-6);
    says(dwarf, "expected legs of 0.01 to 100 m");
    // A place that only bones lead to.
    let mut wide = lively();
    for hip in [LEFT_UP_LEG, RIGHT_UP_LEG] {
        wide.skeleton.joints[hip].offset = Vec3::splat(3e37);
    }
    assert!(to_canonical(&wide).is_err());
}
