//! Planted feet stay where they are: each plant locks the ball of the foot to one place, legs follow by inverse
//! kinematics, hips come down where a leg would have to be longer than it is.

use glam::{Quat, Vec3};

use super::leg::{self, Leg};
use super::{Body, Segment, smoothstep};
use crate::motion::joint::{LEFT_FOOT, RIGHT_FOOT, RIGHT_TOE};
use crate::motion::{Foot, JOINT_COUNT, canonical};

/// Frames over which hips come down and rise again.
const LOWERING_FRAMES: usize = 5;
/// A swing this long (frames) forgets the plant before it.
const LONG_SWING: i32 = 24;
/// Frames over which a long swing takes on or loses the correction of a plant.
const RELEASE_FRAMES: i32 = 10;
/// Gap in a foot's plants over a stitch that still counts as one plant, frames.
const MERGE_FRAMES: i32 = 2;

/// A plant on the crowd's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Lock {
    begin: i32,
    end: i32,
    /// Frames that say where the foot stands: those with others where there are any, so that what people do together
    /// stays as captured.
    anchor: (i32, i32),
    together: bool,
}

impl Lock {
    fn new(begin: i32, end: i32, together: bool) -> Self {
        Self { begin, end, anchor: (begin, end), together }
    }

    /// Goes on with `next`.
    fn extend(&mut self, next: Self) {
        self.end = self.end.max(next.end);
        if next.together && !self.together {
            self.anchor = next.anchor;
        } else if next.together == self.together {
            self.anchor.1 = self.anchor.1.max(next.anchor.1);
        }
        self.together |= next.together;
    }
}

/// Locks planted feet.
pub(super) fn lock(segments: &[Segment], body: &mut Body) {
    let frames = body.root.len();
    if frames == 0 {
        return;
    }
    let legs = [(Foot::Left, LEFT_FOOT), (Foot::Right, RIGHT_FOOT)];
    let balls = trajectories(body, legs.map(|(_, ankle)| ankle + 1));
    let offsets = [0, 1].map(|k| {
        let (foot, balls) = (legs[k].0, &balls[k]);
        let mut offsets = corrections(balls, &locks(segments, foot, body.begin as i32, frames as i32));
        keep_above_floor(balls, &mut offsets);
        offsets
    });
    let lowering = lowering(body, legs.map(|(_, ankle)| ankle), &offsets);
    let mut globals = Vec::new();
    for f in 0..frames {
        let down = lowering[f];
        body.root[f].y -= down;
        // One leg moves no joint of the other.
        leg_globals(body, f, &mut globals);
        for (k, (_, ankle)) in legs.into_iter().enumerate() {
            let mut shift = offsets[k][f] + Vec3::Y * down;
            let pose = &mut body.rotations[f * JOINT_COUNT..(f + 1) * JOINT_COUNT];
            shift.y += leg::lift_toes(pose, &mut globals, ankle, shift.y);
            if shift.length_squared() > 1e-10
                && leg::plant(pose, &globals, ankle, shift).is_strained()
                && body.strained.last() != Some(&f)
            {
                body.strained.push(f);
            }
        }
    }
}

/// The plants of one foot on the crowd's frames 0.. of the body, those that go on over a stitch made one.
fn locks(segments: &[Segment], foot: Foot, begin: i32, frames: i32) -> Vec<Lock> {
    let mut locks: Vec<Lock> = Vec::new();
    for s in segments {
        for p in s.motion().plants.iter().filter(|p| p.foot == foot) {
            let at = |source: u32| s.frame_of(source as f32) - begin as f32;
            let (first, last) = (at(p.begin).ceil() as i32, at(p.end).floor() as i32);
            let lock = Lock::new(first.max(0), last.min(frames - 1), s.kind.people() > 1);
            if lock.end < lock.begin {
                continue;
            }
            match locks.last_mut() {
                Some(last) if lock.begin <= last.end + MERGE_FRAMES => last.extend(lock),
                _ => locks.push(lock),
            }
        }
    }
    locks
}

/// Global transforms of the hips and the legs, which come first.
fn leg_globals(body: &Body, f: usize, out: &mut Vec<(Vec3, Quat)>) {
    canonical().globals(body.root[f], &body.pose(f)[..=RIGHT_TOE], out);
}

