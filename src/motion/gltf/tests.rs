//! Small files built here, whose places are worked out by hand; one fault per test.

use base64::Engine;
use glam::{Quat, Vec3};
use serde_json::{Value, json};

use super::{Source, read};
use crate::Result;
use crate::motion::Clip;

/// A file in the making: its JSON and one buffer of floats.
struct File {
    json: Value,
    buffer: Vec<u8>,
}

const QUARTER: [f32; 4] = [0.0, 0.0, std::f32::consts::FRAC_1_SQRT_2, std::f32::consts::FRAC_1_SQRT_2];

impl File {
    /// Two joints, 0.5 m apart; the lower one turns about z by 90 degrees and moves by 1 m along x in a second.
    fn new(interpolation: &str) -> Self {
        let mut file = Self { json: json!({}), buffer: Vec::new() };
        file.json = json!({
            "asset": { "version": "2.0" },
            "nodes": [
                { "name": "hips", "children": [1], "translation": [0, 1, 0] },
                { "name": "head", "translation": [0, 0.5, 0] },
            ],
            "animations": [{
                "name": "walk",
                "channels": [
                    { "sampler": 0, "target": { "node": 0, "path": "rotation" } },
                    { "sampler": 1, "target": { "node": 0, "path": "translation" } },
                ],
                "samplers": [
                    { "input": 0, "output": 1, "interpolation": interpolation },
                    { "input": 0, "output": 2, "interpolation": interpolation },
                ],
            }],
            "accessors": [], "bufferViews": [], "buffers": [],
        });
        file.floats("SCALAR", &[0.0, 1.0]);
        let turn = [0.0, 0.0, 0.0, 1.0].into_iter().chain(QUARTER);
        let place = [0.0, 1.0, 0.0, 1.0, 1.0, 0.0];
        if interpolation == "CUBICSPLINE" {
            let triples = |flat: Vec<f32>, width: usize| -> Vec<f32> {
                let keys = flat.chunks(width).map(|key| [vec![0.0; width], key.to_vec(), vec![0.0; width]].concat());
                keys.flatten().collect()
            };
            file.floats("VEC4", &triples(turn.collect(), 4));
            file.floats("VEC3", &triples(place.to_vec(), 3));
        } else {
            file.floats("VEC4", &turn.collect::<Vec<f32>>());
            file.floats("VEC3", &place);
        }
        file
    }

    fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let view = self.bytes(bytemuck::cast_slice(values));
        self.accessor(json!({ "bufferView": view, "componentType": 5126, "count": values.len() / width, "type": kind }))
    }

    fn bytes(&mut self, bytes: &[u8]) -> usize {
        let view = json!({ "buffer": 0, "byteOffset": self.buffer.len(), "byteLength": bytes.len() });
        self.buffer.extend_from_slice(bytes);
        self.json["bufferViews"].as_array_mut().unwrap().push(view);
        self.json["bufferViews"].as_array().unwrap().len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.json["accessors"].as_array_mut().unwrap().push(accessor);
        self.json["accessors"].as_array().unwrap().len() - 1
    }

    /// As text with the buffer in a data URI.
    fn gltf(&self) -> Vec<u8> {
        let data = base64::engine::general_purpose::STANDARD.encode(&self.buffer);
        let mut json = self.json.clone();
        let uri = format!("data:application/octet-stream;base64,{data}");
        json["buffers"] = json!([{ "byteLength": self.buffer.len(), "uri": uri }]);
        json.to_string().into_bytes()
    }

    fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{ "byteLength": self.buffer.len() }]);
        let mut json = json.to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let length = 28 + json.len() + self.buffer.len();
        let word = |n: usize| (n as u32).to_le_bytes();
        let header = [b"glTF".as_slice(), &word(2), &word(length), &word(json.len()), b"JSON"].concat();
        [header, json, [word(self.buffer.len()).as_slice(), b"BIN\0"].concat(), self.buffer.clone()].concat()
    }

    fn clip(&self) -> Clip {
        one(&self.gltf(), None).unwrap()
    }

    fn refused(&self, says: &str) {
        let error = one(&self.gltf(), None).expect_err("must be refused").to_string();
        assert!(error.contains(says), "{error}");
    }
}

fn all(bytes: &[u8], fps: Option<f32>) -> Result<Vec<Clip>> {
    Ok(read(bytes, Source { fps, ..Default::default() })?.clips)
}

fn one(bytes: &[u8], fps: Option<f32>) -> Result<Clip> {
    let mut clips = all(bytes, fps)?;
    assert_eq!(clips.len(), 1);
    Ok(clips.remove(0))
}

fn near(a: Vec3, b: Vec3) {
    assert!((a - b).length() < 1e-5, "{a} instead of {b}");
}

