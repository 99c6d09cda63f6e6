//! What files of characters may hold, and what is said of broken ones: one whole file, one fault at a time.

mod disguise;
mod fixture;
mod glb_file;

use base64::Engine;
use crowdquilt::export::{Avatar, glb_with};
use disguise::dressed::{File, PNG, dressed};
use disguise::{CENTIMETRES, character};
use glb_file::Glb;
use serde_json::{Value, json};

#[test]
fn everything_that_is_worn_comes_along() {
    let file = dressed();
    let out = file.exported();
    std::fs::create_dir_all(env!("CARGO_TARGET_TMPDIR")).unwrap();
    let crowd = glb_with(&fixture::lattice(3, 30), &[Avatar::open(&file.bytes()).unwrap()]);
    std::fs::write(concat!(env!("CARGO_TARGET_TMPDIR"), "/dressed.glb"), crowd).unwrap();
    let n = file.vertices();
    let primitive = &out.json["meshes"][0]["primitives"][0];
    let of = |name: &str| out.numbers(&primitive["attributes"][name]);
    let was = |name: &str| file.numbers(&file.json["meshes"][0]["primitives"][0]["attributes"][name]);
    assert!(of("POSITION") == was("POSITION"));
    assert!(of("NORMAL").iter().zip(was("NORMAL")).all(|(a, b)| (a - b).abs() < 1e-6));
    assert!(of("TANGENT") == [0.0, 1.0, 0.0, -1.0].repeat(n));
    assert_eq!(of("TEXCOORD_0")[2 * 3..2 * 4], [3.0 / 255.0, 1.0]);
    assert!(of("TEXCOORD_1") == vec![0.25; 2 * n]);
    assert!(of("COLOR_0") == [1.0, 0.2, 0.0, 1.0].repeat(n));
    assert!(primitive["attributes"]["_OWN"].is_null());
    let moved = out.numbers(&primitive["targets"][0]["POSITION"]);
    assert_eq!((moved[4], moved.iter().map(|v| v.abs()).sum::<f32>()), (7.0, 7.0));
    assert_eq!(out.json["meshes"][0]["weights"], json!([0.5]));
    assert_eq!(out.json["nodes"][out.node("person_0_body")]["weights"], json!([0.25]));
    let glasses = &out.json["nodes"][out.node("person_0_glasses")];
    let glasses = &out.json["meshes"][glasses["mesh"].as_u64().unwrap() as usize]["primitives"][0];
    let places = out.numbers(&glasses["attributes"]["POSITION"]);
    assert_eq!(places, [0.0, 0.0, 0.0, 10.0, 0.0, 0.0, 0.0, 10.0, 0.0]);
    assert_eq!(out.json["skins"][0]["joints"].as_array().unwrap().len(), 23);
    assert!(out.json["skins"][0]["skeleton"].is_null());
    assert_eq!(out.json["skins"].as_array().unwrap().len(), 1);
}

#[test]
fn materials_and_pictures_come_along_if_they_are_used() {
    let file = dressed();
    let out = file.exported();
    let material = &out.json["materials"][0];
    assert_eq!(material["name"], "woven");
    assert_eq!((&material["doubleSided"], &material["alphaMode"]), (&json!(true), &json!("MASK")));
    assert_eq!(material["normalTexture"]["texCoord"], 1);
    let count = |list: &str| out.json[list].as_array().unwrap().len();
    assert_eq!((count("materials"), count("textures"), count("samplers"), count("images")), (1, 2, 1, 2));
    let picture = base64::engine::general_purpose::STANDARD.decode(PNG).unwrap();
    for image in out.json["images"].as_array().unwrap() {
        let view = &out.json["bufferViews"][image["bufferView"].as_u64().unwrap() as usize];
        let at = view["byteOffset"].as_u64().unwrap() as usize;
        assert_eq!(out.binary[at..at + view["byteLength"].as_u64().unwrap() as usize], picture);
        assert_eq!(image["mimeType"], "image/png");
    }
}

