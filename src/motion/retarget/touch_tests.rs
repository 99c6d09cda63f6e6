//! Two people of different size who hold hands for a second, on rigs of their own.

use glam::{Quat, Vec3};

use super::rig::Rig;
use super::touch::{Near, Touch, hands, measure, restore};
use super::{bodies, take};
use crate::motion::contacts::palm_trajectory;
use crate::motion::skeleton::joint::*;
use crate::motion::{Clip, FPS, JOINT_COUNT, Motion, canonical};

/// How much a hand is held out at a time: from 1 to 2 seconds wholly.
fn held_out(time: f32) -> f32 {
    let near = (1.6 - (time - 1.5).abs() * 1.2).clamp(0.0, 1.0);
    near * near * (3.0 - 2.0 * near)
}

/// Someone `size` times as tall as the canonical body who holds a hand out, raised by `pitch`, for 3 seconds.
fn greeter(size: f32, pitch: f32, hand: usize) -> Clip {
    let mut skeleton = canonical().clone();
    for joint in &mut skeleton.joints {
        joint.offset *= size;
        joint.tip = joint.tip.map(|tip| tip * size);
    }
    let side = if hand == LEFT_HAND { -1.0 } else { 1.0 };
    let (frames, rate) = (361, 120.0);
    let mut rotations = Vec::new();
    for frame in 0..frames {
        let mut pose = [Quat::IDENTITY; JOINT_COUNT];
        (pose[LEFT_ARM], pose[RIGHT_ARM]) = (Quat::from_rotation_z(-1.45), Quat::from_rotation_z(1.45));
        let out = Quat::from_rotation_y(0.9 * side) * Quat::from_rotation_z(side * pitch);
        pose[hand - 2] = pose[hand - 2].slerp(out, held_out(frame as f32 / rate));
        pose[hand - 1] = Quat::from_rotation_y(0.9 * side * held_out(frame as f32 / rate));
        rotations.extend(pose);
    }
    let root = vec![Vec3::Y * 0.935 * size; frames];
    Clip { name: format!("size {size}"), skeleton, fps: rate, root, rotations }
}

fn palm_at(clip: &Clip, hand: usize, frame: usize) -> Vec3 {
    let mut globals = Vec::new();
    clip.globals(frame, &mut globals);
    globals[hand].0 + globals[hand].1 * (0.5 * clip.skeleton.joints[hand].tip.unwrap())
}

/// Moves a clip over the ground and turns it.
fn put(clip: &mut Clip, turn: f32, by: Vec3) {
    let turn = Quat::from_rotation_y(turn);
    clip.root.iter_mut().for_each(|p| *p = turn * *p + by);
    clip.rotations.chunks_exact_mut(JOINT_COUNT).for_each(|pose| pose[0] = turn * pose[0]);
}

/// The first person's right hand in the second one's left or right hand, the palms 4 cm apart.
fn pair(size: f32, hand: usize) -> Vec<Clip> {
    let one = greeter(1.0, 0.6, RIGHT_HAND);
    let meets = palm_at(&one, RIGHT_HAND, 180);
    // The other raises the hand as high.
    let height = |pitch: f32| palm_at(&greeter(size, pitch, hand), hand, 180).y;
    let (mut low, mut high) = (1.2, -1.2);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if height(middle) < meets.y { low = middle } else { high = middle }
    }
    let mut other = greeter(size, low, hand);
    put(&mut other, std::f32::consts::PI, Vec3::ZERO);
    let by = meets + Vec3::new(0.02, 0.0, 0.035) - palm_at(&other, hand, 180);
    assert!(by.y.abs() < 0.01, "hands at one height: {by}");
    put(&mut other, 0.0, by.with_y(0.0));
    vec![one, other]
}

fn rigs(clips: &[Clip]) -> Vec<Rig> {
    clips.iter().map(|clip| Rig::new(clip).unwrap()).collect()
}