#[test]
fn text_and_binary_say_the_same() {
    let file = File::new("LINEAR");
    let clip = one(&file.glb(), Some(2.0)).unwrap();
    assert_eq!(clip, one(&file.gltf(), Some(2.0)).unwrap());
    assert_eq!(clip.skeleton.joints.iter().map(|j| j.name.as_str()).collect::<Vec<_>>(), ["hips", "head"]);
    assert_eq!((clip.frames(), clip.fps), (3, 2.0));
    near(clip.root[1], Vec3::new(0.5, 1.0, 0.0));
    let (sin, cos) = std::f32::consts::FRAC_PI_4.sin_cos();
    near(clip.trajectory(1)[1], Vec3::new(0.5 - 0.5 * sin, 1.0 + 0.5 * cos, 0.0));
    near(clip.trajectory(1)[2], Vec3::new(0.5, 1.0, 0.0));
}

#[test]
fn steps_hold_and_splines_ease() {
    let step = one(&File::new("STEP").gltf(), Some(4.0)).unwrap();
    assert_eq!(step.root.iter().map(|p| p.x).collect::<Vec<_>>(), [0.0, 0.0, 0.0, 0.0, 1.0]);
    let spline = one(&File::new("CUBICSPLINE").gltf(), Some(4.0)).unwrap();
    // With tangents of zero: 3 s^2 - 2 s^3.
    for (place, x) in spline.root.iter().zip([0.0, 0.15625, 0.5, 0.84375, 1.0]) {
        near(*place, Vec3::new(x, 1.0, 0.0));
    }
    assert_eq!(File::new("CUBICSPLINE").clip().fps, 30.0);
    assert_eq!(File::new("LINEAR").clip().fps, 1.0);
}

#[test]
fn sparse_and_integer_accessors() {
    let mut file = File::new("LINEAR");
    let (index, value) = (file.bytes(&[1, 0, 0, 0]), file.bytes(bytemuck::cast_slice(&[5.0f32, 6.0, 7.0])));
    file.json["accessors"][2]["sparse"] = json!({
        "count": 1, "indices": { "bufferView": index, "componentType": 5121 }, "values": { "bufferView": value },
    });
    let turns: [i16; 8] = [0, 0, 0, 32767, 0, 0, 23170, 23170];
    let view = file.bytes(bytemuck::cast_slice(&turns));
    file.json["accessors"][1] =
        json!({ "bufferView": view, "componentType": 5122, "normalized": true, "count": 2, "type": "VEC4" });
    let clip = file.clip();
    near(clip.root[1], Vec3::new(5.0, 6.0, 7.0));
    assert!(clip.pose(1)[0].angle_between(Quat::from_array(QUARTER)) < 1e-3);
    // Without a buffer view all is zero but for the sparse elements.
    file.json["accessors"][2].as_object_mut().unwrap().remove("bufferView");
    near(file.clip().root[0], Vec3::ZERO);
    file.json["accessors"][2]["sparse"]["indices"]["componentType"] = json!(5125);
    near(file.clip().root[1], Vec3::new(5.0, 6.0, 7.0));
    file.buffer[file.json["bufferViews"][index]["byteOffset"].as_u64().unwrap() as usize] = 9;
    file.refused("accessor 2: expected sparse indices below its count, found 9");
}

#[test]
fn interleaved_keys() {
    let mut file = File::new("LINEAR");
    let view = file.bytes(bytemuck::cast_slice(&[0.0f32, 1.0, 2.0, 99.0, 3.0, 4.0, 5.0]));
    file.json["bufferViews"][view]["byteStride"] = json!(16);
    file.json["accessors"][2]["bufferView"] = json!(view);
    near(file.clip().root[1], Vec3::new(3.0, 4.0, 5.0));
}

/// A skinned person under a node that turns and shrinks, whose joints are turned at rest.
fn skinned() -> File {
    let mut file = File::new("LINEAR");
    // World: scaled by 0.1 and turned so that the file's z is up.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    file.json["nodes"] = json!([
        { "name": "hips", "children": [1], "translation": [0, 0, 10], "rotation": QUARTER },
        { "name": "head", "translation": [0, 5, 0] },
        { "name": "armature", "children": [0, 3], "rotation": [-half, 0, 0, half], "scale": [0.1, 0.1, 0.1] },
        { "name": "body", "mesh": 0, "skin": 0 },
    ]);
    file.json["skins"] = json!([{ "name": "Bob", "joints": [0, 1] }]);
    file.json["accessors"][2] = json!(null);
    let place = file.floats("VEC3", &[0.0, 0.0, 10.0, 20.0, 0.0, 10.0]);
    let place = file.json["accessors"].as_array_mut().unwrap().remove(place);
    file.json["accessors"][2] = place;
    file
}

