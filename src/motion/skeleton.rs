//! Skeletons as parents and offsets, and the one canonical humanoid that all captures are retargeted to.

use std::sync::LazyLock;

use glam::{Quat, Vec3};

/// Index of a joint in its skeleton.
pub type JointId = usize;

/// One joint: its rest offset from its parent in the parent's frame, in metres.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Joint {
    /// Unique name.
    pub name: String,
    /// Index of the parent, always smaller than the joint's own; `None` for the root.
    pub parent: Option<JointId>,
    /// Rest offset from the parent in metres.
    pub offset: Vec3,
    /// Where the bone ends if no child says so (toe tip, finger tip, crown), in the joint's own frame.
    pub tip: Option<Vec3>,
}

/// A tree of joints in topological order. In the rest pose all rotations are identity.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Skeleton {
    /// The joints; parents come first.
    pub joints: Vec<Joint>,
}

impl Skeleton {
    /// Index of the joint called `name`.
    pub fn find(&self, name: &str) -> Option<JointId> {
        self.joints.iter().position(|j| j.name == name)
    }

    /// Global position and rotation of each joint, from the root's position and all local rotations. O(joints).
    pub fn globals(&self, root: Vec3, rotations: &[Quat], out: &mut Vec<(Vec3, Quat)>) {
        out.resize(rotations.len().min(self.joints.len()), (Vec3::ZERO, Quat::IDENTITY));
        self.place(root, rotations, out);
    }

    /// The same into as many places as there are rotations: of the first joints only, if they are fewer.
    #[inline]
    pub fn place(&self, root: Vec3, rotations: &[Quat], out: &mut [(Vec3, Quat)]) {
        for (j, (joint, &local)) in self.joints.iter().zip(rotations).enumerate() {
            out[j] = match joint.parent {
                None => (root, local),
                Some(parent) => {
                    let (position, rotation) = out[parent];
                    (position + rotation * joint.offset, rotation * local)
                }
            };
        }
    }
}

/// Names of the canonical joints' indices.
pub mod joint {
    #![allow(missing_docs)]
    pub const HIPS: usize = 0;
    pub const LEFT_UP_LEG: usize = 1;
    pub const LEFT_LEG: usize = 2;
    pub const LEFT_FOOT: usize = 3;
    pub const LEFT_TOE: usize = 4;
    pub const RIGHT_UP_LEG: usize = 5;
    pub const RIGHT_LEG: usize = 6;
    pub const RIGHT_FOOT: usize = 7;
    pub const RIGHT_TOE: usize = 8;
    pub const SPINE: usize = 9;
    pub const SPINE1: usize = 10;
    pub const SPINE2: usize = 11;
    pub const NECK: usize = 12;
    pub const HEAD: usize = 13;
    pub const LEFT_SHOULDER: usize = 14;
    pub const LEFT_ARM: usize = 15;
    pub const LEFT_FORE_ARM: usize = 16;
    pub const LEFT_HAND: usize = 17;
    pub const RIGHT_SHOULDER: usize = 18;
    pub const RIGHT_ARM: usize = 19;
    pub const RIGHT_FORE_ARM: usize = 20;
    pub const RIGHT_HAND: usize = 21;

    /// The same joint on the other side of the body.
    pub fn mirror(joint: usize) -> usize {
        match joint {
            1..=4 => joint + 4,
            5..=8 => joint - 4,
            14..=17 => joint + 4,
            18..=21 => joint - 4,
            other => other,
        }
    }
}

/// Number of joints of the canonical skeleton.
pub const JOINT_COUNT: usize = 22;

/// The canonical humanoid: 1.75 m tall, T-pose with arms along +-x, facing +z, left is +x.
///
/// The hips rest 0.935 m above the ground; the toe joint (ball of the foot) 0.02 m above it.
pub fn canonical() -> &'static Skeleton {
    static CANONICAL: LazyLock<Skeleton> = LazyLock::new(|| {
        // name, parent, offset, tip of the bone
        type Row = (&'static str, Option<usize>, [f32; 3], Option<[f32; 3]>);
        let rows: [Row; JOINT_COUNT] = [
            ("hips", None, [0.0, 0.935, 0.0], None),
            ("left_up_leg", Some(0), [0.09, -0.03, 0.0], None),
            ("left_leg", Some(1), [0.0, -0.42, 0.0], None),
            ("left_foot", Some(2), [0.0, -0.41, 0.0], None),
            ("left_toe", Some(3), [0.0, -0.055, 0.125], Some([0.0, 0.0, 0.07])),
            ("right_up_leg", Some(0), [-0.09, -0.03, 0.0], None),
            ("right_leg", Some(5), [0.0, -0.42, 0.0], None),
            ("right_foot", Some(6), [0.0, -0.41, 0.0], None),
            ("right_toe", Some(7), [0.0, -0.055, 0.125], Some([0.0, 0.0, 0.07])),
            ("spine", Some(0), [0.0, 0.10, 0.0], None),
            ("spine1", Some(9), [0.0, 0.13, 0.0], None),
            ("spine2", Some(10), [0.0, 0.13, 0.0], None),
            ("neck", Some(11), [0.0, 0.16, 0.0], None),
            ("head", Some(12), [0.0, 0.10, 0.015], Some([0.0, 0.195, 0.0])),
            ("left_shoulder", Some(11), [0.03, 0.10, 0.0], None),
            ("left_arm", Some(14), [0.145, 0.0, 0.0], None),
            ("left_fore_arm", Some(15), [0.28, 0.0, 0.0], None),
            ("left_hand", Some(16), [0.25, 0.0, 0.0], Some([0.17, 0.0, 0.0])),
            ("right_shoulder", Some(11), [-0.03, 0.10, 0.0], None),
            ("right_arm", Some(18), [-0.145, 0.0, 0.0], None),
            ("right_fore_arm", Some(19), [-0.28, 0.0, 0.0], None),
            ("right_hand", Some(20), [-0.25, 0.0, 0.0], Some([-0.17, 0.0, 0.0])),
        ];
        let joints = rows.into_iter().map(|(name, parent, offset, tip)| Joint {
            name: name.into(),
            parent,
            offset: offset.into(),
            tip: tip.map(Vec3::from),
        });
        Skeleton { joints: joints.collect() }
    });
    &CANONICAL
}

/// Length of the bone that ends at a joint of the canonical skeleton, metres.
pub(crate) fn bone_length(joint: JointId) -> f32 {
    canonical().joints[joint].offset.length()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn canonical_is_symmetric_and_stands_on_the_floor() {
        let skeleton = canonical();
        let mut globals = Vec::new();
        skeleton.globals(skeleton.joints[0].offset, &[Quat::IDENTITY; JOINT_COUNT], &mut globals);
        for (j, (position, _)) in globals.iter().enumerate() {
            let twin = globals[joint::mirror(j)].0;
            assert!((*position - Vec3::new(-twin.x, twin.y, twin.z)).length() < 1e-6, "joint {j}");
            assert_eq!(joint::mirror(joint::mirror(j)), j);
        }
        assert!((globals[joint::LEFT_TOE].0.y - 0.02).abs() < 1e-6);
        let crown = globals[joint::HEAD].0.y + skeleton.joints[joint::HEAD].tip.unwrap().y;
        assert!((crown - 1.75).abs() < 0.01, "{crown}");
    }
}
