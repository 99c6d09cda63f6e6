//! Mirrored copies: left and right swapped, x to -x. They double a patch set.

use glam::{Quat, Vec2, Vec3};

use super::skeleton::{JOINT_COUNT, joint};
use super::{BodyPart, Foot, Motion, MotionPath, Plant};

/// The motion seen in a mirror on the plane x = 0.
pub fn motion(motion: &Motion) -> Motion {
    let path = MotionPath {
        points: motion.path.points.iter().map(|p| Vec2::new(-p.x, p.y)).collect(),
        headings: motion.path.headings.iter().map(|h| -h).collect(),
    };
    let pose = |frame: usize| (0..JOINT_COUNT).map(move |j| rotation(motion.pose(frame)[joint::mirror(j)]));
    Motion {
        path,
        heights: motion.heights.clone(),
        rotations: (0..motion.len()).flat_map(pose).collect(),
        plants: motion.plants.iter().map(|p| Plant { foot: foot(p.foot), ..*p }).collect(),
    }
}

/// The rotation seen in that mirror.
pub(crate) fn rotation(q: Quat) -> Quat {
    Quat::from_xyzw(q.x, -q.y, -q.z, q.w)
}

/// The points of a body (see [`super::pose::points`], or a window of those) seen in that mirror, in the body's order.
pub fn cloud(points: &[Vec3]) -> Vec<Vec3> {
    let per_frame = JOINT_COUNT + TIPS.len();
    let twin = |k: usize| match k.checked_sub(JOINT_COUNT) {
        None => joint::mirror(k),
        Some(tip) => {
            let other = joint::mirror(TIPS[tip]);
            JOINT_COUNT + TIPS.iter().position(|&t| t == other).expect("tips come in pairs")
        }
    };
    let at = |i: usize| points[i / per_frame * per_frame + twin(i % per_frame)] * Vec3::new(-1.0, 1.0, 1.0);
    (0..points.len()).map(at).collect()
}

/// The canonical joints that have tips, in order.
const TIPS: [usize; 5] = [joint::LEFT_TOE, joint::RIGHT_TOE, joint::HEAD, joint::LEFT_HAND, joint::RIGHT_HAND];

/// The other foot.
pub fn foot(foot: Foot) -> Foot {
    match foot {
        Foot::Left => Foot::Right,
        Foot::Right => Foot::Left,
    }
}

/// The same part on the other side.
pub fn part(part: BodyPart) -> BodyPart {
    match part {
        BodyPart::LeftHand => BodyPart::RightHand,
        BodyPart::RightHand => BodyPart::LeftHand,
        other => other,
    }
}

/// The pose group that mirrored copies of `name`'s poses belong to: `walk_left` becomes `walk_right`.
pub fn group(name: &str) -> String {
    if let Some(stem) = name.strip_suffix("_left") {
        return format!("{stem}_right");
    }
    name.strip_suffix("_right").map_or_else(|| name.to_owned(), |stem| format!("{stem}_left"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mirrored_joints_are_the_mirrored_points_and_twice_is_once() {
        let rotations = (0..2 * JOINT_COUNT)
            .map(|i| Quat::from_euler(glam::EulerRot::XYZ, i as f32 * 0.3, i as f32 * 0.7 - 1.0, 0.2 * i as f32));
        let original = Motion {
            path: MotionPath { points: vec![Vec2::new(1.0, 2.0), Vec2::new(1.5, 2.2)], headings: vec![0.4, 0.5] },
            heights: vec![0.9, 0.91],
            rotations: rotations.collect(),
            plants: vec![Plant { foot: Foot::Left, begin: 0, end: 1 }],
        };
        let mirrored = motion(&original);
        assert_eq!(mirrored.plants[0].foot, Foot::Right);
        let (mut a, mut b) = (Vec::new(), Vec::new());
        for frame in 0..2 {
            original.globals(frame, &mut a);
            mirrored.globals(frame, &mut b);
            for j in 0..JOINT_COUNT {
                let expected = a[joint::mirror(j)].0 * Vec3::new(-1.0, 1.0, 1.0);
                assert!((b[j].0 - expected).length() < 1e-5, "joint {j}");
            }
        }
        assert_eq!(motion(&mirrored), original);
        for frame in 0..2 {
            let (points, expected) =
                (cloud(&super::super::pose::points(&original, frame)), super::super::pose::points(&mirrored, frame));
            assert!(points.iter().zip(&expected).all(|(p, q)| p.distance(*q) < 1e-5));
        }
    }

    #[test]
    fn groups_swap_sides() {
        assert_eq!([group("walk_left"), group("walk_right"), group("stand")], ["walk_right", "walk_left", "stand"]);
    }
}