#[test]
fn a_skinned_person_stands_upright_in_metres() {
    let clip = skinned().clip();
    assert_eq!(clip.name, "Bob");
    near(clip.root[0], Vec3::new(0.0, 1.0, 0.0));
    near(clip.root[1], Vec3::new(2.0, 1.0, 0.0));
    // The head is at (0, 5, 0) of hips turned by 90 degrees about the file's z: towards -x of the file and of ours.
    near(clip.skeleton.joints[1].offset, Vec3::new(-0.5, 0.0, 0.0));
}

#[test]
fn rest_is_the_bind_pose_where_there_is_one() {
    let mut file = skinned();
    // The bind pose in the armature's frame: hips not turned.
    let hips = glam::Mat4::from_translation(Vec3::new(0.0, 0.0, -10.0));
    let head = glam::Mat4::from_translation(Vec3::new(0.0, -5.0, -10.0));
    let matrices = [hips.to_cols_array(), head.to_cols_array()].concat();
    let bind = file.floats("MAT4", &matrices);
    file.json["skins"][0]["inverseBindMatrices"] = json!(bind);
    let clip = file.clip();
    near(clip.skeleton.joints[1].offset, Vec3::new(0.0, 0.0, -0.5));
    // The first key is no turn at all, as the bind pose; the last a quarter turn about the file's z, our y.
    assert!(clip.pose(0)[0].angle_between(Quat::IDENTITY) < 1e-3);
    assert!(clip.pose(1)[0].angle_between(Quat::from_rotation_y(std::f32::consts::FRAC_PI_2)) < 1e-3);
    near(clip.trajectory(1)[1], Vec3::new(1.5, 1.0, 0.0));
}

#[test]
fn hips_below_a_still_root_are_the_clips_root() {
    let mut file = File::new("LINEAR");
    file.json["nodes"] = json!([
        { "name": "pelvis", "children": [1], "translation": [0, 1, 0] },
        { "name": "head", "translation": [0, 0.5, 0] },
        { "name": "root", "children": [0, 3] },
        { "name": "ik", "translation": [0, 0, 1] },
    ]);
    file.json["skins"] = json!([{ "joints": [2, 0, 1, 3] }]);
    file.json["nodes"][1]["children"] = json!([4, 5]);
    for name in ["left", "right"] {
        file.json["nodes"].as_array_mut().unwrap().push(json!({ "name": name, "translation": [0.1, 0, 0] }));
    }
    file.json["skins"][0]["joints"] = json!([2, 0, 1, 3, 4, 5]);
    let clip = file.clip();
    assert_eq!(clip.skeleton.joints[0].name, "pelvis");
    assert_eq!(clip.skeleton.joints.len(), 4);
    near(clip.root[1], Vec3::new(1.0, 1.0, 0.0));
}

#[test]
fn people_of_several_animations_are_all_found() {
    let mut file = File::new("LINEAR");
    let nodes = file.json["nodes"].as_array_mut().unwrap();
    nodes.extend([json!({ "name": "pelvis", "children": [3] }), json!({ "name": "top", "translation": [0, 1, 0] })]);
    let mut run = file.json["animations"][0].clone();
    run["name"] = json!("run");
    run["channels"].as_array_mut().unwrap().iter_mut().for_each(|c| c["target"]["node"] = json!(2));
    file.json["animations"].as_array_mut().unwrap().push(run);
    let names = |source: Source| -> Vec<String> {
        read(&file.gltf(), source).unwrap().clips.into_iter().map(|c| c.name).collect()
    };
    assert_eq!(names(Source::default()), ["hips", "pelvis"]);
    assert_eq!(names(Source { animation: Some("run"), ..Default::default() }), ["pelvis"]);
    let error = read(&file.gltf(), Source { animation: Some("fly"), ..Default::default() }).err().unwrap().to_string();
    assert!(error.contains("expected an animation 'fly', found 'walk', 'run'"), "{error}");
}

#[test]
fn a_hidden_person_is_left_out_where_it_is_hidden() {
    let mut file = File::new("LINEAR");
    file.json["nodes"].as_array_mut().unwrap().push(json!({ "name": "top", "children": [0] }));
    file.json["animations"][0]["channels"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "sampler": 2, "target": { "node": 2, "path": "scale" } }));
    let times = file.floats("SCALAR", &[0.0, 0.5]);
    let scales = file.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    file.json["animations"][0]["samplers"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "input": times, "output": scales, "interpolation": "STEP" }));
    let clip = one(&file.gltf(), Some(10.0)).unwrap();
    assert_eq!(clip.frames(), 6);
    near(clip.root[0], Vec3::new(0.5, 1.0, 0.0));
}