/// Where two joints of the legs are on each frame.
fn trajectories(body: &Body, joints: [usize; 2]) -> [Vec<Vec3>; 2] {
    let (mut globals, mut out) = (Vec::new(), [const { Vec::new() }; 2]);
    for f in 0..body.root.len() {
        leg_globals(body, f, &mut globals);
        out.iter_mut().zip(joints).for_each(|(places, joint)| places.push(globals[joint].0));
    }
    out
}

/// What to add to the ball's position on each frame: exactly what keeps it in place over a plant, and a smooth way
/// from one plant's last correction to the next one's first in between.
fn corrections(balls: &[Vec3], locks: &[Lock]) -> Vec<Vec3> {
    let mut offsets = vec![Vec3::ZERO; balls.len()];
    for lock in locks {
        let range = lock.begin as usize..=lock.end as usize;
        let anchor = &balls[lock.anchor.0 as usize..=lock.anchor.1 as usize];
        let place = anchor.iter().sum::<Vec3>() / anchor.len() as f32;
        for f in range {
            offsets[f] = place - balls[f];
        }
    }
    for pair in locks.windows(2) {
        fill(&mut offsets, Some(pair[0].end), Some(pair[1].begin));
    }
    if let (Some(first), Some(last)) = (locks.first(), locks.last()) {
        fill(&mut offsets, None, Some(first.begin));
        fill(&mut offsets, Some(last.end), None);
    }
    offsets
}

/// Blends and captures let feet sink a little: no ball goes below the floor.
fn keep_above_floor(balls: &[Vec3], offsets: &mut [Vec3]) {
    for (ball, offset) in balls.iter().zip(offsets) {
        offset.y = offset.y.max(-ball.y);
    }
}

fn fill(offsets: &mut [Vec3], from: Option<i32>, to: Option<i32>) {
    let begin = from.unwrap_or(-LONG_SWING);
    let end = to.unwrap_or(offsets.len() as i32 + LONG_SWING);
    let before = from.map_or(Vec3::ZERO, |f| offsets[f as usize]);
    let after = to.map_or(Vec3::ZERO, |f| offsets[f as usize]);
    let fade = if end - begin < LONG_SWING { end - begin } else { RELEASE_FRAMES };
    for f in (begin + 1).max(0)..end.min(offsets.len() as i32) {
        let left = 1.0 - smoothstep((f - begin) as f32 / fade as f32);
        let gained = 1.0 - smoothstep((end - f) as f32 / fade as f32);
        offsets[f as usize] = before * left + after * gained;
    }
}

/// How far the hips must come down on each frame for both feet to be in reach, smoothed over time.
fn lowering(body: &Body, ankles: [usize; 2], offsets: &[Vec<Vec3>; 2]) -> Vec<f32> {
    let n = body.root.len();
    let mut globals = Vec::new();
    let need: Vec<f32> = (0..n)
        .map(|f| {
            leg_globals(body, f, &mut globals);
            let of_leg = |k: usize| match offsets[k][f] {
                Vec3::ZERO => 0.0,
                shift => Leg::new(&globals, ankles[k], shift).lowering(),
            };
            of_leg(0).max(of_leg(1))
        })
        .collect();
    if need.iter().all(|&v| v == 0.0) {
        return need;
    }
    // A running maximum and a running mean of the same width: smooth, and nowhere less than needed.
    let window = |f: usize| f.saturating_sub(LOWERING_FRAMES)..(f + LOWERING_FRAMES + 1).min(n);
    let widest: Vec<f32> = (0..n).map(|f| need[window(f)].iter().copied().fold(0.0, f32::max)).collect();
    (0..n).map(|f| widest[window(f)].iter().sum::<f32>() / window(f).len() as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corrections_hold_the_ball_still_and_are_smooth_between() {
        let balls: Vec<Vec3> = (0..60).map(|f| Vec3::new(0.0, 0.02, f as f32 * 0.01)).collect();
        let locks = [Lock::new(5, 20, false), Lock::new(35, 50, false)];
        let offsets = corrections(&balls, &locks);
        for lock in locks {
            let place = balls[lock.begin as usize] + offsets[lock.begin as usize];
            for f in lock.begin..=lock.end {
                assert!((balls[f as usize] + offsets[f as usize] - place).length() < 1e-6);
            }
        }
        let jump = offsets.windows(2).map(|w| (w[1] - w[0]).length()).fold(0.0, f32::max);
        assert!(jump < 0.03, "{jump}");
    }
}
