//! Rigs told from names and hierarchy: every family, with the clutter that exporters add, and rigs of no family.

use glam::{Quat, Vec3};

use super::families::FAMILIES;
use super::rigfile::RigFile;
use super::{RestRig, match_rig, rest_turns};
use crate::motion::skeleton::joint::*;
use crate::motion::{JOINT_COUNT, Joint, JointId, Skeleton, canonical};

/// The canonical skeleton with its joints renamed; those without a name are left out and their children hang higher.
fn renamed(names: &[Option<String>; JOINT_COUNT]) -> RestRig {
    let full = RestRig::of(canonical());
    let mut index: [Option<JointId>; JOINT_COUNT] = [None; JOINT_COUNT];
    let (mut out_names, mut parents, mut places): (Vec<String>, Vec<Option<usize>>, Vec<Vec3>) = Default::default();
    for j in 0..JOINT_COUNT {
        let Some(name) = &names[j] else { continue };
        if let Some(same) = out_names.iter().position(|n| n == name) {
            index[j] = Some(same);
            continue;
        }
        index[j] = Some(out_names.len());
        parents.push(full.up_from(j).skip(1).find_map(|p| index[p]));
        out_names.push(name.clone());
        places.push(full.places[j]);
    }
    RestRig::new(out_names, parents, places).unwrap()
}

fn rig_of(rows: &[(&str, Option<usize>, [f32; 3])]) -> RestRig {
    let names = rows.iter().map(|r| r.0.to_owned()).collect();
    RestRig::new(names, rows.iter().map(|r| r.1).collect(), rows.iter().map(|r| Vec3::from(r.2)).collect()).unwrap()
}

fn played<'a>(rig: &'a RestRig, slots: &[usize]) -> Vec<&'a str> {
    let found = match_rig(rig).unwrap();
    slots.iter().map(|&s| found.joints[s].map_or("-", |j| rig.names[j].as_str())).collect()
}

#[test]
fn every_family_is_known_by_its_names() {
    for family in &FAMILIES {
        let names = family.joints();
        let found = match_rig(&renamed(&names)).unwrap();
        let rig = renamed(&names);
        assert_eq!(found.family, family.name);
        for (slot, name) in names.iter().enumerate() {
            assert_eq!(found.joints[slot].map(|j| &rig.names[j]), name.as_ref(), "{} {slot}", family.name);
        }
    }
}

#[test]
fn clutter_around_names_does_not_matter() {
    type Clutter = fn(usize, &str) -> String;
    let clutters: [Clutter; 5] = [
        |_, n| format!("mixamorig:{n}"),
        |_, n| format!("Armature|{n}"),
        |_, n| format!("Character1_{n}"),
        |i, n| format!("{n}_{:02}", i + 40),
        |_, n| format!("Bip001 {n}"),
    ];
    for family in FAMILIES.iter().filter(|f| f.name != "canonical") {
        for clutter in clutters {
            let mut rig = renamed(&family.joints());
            let plain = match_rig(&rig).unwrap();
            for (i, name) in rig.names.iter_mut().enumerate() {
                *name = clutter(i, name);
            }
            assert_eq!(match_rig(&rig).unwrap().joints, plain.joints, "{}: {:?}", family.name, rig.names);
        }
    }
}

/// Words in an order and with a side that no family has: told by the guess, which finds the same joints.
#[test]
fn rigs_of_no_family_are_guessed() {
    let styles: [[&str; 22]; 4] = [
        [
            "Root_M",
            "Hip_L",
            "Knee_L",
            "Ankle_L",
            "Toes_L",
            "Hip_R",
            "Knee_R",
            "Ankle_R",
            "Toes_R",
            "Spine1_M",
            "Spine2_M",
            "Chest_M",
            "Neck_M",
            "Head_M",
            "Scapula_L",
            "Shoulder_L",
            "Elbow_L",
            "Wrist_L",
            "Scapula_R",
            "Shoulder_R",
            "Elbow_R",
            "Wrist_R",
        ],
        [
            "body",
            "jnt_l_thigh",
            "jnt_l_calf",
            "jnt_l_foot",
            "jnt_l_ball",
            "jnt_r_thigh",
            "jnt_r_calf",
            "jnt_r_foot",
            "jnt_r_ball",
            "belly",
            "ribs",
            "breast",
            "jnt_neck",
            "jnt_head",
            "jnt_l_clav",
            "jnt_l_uparm",
            "jnt_l_lowarm",
            "jnt_l_wrist",
            "jnt_r_clav",
            "jnt_r_uparm",
            "jnt_r_lowarm",
            "jnt_r_wrist",
        ],
        [
            "HIPS",
            "LEFTTHIGH",
            "LEFTSHIN",
            "LEFTANKLE",
            "LEFTTOE",
            "RIGHTTHIGH",
            "RIGHTSHIN",
            "RIGHTANKLE",
            "RIGHTTOE",
            "SPINE",
            "SPINE1",
            "CHEST",
            "NECK",
            "HEAD",
            "LEFTCOLLAR",
            "LEFTUPPERARM",
            "LEFTFOREARM",
            "LEFTHAND",
            "RIGHTCOLLAR",
            "RIGHTUPPERARM",
            "RIGHTFOREARM",
            "RIGHTHAND",
        ],
        // Knees and elbows without a meaning: told by where they are.
        [
            "a",
            "leg upper left",
            "b",
            "foot left",
            "toe left",
            "leg upper right",
            "d",
            "foot right",
            "toe right",
            "e",
            "f",
            "g",
            "neck",
            "head",
            "shoulder left",
            "arm left",
            "h",
            "hand left",
            "shoulder right",
            "arm right",
            "i",
            "hand right",
        ],
    ];
    for style in styles {
        let rig = renamed(&style.map(|n| Some(n.to_owned())));
        let found = match_rig(&rig).unwrap();
        assert_eq!(found.family, "guessed", "{style:?}");
        let expected: Vec<Option<usize>> = (0..JOINT_COUNT).map(Some).collect();
        assert_eq!(found.joints.as_slice(), expected.as_slice(), "{style:?}");
    }
}

