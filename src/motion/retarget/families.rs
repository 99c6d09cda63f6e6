//! Names of joints in the rigs that people have, a table per family.

use crate::motion::JOINT_COUNT;
use crate::motion::skeleton::joint::*;

/// A family of rigs: what it calls the canonical joints; `-` where it has none. `%` stands for the side.
pub(super) struct Family {
    pub name: &'static str,
    /// What stands for `%` on the left and on the right.
    sides: [&'static str; 2],
    /// Hips, three joints of the spine, neck, head.
    trunk: &'static str,
    /// Thigh, shin, foot, toe.
    leg: &'static str,
    /// Shoulder (collar bone), upper arm, forearm, hand.
    arm: &'static str,
}

impl Family {
    /// The family's name for every canonical joint; `None` where it has none.
    pub fn joints(&self) -> [Option<String>; JOINT_COUNT] {
        let mut out: [Option<String>; JOINT_COUNT] = std::array::from_fn(|_| None);
        let mut fill = |slots: &[usize], names: &str, side: &str| {
            for (&slot, name) in slots.iter().zip(names.split_whitespace()).filter(|(_, name)| *name != "-") {
                out[slot] = Some(name.replace('%', side).replace('~', " "));
            }
        };
        fill(&[HIPS, SPINE, SPINE1, SPINE2, NECK, HEAD], self.trunk, "");
        for (side, leg, arm) in
            [(self.sides[0], LEFT_UP_LEG, LEFT_SHOULDER), (self.sides[1], RIGHT_UP_LEG, RIGHT_SHOULDER)]
        {
            fill(&[leg, leg + 1, leg + 2, leg + 3], self.leg, side);
            fill(&[arm, arm + 1, arm + 2, arm + 3], self.arm, side);
        }
        out
    }
}

const fn family(
    name: &'static str,
    sides: [&'static str; 2],
    trunk: &'static str,
    leg: &'static str,
    arm: &'static str,
) -> Family {
    Family { name, sides, trunk, leg, arm }
}

const FULL: [&str; 2] = ["Left", "Right"];
const SHORT: [&str; 2] = ["L", "R"];
const SMALL: [&str; 2] = ["l", "r"];
const SNAKE: [&str; 2] = ["left", "right"];

/// The families. A rig belongs to the one of which it has most joints, the first of equals; a space in a name is
/// written `~`. Where a family has more than three spine joints, those are named whose bones cover the middle of the
/// canonical ones.
pub(super) const FAMILIES: [Family; 25] = [
    family(
        "canonical",
        SNAKE,
        "hips spine spine1 spine2 neck head",
        "%_up_leg %_leg %_foot %_toe",
        "%_shoulder %_arm %_fore_arm %_hand",
    ),
    // Four joints in the spine: Xsens MVN's FBX.
    family(
        "xsens-fbx",
        FULL,
        "Hips Spine Spine1 Spine3 Neck Head",
        "%UpLeg %Leg %Foot %ToeBase",
        "%Shoulder %Arm %ForeArm %Hand",
    ),
    // Also LAFAN, Ready Player Me, MotionBuilder's characters, Vicon Shogun, OptiTrack's FBX of that template.
    family(
        "mixamo",
        FULL,
        "Hips Spine Spine1 Spine2 Neck Head",
        "%UpLeg %Leg %Foot %ToeBase",
        "%Shoulder %Arm %ForeArm %Hand",
    ),
    // CMU by cgspeed for MotionBuilder. `LowerBack` stands at the hips and carries the first bone of the spine.
    family(
        "cmu-mb",
        FULL,
        "Hips LowerBack Spine Spine1 Neck Head",
        "%UpLeg %Leg %Foot %ToeBase",
        "%Shoulder %Arm %ForeArm %Hand",
    ),
    // The same for 3ds Max.
    family(
        "cmu-max",
        FULL,
        "Hips lowerback Chest Chest2 lowerneck Head",
        "%Hip %Knee %Ankle %Toe",
        "%Collar %Shoulder %Elbow %Wrist",
    ),
    // The same for Daz: its first spine joint lies as high as the canonical second one, and it has no toes.
    family(
        "cmu-daz",
        SMALL,
        "hip hip abdomen chest neck head",
        "%Thigh %Shin %Foot -",
        "%Collar %Shldr %ForeArm %Hand",
    ),
    // CMU's own ASF/AMC: bones carry the names of bones and begin where their parents end.
    family(
        "cmu-asf",
        SMALL,
        "root lowerback upperback thorax lowerneck head",
        "%femur %tibia %foot %toes",
        "%clavicle %humerus %radius %wrist",
    ),
    // Rokoko Studio's own naming (BVH and FBX with the "Newton" skeleton).
    family(
        "rokoko",
        FULL,
        "Hips Spine Spine2 Spine4 Neck Head",
        "%Thigh %Shin %Foot %Toe",
        "%Shoulder %Arm %ForeArm %Hand",
    ),
    // Xsens MVN: the segments as the MVN streams name them, then BVH.
    family(
        "xsens-mvn",
        FULL,
        "Pelvis L5 L3 T8 Neck Head",
        "%UpperLeg %LowerLeg %Foot %Toe",
        "%Shoulder %UpperArm %ForeArm %Hand",
    ),
    family(
        "xsens-bvh",
        FULL,
        "Hips Chest Chest2 Chest4 Neck Head",
        "%Hip %Knee %Ankle %Toe",
        "%Collar %Shoulder %Elbow %Wrist",
    ),
    // Vicon Plug-in Gait's segments.
    family("plug-in-gait", SHORT, "PEL TRX - - - HED", "%FE %TI %FO %TO", "%CL %HU %RA %HN"),
    family(
        "unreal5",
        SMALL,
        "pelvis spine_03 spine_04 spine_05 neck_01 head",
        "thigh_% calf_% foot_% ball_%",
        "clavicle_% upperarm_% lowerarm_% hand_%",
    ),
    family(
        "unreal",
        SMALL,
        "pelvis spine_01 spine_02 spine_03 neck_01 head",
        "thigh_% calf_% foot_% ball_%",
        "clavicle_% upperarm_% lowerarm_% hand_%",
    ),
    family(
        "unity",
        FULL,
        "Hips Spine Chest UpperChest Neck Head",
        "%UpperLeg %LowerLeg %Foot %Toes",
        "%Shoulder %UpperArm %LowerArm %Hand",
    ),
    family(
        "vrm",
        SNAKE,
        "hips spine chest upperChest neck head",
        "%UpperLeg %LowerLeg %Foot %Toes",
        "%Shoulder %UpperArm %LowerArm %Hand",
    ),
    family(
        "vroid",
        SHORT,
        "J_Bip_C_Hips J_Bip_C_Spine J_Bip_C_Chest J_Bip_C_UpperChest J_Bip_C_Neck J_Bip_C_Head",
        "J_Bip_%_UpperLeg J_Bip_%_LowerLeg J_Bip_%_Foot J_Bip_%_ToeBase",
        "J_Bip_%_Shoulder J_Bip_%_UpperArm J_Bip_%_LowerArm J_Bip_%_Hand",
    ),
    // SMPL, SMPL-H, SMPL-X: `left_foot` is the ball, `left_shoulder` the upper arm.
    family(
        "smpl",
        SNAKE,
        "pelvis spine1 spine2 spine3 neck head",
        "%_hip %_knee %_ankle %_foot",
        "%_collar %_shoulder %_elbow %_wrist",
    ),
    // The FBX of the same body, and of AMASS's add-ons.
    family(
        "smpl-fbx",
        SHORT,
        "Pelvis Spine1 Spine2 Spine3 Neck Head",
        "%_Hip %_Knee %_Ankle %_Foot",
        "%_Collar %_Shoulder %_Elbow %_Wrist",
    ),
    // Rigify: what deforms, then the metarig.
    family(
        "rigify-deform",
        SHORT,
        "DEF-spine DEF-spine.001 DEF-spine.002 DEF-spine.003 DEF-spine.004 DEF-spine.006",
        "DEF-thigh.% DEF-shin.% DEF-foot.% DEF-toe.%",
        "DEF-shoulder.% DEF-upper_arm.% DEF-forearm.% DEF-hand.%",
    ),
    family(
        "rigify",
        SHORT,
        "spine spine.001 spine.002 spine.003 spine.004 spine.006",
        "thigh.% shin.% foot.% toe.%",
        "shoulder.% upper_arm.% forearm.% hand.%",
    ),
    // 3ds Max Biped; `Bip01`, `Bip001` and the like are told from the other joints.
    family(
        "biped",
        SHORT,
        "Pelvis Spine Spine1 Spine2 Neck Head",
        "%~Thigh %~Calf %~Foot %~Toe0",
        "%~Clavicle %~UpperArm %~Forearm %~Hand",
    ),
    family(
        "biped-fbx",
        SHORT,
        "Pelvis Spine Spine1 Spine2 Neck Head",
        "%_Thigh %_Calf %_Foot %_Toe0",
        "%_Clavicle %_UpperArm %_Forearm %_Hand",
    ),
    family(
        "daz-genesis8",
        SMALL,
        "hip abdomenLower abdomenUpper chestUpper neckLower head",
        "%ThighBend %Shin %Foot %Toe",
        "%Collar %ShldrBend %ForearmBend %Hand",
    ),
    family(
        "daz-genesis9",
        SMALL,
        "hip spine1 spine2 spine4 neck1 head",
        "%_thigh %_shin %_foot %_toes",
        "%_shoulder %_upperarm %_forearm %_hand",
    ),
    family(
        "character-creator",
        SHORT,
        "CC_Base_Hip CC_Base_Waist CC_Base_Spine01 CC_Base_Spine02 CC_Base_NeckTwist01 CC_Base_Head",
        "CC_Base_%_Thigh CC_Base_%_Calf CC_Base_%_Foot CC_Base_%_ToeBase",
        "CC_Base_%_Clavicle CC_Base_%_Upperarm CC_Base_%_Forearm CC_Base_%_Hand",
    ),
];
