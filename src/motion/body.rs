//! The body as capsules, for collision: one list for the planner and for whoever wants to draw it.

use glam::{Quat, Vec3};

use super::skeleton::joint::*;
use crate::geom::Capsule;

/// Parts of a body that touch other bodies and props.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BodyPart {
    /// Left palm.
    LeftHand,
    /// Right palm.
    RightHand,
    /// Chest and back.
    Torso,
    /// Head.
    Head,
}

/// One capsule of the body: its axis runs between two points fixed to joints.
#[derive(Clone, Copy, Debug)]
pub struct BodyCapsule {
    /// Joint and offset in its frame of one end.
    pub a: (usize, Vec3),
    /// Joint and offset in its frame of the other end.
    pub b: (usize, Vec3),
    /// Radius in metres.
    pub radius: f32,
}

const fn bone(a: usize, b: usize, radius: f32) -> BodyCapsule {
    BodyCapsule { a: (a, Vec3::ZERO), b: (b, Vec3::ZERO), radius }
}

const fn tip(a: usize, offset: [f32; 3], radius: f32) -> BodyCapsule {
    BodyCapsule { a: (a, Vec3::ZERO), b: (a, Vec3::from_array(offset)), radius }
}

/// The capsules of the canonical body.
pub const BODY_CAPSULES: [BodyCapsule; 16] = [
    bone(HIPS, SPINE1, 0.13),
    bone(SPINE1, SPINE2, 0.13),
    bone(LEFT_ARM, RIGHT_ARM, 0.08),
    tip(HEAD, [0.0, 0.11, 0.01], 0.095),
    bone(LEFT_UP_LEG, LEFT_LEG, 0.075),
    bone(RIGHT_UP_LEG, RIGHT_LEG, 0.075),
    bone(LEFT_LEG, LEFT_FOOT, 0.055),
    bone(RIGHT_LEG, RIGHT_FOOT, 0.055),
    bone(LEFT_FOOT, LEFT_TOE, 0.045),
    bone(RIGHT_FOOT, RIGHT_TOE, 0.045),
    bone(LEFT_ARM, LEFT_FORE_ARM, 0.05),
    bone(RIGHT_ARM, RIGHT_FORE_ARM, 0.05),
    bone(LEFT_FORE_ARM, LEFT_HAND, 0.042),
    bone(RIGHT_FORE_ARM, RIGHT_HAND, 0.042),
    tip(LEFT_HAND, [0.10, 0.0, 0.0], 0.035),
    tip(RIGHT_HAND, [-0.10, 0.0, 0.0], 0.035),
];

/// The capsules of a body whose joints' global transforms are given, in the order of [`BODY_CAPSULES`].
#[inline]
pub fn shape(globals: &[(Vec3, Quat)]) -> [Capsule; BODY_CAPSULES.len()] {
    // Most ends are joints: there is nothing to turn.
    let at = |(joint, offset): (usize, Vec3)| match offset {
        Vec3::ZERO => globals[joint].0,
        offset => globals[joint].0 + globals[joint].1 * offset,
    };
    BODY_CAPSULES.map(|c| Capsule { a: at(c.a), b: at(c.b), radius: c.radius })
}

/// The same, appended to `out`.
pub fn body_capsules(globals: &[(Vec3, Quat)], out: &mut Vec<Capsule>) {
    out.extend(shape(globals));
}
