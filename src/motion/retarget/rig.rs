//! How a rig's joint frames turn into canonical ones: bones that point the same way in space.
//!
//! Both rest poses have identity rotations, but the bones point elsewhere: CMU's rigs rest with their legs spread by
//! 20 degrees, the 3ds Max one with its arms down. So every joint gets a constant turn `rig_from_canonical` in its
//! own frame, which carries the canonical bone's rest direction onto the rig's. Global rotations follow as
//! `canonical = rig * rig_from_canonical`.

use glam::{Mat3, Quat, Vec3};

use super::names::match_family;
use crate::motion::skeleton::joint::*;
use crate::motion::{Clip, JOINT_COUNT, JointId, canonical};
use crate::{Error, Result};

/// A rig made ready: which joints to read and how to turn them.
pub(super) struct Rig {
    pub joints: [Option<JointId>; JOINT_COUNT],
    pub rig_from_canonical: [Quat; JOINT_COUNT],
    /// Length of thigh and shin together, mean of both legs, in the clip's unit.
    pub leg: f32,
}

/// The joint at the far end of the bone whose direction is matched, for limbs.
const LIMB_CHILD: [(usize, usize); 8] = [
    (LEFT_UP_LEG, LEFT_LEG),
    (LEFT_LEG, LEFT_FOOT),
    (RIGHT_UP_LEG, RIGHT_LEG),
    (RIGHT_LEG, RIGHT_FOOT),
    (LEFT_ARM, LEFT_FORE_ARM),
    (LEFT_FORE_ARM, LEFT_HAND),
    (RIGHT_ARM, RIGHT_FORE_ARM),
    (RIGHT_FORE_ARM, RIGHT_HAND),
];

/// Shin, foot and toe of each leg.
const FEET: [[usize; 3]; 2] = [[LEFT_LEG, LEFT_FOOT, LEFT_TOE], [RIGHT_LEG, RIGHT_FOOT, RIGHT_TOE]];

impl Rig {
    /// # Errors
    /// The rig is of no known family, or has a leg without length.
    pub fn new(clip: &Clip) -> Result<Self> {
        let joints = match_family(clip)?;
        let rest = rest_positions(clip);
        let at = |j: usize| joints[j].map(|source| rest[source]).unwrap_or(Vec3::NAN);
        let bone = |a: usize, b: usize| (at(b) - at(a)).length();
        let leg = [[LEFT_UP_LEG, LEFT_LEG, LEFT_FOOT], [RIGHT_UP_LEG, RIGHT_LEG, RIGHT_FOOT]]
            .map(|[hip, knee, ankle]| bone(hip, knee) + bone(knee, ankle));
        let leg = 0.5 * (leg[0] + leg[1]);
        if !(leg > 0.0 && leg.is_finite()) {
            let problem = format!("expected legs with a length, found {leg}");
            return Err(Error::invalid(clip.name.clone(), "skeleton", problem));
        }
        let mut turns = [Quat::IDENTITY; JOINT_COUNT];
        for (joint, child) in LIMB_CHILD {
            turns[joint] = between(canonical().joints[child].offset, at(child) - at(joint));
        }
        for hand in [LEFT_HAND, RIGHT_HAND] {
            let tip = canonical().joints[hand].tip.expect("hands have tips");
            turns[hand] = between(tip, joints[hand].map_or(Vec3::ZERO, |source| bone_direction(clip, source)));
        }
        for [shin, foot, toe] in FEET {
            let forward = joints[foot].map_or(Vec3::ZERO, |source| bone_direction(clip, source));
            turns[foot] = foot_turn(at(foot) - at(shin), forward);
            turns[toe] = turns[foot];
        }
        Ok(Self { joints, rig_from_canonical: turns, leg })
    }
}

fn rest_positions(clip: &Clip) -> Vec<Vec3> {
    let mut globals = Vec::new();
    clip.skeleton.globals(Vec3::ZERO, &vec![Quat::IDENTITY; clip.skeleton.joints.len()], &mut globals);
    globals.into_iter().map(|g| g.0).collect()
}

/// Rest direction of a joint's bone: to its farthest descendant among children and children of zero-length children
/// (a hand's longest finger), or its tip.
fn bone_direction(clip: &Clip, joint: JointId) -> Vec3 {
    let joints = &clip.skeleton.joints;
    let mut best = joints[joint].tip.unwrap_or(Vec3::ZERO);
    let mut reach = vec![None; joints.len()];
    reach[joint] = Some(Vec3::ZERO);
    for (j, this) in joints.iter().enumerate().skip(joint + 1) {
        let Some(at) = this.parent.and_then(|p| reach[p]).filter(|at: &Vec3| *at == Vec3::ZERO) else { continue };
        reach[j] = Some(at + this.offset);
        if this.offset.length() > best.length() {
            best = this.offset;
        }
    }
    best
}

/// The foot's turn: sole on the ground wherever the rig's foot stands flat in its rest pose. The rig's foot is taken
/// to be rolled sideways together with its shin (spread legs), but not pitched with it (a shin that leans back).
fn foot_turn(shin: Vec3, foot: Vec3) -> Quat {
    let up = Vec3::new(-shin.x, -shin.y, 0.0).try_normalize().unwrap_or(Vec3::Y);
    let Some(forward) = foot.reject_from(up).try_normalize() else { return Quat::IDENTITY };
    Quat::from_mat3(&Mat3::from_cols(up.cross(forward), up, forward)).normalize()
}

fn between(from: Vec3, to: Vec3) -> Quat {
    match (from.try_normalize(), to.try_normalize()) {
        (Some(a), Some(b)) => Quat::from_rotation_arc(a, b),
        _ => Quat::IDENTITY,
    }
}
