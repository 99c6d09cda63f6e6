//! A small character with one of everything that characters pass on.

use base64::Engine;
use crowdquilt::export::Avatar;
use crowdquilt::motion::canonical;
use serde_json::{Value, json};

use crate::glb_file::{self, Glb};

/// A picture of one point.
const PNG: &str = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==";

struct File(Glb);

impl File {
    fn push(&mut self, list: &str, new: Value) -> usize {
        if self.0.json[list].is_null() {
            self.0.json[list] = json!([]);
        }
        let list = self.0.json[list].as_array_mut().expect("a list");
        list.push(new);
        list.len() - 1
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        let begin = self.0.binary.len();
        self.0.binary.extend_from_slice(bytes);
        self.0.binary.resize(self.0.binary.len().next_multiple_of(4), 0);
        self.push("bufferViews", json!({ "buffer": 0, "byteOffset": begin, "byteLength": bytes.len() }))
    }

    fn floats(&mut self, kind: &str, count: usize, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes);
        self.push("accessors", json!({ "bufferView": view, "componentType": 5126, "count": count, "type": kind }))
    }

    fn bytes(&mut self, kind: &str, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        self.push("accessors", json!({ "bufferView": view, "componentType": 5121, "count": 3, "type": kind }))
    }
}

/// The clip's skeleton with a skin of one triangle.
pub fn character(clip: &[u8]) -> Vec<u8> {
    let mut file = File(Glb::open(clip));
    let joints = canonical().joints.len();
    let identities: Vec<f32> = (0..joints).flat_map(|_| glam::Mat4::IDENTITY.to_cols_array()).collect();
    let binds = file.floats("MAT4", joints, &identities);
    let attributes = json!({
        "POSITION": file.floats("VEC3", 3, &[0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.1, 0.0]),
        "NORMAL": file.floats("VEC3", 3, &[0.0, 0.0, 1.0].repeat(3)),
        "TANGENT": file.floats("VEC4", 3, &[1.0, 0.0, 0.0, 1.0].repeat(3)),
        "TEXCOORD_0": file.floats("VEC2", 3, &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]),
        "JOINTS_0": file.bytes("VEC4", &[0, 1, 0, 0].repeat(3)),
        "WEIGHTS_0": file.floats("VEC4", 3, &[0.5, 0.5, 0.0, 0.0].repeat(3)),
    });
    let indices = file.bytes("SCALAR", &[0, 1, 2]);
    let (index, moved) = (file.view(&[1]), file.view(&[0; 12]));
    let sparse = json!({
        "count": 1, "indices": { "bufferView": index, "componentType": 5121 }, "values": { "bufferView": moved },
    });
    let target = file.push("accessors", json!({ "componentType": 5126, "type": "VEC3", "count": 3, "sparse": sparse }));
    let picture = file.view(&base64::engine::general_purpose::STANDARD.decode(PNG).expect("base64"));
    file.push("images", json!({ "bufferView": picture, "mimeType": "image/png" }));
    file.push("samplers", json!({ "magFilter": 9729 }));
    file.push("textures", json!({ "source": 0, "sampler": 0 }));
    let paint = json!({ "index": 0 });
    file.push("materials", json!({ "pbrMetallicRoughness": { "baseColorTexture": paint }, "normalTexture": paint }));
    let stiff = json!({ "attributes": { "POSITION": attributes["POSITION"] } });
    let primitive =
        json!({ "attributes": attributes, "indices": indices, "material": 0, "targets": [{ "POSITION": target }] });
    let body = file.push("meshes", json!({ "primitives": [primitive], "weights": [0.5] }));
    let glasses = file.push("meshes", json!({ "primitives": [stiff] }));
    file.push("skins", json!({ "joints": (0..joints).collect::<Vec<_>>(), "inverseBindMatrices": binds }));
    let body = file.push("nodes", json!({ "mesh": body, "skin": 0 }));
    let glasses = file.push("nodes", json!({ "mesh": glasses }));
    let Glb { json, binary } = &mut file.0;
    let tip = (0..joints).find(|&j| json["nodes"][j]["children"].is_null()).expect("a tree has leaves");
    json["nodes"][tip]["children"] = json!([glasses]);
    json["scenes"][0]["nodes"].as_array_mut().expect("a scene").push(json!(body));
    json["buffers"][0]["byteLength"] = json!(binary.len());
    let bytes = glb_file::write(json, binary);
    Avatar::open(&bytes).expect("a seed is a whole character");
    bytes
}
