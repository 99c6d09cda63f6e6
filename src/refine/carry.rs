//! Carrying bodies along deformed paths, and blending them at stitches.
//!
//! At a stitch the two captures differ a little in pose, height and speed. Either side takes a share of each
//! difference, in value and in rate, and fades it out by a cubic over a short window, so that the result is continuous
//! and smooth (C1) and only the neighbourhood of the stitch changes. People who act alone take it all where they meet
//! a patch of several: what people do together stays exactly as captured. A blend turns no joint further beyond what
//! people can do than the captures that it blends.

use glam::{Quat, Vec3};

use super::{Body, Segment};
use crate::geom::Ground;
use crate::motion::limits::{excess, hold_back};
use crate::motion::{JOINT_COUNT, fade};

/// Frames over which a difference is faded on either side of a stitch, and where one side takes all of it.
const BLEND_FRAMES: i32 = 10;
const LONG_BLEND_FRAMES: i32 = 16;
/// Most that the hips leave the path, metres.
const MAX_SHIFT: f32 = 0.045;
/// Numbers that describe a pose besides the joints: hips x, y, z.
type Offset = [Vec3; JOINT_COUNT + 1];

/// The carried and blended motion on the frames within 0..=last_frame.
pub(super) fn carry(segments: &[Segment], last_frame: u32) -> Body {
    let first = segments.first().map_or(0, |s| s.placed.begin.max(0));
    let last = segments.last().map_or(-1, |s| s.placed.end.min(last_frame as i32));
    let mut body = Body { begin: first as u32, ..Body::default() };
    let stitches: Vec<Stitch> = segments.windows(2).map(|pair| Stitch::between(&pair[0], &pair[1])).collect();
    let frames = (last + 1 - first).max(0) as usize;
    body.root.reserve_exact(frames);
    body.rotations.reserve_exact(frames * JOINT_COUNT);
    let mut current = 0;
    for frame in first..=last {
        while current + 1 < segments.len() && frame >= segments[current].placed.end {
            current += 1;
        }
        let mut pose = pose_at(&segments[current], segments[current].source_frame(frame));
        if current > 0 {
            pose.add(&stitches[current - 1], stitches[current - 1].after(frame));
        }
        if let Some(stitch) = stitches.get(current) {
            pose.add(stitch, stitch.before(frame));
        }
        body.root.push(pose.root);
        body.rotations.push(pose.heading * pose.rotations[0]);
        body.rotations.extend_from_slice(&pose.rotations[1..]);
    }
    body
}

/// A carried pose; the hips' rotation is still relative to the path frame.
struct Pose {
    root: Vec3,
    heading: Quat,
    rotations: [Quat; JOINT_COUNT],
}

impl Pose {
    /// Adds the stitch's differences, the value scaled by `weights.0` and the rate by `weights.1`.
    fn add(&mut self, stitch: &Stitch, (value, rate): (f32, f32)) {
        if value == 0.0 && rate == 0.0 {
            return;
        }
        let offset = |i: usize| stitch.difference[i] * value + stitch.rate[i] * rate;
        // Where speeds differ so much that the hips would leave the path, nearness to the path goes first.
        self.root += offset(JOINT_COUNT).clamp_length_max(MAX_SHIFT);
        for (i, q) in self.rotations.iter_mut().enumerate() {
            let blended = (Quat::from_scaled_axis(offset(i)) * *q).normalize();
            *q = hold_back(i, blended, || stitch.excess[i].max(excess(i, *q)));
        }
    }
}

fn pose_at(segment: &Segment, source_frame: f32) -> Pose {
    let motion = segment.motion();
    let i = (source_frame as usize).min(motion.len() - 2);
    let t = source_frame - i as f32;
    let at = ground_at(segment, i, t);
    let height = motion.heights[i] * (1.0 - t) + motion.heights[i + 1] * t;
    let (a, b) = (motion.pose(i), motion.pose(i + 1));
    Pose {
        root: Vec3::new(at.position.x, height, at.position.y),
        heading: at.rotation(),
        rotations: std::array::from_fn(|j| if t == 0.0 { a[j] } else { a[j].lerp(b[j], t) }),
    }
}

/// The placed path between source frames `i` and `i + 1`.
pub(super) fn ground_at(segment: &Segment, i: usize, t: f32) -> Ground {
    let (points, headings) = (&segment.placed.points, &segment.placed.headings);
    Ground::new(points[i].lerp(points[i + 1], t), headings[i] * (1.0 - t) + headings[i + 1] * t)
}