/// How much farther from each other hands and palms are than in the capture while they touch there.
fn errors(motions: &[Motion], touch: &Touch) -> Vec<f32> {
    let found: Vec<_> = motions.iter().map(hands).collect();
    let [a, b] = touch.hands.map(|(person, side)| &found[person][side]);
    let off = |(f, near): (usize, &Option<Near>)| {
        let (was, is) = ((*near)?, Near::of(&a[f], &b[f]));
        Some((is.palms - was.palms).max(is.hands - was.hands))
    };
    touch.near.iter().enumerate().filter_map(off).collect()
}

fn most(values: &[f32]) -> f32 {
    values.iter().copied().fold(0.0, f32::max)
}

#[test]
fn hands_of_large_and_small_people_still_touch() {
    for (size, hand) in [(0.7, RIGHT_HAND), (0.8, LEFT_HAND), (1.15, RIGHT_HAND), (0.9, LEFT_HAND)] {
        let clips = pair(size, hand);
        let rigs = rigs(&clips);
        let touches = measure(&clips, &rigs);
        assert_eq!(touches.len(), 1, "size {size}");
        let before = errors(&bodies(&clips, &rigs).unwrap(), &touches[0]);
        assert!(before.len() >= 29, "size {size}: they touch for {} frames", before.len());
        let after = errors(&take(&clips).unwrap(), &touches[0]);
        println!("size {size}: palms off by {:.3} m, restored: {:.3} m", most(&before), most(&after));
        assert!(most(&before) > 0.05, "size {size}: {before:?}");
        assert!(most(&after) < 0.02, "size {size}: {after:?}");
    }
}

#[test]
fn corrections_come_and_go_smoothly() {
    let clips = pair(0.75, RIGHT_HAND);
    let (before, after) = (bodies(&clips, &rigs(&clips)).unwrap(), take(&clips).unwrap());
    for (before, after) in before.iter().zip(&after) {
        let turned = |f: usize, j: usize| before.pose(f)[j].angle_between(after.pose(f)[j]);
        assert!(
            (0..JOINT_COUNT).all(|j| turned(0, j) < 1e-3 && turned(90, j) < 1e-3),
            "far from the touch nothing changes"
        );
        let jolt = |m: &Motion| {
            let palm = palm_trajectory(m, RIGHT_HAND);
            most(&palm.windows(3).map(|p| (p[2] - 2.0 * p[1] + p[0]).length() * FPS * FPS).collect::<Vec<f32>>())
        };
        assert!(jolt(after) < jolt(before) + 40.0, "{} m/s2 instead of {}", jolt(after), jolt(before));
        assert_eq!((&before.path, &before.heights, &before.plants), (&after.path, &after.heights, &after.plants));
    }
}

#[test]
fn people_of_one_size_and_strangers_are_left_alone() {
    let mut clips = pair(1.0, RIGHT_HAND);
    assert_eq!(take(&clips).unwrap(), bodies(&clips, &rigs(&clips)).unwrap());
    clips[1] = greeter(0.7, 0.0, LEFT_HAND);
    put(&mut clips[1], 2.0, Vec3::new(3.0, 0.0, 1.0));
    assert!(measure(&clips, &rigs(&clips)).is_empty());
    assert_eq!(take(&clips).unwrap(), bodies(&clips, &rigs(&clips)).unwrap());
}

/// A hand in two others' hands settles between them.
#[test]
fn a_hand_that_two_hold_stays_with_both() {
    let mut clips = pair(0.85, RIGHT_HAND);
    let mut third = clips[1].clone();
    put(&mut third, 0.8, Vec3::ZERO);
    let by = palm_at(&clips[1], RIGHT_HAND, 180) + Vec3::new(0.05, 0.0, 0.03) - palm_at(&third, RIGHT_HAND, 180);
    put(&mut third, 0.0, by.with_y(0.0));
    clips.push(third);
    let rigs = rigs(&clips);
    let touches = measure(&clips, &rigs);
    assert!(touches.len() >= 2, "{}", touches.len());
    let mut motions = bodies(&clips, &rigs).unwrap();
    let before: Vec<f32> = touches.iter().map(|t| most(&errors(&motions, t))).collect();
    restore(&mut motions, &touches);
    let after: Vec<f32> = touches.iter().map(|t| most(&errors(&motions, t))).collect();
    assert!(most(&before) > 0.05 && most(&after) < 0.02, "{before:?} {after:?}");
}
