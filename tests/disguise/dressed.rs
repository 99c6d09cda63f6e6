//! A character with one of everything, and a file in the making around it.

use base64::Engine;
use crowdquilt::export::{Avatar, glb_with};
use serde_json::{Value, json};

use super::{CENTIMETRES, character};
use crate::fixture;
use crate::glb_file::{self, Glb};

/// A picture of one point.
pub const PNG: &str =
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==";

/// A file in the making.
pub struct File {
    pub json: Value,
    pub binary: Vec<u8>,
}

impl File {
    pub fn bytes(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"][0]["byteLength"] = self.binary.len().into();
        glb_file::write(&json, &self.binary)
    }

    pub fn push(&mut self, list: &str, new: Value) -> usize {
        if self.json[list].is_null() {
            self.json[list] = json!([]);
        }
        self.json[list].as_array_mut().unwrap().push(new);
        self.json[list].as_array().unwrap().len() - 1
    }

    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": self.binary.len(), "byteLength": bytes.len() });
        self.binary.extend_from_slice(bytes);
        self.push("bufferViews", view)
    }

    pub fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let view = self.view(bytes);
        self.push("accessors", json!({ "bufferView": view, "componentType": component, "type": kind, "count": count }))
    }

    pub fn floats(&mut self, values: &[f32], kind: &str, count: usize) -> usize {
        self.accessor(bytemuck::cast_slice(values), 5126, kind, count)
    }

    pub fn vertices(&self) -> usize {
        let places = &self.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"];
        self.json["accessors"][places.as_u64().unwrap() as usize]["count"].as_u64().unwrap() as usize
    }

    pub fn numbers(&self, accessor: &Value) -> Vec<f32> {
        let file = Glb { json: self.json.clone(), binary: self.binary.clone() };
        file.numbers(accessor)
    }

    pub fn node(&self, name: &str) -> usize {
        self.json["nodes"].as_array().unwrap().iter().position(|n| n["name"] == name).unwrap()
    }

    /// As one of a crowd.
    pub fn exported(&self) -> Glb {
        let avatar = Avatar::open(&self.bytes()).unwrap();
        Glb::open(&glb_with(&fixture::lattice(1, 2), &[avatar]))
    }
}

/// A character with all that is passed on: textures, tangents, colours, a morph target, a stiff part, a joint that does
/// not hang from the hips; in all the ways in which numbers can be put into a file.
pub fn dressed() -> File {
    let (json, binary) = character(&CENTIMETRES);
    let mut file = File { json, binary };
    let n = file.vertices();
    let bytes = base64::engine::general_purpose::STANDARD.decode(PNG).unwrap();
    let view = file.view(&bytes);
    file.json["images"] = json!([
        { "bufferView": view, "mimeType": "image/png", "name": "cloth" },
        { "uri": format!("data:image/png;base64,{PNG}") },
        { "uri": "unused.png" },
    ]);
    file.json["samplers"] = json!([{ "magFilter": 9729, "wrapS": 33071 }]);
    file.json["textures"] = json!([{ "source": 0, "sampler": 0 }, { "source": 1 }, { "source": 2 }]);
    file.json["materials"][0] = json!({
        "name": "woven", "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.4,
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "roughnessFactor": 0.5 },
        "normalTexture": { "index": 1, "texCoord": 1, "scale": 0.5 }, "occlusionTexture": { "index": 1 },
        "emissiveTexture": { "index": 0 }, "emissiveFactor": [0.1, 0.0, 1.0],
    });
    let places: Vec<u16> = (0..n).flat_map(|v| [(v % 256) as u16 * 257, 65535]).collect();
    let first = file.accessor(bytemuck::cast_slice(&places), 5123, "VEC2", n);
    file.json["accessors"][first]["normalized"] = true.into();
    let second = file.floats(&vec![0.25; 2 * n], "VEC2", n);
    let tangents = file.floats(&[0.0, 2.0, 0.0, -1.0].repeat(n), "VEC4", n);
    let colours = file.accessor(&[255, 51, 0, 255].repeat(n), 5121, "VEC4", n);
    file.json["accessors"][colours]["normalized"] = true.into();
    let own = file.floats(&vec![0.0; n], "SCALAR", n);
    // Only vertex 1 moves.
    let (index, moved) = (file.view(&[1, 0, 0, 0]), file.view(bytemuck::cast_slice(&[0.0f32, 7.0, 0.0])));
    let sparse = json!({
        "count": 1, "indices": { "bufferView": index, "componentType": 5121 }, "values": { "bufferView": moved },
    });
    let target = file.push("accessors", json!({ "componentType": 5126, "type": "VEC3", "count": n, "sparse": sparse }));
    for primitive in file.json["meshes"][0]["primitives"].as_array_mut().unwrap() {
        primitive["targets"] = json!([{ "POSITION": target }]);
        primitive["material"] = 0.into();
        let attributes = primitive["attributes"].as_object_mut().unwrap();
        for (name, accessor) in
            [("TEXCOORD_0", first), ("TEXCOORD_1", second), ("TANGENT", tangents), ("COLOR_0", colours)]
        {
            attributes.insert(name.into(), accessor.into());
        }
        attributes.insert("_OWN".into(), own.into());
    }
    file.json["meshes"][0]["weights"] = json!([0.5]);
    let body = file.json["nodes"].as_array().unwrap().iter().position(|n| n["skin"] == 0).unwrap();
    file.json["nodes"][body]["weights"] = json!([0.25]);
    // Glasses: one triangle, places and a number that nobody asks for by turns.
    let corners = [[0.0f32, 0.0, 0.0, 9.0], [10.0, 0.0, 0.0, 9.0], [0.0, 10.0, 0.0, 9.0]].concat();
    let glasses = file.floats(&corners, "VEC3", 3);
    let view = file.json["accessors"][glasses]["bufferView"].as_u64().unwrap() as usize;
    file.json["bufferViews"][view]["byteStride"] = 16.into();
    let glasses = file.push("meshes", json!({ "primitives": [{ "attributes": { "POSITION": glasses } }] }));
    let glasses = file.push("nodes", json!({ "name": "glasses", "mesh": glasses }));
    let head = file.node("mixamorig:Head");
    file.json["nodes"][head]["children"] = json!([glasses]);
    // The node above the hips is a joint of no weight.
    let armature = file.node("Armature");
    let mut binds = file.numbers(&file.json["skins"][0]["inverseBindMatrices"].clone());
    binds.extend_from_slice(&glam::Mat4::IDENTITY.to_cols_array());
    file.json["skins"][0]["joints"].as_array_mut().unwrap().push(armature.into());
    let binds = file.floats(&binds, "MAT4", 23);
    file.json["skins"][0]["inverseBindMatrices"] = binds.into();
    file
}
