//! Those who sit. Who sits down and gets up again every few seconds looks odd, and kinds with boxes are left out where time
//! comes round; so a sitter plays the time between: from the frame of a capture to the later one that is most like it, as
//! often as goes into the period, a trifle faster or slower. What is left between the two is spread over the round.

use glam::{Quat, Vec2, Vec3};

use super::tableau::Tableau;
use crate::motion::{FPS, JOINT_COUNT, Motion, pose};
use crate::patch::{PatchKind, PatchProp, PatchSet, PropHold};
use crate::stage::world::Act;

/// A round lasts at least so many frames, and frames next to the seat's begin and end belong to sitting down and getting up.
const SHORTEST: usize = 24;
const SETTLING: usize = 8;
/// Poses are compared over so many frames on either side.
const AROUND: usize = 3;
/// Poses that are farther from each other than this, metres, do not make a round.
const UNLIKE: f32 = 0.04;
/// Sitters whose merit is below this part of the best one's are left out.
const LIVELY: f32 = 0.4;
/// Rounds are played this much faster or slower at most.
const PACES: std::ops::RangeInclusive<f32> = 0.8..=1.25;

/// A stretch of a motion that can be repeated: how far its end is from its begin, and how far it gets from there, metres.
struct Round {
    frames: (usize, usize),
    gap: f32,
    stirs: f32,
}

impl Round {
    /// The more happens the better, the less has to be led back the better.
    fn merit(&self) -> f32 {
        self.stirs - 2.0 * self.gap
    }
}

/// Up to `most` sitters alone, the best first.
pub(super) fn sit(set: &PatchSet, period: f32, most: usize) -> Vec<Tableau> {
    let stretches =
        set.kinds.iter().flat_map(|kind| kind.props.iter().flat_map(move |p| p.sat.iter().map(move |s| (kind, p, s))));
    let mut found: Vec<(f32, Tableau)> =
        stretches.filter_map(|(kind, prop, sat)| sitter(kind, prop, sat, period)).collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    // Who sits like a stone is left out where there are others.
    let least = LIVELY * found.first().map_or(0.0, |best| best.0);
    found.into_iter().take_while(|f| f.0 >= least).take(most).map(|(_, tableau)| tableau).collect()
}

fn sitter(kind: &PatchKind, prop: &PatchProp, sat: &PropHold, period: f32) -> Option<(f32, Tableau)> {
    let fragment = kind.fragments.get(sat.role as usize)?;
    let motion = &fragment.motion;
    let first = (sat.begin - fragment.begin) as usize + SETTLING;
    let last = ((sat.end - fragment.begin) as usize).checked_sub(SETTLING)?;
    let round = round(motion, (first, last), period)?;
    let rest = prop.before?;
    let seat = (Vec2::new(rest.middle.x, rest.middle.z), Vec2::new(prop.size[0], prop.size[2]), -rest.heading);
    Some((round.merit(), Tableau::new(vec![clip(motion, &round, period)], vec![seat])))
}

/// The best stretch of all.
fn round(motion: &Motion, (first, last): (usize, usize), period: f32) -> Option<Round> {
    let mut best: Option<Round> = None;
    for begin in (first..last.saturating_sub(SHORTEST)).step_by(2) {
        let mut stirs = 0.0f32;
        for end in (begin + 2..=last).step_by(2) {
            stirs = stirs.max(pose::distance(motion, begin, motion, end));
            let pace = rounds(end - begin, period) * (end - begin) as f32 / (period * FPS);
            if end < begin + SHORTEST || !PACES.contains(&pace) {
                continue;
            }
            let gap = pose::window_distance(motion, begin, motion, end, AROUND);
            let round = Round { frames: (begin, end), gap, stirs };
            if gap < UNLIKE && best.as_ref().is_none_or(|b| round.merit() > b.merit()) {
                best = Some(round);
            }
        }
    }
    best
}

/// How often a stretch of so many frames goes into a period.
fn rounds(frames: usize, period: f32) -> f32 {
    (period * FPS / frames as f32).round().max(1.0)
}

fn clip(motion: &Motion, round: &Round, period: f32) -> Act {
    let (begin, end) = round.frames;
    let count = (period / rounds(end - begin, period) * FPS).round().max(2.0) as usize;
    let (first, last) = (state(motion, begin as f32), state(motion, end as f32));
    let mut act = Act { step: period / rounds(end - begin, period) / count as f32, ..Act::default() };
    for frame in 0..count {
        let share = frame as f32 / count as f32;
        let (root, pose) = state(motion, begin as f32 + share * (end - begin) as f32);
        act.roots.push(root + (first.0 - last.0) * share);
        act.rotations.extend((0..JOINT_COUNT).map(|j| led(pose[j], last.1[j], first.1[j], share)));
    }
    act
}

/// A rotation that is led to where the round began.
fn led(q: Quat, last: Quat, first: Quat, share: f32) -> Quat {
    let back = last.inverse() * first;
    let back = if back.w < 0.0 { -back } else { back };
    (q * Quat::IDENTITY.slerp(back, share)).normalize()
}

/// Hips and rotations between two frames, in the patch's frame.
fn state(motion: &Motion, at: f32) -> (Vec3, Vec<Quat>) {
    let frame = (at as usize).min(motion.len() - 2);
    let (a, b, share) = (whole(motion, frame), whole(motion, frame + 1), at - frame as f32);
    (a.0.lerp(b.0, share), a.1.iter().zip(&b.1).map(|(p, q)| p.slerp(*q, share)).collect())
}

fn whole(motion: &Motion, frame: usize) -> (Vec3, Vec<Quat>) {
    let place = motion.path.points[frame];
    let mut pose = motion.pose(frame).to_vec();
    pose[0] = Quat::from_rotation_y(motion.path.headings[frame]) * pose[0];
    (Vec3::new(place.x, motion.heights[frame], place.y), pose)
}
