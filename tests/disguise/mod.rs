//! Our mannequin, disguised as a character from elsewhere.
#![allow(dead_code)]

pub mod dressed;

use crowdquilt::export::{Avatar, glb};
use crowdquilt::motion::{Build, JOINT_COUNT, canonical, joint};
use crowdquilt::stage::Crowd;
use glam::{Affine3A, Mat4, Quat, Vec3};
use serde_json::{Value, json};

use crate::fixture;
use crate::glb_file::{self, Glb};

/// What Mixamo calls the canonical joints.
pub const MIXAMO: [&str; JOINT_COUNT] = [
    "Hips",
    "LeftUpLeg",
    "LeftLeg",
    "LeftFoot",
    "LeftToeBase",
    "RightUpLeg",
    "RightLeg",
    "RightFoot",
    "RightToeBase",
    "Spine",
    "Spine1",
    "Spine2",
    "Neck",
    "Head",
    "LeftShoulder",
    "LeftArm",
    "LeftForeArm",
    "LeftHand",
    "RightShoulder",
    "RightArm",
    "RightForeArm",
    "RightHand",
];

/// How the mannequin is disguised: its size in its own unit, the angle by which its arms hang at rest, and how much
/// its joints' own frames are twisted.
pub struct Disguise {
    pub size: f32,
    pub arms: f32,
    pub twist: f32,
    /// Scale and turn of a node above the hips.
    pub armature: (f32, Quat),
}

/// A character in centimetres, arms half down, its joints turned anyhow.
pub const CENTIMETRES: Disguise = Disguise { size: 120.0, arms: 0.8, twist: 1.0, armature: (0.01, Quat::IDENTITY) };

fn one(crowd: &Crowd) -> Crowd {
    let mut one = crowd.clone();
    one.characters.truncate(1);
    one
}

/// The mannequin as the file of a character with Mixamo's names.
pub fn character(disguise: &Disguise) -> (Value, Vec<u8>) {
    let mut crowd = one(&fixture::crowd());
    crowd.characters[0].build = Build::canonical();
    let Glb { mut json, mut binary } = Glb::open(&glb(&crowd));
    let (scale, turn) = disguise.armature;
    let mut locals = [Quat::IDENTITY; JOINT_COUNT];
    locals[joint::LEFT_ARM] = Quat::from_rotation_z(-disguise.arms);
    locals[joint::RIGHT_ARM] = Quat::from_rotation_z(disguise.arms);
    let (mut posed, mut plain) = (Vec::new(), Vec::new());
    canonical().globals(canonical().joints[0].offset, &locals, &mut posed);
    canonical().globals(canonical().joints[0].offset, &[Quat::IDENTITY; JOINT_COUNT], &mut plain);
    let twist =
        |j: usize| Quat::from_rotation_x(disguise.twist * j as f32) * Quat::from_rotation_y(1.7 * disguise.twist);
    // The disguised joints in the space below the armature.
    let armature = Affine3A::from_scale_rotation_translation(Vec3::splat(scale), turn, Vec3::ZERO);
    let below = |j: usize| {
        let place = armature.inverse().transform_point3(posed[j].0 * disguise.size * scale);
        (place, turn.inverse() * posed[j].1 * twist(j))
    };
    let first = json["skins"][0]["joints"][0].as_u64().unwrap() as usize;
    let mut binds: Vec<f32> = Vec::new();
    for (j, joint) in canonical().joints.iter().enumerate() {
        let (place, rotation) = below(j);
        let (parent, parent_turn) = joint.parent.map_or((Vec3::ZERO, Quat::IDENTITY), below);
        let node = &mut json["nodes"][first + j];
        node["name"] = format!("mixamorig:{}", MIXAMO[j]).into();
        node["translation"] = json!((parent_turn.inverse() * (place - parent)).to_array());
        node["rotation"] = json!((parent_turn.inverse() * rotation).normalize().to_array());
        let own = Mat4::from_scale(Vec3::splat(disguise.size)) * Mat4::from_translation(-plain[j].0);
        binds.extend((Mat4::from_quat(twist(j).inverse()) * own).to_cols_array());
    }
    let top = json["nodes"].as_array().unwrap().iter().position(|n| n["name"] == "person_0").unwrap();
    json["nodes"][top] = json!({
        "name": "Armature", "children": [first], "scale": [scale, scale, scale], "rotation": turn.to_array(),
    });
    let accessor = json["skins"][0]["inverseBindMatrices"].as_u64().unwrap() as usize;
    let view = json["accessors"][accessor]["bufferView"].as_u64().unwrap() as usize;
    let at = json["bufferViews"][view]["byteOffset"].as_u64().unwrap() as usize;
    let bytes: Vec<u8> = binds.iter().flat_map(|v| v.to_le_bytes()).collect();
    binary[at..at + bytes.len()].copy_from_slice(&bytes);
    json.as_object_mut().unwrap().remove("animations");
    (json, binary)
}

/// The character, read.
pub fn avatar(disguise: &Disguise) -> Avatar {
    let (json, binary) = character(disguise);
    Avatar::open(&glb_file::write(&json, &binary)).unwrap()
}
