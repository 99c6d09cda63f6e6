//! How a rig's joint frames turn into canonical ones: bones that point the same way in space.
//!
//! All rest poses have identity rotations, but the bones point elsewhere: CMU's rigs rest with their legs spread by
//! 20 degrees, Unreal's with its arms half down, some face another way. So every joint gets a constant turn
//! `rig_from_canonical` in its own frame: the turn of the whole rig at rest, and for limbs the shortest turn on top of
//! it that carries the canonical bone's rest direction onto the rig's. Global rotations follow as
//! `canonical = rig * rig_from_canonical`.

use glam::{Mat3, Quat, Vec3};

use super::names::{RigMatch, match_rig};
use super::rest::RestRig;
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

/// A rig at rest whose facing is within this of the axes is taken to face along them, radians: hips tilt, heads lean.
const ALONG_AXES: f32 = 30.0 / 180.0 * std::f32::consts::PI;

impl Rig {
    /// # Errors
    /// The rig is none of a person that can be told, or has a leg without length.
    pub fn new(clip: &Clip) -> Result<Self> {
        let rest = RestRig::of(&clip.skeleton);
        let named = |e: Error| match e {
            Error::Invalid { place, problem, .. } => Error::invalid(clip.name.clone(), place, problem),
            other => other,
        };
        let found = match_rig(&rest).map_err(named)?;
        let joints = found.joints;
        let bone = |a: usize, b: usize| joints[a].zip(joints[b]).map_or(f32::NAN, |(a, b)| rest.length(a, b));
        let leg = [[LEFT_UP_LEG, LEFT_LEG, LEFT_FOOT], [RIGHT_UP_LEG, RIGHT_LEG, RIGHT_FOOT]]
            .map(|[hip, knee, ankle]| bone(hip, knee) + bone(knee, ankle));
        let leg = 0.5 * (leg[0] + leg[1]);
        if !(leg > 0.0 && leg.is_finite()) {
            let problem = format!("expected legs with a length, found {leg}");
            return Err(Error::invalid(clip.name.clone(), "skeleton", problem));
        }
        Ok(Self { joints, rig_from_canonical: rest_turns(&rest, &found), leg })
    }
}

/// For every canonical joint the turn `rig_from_canonical`: where the rig's joint has turned by `r` from the rest pose
/// (in the space of the whole rig), the canonical joint's global rotation is `r * rig_from_canonical`; the other way
/// round, a canonical global rotation `c` turns the rig's joint by `c * rig_from_canonical.inverse()` from its rest.
pub fn rest_turns(rest: &RestRig, found: &RigMatch) -> [Quat; JOINT_COUNT] {
    let joints = &found.joints;
    let whole = whole_turn(rest, joints);
    let at = |j: usize| joints[j].map(|source| rest.places[source]).unwrap_or(Vec3::NAN);
    let mut turns = [whole; JOINT_COUNT];
    for (joint, child) in LIMB_CHILD {
        turns[joint] = between(whole * canonical().joints[child].offset, at(child) - at(joint)) * whole;
    }
    for hand in [LEFT_HAND, RIGHT_HAND] {
        let tip = canonical().joints[hand].tip.expect("hands have tips");
        turns[hand] = between(whole * tip, joints[hand].map_or(Vec3::ZERO, |source| rest.bone(source))) * whole;
    }
    let back = whole.inverse();
    for [shin, foot, toe] in FEET {
        let forward = joints[foot].map_or(Vec3::ZERO, |source| rest.bone(source));
        let ahead = joints[toe].map_or(forward, |_| at(toe) - at(foot));
        turns[foot] = whole * foot_turn(back * (at(foot) - at(shin)), back * ahead);
        turns[toe] = turns[foot];
    }
    turns
}

/// How the whole rig stands at rest: from its hip joints and the way from hips to head, along the axes if near them.
fn whole_turn(rest: &RestRig, joints: &[Option<JointId>; JOINT_COUNT]) -> Quat {
    let at = |j: usize| joints[j].map_or(Vec3::NAN, |source| rest.places[source]);
    let left = (at(LEFT_UP_LEG) - at(RIGHT_UP_LEG)).try_normalize();
    let up = (at(HEAD) - 0.5 * (at(LEFT_UP_LEG) + at(RIGHT_UP_LEG))).try_normalize();
    let (Some(left), Some(up)) = (left, up) else { return Quat::IDENTITY };
    let Some(up) = up.reject_from_normalized(left).try_normalize() else { return Quat::IDENTITY };
    let turn = Quat::from_mat3(&Mat3::from_cols(left, up, left.cross(up)));
    let (x, y) = (axis(left), axis(up));
    let along = Quat::from_mat3(&Mat3::from_cols(x, y, x.cross(y)));
    if x.dot(y) == 0.0 && turn.angle_between(along) < ALONG_AXES { along.normalize() } else { turn.normalize() }
}

/// The axis nearest to a direction.
fn axis(direction: Vec3) -> Vec3 {
    let size = direction.abs();
    let nearest = if size.x >= size.y && size.x >= size.z {
        Vec3::X
    } else if size.y >= size.z {
        Vec3::Y
    } else {
        Vec3::Z
    };
    nearest * direction.dot(nearest).signum()
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