#[test]
fn faults_name_their_place() {
    let with = |pointer: &str, value: Value, says: &str| {
        let mut file = File::new("LINEAR");
        *file.json.pointer_mut(pointer).unwrap_or_else(|| panic!("{pointer}")) = value;
        file.refused(says);
    };
    with("/asset/version", json!("1.0"), "asset: expected version 2, found '1.0'");
    with("/animations", json!([]), "expected an animation, found none at all");
    with("/animations/0/channels", json!([]), "expected an animation that moves a tree of nodes");
    with(
        "/animations/0/channels/0/sampler",
        json!(7),
        "animation 'walk' channel 0: expected one of 2 samplers, found number 7",
    );
    with("/animations/0/channels/0/target/node", json!(7), "animations: expected one of 2 nodes, found number 7");
    with(
        "/animations/0/samplers/0/input",
        json!(1),
        "animation 'walk' channel 0, accessor 1: expected [Scalar] of numbers, found",
    );
    with("/animations/0/samplers/0/output", json!(9), "channel 0: expected one of 3 accessors, found number 9");
    with("/animations/0/samplers/0/interpolation", json!("CUBICSPLINE"), "found 2 values for 6");
    with("/accessors/0/bufferView", json!(9), "accessor 0: expected one of 3 buffer views, found number 9");
    with("/accessors/0/count", json!(4_000_000_000u64), "expected accessors of no more data than the file's");
    with("/accessors/0/count", json!(3), "accessor 0: expected 12 bytes of its buffer view, found 8");
    with("/bufferViews/0", json!({ "buffer": 0, "byteLength": 8, "byteStride": 2 }), "at least 4 bytes apart, found 2");
    with("/bufferViews/0/byteLength", json!(4_000_000_000u64), "buffer view 0: expected a buffer of 4000000000 bytes");
    with("/bufferViews/0/buffer", json!(3), "buffer view 0: expected one of 1 buffers, found number 3");
}

#[test]
fn trees_that_are_none_are_refused() {
    let with = |children: [Value; 2], says: &str| {
        let mut file = File::new("LINEAR");
        for (i, c) in children.into_iter().enumerate() {
            file.json["nodes"][i]["children"] = c;
        }
        file.refused(says);
    };
    with([json!([1]), json!([0])], "node 0: expected a tree, found a node that is its own ancestor");
    with([json!([1, 1]), json!([])], "node 1: expected one parent, found two");
    with([json!([9]), json!([])], "node 0: expected one of 2 nodes, found number 9");
}

#[test]
fn keys_must_be_finite_and_rise() {
    for (times, says) in [([1.0f32, 0.0], "rising order"), ([0.0, f32::NAN], "rising order")] {
        let mut file = File::new("LINEAR");
        file.buffer[..8].copy_from_slice(bytemuck::cast_slice(&times));
        file.refused(says);
    }
    let mut file = File::new("LINEAR");
    file.buffer[8..12].copy_from_slice(&f32::INFINITY.to_le_bytes());
    file.refused("expected finite values, found inf");
}

#[test]
fn every_cut_of_a_glb_is_refused() {
    let glb = File::new("LINEAR").glb();
    for n in 4..glb.len() {
        assert!(all(&glb[..n], None).is_err(), "cut at {n}");
    }
}

#[test]
fn few_bytes_cannot_ask_for_many_frames() {
    let mut file = File::new("LINEAR");
    let times = file.floats("SCALAR", &[0.0, 0.004, 1e6]);
    let places = file.floats("VEC3", &[0.0; 9]);
    file.json["animations"][0]["samplers"][1] = json!({ "input": times, "output": places });
    file.refused("expected no more poses of joints than");
}

#[test]
fn files_beside_it_only_where_there_is_a_folder() {
    let mut file = File::new("LINEAR");
    let folder = std::env::temp_dir().join(format!("crowdquilt-gltf-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("walk data.bin"), &file.buffer).unwrap();
    let mut with = |uri: &str| {
        file.json["buffers"] = json!([{ "byteLength": file.buffer.len(), "uri": uri }]);
        let source = Source { folder: Some(&folder), ..Default::default() };
        read(file.json.to_string().as_bytes(), source).map(|c| c.clips[0].root[1]).map_err(|e| e.to_string())
    };
    near(with("walk%20data.bin").unwrap(), Vec3::new(1.0, 1.0, 0.0));
    assert!(with("none.bin").unwrap_err().contains("none.bin"));
    assert!(with("/dev/zero").unwrap_err().contains("buffer 0: expected a file beside it"));
    assert!(with("https://example.org/a.bin").unwrap_err().contains("expected a file beside it"));
    assert!(with(".").unwrap_err().contains("expected a file, found"));
    assert!(with("data:text/plain,abc").unwrap_err().contains("expected data in base64"));
    std::fs::remove_dir_all(&folder).unwrap();
    let error = all(file.json.to_string().as_bytes(), None).unwrap_err().to_string();
    assert!(error.contains("buffer 0"), "{error}");
}
