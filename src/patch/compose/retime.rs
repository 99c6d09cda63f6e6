//! A motion on a deformed path, played at other times.

use glam::Quat;

use crate::motion::{JOINT_COUNT, Motion, MotionPath, Plant};

/// Nothing is resampled where no frame is farther from a whole one than this, frames.
const WHOLE: f32 = 1e-3;

/// The motion carried by `path`, each of its frames played at its tick of `ticks` (first and last whole, increasing), at
/// whole ticks; and the first of them. O(frames x joints).
pub(super) fn play(motion: &Motion, path: &MotionPath, ticks: &[f32]) -> (Motion, u32) {
    let begin = ticks[0].round();
    let carried = Motion { path: path.clone(), ..motion.clone() };
    let on_time = |(i, tick): (usize, &f32)| (tick - begin - i as f32).abs() < WHOLE;
    if ticks.iter().enumerate().all(on_time) {
        return (carried, begin as u32);
    }
    let mut out = Motion::default();
    let mut i = 0;
    for frame in 0..=(ticks[ticks.len() - 1].round() - begin) as usize {
        let tick = begin + frame as f32;
        while i + 2 < ticks.len() && ticks[i + 1] <= tick {
            i += 1;
        }
        let t = ((tick - ticks[i]) / (ticks[i + 1] - ticks[i]).max(1e-6)).clamp(0.0, 1.0);
        push_between(&carried, i, t, &mut out);
    }
    let last = out.len() as u32 - 1;
    let at = |frame: u32| ((ticks[frame as usize] - begin).round() as u32).min(last);
    out.plants = motion.plants.iter().map(|p| Plant { foot: p.foot, begin: at(p.begin), end: at(p.end) }).collect();
    (out, begin as u32)
}

/// Adds the state between frames `i` and `i + 1`.
fn push_between(from: &Motion, i: usize, t: f32, out: &mut Motion) {
    let path = &from.path;
    out.path.points.push(path.points[i].lerp(path.points[i + 1], t));
    out.path.headings.push(path.headings[i] * (1.0 - t) + path.headings[i + 1] * t);
    out.heights.push(from.heights[i] * (1.0 - t) + from.heights[i + 1] * t);
    let (a, b) = (from.pose(i), from.pose(i + 1));
    let between = |j: usize| -> Quat { if t == 0.0 { a[j] } else { a[j].lerp(b[j], t) } };
    out.rotations.extend((0..JOINT_COUNT).map(between));
}
