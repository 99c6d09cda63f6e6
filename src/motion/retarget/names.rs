//! Which joints of a rig play the canonical joints: tables of names per family of rigs.

use crate::motion::{Clip, JOINT_COUNT, JointId};
use crate::{Error, Result};

/// A family of rigs: the joint for each canonical joint in canonical order; `-` where the family has none.
pub(super) struct Family {
    pub name: &'static str,
    joints: &'static str,
}

impl Family {
    pub fn joints(&self) -> impl Iterator<Item = &'static str> {
        self.joints.split_whitespace()
    }
}

/// The families, tried in this order; a rig belongs to the first whose names it all has.
pub(super) const FAMILIES: [Family; 5] = [
    Family {
        name: "canonical",
        joints: "hips left_up_leg left_leg left_foot left_toe right_up_leg right_leg right_foot right_toe
            spine spine1 spine2 neck head
            left_shoulder left_arm left_fore_arm left_hand right_shoulder right_arm right_fore_arm right_hand",
    },
    Family {
        name: "mixamo",
        joints: "Hips LeftUpLeg LeftLeg LeftFoot LeftToeBase RightUpLeg RightLeg RightFoot RightToeBase
            Spine Spine1 Spine2 Neck Head
            LeftShoulder LeftArm LeftForeArm LeftHand RightShoulder RightArm RightForeArm RightHand",
    },
    // CMU by cgspeed for MotionBuilder. `LowerBack` stands at the hips and carries the first bone of the spine.
    Family {
        name: "cmu-mb",
        joints: "Hips LeftUpLeg LeftLeg LeftFoot LeftToeBase RightUpLeg RightLeg RightFoot RightToeBase
            LowerBack Spine Spine1 Neck Head
            LeftShoulder LeftArm LeftForeArm LeftHand RightShoulder RightArm RightForeArm RightHand",
    },
    // The same for 3ds Max.
    Family {
        name: "cmu-max",
        joints: "Hips LeftHip LeftKnee LeftAnkle LeftToe RightHip RightKnee RightAnkle RightToe
            lowerback Chest Chest2 lowerneck Head
            LeftCollar LeftShoulder LeftElbow LeftWrist RightCollar RightShoulder RightElbow RightWrist",
    },
    // The same for Daz: its first spine joint lies as high as the canonical second one, and it has no toes.
    Family {
        name: "cmu-daz",
        joints: "hip lThigh lShin lFoot - rThigh rShin rFoot -
            hip abdomen chest neck head
            lCollar lShldr lForeArm lHand rCollar rShldr rForeArm rHand",
    },
];

/// The clip's joint for each canonical joint, by the first family that fits; `None` where the family has none.
///
/// # Errors
/// No family fits: names the nearest and the joints it misses.
pub(super) fn match_family(clip: &Clip) -> Result<[Option<JointId>; JOINT_COUNT]> {
    let mut nearest: Option<(&str, Vec<&str>)> = None;
    for family in &FAMILIES {
        let mut found = [None; JOINT_COUNT];
        let mut missing = Vec::new();
        for (slot, name) in found.iter_mut().zip(family.joints()).filter(|(_, name)| *name != "-") {
            *slot = find(clip, name);
            if slot.is_none() {
                missing.push(name);
            }
        }
        if missing.is_empty() {
            return Ok(found);
        }
        if nearest.as_ref().is_none_or(|(_, fewest)| missing.len() < fewest.len()) {
            nearest = Some((family.name, missing));
        }
    }
    let (name, missing) = nearest.expect("there are families");
    let problem = format!("expected a known rig; the nearest, {name}, misses the joints {}", missing.join(", "));
    Err(Error::invalid(clip.name.clone(), "skeleton", problem))
}

/// Index of the joint called `name`, any name space before a colon aside (`mixamorig:Hips`).
fn find(clip: &Clip, name: &str) -> Option<JointId> {
    clip.skeleton.joints.iter().position(|j| j.name.rsplit(':').next() == Some(name))
}
