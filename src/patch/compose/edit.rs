//! What a compose file changes of a clip: the side it is seen from, what arms do, that it goes on for ever, where it leads.

use glam::{Quat, Vec3};

use super::story::Clip;
use super::sweep::sweep;
use crate::Result;
use crate::deform::Limits;
use crate::motion::{Foot, JOINT_COUNT, Motion, arm, fade, mirror};

/// A clip's motion as the file wants it. O(frames x joints).
///
/// # Errors
/// It cannot end where it is to ([`sweep`]).
pub(super) fn edit(clip: &Clip, captured: Motion, limits: &Limits) -> Result<Motion> {
    let mut motion = if clip.mirror { mirror::motion(&captured) } else { captured };
    clip.arms.into_iter().for_each(|side| mirror_arm(&mut motion, side));
    sweep(clip, if clip.looped { looped(motion) } else { motion }, limits)
}

/// Makes the other arm the mirror image of the one on this side.
fn mirror_arm(motion: &mut Motion, side: Foot) {
    for pose in motion.rotations.chunks_exact_mut(JOINT_COUNT) {
        for (joint, other) in arm::joints(side).into_iter().zip(arm::joints(mirror::foot(side))) {
            pose[other] = mirror::rotation(pose[joint]);
        }
    }
}

/// A motion that ends in the pose in which it begins, and as fast: what is missing is spread over all of it, as between
/// two motions that follow each other ([`fade`]).
fn looped(mut motion: Motion) -> Motion {
    let last = motion.len() - 1;
    let turns = |from: usize, to: usize| -> Vec<Vec3> {
        motion.pose(from).iter().zip(motion.pose(to)).map(|(&a, &b)| fade::turn_from(a, b)).collect()
    };
    let heights = motion.heights.clone();
    let rise = |from: usize, to: usize| heights[to] - heights[from];
    let (turn, begin, end) = (turns(last, 0), turns(0, 1), turns(last - 1, last));
    for frame in 0..=last {
        let (before, after) =
            (fade::before(0.5, last as f32, (last - frame) as f32), fade::after(0.5, last as f32, frame as f32));
        let (value, rate) = (before.0 + after.0, before.1 + after.1);
        motion.heights[frame] += value * rise(last, 0) + rate * (rise(0, 1) - rise(last - 1, last));
        for joint in 0..JOINT_COUNT {
            let change = turn[joint] * value + (begin[joint] - end[joint]) * rate;
            let pose = &mut motion.rotations[frame * JOINT_COUNT + joint];
            *pose = (Quat::from_scaled_axis(change) * *pose).normalize();
        }
    }
    motion
}