#[test]
fn toes_shoulders_neck_and_spine_may_be_missing() {
    for family in &FAMILIES {
        let mut names = family.joints();
        for slot in [LEFT_TOE, RIGHT_TOE, LEFT_SHOULDER, RIGHT_SHOULDER, SPINE1, SPINE2, NECK] {
            names[slot] = None;
        }
        let found = match_rig(&renamed(&names)).unwrap_or_else(|e| panic!("{}: {e}", family.name));
        assert!(found.joints[LEFT_TOE].is_none() && found.joints[NECK].is_none());
        assert!([SPINE, SPINE1, SPINE2].iter().any(|&j| found.joints[j].is_some()), "{}", family.name);
    }
}

#[test]
fn what_is_missing_is_named() {
    for family in &FAMILIES {
        let mut names = family.joints();
        let (hand, foot) = (names[LEFT_HAND].take().unwrap(), names[RIGHT_FOOT].take().unwrap());
        let told = match_rig(&renamed(&names)).unwrap_err().to_string();
        assert!(told.contains("left_hand") && told.contains("right_foot"), "{}: {told}", family.name);
        if family.name != "xsens-fbx" && family.name != "cmu-mb" {
            let known = FAMILIES.iter().any(|f| told.contains(f.name));
            assert!(known && told.contains(&hand) && told.contains(&foot), "{}: {told}", family.name);
        }
    }
}

#[test]
fn names_that_the_hierarchy_denies_are_not_believed() {
    let mut rig = renamed(&FAMILIES[2].joints());
    let at = |rig: &RestRig, name: &str| rig.names.iter().position(|n| n == name).unwrap();
    let (thigh, shin) = (at(&rig, "LeftUpLeg"), at(&rig, "LeftLeg"));
    rig.names.swap(thigh, shin);
    let found = match_rig(&rig).unwrap();
    assert_eq!((found.family, found.joints[LEFT_UP_LEG]), ("guessed", Some(thigh)), "told by the hierarchy");
    let mut long = renamed(&FAMILIES[2].joints());
    let (shin, foot) = (at(&long, "LeftLeg"), at(&long, "LeftFoot"));
    long.places[foot] = long.places[shin] + Vec3::NEG_Y * 2.0;
    let told = match_rig(&long).unwrap_err().to_string();
    assert!(told.contains("the left leg is"), "{told}");
}

