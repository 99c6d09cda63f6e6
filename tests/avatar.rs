//! Somebody's own character plays the people of a crowd: our mannequin, disguised as a character from elsewhere.

mod fixture;
mod glb_file;

use crowdquilt::export::{Avatar, glb, glb_with};
use crowdquilt::motion::{Build, FPS, JOINT_COUNT, canonical, joint};
use crowdquilt::stage::{Character, Crowd};
use glam::{Affine3A, Mat4, Quat, Vec3};
use glb_file::Glb;
use serde_json::{Value, json};

const MIXAMO: [&str; JOINT_COUNT] = [
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
struct Disguise {
    size: f32,
    arms: f32,
    twist: f32,
    /// Scale and turn of a node above the hips.
    armature: (f32, Quat),
}

const CENTIMETRES: Disguise = Disguise { size: 120.0, arms: 0.8, twist: 1.0, armature: (0.01, Quat::IDENTITY) };

fn one(crowd: &Crowd) -> Crowd {
    let mut one = crowd.clone();
    one.characters.truncate(1);
    one
}

/// The mannequin as the file of a character with Mixamo's names.
fn character(disguise: &Disguise) -> (Value, Vec<u8>) {
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

fn avatar(disguise: &Disguise) -> Avatar {
    let (json, binary) = character(disguise);
    Avatar::open(&glb_file::write(&json, &binary)).unwrap()
}

/// Places of a person's joints in the exported file at a frame, by Mixamo's names.
fn joints(file: &Glb, person: usize, frame: u32) -> Vec<Vec3> {
    let nodes = file.json["nodes"].as_array().unwrap();
    let mut parent = vec![None; nodes.len()];
    for (n, node) in nodes.iter().enumerate() {
        node["children"].as_array().into_iter().flatten().for_each(|c| parent[c.as_u64().unwrap() as usize] = Some(n));
    }
    let local = |n: usize| {
        let name = nodes[n]["name"].as_str().unwrap();
        let key = |path: &str, width: usize| -> Option<Vec<f32>> {
            let (times, values, _) = file.channel(name, path)?;
            let after = times.partition_point(|&t| t < frame as f32 / FPS - 1e-4).min(times.len() - 1);
            Some(values[after * width..(after + 1) * width].to_vec())
        };
        let fixed = |path: &str| -> Option<Vec<f32>> {
            Some(nodes[n][path].as_array()?.iter().map(|v| v.as_f64().unwrap() as f32).collect())
        };
        let place = key("translation", 3).or_else(|| fixed("translation")).map_or(Vec3::ZERO, |v| Vec3::from_slice(&v));
        let turn = key("rotation", 4).or_else(|| fixed("rotation")).map_or(Quat::IDENTITY, |v| Quat::from_slice(&v));
        let scale = fixed("scale").map_or(Vec3::ONE, |v| Vec3::from_slice(&v));
        Affine3A::from_scale_rotation_translation(scale, turn.normalize(), place)
    };
    MIXAMO
        .iter()
        .map(|name| {
            let mut n = file.node(&format!("person_{person}_mixamorig:{name}"));
            let mut frame = local(n);
            while let Some(p) = parent[n] {
                frame = local(p) * frame;
                n = p;
            }
            frame.translation.into()
        })
        .collect()
}

fn person(character: &Character, frame: u32) -> Vec<Vec3> {
    let mut globals = Vec::new();
    character.globals((frame - character.begin) as usize, &mut globals);
    globals.into_iter().map(|g| g.0).collect()
}

/// Bones by their two joints.
const BONES: [[usize; 2]; 10] = [
    [joint::LEFT_UP_LEG, joint::LEFT_LEG],
    [joint::LEFT_LEG, joint::LEFT_FOOT],
    [joint::RIGHT_UP_LEG, joint::RIGHT_LEG],
    [joint::RIGHT_LEG, joint::RIGHT_FOOT],
    [joint::SPINE, joint::NECK],
    [joint::NECK, joint::HEAD],
    [joint::LEFT_ARM, joint::LEFT_FORE_ARM],
    [joint::LEFT_FORE_ARM, joint::LEFT_HAND],
    [joint::RIGHT_ARM, joint::RIGHT_FORE_ARM],
    [joint::RIGHT_FORE_ARM, joint::RIGHT_HAND],
];

fn crowd() -> Crowd {
    let mut crowd = fixture::crowd();
    crowd.characters[1].build = Build::catalogue()[1][0].clone();
    crowd
}

#[test]
fn bones_point_where_the_persons_do_and_feet_stand_where_theirs_do() {
    let crowd = crowd();
    let z_up = Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2);
    for disguise in [
        CENTIMETRES,
        Disguise { size: 0.6, arms: 0.0, twist: 0.0, armature: (1.0, Quat::IDENTITY) },
        Disguise { size: 1.3, arms: 1.3, twist: -0.7, armature: (1.0, z_up) },
    ] {
        let file = Glb::open(&glb_with(&crowd, &[avatar(&disguise)]));
        for (p, character) in crowd.characters.iter().enumerate() {
            for frame in [character.begin, character.begin + 40, character.end()] {
                let (is, wanted) = (joints(&file, p, frame), person(character, frame));
                for [a, b] in BONES {
                    let angle = (is[b] - is[a]).angle_between(wanted[b] - wanted[a]).to_degrees();
                    assert!(
                        angle < 2.0,
                        "size {}, person {p}, frame {frame}, bone {a}: {angle} degrees",
                        disguise.size
                    );
                }
                for foot in [joint::LEFT_FOOT, joint::RIGHT_FOOT] {
                    let off = is[foot].distance(wanted[foot]);
                    assert!(off < 0.01, "size {}, person {p}, frame {frame}, joint {foot}: {off} m", disguise.size);
                }
                if character.build == Build::canonical() {
                    let off = is.iter().zip(&wanted).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
                    assert!(off < 0.01, "size {}, person {p}, frame {frame}: {off} m", disguise.size);
                }
            }
        }
    }
}

#[test]
fn meshes_are_shared_and_characters_are_dealt_out() {
    let crowd = fixture::lattice(12, 30);
    let own = [avatar(&CENTIMETRES), avatar(&Disguise { size: 1.0, arms: 0.4, ..CENTIMETRES })];
    let bytes = glb_with(&crowd, &own);
    std::fs::write(concat!(env!("CARGO_TARGET_TMPDIR"), "/avatars.glb"), &bytes).unwrap();
    let file = Glb::open(&bytes);
    assert_eq!(file.json["meshes"].as_array().unwrap().len(), 2);
    assert_eq!(file.json["skins"].as_array().unwrap().len(), 12);
    let mesh = |p: usize| file.json["nodes"][file.node(&format!("person_{p}_body"))]["mesh"].as_u64().unwrap();
    assert_eq!((0..12).filter(|&p| mesh(p) == 0).count(), 6);
    let (json, binary) = character(&CENTIMETRES);
    let (one, rest) = (glb_file::write(&json, &binary).len(), 12 * 31 * (22 * 8 + 12));
    assert!(bytes.len() < 2 * one + rest + 12 * 20_000, "{} bytes", bytes.len());
    assert_eq!(bytes, glb_with(&crowd, &own));
}

#[test]
fn bad_characters_are_told_by_name() {
    let told = |change: &dyn Fn(&mut Value)| {
        let (mut json, binary) = character(&CENTIMETRES);
        change(&mut json);
        Avatar::open(&glb_file::write(&json, &binary)).unwrap_err().to_string()
    };
    let rename = |json: &mut Value, name: &str, to: &str| {
        let nodes = json["nodes"].as_array_mut().unwrap();
        nodes.iter_mut().filter(|n| n["name"] == name).for_each(|n| n["name"] = to.into());
    };
    let unskinned = told(&|json| {
        json.as_object_mut().unwrap().remove("skins");
        json["nodes"].as_array_mut().unwrap().iter_mut().for_each(|n| drop(n.as_object_mut().unwrap().remove("skin")));
    });
    assert!(unskinned.contains("skins") && unskinned.contains("meshes without a skin"), "{unskinned}");
    let legless = told(&|json| {
        for name in ["LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase"] {
            rename(json, &format!("mixamorig:{name}"), "thing");
        }
    });
    assert!(legless.contains("LeftUpLeg, LeftLeg, LeftFoot"), "{legless}");
    let squeezed = told(&|json| json["nodes"][3]["scale"] = json!([1.0, 2.0, 1.0]));
    assert!(squeezed.contains("node 3") && squeezed.contains("one scale"), "{squeezed}");
    let packed = told(&|json| json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]));
    assert!(packed.contains("KHR_draco_mesh_compression"), "{packed}");
    let elsewhere = told(&|json| json["buffers"][0]["uri"] = "body.bin".into());
    assert!(elsewhere.contains("buffer 0") && elsewhere.contains("one .glb"), "{elsewhere}");
    let beyond = told(&|json| json["accessors"][0]["count"] = 9_999_999.into());
    assert!(beyond.contains("accessor 0"), "{beyond}");
    let lost = told(&|json| json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 999.into());
    assert!(lost.contains("mesh 0") && lost.contains("found 999"), "{lost}");
    let joints = character(&CENTIMETRES).0["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"].as_u64().unwrap();
    let floats = told(&|json| json["accessors"][joints as usize]["componentType"] = 5126.into());
    assert!(floats.contains("mesh 0") && floats.contains("fit for"), "{floats}");
    let bvh = Avatar::open(b"HIERARCHY").unwrap_err().to_string();
    assert!(bvh.contains(".glb"), "{bvh}");
}

#[test]
fn cut_files_are_refused_without_panic() {
    let (json, binary) = character(&CENTIMETRES);
    let whole = glb_file::write(&json, &binary);
    // A header that claims less than its own size.
    let mut lying = whole[..478].to_vec();
    lying[8..12].copy_from_slice(&3u32.to_le_bytes());
    assert!(Avatar::open(&lying).is_err());
    for length in (0..whole.len()).step_by(1 + whole.len() / 200) {
        assert!(Avatar::open(&whole[..length]).is_err(), "{length} of {}", whole.len());
    }
}