/// The differences between the two sides of a stitch: entry minus exit, in value and per frame.
struct Stitch {
    frame: i32,
    /// What the side before takes, 0 to 1; the side after takes the rest.
    share_before: f32,
    window_before: i32,
    window_after: i32,
    difference: Offset,
    rate: Offset,
    /// How far each joint is beyond its limits on either side of the stitch, the larger of the two, radians.
    excess: [f32; JOINT_COUNT],
}

impl Stitch {
    fn between(before: &Segment, after: &Segment) -> Self {
        let last = (before.motion().len() - 1) as f32;
        let (exit, entry) = (pose_at(before, last), pose_at(after, 0.0));
        let exit_rate = rate(&pose_at(before, last - 1.0), &exit, before.rate());
        let entry_rate = rate(&entry, &pose_at(after, 1.0), after.rate());
        let share_before = match (before.kind.people() > 1, after.kind.people() > 1) {
            (true, false) => 0.0,
            (false, true) => 1.0,
            _ => 0.5,
        };
        let window = |s: &Segment, share: f32| {
            let (frames, ticks) =
                (if share == 1.0 { LONG_BLEND_FRAMES } else { BLEND_FRAMES }, s.placed.end - s.placed.begin);
            frames.min((ticks as f32 * (0.5 + 0.3 * (share - 0.5))) as i32).max(1)
        };
        Self {
            frame: after.placed.begin,
            share_before,
            window_before: window(before, share_before),
            window_after: window(after, 1.0 - share_before),
            difference: difference(&exit, &entry),
            rate: std::array::from_fn(|i| entry_rate[i] - exit_rate[i]),
            excess: std::array::from_fn(|i| excess(i, exit.rotations[i]).max(excess(i, entry.rotations[i]))),
        }
    }

    /// Weights of difference and rate at a frame before the stitch.
    fn before(&self, frame: i32) -> (f32, f32) {
        fade::before(self.share_before, self.window_before as f32, (self.frame - frame) as f32)
    }

    /// Weights of difference and rate at a frame after the stitch.
    fn after(&self, frame: i32) -> (f32, f32) {
        fade::after(1.0 - self.share_before, self.window_after as f32, (frame - self.frame) as f32)
    }
}

fn difference(from: &Pose, to: &Pose) -> Offset {
    std::array::from_fn(|i| match i {
        JOINT_COUNT => to.root - from.root,
        _ => fade::turn_from(from.rotations[i], to.rotations[i]),
    })
}

fn rate(from: &Pose, to: &Pose, per_frame: f32) -> Offset {
    difference(from, to).map(|d| d * per_frame)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::joint::LEFT_LEG;

    #[test]
    fn blends_turn_no_joint_further_than_what_they_blend() {
        let pose = |knee: f32| {
            let mut rotations = [Quat::IDENTITY; JOINT_COUNT];
            rotations[LEFT_LEG] = Quat::from_rotation_x(knee);
            Pose { root: Vec3::ZERO, heading: Quat::IDENTITY, rotations }
        };
        let over = |pose: &Pose| excess(LEFT_LEG, pose.rotations[LEFT_LEG]);
        let (exit, entry) = (pose(-0.3), pose(0.0));
        // A knee that straightens fast would be bent backwards by the rate it is to lose.
        let mut rate = [Vec3::ZERO; JOINT_COUNT + 1];
        rate[LEFT_LEG] = Vec3::NEG_X * 0.3;
        let stitch = Stitch {
            frame: 0,
            share_before: 0.5,
            window_before: 10,
            window_after: 10,
            difference: difference(&exit, &entry),
            rate,
            excess: std::array::from_fn(|i| excess(i, exit.rotations[i]).max(excess(i, entry.rotations[i]))),
        };
        let allowed = over(&exit);
        assert!(allowed > 0.1);
        let mut last = 0.0;
        for weight in 0..20 {
            let mut blended = pose(0.0);
            blended.add(&stitch, (0.0, weight as f32 * 0.1));
            assert!(over(&blended) <= allowed + 1e-3 && (over(&blended) - last).abs() < 0.04, "{}", over(&blended));
            last = over(&blended);
        }
        assert!((last - allowed).abs() < 1e-3, "nothing was held back");
    }
}
