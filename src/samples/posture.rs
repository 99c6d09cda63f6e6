//! Posture: the neutral stance, the channels a gesture may move, and the whole body assembled from them.

use glam::{Mat3, Quat, Vec3};

use super::footsteps::FootPose;
use crate::motion::ik::bend;
use crate::motion::{Foot, JOINT_COUNT, bone_length, canonical, joint::*};

/// What pulses may add to the body's posture. Angles in radians, lengths in metres.
///
/// Pitch is forward, yaw to the left, roll lifts the left side, seen from the person.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Channel {
    HipsForward,
    HipsLeft,
    HipsUp,
    PelvisPitch,
    PelvisYaw,
    PelvisRoll,
    SpinePitch,
    SpineYaw,
    SpineRoll,
    HeadPitch,
    HeadYaw,
    HeadRoll,
    HeelUpLeft,
    HeelUpRight,
    FlexLeft,
    FlexRight,
    AbductLeft,
    AbductRight,
    ElbowLeft,
    ElbowRight,
    ShrugLeft,
    ShrugRight,
    /// Turns the knee outwards.
    KneeOutLeft,
    KneeOutRight,
    /// Takes away from the arms' swing: 1 stills them.
    StillArms,
}

const CHANNELS: usize = Channel::StillArms as usize + 1;

/// The values of all channels at one moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Channels([f32; CHANNELS]);

impl Default for Channels {
    fn default() -> Self {
        Self([0.0; CHANNELS])
    }
}

impl std::ops::Index<Channel> for Channels {
    type Output = f32;
    fn index(&self, c: Channel) -> &f32 {
        &self.0[c as usize]
    }
}

impl std::ops::IndexMut<Channel> for Channels {
    fn index_mut(&mut self, c: Channel) -> &mut f32 {
        &mut self.0[c as usize]
    }
}

/// Joints of a leg on one side: upper, lower, foot, toe.
pub(super) fn leg(side: Foot) -> [usize; 4] {
    if side == Foot::Left {
        [LEFT_UP_LEG, LEFT_LEG, LEFT_FOOT, LEFT_TOE]
    } else {
        [RIGHT_UP_LEG, RIGHT_LEG, RIGHT_FOOT, RIGHT_TOE]
    }
}

/// A body under construction: local rotations, with global transforms known from the root up to what is set.
#[derive(Clone, Debug)]
pub(super) struct Body {
    pub root: Vec3,
    pub local: [Quat; JOINT_COUNT],
    pub global: Vec<(Vec3, Quat)>,
}

impl Body {
    pub fn new(root: Vec3, pelvis: Quat) -> Self {
        let mut local = [Quat::IDENTITY; JOINT_COUNT];
        local[HIPS] = pelvis;
        let mut body = Self { root, local, global: Vec::with_capacity(JOINT_COUNT) };
        body.refresh();
        body
    }

    /// Recomputes the global transforms.
    pub fn refresh(&mut self) {
        canonical().globals(self.root, &self.local, &mut self.global);
    }

    pub fn position(&self, joint: usize) -> Vec3 {
        self.global[joint].0
    }

    pub fn rotation(&self, joint: usize) -> Quat {
        self.global[joint].1
    }

    /// Puts a leg onto its foot with the knee towards `pole`.
    pub fn set_leg(&mut self, side: Foot, foot: &FootPose, pole: Vec3, stretch: f32) {
        let [up, low, foot_joint, toe] = leg(side);
        let (hip, pelvis) = (self.position(up), self.rotation(HIPS));
        let (thigh_length, shin_length) = (bone_length(low), bone_length(foot_joint));
        let (knee, end) = bend(hip, foot.ankle, thigh_length, shin_length, pole, stretch);
        let hinge = |along: Vec3, forward: Vec3| frame(-along, forward);
        // In both frames z looks to the front of the leg; the knee is in front of the line from hip to ankle.
        let front = knee - (hip + end) * 0.5;
        let thigh = hinge(knee - hip, front);
        let shin = hinge(end - knee, front);
        self.local[up] = pelvis.inverse() * thigh;
        self.local[low] = thigh.inverse() * shin;
        self.local[foot_joint] = shin.inverse() * foot.rotation;
        self.local[toe] = Quat::from_rotation_x(-foot.toe);
    }

    /// Bends the spine by `turn` in the pelvis' frame, a third at each joint.
    pub fn set_spine(&mut self, turn: Quat, curve: [f32; 3]) {
        let third = Quat::IDENTITY.slerp(turn, 1.0 / 3.0);
        for (joint, bend) in [SPINE, SPINE1, SPINE2].into_iter().zip(curve) {
            self.local[joint] = third * Quat::from_rotation_x(bend);
        }
    }

    /// Turns the head to a global rotation, neck and head sharing the turn.
    pub fn set_head(&mut self, rotation: Quat) {
        let turn = self.rotation(SPINE2).inverse() * rotation;
        self.local[NECK] = Quat::IDENTITY.slerp(turn, 0.45);
        self.local[HEAD] = self.local[NECK].inverse() * turn;
    }
}

/// The rotation whose y axis is `up` and whose z axis is `forward` as far as that goes.
fn frame(up: Vec3, forward: Vec3) -> Quat {
    let y = up.normalize();
    let z = (forward - y * forward.dot(y)).try_normalize().unwrap_or_else(|| y.any_orthonormal_vector());
    Quat::from_mat3(&Mat3::from_cols(y.cross(z), y, z))
}
