//! Simple generated motion for unit tests.

use glam::{Quat, Vec2, Vec3};

use super::skeleton::joint::*;
use super::{FPS, JOINT_COUNT, Motion, canonical, ik, plants};

/// Seconds of one step, and metres.
const STEP: (f32, f32) = (16.0 / FPS, 0.6);

/// Someone who stands in the rest pose with the arms down.
pub(crate) fn standing(seconds: f32) -> Motion {
    walk(seconds, 0.0)
}

/// Someone who walks along +z in steps of 16 frames and 0.6 m; the left foot is planted from time 0 on.
pub(crate) fn walking(seconds: f32) -> Motion {
    walk(seconds, STEP.1)
}

fn walk(seconds: f32, step: f32) -> Motion {
    let frames = (seconds * FPS).round() as usize + 1;
    let mut motion = Motion::default();
    for frame in 0..frames {
        let t = frame as f32 / FPS / STEP.0;
        let position = Vec2::new(0.0, step * t);
        motion.path.points.push(position);
        motion.path.headings.push(0.0);
        motion.heights.push(if step > 0.0 { 0.88 } else { 0.92 });
        motion.rotations.extend(pose(motion.heights[frame], position, t, step));
    }
    motion.plants = plants::detect(&motion, &plants::PlantOptions::default());
    motion
}

/// Where a foot is after `t` steps, which is planted over even (`first` 0) or odd steps and swings over the others.
fn foot_place(t: f32, first: f32, step: f32) -> (f32, f32) {
    let phase = (t - first).rem_euclid(2.0);
    let planted = step * (t - phase + 0.5);
    if phase < 1.0 || step == 0.0 {
        return (planted, 0.075);
    }
    let swing = phase - 1.0;
    let eased = swing * swing * (3.0 - 2.0 * swing);
    (planted + 2.0 * step * eased, 0.075 + 0.07 * (std::f32::consts::PI * swing).sin())
}

fn pose(height: f32, at: Vec2, t: f32, step: f32) -> [Quat; JOINT_COUNT] {
    let mut pose = [Quat::IDENTITY; JOINT_COUNT];
    let swing = if step > 0.0 { 0.3 * (t * std::f32::consts::PI).cos() } else { 0.0 };
    pose[LEFT_ARM] = Quat::from_rotation_x(swing) * Quat::from_rotation_z(-1.45);
    pose[RIGHT_ARM] = Quat::from_rotation_x(-swing) * Quat::from_rotation_z(1.45);
    for ([hip, knee, ankle], first) in [([LEFT_UP_LEG, LEFT_LEG, LEFT_FOOT], 0.0), ([5, 6, 7], 1.0)] {
        let mut globals = Vec::new();
        canonical().globals(Vec3::new(at.x, height, at.y), &pose, &mut globals);
        let (z, y) = foot_place(t, first, step);
        let target = Vec3::new(globals[hip].0.x, y, z);
        let p = [hip, knee, ankle].map(|j| globals[j].0);
        let (swing, bend, _) = ik::two_bone(p[0], p[1], p[2], target, Vec3::Z, 0.999);
        (pose[hip], pose[knee], pose[ankle]) = (swing, swing.inverse() * swing * bend, (swing * bend).inverse());
    }
    pose
}
