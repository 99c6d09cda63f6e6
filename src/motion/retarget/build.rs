//! From a clip on the canonical skeleton to a [`Motion`]: sampled at 30 fps, split into path and body.

use glam::{Quat, Vec2, Vec3};

use crate::geom::wrap_angle;
use crate::motion::skeleton::joint::*;
use crate::motion::{Clip, FPS, JOINT_COUNT, Motion, MotionPath};

/// Width (standard deviation, seconds) of the smoothing of headings: long enough that a walk's sway of the hips
/// (about 1 Hz) hardly turns the path's frame, short enough that real turns do.
const HEADING_SIGMA: f32 = 0.22;

/// A motion from a clip on the canonical skeleton, without foot plants: frame k is time k / 30 s.
/// Positions and heights are interpolated linearly, rotations spherically.
pub fn motion(clip: &Clip) -> Motion {
    let frames = (clip.seconds() * FPS + 1e-3).floor() as usize + 1;
    let (mut roots, mut rotations) = (Vec::with_capacity(frames), Vec::with_capacity(frames * JOINT_COUNT));
    for frame in 0..frames {
        let (root, pose) = sample(clip, frame as f32 / FPS);
        roots.push(root);
        rotations.extend(pose);
    }
    let headings = smooth(&facings(clip, &roots, &rotations), HEADING_SIGMA * FPS);
    for (pose, &heading) in rotations.chunks_exact_mut(JOINT_COUNT).zip(&headings) {
        pose[HIPS] = (Quat::from_rotation_y(-heading) * pose[HIPS]).normalize();
    }
    Motion {
        path: MotionPath { points: roots.iter().map(|p| Vec2::new(p.x, p.z)).collect(), headings },
        heights: roots.iter().map(|p| p.y).collect(),
        rotations,
        plants: Vec::new(),
    }
}

/// Root and local rotations at a time in seconds.
fn sample(clip: &Clip, time: f32) -> (Vec3, Vec<Quat>) {
    let at = (time * clip.fps).clamp(0.0, (clip.frames() - 1) as f32);
    let (i, mut part) = (at.floor() as usize, at.fract());
    let j = (i + 1).min(clip.frames() - 1);
    // Rates such as 120 / 30 land on frames but for rounding: take those as they are.
    part = if part < 1e-3 { 0.0 } else { part };
    let pose = clip.pose(i).iter().zip(clip.pose(j)).map(|(a, &b)| a.slerp(b, part).normalize());
    (clip.root[i].lerp(clip.root[j], part), pose.collect())
}

/// Unwrapped direction the body faces at every frame, from the axes through the hip joints and the shoulders.
fn facings(clip: &Clip, roots: &[Vec3], rotations: &[Quat]) -> Vec<f32> {
    let mut globals = Vec::new();
    let mut last = 0.0;
    let poses = rotations.chunks_exact(JOINT_COUNT).zip(roots);
    poses
        .map(|(pose, &root)| {
            clip.skeleton.globals(root, pose, &mut globals);
            let axis = |left: usize, right: usize| {
                let axis = globals[left].0 - globals[right].0;
                Vec2::new(axis.x, axis.z).normalize_or_zero()
            };
            let left = axis(LEFT_UP_LEG, RIGHT_UP_LEG) + axis(LEFT_ARM, RIGHT_ARM);
            // The left side is at +x when the body faces +z (heading 0). A body lying down keeps its last facing.
            if left.length() > 0.1 {
                last += wrap_angle(f32::atan2(-left.y, left.x) - last);
            }
            last
        })
        .collect()
}

/// Gaussian smoothing that does not bias the ends: a line fitted with Gaussian weights around every frame, read at
/// the frame. In the middle it equals the plain Gaussian mean. `sigma` in frames. O(frames x sigma).
pub fn smooth(values: &[f32], sigma: f32) -> Vec<f32> {
    let reach = (3.0 * sigma).ceil() as isize;
    let last = values.len() as isize - 1;
    let at = |i: isize| {
        let [mut w0, mut w1, mut w2, mut v0, mut v1] = [0.0f64; 5];
        for k in (i - reach).max(0)..=(i + reach).min(last) {
            let d = (k - i) as f64;
            let w = (-0.5 * (d / sigma as f64).powi(2)).exp();
            let v = (values[k as usize] - values[i as usize]) as f64;
            (w0, w1, w2) = (w0 + w, w1 + w * d, w2 + w * d * d);
            (v0, v1) = (v0 + w * v, v1 + w * d * v);
        }
        let spread = w0 * w2 - w1 * w1;
        let offset = if spread > 1e-9 { (v0 * w2 - v1 * w1) / spread } else { v0 / w0 };
        values[i as usize] + offset as f32
    };
    (0..=last).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smoothing_keeps_lines_to_the_ends_and_removes_sway() {
        let line: Vec<f32> = (0..60).map(|i| 3.0 - 0.1 * i as f32).collect();
        for (a, b) in smooth(&line, 6.6).iter().zip(&line) {
            assert!((a - b).abs() < 1e-4);
        }
        let sway: Vec<f32> = (0..90).map(|i| (i as f32 / 30.0 * std::f32::consts::TAU).sin()).collect();
        let middle = &smooth(&sway, 6.6)[25..65];
        assert!(middle.iter().all(|v| v.abs() < 0.42));
        assert_eq!(smooth(&[2.5], 6.6), [2.5]);
    }
}
