//! A reader of GLB files for tests, and a writer.

use serde_json::Value;

/// A GLB taken apart.
pub struct Glb {
    /// Its JSON.
    pub json: Value,
    /// Its binary chunk.
    pub binary: Vec<u8>,
}

impl Glb {
    /// From the bytes of a file.
    pub fn open(bytes: &[u8]) -> Self {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!(&bytes[..4], b"glTF");
        assert_eq!((word(4), word(8)), (2, bytes.len()));
        let json = word(12);
        assert_eq!(&bytes[16..20], b"JSON");
        assert_eq!(&bytes[24 + json..28 + json], b"BIN\0");
        assert_eq!(word(20 + json), bytes.len() - 28 - json);
        Self { json: serde_json::from_slice(&bytes[20..20 + json]).unwrap(), binary: bytes[28 + json..].to_vec() }
    }

    /// The numbers of an accessor; normalised shorts as fractions.
    pub fn numbers(&self, accessor: &Value) -> Vec<f32> {
        let accessor = &self.json["accessors"][accessor.as_u64().unwrap() as usize];
        let view = &self.json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let at = |v: &Value| v["byteOffset"].as_u64().unwrap_or(0) as usize;
        let width = match accessor["type"].as_str().unwrap() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "MAT4" => 16,
            _ => 4,
        };
        let count = accessor["count"].as_u64().unwrap() as usize * width;
        let bytes = &self.binary[at(view) + at(accessor)..];
        match accessor["componentType"].as_u64().unwrap() {
            5126 => bytes.chunks_exact(4).take(count).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect(),
            5122 => bytes
                .chunks_exact(2)
                .take(count)
                .map(|b| (i16::from_le_bytes(b.try_into().unwrap()) as f32 / 32767.0).max(-1.0))
                .collect(),
            other => panic!("component type {other}"),
        }
    }

    /// Index of the node of that name.
    pub fn node(&self, name: &str) -> usize {
        self.json["nodes"].as_array().unwrap().iter().position(|n| n["name"] == name).unwrap()
    }

    /// Times and values of the channel that drives `path` of the node `name`.
    #[allow(dead_code)]
    pub fn channel(&self, name: &str, path: &str) -> Option<(Vec<f32>, Vec<f32>, String)> {
        let animation = &self.json["animations"][0];
        let node = self.node(name);
        let channel = animation["channels"].as_array().unwrap().iter();
        let mut found = channel.filter(|c| c["target"]["node"] == node && c["target"]["path"] == path);
        let sampler = &animation["samplers"][found.next()?["sampler"].as_u64().unwrap() as usize];
        assert!(found.next().is_none(), "two channels drive {name}.{path}");
        let interpolation = sampler["interpolation"].as_str().unwrap_or("LINEAR").to_owned();
        Some((self.numbers(&sampler["input"]), self.numbers(&sampler["output"]), interpolation))
    }
}

/// The file with that JSON and binary chunk.
#[allow(dead_code)]
pub fn write(json: &Value, binary: &[u8]) -> Vec<u8> {
    let mut text = serde_json::to_vec(json).unwrap();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut out = b"glTF".to_vec();
    let word = |out: &mut Vec<u8>, v: usize| out.extend_from_slice(&(v as u32).to_le_bytes());
    word(&mut out, 2);
    word(&mut out, 28 + text.len() + binary.len());
    word(&mut out, text.len());
    out.extend_from_slice(b"JSON");
    out.extend_from_slice(&text);
    word(&mut out, binary.len());
    out.extend_from_slice(b"BIN\0");
    out.extend_from_slice(binary);
    out
}