#[test]
fn weights_add_up_and_no_joint_comes_twice() {
    let mut file = dressed();
    let n = file.vertices();
    let joints: Vec<[u16; 4]> = (0..n).map(|v| [[3, 3, 5, 999], [7, 8, 9, 10]][v % 2]).collect();
    let weights: Vec<[f32; 4]> = (0..n).map(|v| [[1.0, 2.0, 1.0, 0.0], [0.0; 4]][v % 2]).collect();
    let joints = file.accessor(bytemuck::cast_slice(&joints), 5123, "VEC4", n);
    let weights = file.floats(weights.as_flattened(), "VEC4", n);
    for primitive in file.json["meshes"][0]["primitives"].as_array_mut().unwrap() {
        primitive["attributes"]["JOINTS_0"] = joints.into();
        primitive["attributes"]["WEIGHTS_0"] = weights.into();
    }
    let out = file.exported();
    let attributes = &out.json["meshes"][0]["primitives"][0]["attributes"];
    assert_eq!(out.numbers(&attributes["WEIGHTS_0"])[..8], [0.75, 0.25, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    let joints = &out.json["accessors"][attributes["JOINTS_0"].as_u64().unwrap() as usize];
    let at = out.json["bufferViews"][joints["bufferView"].as_u64().unwrap() as usize]["byteOffset"].as_u64().unwrap();
    assert_eq!(out.binary[at as usize..at as usize + 8], [3, 5, 0, 0, 7, 0, 0, 0]);
}

#[test]
fn what_pieces_share_is_written_once() {
    let (json, binary) = character(&CENTIMETRES);
    let file = File { json, binary };
    let out = file.exported();
    let pieces = out.json["meshes"][0]["primitives"].as_array().unwrap();
    assert!(pieces.len() > 2);
    assert!(pieces.iter().all(|p| p["attributes"] == pieces[0]["attributes"]));
}

/// What is said of a character with one fault.
fn told(change: impl Fn(&mut File)) -> String {
    let mut file = dressed();
    change(&mut file);
    Avatar::open(&file.bytes()).expect_err("must be refused").to_string()
}

fn refused(pointer: &str, value: Value, says: &str) {
    let error = told(|file| {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        let parent = file.json.pointer_mut(parent).unwrap_or_else(|| panic!("{pointer}"));
        match parent {
            Value::Array(list) => list[key.parse::<usize>().unwrap()] = value.clone(),
            other => other[key] = value.clone(),
        }
    });
    assert!(error.contains(says), "{pointer}: {error}");
}

/// The same for the accessor of an attribute of the first primitive.
fn refused_of(attribute: &str, key: &str, value: Value, says: &str) {
    let error = told(|file| {
        let index = file.json["meshes"][0]["primitives"][0]["attributes"][attribute].as_u64().unwrap();
        file.json["accessors"][index as usize][key] = value.clone();
    });
    assert!(error.contains(&format!("mesh 0 primitive 0 {attribute}")) && error.contains(says), "{error}");
}

#[test]
fn references_that_lead_nowhere_are_named() {
    refused("/scene", json!(7), "scene: expected one of 1 scenes, found number 7");
    refused("/scenes/0/nodes", json!([99]), "scene: expected one of");
    refused("/nodes/0/children", json!([99]), "node 0: expected one of");
    refused("/skins/0/joints", json!([99]), "skin 0: expected one of");
    refused("/skins/0/inverseBindMatrices", json!(99), "skin 0: expected one of");
    let body = dressed().json["nodes"].as_array().unwrap().iter().position(|n| n["skin"] == 0).unwrap();
    refused(&format!("/nodes/{body}/skin"), json!(9), &format!("node {body}: expected one of 1 skins, found number 9"));
    refused(
        &format!("/nodes/{body}/mesh"),
        json!(9),
        &format!("node {body}: expected one of 3 meshes, found number 9"),
    );
    let piece = "/meshes/0/primitives/0";
    refused(&format!("{piece}/attributes/POSITION"), json!(999), "mesh 0 primitive 0 POSITION: expected one of");
    refused(&format!("{piece}/indices"), json!(999), "mesh 0 primitive 0 indices: expected one of");
    refused(&format!("{piece}/material"), json!(99), "mesh 0 primitive 0: expected one of");
    refused(&format!("{piece}/targets/0/POSITION"), json!(999), "mesh 0 primitive 0 target: expected one of");
    refused("/materials/0/normalTexture/index", json!(9), "material 0: expected one of 3 textures, found number 9");
    refused("/textures/0/source", json!(9), "texture 0: expected one of 3 images, found number 9");
    refused("/textures/0/sampler", json!(9), "texture 0: expected one of 1 samplers, found number 9");
    refused("/images/0/bufferView", json!(999), "image 0: expected one of");
    refused("/accessors/0/bufferView", json!(999), "accessor 0: expected one of");
    refused("/bufferViews/0/buffer", json!(9), "buffer view 0: expected one of 1 buffers, found number 9");
}

#[test]
fn numbers_of_the_wrong_kind_are_named() {
    refused_of("JOINTS_0", "componentType", json!(5126), "expected [Vec4] of whole numbers of at most 2 bytes");
    refused_of("JOINTS_0", "normalized", json!(true), "at most 2 bytes, found Vec4 of normalised U8");
    refused_of("POSITION", "type", json!("VEC2"), "expected [Vec3] of floats, found Vec2 of F32");
    refused_of(
        "POSITION",
        "componentType",
        json!(7),
        "expected [Vec3] of floats, found a type that glTF does not know",
    );
    refused_of("TEXCOORD_0", "normalized", json!(false), "expected [Vec2] of floats or normalised integers");
    refused_of("NORMAL", "count", json!(3), "vertices, found 3");
    refused_of("POSITION", "count", json!(0), "found 0");
    refused_of("POSITION", "count", json!(9_999_999), "no more data than the file's");
    let error = told(|file| file.json["skins"][0]["inverseBindMatrices"] = 0.into());
    assert!(error.contains("skin 0, accessor 0: expected [Mat4] of floats"), "{error}");
    let error = told(|file| {
        let binds = file.json["skins"][0]["inverseBindMatrices"].as_u64().unwrap() as usize;
        file.json["accessors"][binds]["count"] = 22.into();
    });
    assert!(error.contains("skin 0: expected an inverse bind matrix for each of 23 joints, found 22"), "{error}");
}

#[test]
fn numbers_out_of_range_are_named() {
    let with = |attribute: &str, value: f32, says: &str| {
        let error = told(|file| {
            let n = file.vertices();
            let width = if attribute == "WEIGHTS_0" { 4 } else { 3 };
            let kind = if width == 4 { "VEC4" } else { "VEC3" };
            let accessor = file.floats(&vec![value; width * n], kind, n);
            file.json["meshes"][0]["primitives"][0]["attributes"][attribute] = accessor.into();
        });
        assert!(error.contains("mesh 0 primitive 0") && error.contains(says), "{error}");
    };
    with("POSITION", f32::NAN, "expected finite numbers, found NaN");
    with("WEIGHTS_0", -0.5, "vertex 0: expected weights of 0 and more, found -0.5");
    let error = told(|file| {
        let n = file.vertices();
        let joints = file.accessor(&vec![23; 4 * n], 5121, "VEC4", n);
        file.json["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = joints.into();
    });
    assert!(error.contains("expected one of the skin's 23 joints, found number 23"), "{error}");
    let error = told(|file| {
        let n = file.vertices() as u16;
        let corners = file.accessor(bytemuck::cast_slice(&[0, 1, n]), 5123, "SCALAR", 3);
        file.json["meshes"][0]["primitives"][0]["indices"] = corners.into();
    });
    assert!(error.contains("mesh 0 primitive 0 indices: expected numbers of"), "{error}");
    let error = told(|file| {
        let corners = file.accessor(&[0, 1, 2, 3], 5121, "SCALAR", 4);
        file.json["meshes"][0]["primitives"][0]["indices"] = corners.into();
    });
    assert!(error.contains("mesh 0 primitive 0: expected whole Triangles, found 4 corners"), "{error}");
    let bent = glam::Mat4::from_scale(glam::Vec3::ONE).to_cols_array().map(|v| v * 2.0).repeat(23);
    let error = told(|file| file.json["skins"][0]["inverseBindMatrices"] = file.floats(&bent, "MAT4", 23).into());
    assert!(error.contains("skin 0: expected inverse bind matrices without perspective"), "{error}");
}

#[test]
fn meshes_that_do_not_fit_together_are_named() {
    let error = told(|file| {
        file.json["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap().remove("JOINTS_0");
    });
    assert!(error.contains("mesh 0 primitive 0: expected joints and their weights"), "{error}");
    let error = told(|file| {
        file.json["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap().remove("TEXCOORD_1");
    });
    assert!(error.contains("mesh 0 primitive 0: expected TEXCOORD_1 for material 0, found none"), "{error}");
    let error = told(|file| {
        file.json["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap().remove("POSITION");
    });
    assert!(error.contains("mesh 0 primitive 0: expected POSITION, found none"), "{error}");
    let piece = "/meshes/0/primitives/1";
    refused(&format!("{piece}/targets"), json!([]), "primitive 1: expected 1 morph targets as in the first, found 0");
    refused(&format!("{piece}/targets"), json!([{}]), "primitive 1 target: expected POSITION, found none");
    refused(&format!("{piece}/mode"), json!(9), "primitive 1: expected a mode of glTF 2.0");
    refused("/meshes/0/weights", json!([0.5, 0.5]), "mesh 0: expected 1 finite weights");
    refused("/meshes/0/weights", json!([1e300]), "mesh 0: expected 1 finite weights");
    refused("/meshes/0/primitives", json!([]), "mesh 0: expected a primitive, found none");
    refused("/skins/0/joints", json!([]), "skin 0: expected joints, each once, found 0 of 0 nodes");
    let error = told(|file| file.json["skins"][0]["joints"][1] = file.json["skins"][0]["joints"][0].clone());
    assert!(error.contains("skin 0: expected joints, each once, found 23 of 22 nodes"), "{error}");
}

#[test]
fn materials_and_pictures_that_none_can_show_are_named() {
    let factor = "/materials/0/pbrMetallicRoughness";
    refused(&format!("{factor}/metallicFactor"), json!(1.5), "material 0: expected factors from 0 to 1, found 1.5");
    refused(&format!("{factor}/baseColorFactor"), json!([0, 0, 0, -1]), "expected factors from 0 to 1, found -1");
    refused("/materials/0/emissiveFactor", json!([0, 1e300, 0]), "material 0: expected factors from 0 to 1, found inf");
    refused("/materials/0/alphaMode", json!("GLASS"), "material 0: expected alphaMode");
    refused("/materials/0/alphaCutoff", json!(-1), "material 0: expected an alphaCutoff of 0 or more, found -1");
    refused("/materials/0/normalTexture/scale", json!(1e300), "material 0: expected a finite scale");
    refused("/samplers/0/wrapS", json!(1), "sampler 0: expected filters and wrapping modes");
    refused("/images/1/uri", json!("cloth.png"), "image 1: expected the picture in the file itself, found a link");
    refused("/images/1/uri", json!("data:image/png;base64,QUJD"), "image 1: expected a PNG or JPEG picture");
    refused("/images/1/uri", json!("data:image/png;base64,?"), "image 1: expected data in base64");
    refused("/images/1", json!({}), "image 1: expected a picture, found none");
    let error = told(|file| drop(file.json["textures"][0].as_object_mut().unwrap().remove("source")));
    assert!(error.contains("texture 0: expected a PNG or JPEG picture, found none"), "{error}");
}

#[test]
fn skeletons_that_none_can_play_are_named() {
    let rename = |file: &mut File, name: &str, to: &str| {
        let node = file.node(name);
        file.json["nodes"][node]["name"] = to.into();
    };
    let error = told(|file| {
        file.json["nodes"]
            .as_array_mut()
            .unwrap()
            .iter_mut()
            .for_each(|n| drop(n.as_object_mut().unwrap().remove("skin")));
    });
    assert!(error.contains("skins") && error.contains("meshes without a skin"), "{error}");
    let error = told(|file| {
        for name in ["LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase"] {
            rename(file, &format!("mixamorig:{name}"), "thing");
        }
    });
    assert!(error.contains("LeftUpLeg, LeftLeg, LeftFoot"), "{error}");
    refused("/nodes/3/scale", json!([1.0, 2.0, 1.0]), "node 3 (mixamorig:LeftFoot): expected one scale above 0");
    refused("/nodes/3/scale", json!([1e-9, 1e-9, 1e-9]), "node 3: expected a size and place in the scene");
    refused("/nodes/3/translation", json!([1e30, 0, 0]), "node 3: expected a size and place in the scene");
    refused("/nodes/3/translation", json!([1e300, 0, 0]), "node 3 (mixamorig:LeftFoot): expected finite numbers");
    refused("/scenes/0/nodes", json!([]), "expected a mesh that is bound to a skeleton");
    let error = told(|file| file.json["nodes"][3]["children"] = json!([0]));
    assert!(error.contains("expected one parent, found two"), "{error}");
}

#[test]
fn nodes_outside_the_scene_change_nothing() {
    let mut file = dressed();
    let whole = file.exported();
    // They go round in circles, and claim a joint as their child.
    let (a, b) = (file.json["nodes"].as_array().unwrap().len(), file.json["nodes"].as_array().unwrap().len() + 1);
    file.push("nodes", json!({ "children": [b, 3] }));
    file.push("nodes", json!({ "children": [a] }));
    file.push("skins", json!({ "joints": [a, 999] }));
    let out = file.exported();
    assert!((out.json, out.binary) == (whole.json, whole.binary));
}

#[test]
fn files_that_are_no_characters_are_named() {
    let error = told(|file| file.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]));
    assert!(error.contains("KHR_draco_mesh_compression"), "{error}");
    let error = told(|file| file.json["buffers"][0]["uri"] = "body.bin".into());
    assert!(error.contains("buffer 0") && error.contains("export as one .glb"), "{error}");
    refused("/asset/version", json!("1.0"), "asset: expected version 2, found '1.0'");
    let error = Avatar::open(b"HIERARCHY").unwrap_err().to_string();
    assert!(error.contains(".glb"), "{error}");
}

#[test]
fn cut_files_are_refused_without_panic() {
    let whole = dressed().bytes();
    // A header that claims less than its own size.
    let mut lying = whole[..478].to_vec();
    lying[8..12].copy_from_slice(&3u32.to_le_bytes());
    assert!(Avatar::open(&lying).is_err());
    for length in (0..whole.len()).step_by(1 + whole.len() / 200) {
        assert!(Avatar::open(&whole[..length]).is_err(), "{length} of {}", whole.len());
    }
}

#[test]
fn few_bytes_cannot_ask_for_much_memory() {
    // Every piece has vertices of its own, made of the same accessors in other ways.
    let mut file = dressed();
    let n = file.vertices();
    let sets: Vec<usize> = (0..40).map(|_| file.floats(&vec![0.5; 2 * n], "VEC2", n)).collect();
    let view = file.json["accessors"][sets[0]]["bufferView"].clone();
    for &set in &sets {
        file.json["accessors"][set]["bufferView"] = view.clone();
    }
    file.binary.truncate(file.binary.len() - 39 * 8 * n);
    let piece = file.json["meshes"][0]["primitives"][0].clone();
    let pieces = sets.iter().flat_map(|&a| sets.iter().map(move |&b| (a, b))).map(|(a, b)| {
        let mut piece = piece.clone();
        (piece["attributes"]["TEXCOORD_0"], piece["attributes"]["TEXCOORD_1"]) = (a.into(), b.into());
        piece
    });
    file.json["meshes"][0]["primitives"] = pieces.collect();
    let error = Avatar::open(&file.bytes()).unwrap_err().to_string();
    assert!(error.contains("expected accessors of no more data than the file's"), "{error}");
}

/// Pointers to everything in a JSON value.
fn pointers(value: &Value, at: &str, found: &mut Vec<String>) {
    found.push(at.to_owned());
    match value {
        Value::Array(list) => list.iter().enumerate().for_each(|(i, v)| pointers(v, &format!("{at}/{i}"), found)),
        Value::Object(map) => map.iter().for_each(|(k, v)| pointers(v, &format!("{at}/{k}"), found)),
        _ => {}
    }
}

#[test]
fn any_one_change_is_refused_or_harmless() {
    let file = dressed();
    let mut all = Vec::new();
    pointers(&file.json, "", &mut all);
    let crowd = fixture::lattice(1, 2);
    let others = [json!(null), json!(0), json!(3), json!(-1), json!(4_000_000_000u64), json!(1e300), json!("MASK")];
    let others = [others.as_slice(), &[json!([]), json!({}), json!([0.5, 1.0]), json!(5121), json!(true)]].concat();
    let (mut refused, mut played) = (0, 0);
    for (i, pointer) in all.iter().enumerate() {
        // One way for each place; over all places every way is taken many times.
        let mut changed = File { json: file.json.clone(), binary: file.binary.clone() };
        *changed.json.pointer_mut(pointer).unwrap() = others[i % others.len()].clone();
        match Avatar::open(&glb_file::write(&changed.json, &changed.binary)) {
            Err(error) => {
                let told = error.to_string();
                assert!(told.contains("expected") || told.contains("missing field"), "{pointer}: {told}");
                refused += 1;
            }
            Ok(avatar) => {
                let Glb { json, .. } = Glb::open(&glb_with(&crowd, &[avatar]));
                assert!(json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].is_u64());
                played += 1;
            }
        }
    }
    assert!(refused > 100 && played > 100, "{refused} refused, {played} played");
}