#[test]
fn rigs_with_more_joints_than_the_canonical() {
    // CMU's ASF: hip joints before the thighs, two necks, wrist and hand.
    let rig = rig_of(&[
        ("root", None, [0.0, 0.9, 0.0]),
        ("lhipjoint", Some(0), [0.0, 0.9, 0.0]),
        ("lfemur", Some(1), [0.09, 0.85, 0.0]),
        ("ltibia", Some(2), [0.2, 0.45, 0.0]),
        ("lfoot", Some(3), [0.3, 0.08, 0.0]),
        ("ltoes", Some(4), [0.3, 0.02, 0.12]),
        ("rhipjoint", Some(0), [0.0, 0.9, 0.0]),
        ("rfemur", Some(6), [-0.09, 0.85, 0.0]),
        ("rtibia", Some(7), [-0.2, 0.45, 0.0]),
        ("rfoot", Some(8), [-0.3, 0.08, 0.0]),
        ("rtoes", Some(9), [-0.3, 0.02, 0.12]),
        ("lowerback", Some(0), [0.0, 0.9, 0.0]),
        ("upperback", Some(11), [0.0, 1.02, 0.0]),
        ("thorax", Some(12), [0.0, 1.14, 0.0]),
        ("lowerneck", Some(13), [0.0, 1.26, 0.0]),
        ("upperneck", Some(14), [0.0, 1.35, 0.0]),
        ("head", Some(15), [0.0, 1.44, 0.0]),
        ("lclavicle", Some(13), [0.0, 1.26, 0.0]),
        ("lhumerus", Some(17), [0.18, 1.3, 0.0]),
        ("lradius", Some(18), [0.46, 1.3, 0.0]),
        ("lwrist", Some(19), [0.64, 1.3, 0.0]),
        ("lhand", Some(20), [0.7, 1.3, 0.0]),
        ("rclavicle", Some(13), [0.0, 1.26, 0.0]),
        ("rhumerus", Some(22), [-0.18, 1.3, 0.0]),
        ("rradius", Some(23), [-0.46, 1.3, 0.0]),
        ("rwrist", Some(24), [-0.64, 1.3, 0.0]),
        ("rhand", Some(25), [-0.7, 1.3, 0.0]),
    ]);
    let slots =
        [HIPS, LEFT_UP_LEG, LEFT_LEG, LEFT_TOE, SPINE, SPINE2, NECK, HEAD, RIGHT_SHOULDER, RIGHT_ARM, RIGHT_HAND];
    let expected = [
        "root",
        "lfemur",
        "ltibia",
        "ltoes",
        "lowerback",
        "thorax",
        "lowerneck",
        "head",
        "rclavicle",
        "rhumerus",
        "rwrist",
    ];
    assert_eq!(match_rig(&rig).unwrap().family, "cmu-asf");
    assert_eq!(played(&rig, &slots), expected);
    // The same by the guess: no family has these names.
    let mut guessed = rig.clone();
    guessed.names.iter_mut().for_each(|n| *n = n.replace("tibia", "shin").replace("root", "center"));
    let of = |name: &str| rig.names.iter().position(|n| n == name).unwrap();
    let found = match_rig(&guessed).unwrap();
    assert_eq!(found.family, "guessed");
    for (slot, name) in slots.into_iter().zip(expected) {
        assert_eq!(found.joints[slot], Some(of(name)), "{name}");
    }
}

#[test]
fn twist_bones_are_passed_over_and_long_spines_thinned() {
    let mut rows: Vec<(&str, Option<usize>, [f32; 3])> = vec![("Hub", None, [0.0, 0.93, 0.0])];
    for (name, y) in [("S1", 0.97), ("S2", 1.06), ("S3", 1.15), ("S4", 1.24), ("S5", 1.33)] {
        rows.push((name, Some(rows.len() - 1), [0.0, y, 0.0]));
    }
    rows.extend([("Neck", Some(5), [0.0, 1.45, 0.0]), ("Head", Some(6), [0.0, 1.55, 0.0])]);
    for (x, names) in [
        (1.0, ["L_Thigh", "L_ThighTwist", "L_Shin", "L_Foot", "L_UpperArm", "L_UpperArm_Twist", "L_Forearm", "L_Hand"]),
        (
            -1.0,
            ["R_Thigh", "R_ThighTwist", "R_Shin", "R_Foot", "R_UpperArm", "R_UpperArm_Twist", "R_Forearm", "R_Hand"],
        ),
    ] {
        let at = rows.len();
        for (i, (y, parent)) in [(0.9, 0), (0.7, at), (0.48, at + 1), (0.07, at + 2)].into_iter().enumerate() {
            rows.push((names[i], Some(parent), [0.09 * x, y, 0.0]));
        }
        for (i, (reach, parent)) in [(0.2, 5), (0.35, at + 4), (0.48, at + 5), (0.74, at + 6)].into_iter().enumerate() {
            rows.push((names[4 + i], Some(parent), [reach * x, 1.4, 0.0]));
        }
    }
    let rig = rig_of(&rows);
    let slots = [HIPS, SPINE, SPINE1, SPINE2, LEFT_UP_LEG, RIGHT_LEG, LEFT_ARM, RIGHT_FORE_ARM, LEFT_SHOULDER];
    assert_eq!(played(&rig, &slots), ["Hub", "S2", "S3", "S5", "L_Thigh", "R_Shin", "L_UpperArm", "R_Forearm", "-"]);
}

