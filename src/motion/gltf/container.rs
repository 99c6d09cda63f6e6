//! The parts of a glTF file: its JSON, and the binary chunk of a GLB.

use gltf_json::{Accessor, Animation, Buffer, Node, Skin, buffer::View};

use crate::{Error, Result};

pub(super) fn bad(place: impl Into<String>, problem: impl Into<String>) -> Error {
    Error::invalid("glTF", place, problem)
}

/// What is read of the JSON; meshes, materials and all else may be as they like.
#[derive(Debug, serde::Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Document {
    asset: Asset,
    #[serde(default)]
    pub accessors: Vec<Accessor>,
    #[serde(default)]
    pub animations: Vec<Animation>,
    #[serde(default)]
    pub buffers: Vec<Buffer>,
    #[serde(default)]
    pub buffer_views: Vec<View>,
    #[serde(default)]
    pub nodes: Vec<Node>,
    #[serde(default)]
    pub skins: Vec<Skin>,
    #[serde(default)]
    extensions_required: Vec<String>,
}

#[derive(Debug, serde::Deserialize)]
struct Asset {
    version: String,
}

/// The JSON and the binary chunk, where there is one.
pub(super) fn open(bytes: &[u8]) -> Result<(Document, Option<&[u8]>)> {
    let (json, binary) = if bytes.starts_with(b"glTF") { chunks(bytes)? } else { (bytes, None) };
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    let root: Document = serde_json::from_slice(json)
        .map_err(|e| bad(format!("JSON line {} column {}", e.line(), e.column()), e.to_string()))?;
    if !root.asset.version.starts_with("2.") {
        return Err(bad("asset", format!("expected version 2, found '{}'", root.asset.version)));
    }
    let packed = root.extensions_required.iter().find(|e| e.ends_with("meshopt_compression"));
    match packed {
        Some(extension) => Err(bad("extensionsRequired", format!("expected plain buffers, found {extension}"))),
        None => Ok((root, binary)),
    }
}

fn word(bytes: &[u8], at: usize) -> Option<usize> {
    let word = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes(word.try_into().ok()?) as usize)
}

/// The chunks of a GLB (glTF 2.0, section 4): JSON, and binary where there is some.
///
/// # Errors
/// The container is not version 2, or ends early.
pub(crate) fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>)> {
    let version = word(bytes, 4).unwrap_or(0);
    if version != 2 {
        return Err(bad("byte 4", format!("expected version 2 of the container, found {version}")));
    }
    let chunk = |at: usize, what: &str| -> Result<(&[u8], &[u8], usize)> {
        let end = || bad(format!("byte {at}"), format!("expected {what}, found the end of the file"));
        let length = word(bytes, at).ok_or_else(end)?;
        let kind = bytes.get(at + 4..at + 8).ok_or_else(end)?;
        let data = bytes.get(at + 8..(at + 8).saturating_add(length)).ok_or_else(end)?;
        Ok((kind, data, at + 8 + length))
    };
    let (kind, json, mut at) = chunk(12, "a chunk of JSON")?;
    if kind != b"JSON" {
        return Err(bad("byte 16", "expected a chunk of JSON, found another"));
    }
    while at < bytes.len() {
        let (kind, data, next) = chunk(at, "a whole chunk")?;
        if kind == b"BIN\0" {
            return Ok((json, Some(data)));
        }
        at = next;
    }
    Ok((json, None))
}
