//! Walk and clip fade into each other. The body does so in half a second; each foot goes over by itself, in a step: while it stands
//! it stays where it is, be it on a footprint of the walk or of the clip, and the leg reaches it in closed form.

use glam::{Quat, Vec3};

use crate::motion::ik::two_bone;
use crate::motion::{JOINT_COUNT, canonical, joint};

/// Largest part of a leg's length that is used, unless walk or clip use more, so that knees never lock.
const STRETCH: f32 = 0.995;
/// Most that hips come down for a foot to be in reach, metres.
const LOWERING: f32 = 0.06;

/// How much of a clip is seen, 0 to 1: of the body, of the left and of the right foot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shares {
    pub body: f32,
    pub feet: [f32; 2],
}

/// Places and rotations in the world of thigh, shin, foot and toes.
type Leg = [(Vec3, Quat); 4];

/// Leads `pose`, whose hips are at `root`, to the other one as far as the shares say; returns its hips. O(1), no allocation.
pub(super) fn fade(
    pose: &mut [Quat; JOINT_COUNT],
    root: Vec3,
    (other, other_root): (&[Quat; JOINT_COUNT], Vec3),
    shares: Shares,
) -> Vec3 {
    let both = [shares.feet[0], shares.feet[1], shares.body];
    if both == [0.0; 3] {
        return root;
    }
    if both == [1.0; 3] {
        *pose = *other;
        return other_root;
    }
    let ups = [joint::LEFT_UP_LEG, joint::RIGHT_UP_LEG];
    let feet = [0, 1].map(|i| {
        let (own, to) = (leg(pose, root, ups[i]), leg(other, other_root, ups[i]));
        let between = |k: usize| (own[k].0.lerp(to[k].0, shares.feet[i]), between(own[k].1, to[k].1, shares.feet[i]));
        [between(2), between(3)]
    });
    for (q, to) in pose.iter_mut().zip(other) {
        *q = between(*q, *to, shares.body);
    }
    let mut root = root.lerp(other_root, shares.body);
    let targets = [0, 1].map(|i| {
        let [(_, foot), (ball, _)] = feet[i];
        ball - foot * canonical().joints[ups[i] + 3].offset
    });
    let down = [0, 1].map(|i| lowering(&leg(pose, root, ups[i]), targets[i])).into_iter().fold(0.0, f32::max);
    root.y -= down.min(LOWERING);
    for i in 0..2 {
        let [(_, foot), (_, toes)] = feet[i];
        reach(pose, root, ups[i], targets[i], [foot, toes]);
    }
    root
}

/// On the way from one rotation to another.
fn between(from: Quat, to: Quat, share: f32) -> Quat {
    let to = if from.dot(to) < 0.0 { -to } else { to };
    (from * (1.0 - share) + to * share).normalize()
}

/// The leg that begins at joint `up`.
fn leg(pose: &[Quat; JOINT_COUNT], root: Vec3, up: usize) -> Leg {
    let mut at = (root, pose[0]);
    std::array::from_fn(|k| {
        at = (at.0 + at.1 * canonical().joints[up + k].offset, at.1 * pose[up + k]);
        at
    })
}

/// How far the hips should come down for an ankle to be in reach, metres. A leg reaches as far as it already does.
fn lowering(leg: &Leg, ankle: Vec3) -> f32 {
    let (hip, own) = (leg[0].0, leg[2].0);
    let length = leg[0].0.distance(leg[1].0) + leg[1].0.distance(own);
    let reach = hip.distance(own).max(STRETCH * length);
    let across = (ankle - hip).with_y(0.0).length_squared();
    hip.y - ankle.y - (reach * reach - across).max(0.0).sqrt()
}

/// Brings an ankle to its place, with foot and toes turned as given.
fn reach(pose: &mut [Quat; JOINT_COUNT], root: Vec3, up: usize, ankle: Vec3, [foot, toes]: [Quat; 2]) {
    let [(hip, thigh), (knee, shin), (own, _), _] = leg(pose, root, up);
    let (swing, bend, _) = two_bone(hip, knee, own, ankle, thigh * Vec3::Z, 0.9999);
    let (thigh, shin) = (swing * thigh, swing * bend * shin);
    pose[up] = (pose[0].conjugate() * thigh).normalize();
    pose[up + 1] = (thigh.conjugate() * shin).normalize();
    pose[up + 2] = (shin.conjugate() * foot).normalize();
    pose[up + 3] = (foot.conjugate() * toes).normalize();
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Somebody in mid-step, one leg ahead.
    fn stepping(ahead: f32, heading: f32) -> ([Quat; JOINT_COUNT], Vec3) {
        let mut pose = [Quat::IDENTITY; JOINT_COUNT];
        pose[0] = Quat::from_rotation_y(heading);
        for (up, side) in [(joint::LEFT_UP_LEG, 1.0), (joint::RIGHT_UP_LEG, -1.0)] {
            pose[up] = Quat::from_rotation_x(-0.3 * side * ahead - 0.2);
            pose[up + 1] = Quat::from_rotation_x(0.4);
            pose[up + 2] = Quat::from_rotation_x(-0.2);
        }
        (pose, Vec3::new(0.02 * ahead, 0.90, 0.1 * ahead))
    }

    fn balls(pose: &[Quat; JOINT_COUNT], root: Vec3) -> [Vec3; 2] {
        [joint::LEFT_UP_LEG, joint::RIGHT_UP_LEG].map(|up| leg(pose, root, up)[3].0)
    }

    #[test]
    fn feet_are_where_their_own_shares_have_them_whatever_the_body_does() {
        let ((walk, hips), (clip, place)) = (stepping(1.0, 0.0), stepping(0.6, 0.15));
        let (from, to) = (balls(&walk, hips), balls(&clip, place));
        for body in [0.0, 0.25, 0.5, 1.0] {
            for feet in [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.3, 0.0]] {
                let mut pose = walk;
                let root = fade(&mut pose, hips, (&clip, place), Shares { body, feet });
                let found = balls(&pose, root);
                for i in 0..2 {
                    let wanted = from[i].lerp(to[i], feet[i]);
                    assert!(found[i].distance(wanted) < 2e-3, "{body} {feet:?} {i}: {} {wanted}", found[i]);
                }
            }
        }
    }

    #[test]
    fn nothing_leaps_where_a_fade_begins_and_ends() {
        let ((walk, hips), (clip, place)) = (stepping(1.0, 0.0), stepping(0.6, 0.15));
        for (share, wanted) in [(1e-4, (walk, hips)), (1.0 - 1e-4, (clip, place))] {
            let mut pose = walk;
            let root = fade(&mut pose, hips, (&clip, place), Shares { body: share, feet: [share; 2] });
            assert!(root.distance(wanted.1) < 2e-3, "{root} {}", wanted.1);
            for (q, to) in pose.iter().zip(wanted.0) {
                assert!(q.angle_between(to) < 0.02, "{q} {to}");
            }
        }
    }
}