/// Wherever a rig faces at rest, and however it holds its arms there, canonical rotations turn its bones into the
/// canonical bones' directions.
#[test]
fn turns_carry_bones_onto_the_canonical_ones() {
    let names = FAMILIES[3].joints();
    for (facing, arms) in
        [(0.0, 0.0), (0.0, 0.8), (std::f32::consts::FRAC_PI_2, 0.0), (std::f32::consts::PI, 1.4), (0.9, 0.5)]
    {
        let mut rig = renamed(&names);
        let stand = Quat::from_rotation_y(facing);
        for side in [1.0, -1.0] {
            let arm = if side > 0.0 { LEFT_ARM } else { RIGHT_ARM };
            let lowered = Quat::from_rotation_z(-arms * side);
            let shoulder = rig.places[arm];
            for j in arm..arm + 3 {
                rig.places[j] = shoulder + lowered * (rig.places[j] - shoulder);
            }
        }
        rig.places.iter_mut().for_each(|p| *p = stand * *p);
        let found = match_rig(&rig).unwrap();
        let turns = rest_turns(&rig, &found);
        for (j, child) in [(LEFT_UP_LEG, LEFT_LEG), (LEFT_ARM, LEFT_FORE_ARM), (RIGHT_FORE_ARM, RIGHT_HAND)] {
            let bone = |a: usize, b: usize| (rig.places[b] - rig.places[a]).normalize();
            let want = turns[j].inverse() * bone(found.joints[j].unwrap(), found.joints[child].unwrap());
            let gap = want.angle_between(canonical().joints[child].offset);
            assert!(gap < 2e-3, "facing {facing}, arms {arms}: {gap}");
        }
        assert!(turns[SPINE1].angle_between(stand) < 3e-2, "facing {facing}: {}", turns[SPINE1]);
    }
}

#[test]
fn a_rig_file_says_which_joint_is_which() {
    let mut skeleton = canonical().clone();
    skeleton.joints.iter_mut().enumerate().for_each(|(i, j)| j.name = format!("bone{i}"));
    assert!(match_rig(&RestRig::of(&skeleton)).is_err());
    let lines: Vec<String> =
        canonical().joints.iter().enumerate().map(|(i, j)| format!("{} = \"bone{i}\"", j.name)).collect();
    RigFile::parse(&lines.join("\n")).unwrap().apply(&mut skeleton).unwrap();
    let found = match_rig(&RestRig::of(&skeleton)).unwrap();
    assert!((0..JOINT_COUNT).all(|j| found.joints[j] == Some(j)));
}

#[test]
fn a_rig_file_overrides_a_few_and_the_rest_is_found() {
    let mut skeleton = Skeleton { joints: canonical().joints.clone() };
    for (joint, name) in skeleton.joints.iter_mut().zip(FAMILIES[2].joints()) {
        joint.name = name.unwrap();
    }
    let extra = Joint { name: "Pelvis2".into(), parent: Some(0), offset: Vec3::ZERO, tip: None };
    skeleton.joints.push(extra);
    let file = "hips = 'Hips'\nspine = \"Spine\"\nspine1 = \"Spine\"\n";
    RigFile::parse(file).unwrap().apply(&mut skeleton).unwrap();
    assert_eq!(skeleton.joints[SPINE].name, "crowdquilt:spine+spine1");
    let found = match_rig(&RestRig::of(&skeleton)).unwrap();
    assert_eq!((found.joints[SPINE], found.joints[SPINE1]), (Some(SPINE), Some(SPINE)));
    assert_eq!(found.joints[LEFT_HAND], Some(LEFT_HAND));
}

#[test]
fn bad_rig_files_are_named() {
    let says = |text: &str, part: &str| {
        let told = match RigFile::parse(text) {
            Err(e) => e.to_string(),
            Ok(file) => file.apply(&mut canonical().clone()).unwrap_err().to_string(),
        };
        assert!(told.contains(part), "{text}: {told}");
    };
    says("hips = ", "line 1");
    says("hips = 'hips'\npelvis = 'hips'", "found 'pelvis'");
    says("hips = 3", "line 1");
    says("hips = 'Hip'", "found 'Hip'");
}

#[test]
fn bad_rigs_are_named() {
    let names = |n: usize| (0..n).map(|i| format!("j{i}")).collect::<Vec<_>>();
    let says = |parents: Vec<Option<usize>>, places: Vec<Vec3>, part: &str| {
        let told = RestRig::new(names(2), parents, places).unwrap_err().to_string();
        assert!(told.contains(part), "{told}");
    };
    says(vec![None], vec![Vec3::ZERO; 2], "expected 2 parents");
    says(vec![None, Some(2)], vec![Vec3::ZERO; 2], "expected a parent below 2");
    says(vec![Some(1), Some(0)], vec![Vec3::ZERO; 2], "circle");
    says(vec![None, None], vec![Vec3::ZERO, Vec3::NAN], "finite");
    assert!(match_rig(&RestRig::new(vec![], vec![], vec![]).unwrap()).is_err());
}
