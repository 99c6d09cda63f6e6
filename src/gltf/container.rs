//! The parts of a glTF file: its JSON, and the binary chunk of a GLB.

use gltf_json::Asset;
use serde::de::DeserializeOwned;

use super::bad;
use crate::Result;

/// The JSON as whatever is wanted of it, and the binary chunk, where there is one.
///
/// # Errors
/// The container is not whole, or the JSON not what it must be.
pub(crate) fn open<T: DeserializeOwned>(bytes: &[u8]) -> Result<(T, Option<&[u8]>)> {
    let (json, binary) = if bytes.starts_with(b"glTF") { chunks(bytes)? } else { (bytes, None) };
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    let root = serde_json::from_slice(json)
        .map_err(|e| bad(format!("JSON line {} column {}", e.line(), e.column()), e.to_string()))?;
    Ok((root, binary))
}

/// # Errors
/// The file is of another version of glTF.
pub(crate) fn version(asset: &Asset) -> Result<()> {
    if asset.version.starts_with("2.") {
        return Ok(());
    }
    Err(bad("asset", format!("expected version 2, found '{}'", asset.version)))
}

fn word(bytes: &[u8], at: usize) -> Option<usize> {
    let word = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes(word.try_into().ok()?) as usize)
}

/// The chunks of a GLB (glTF 2.0, section 4): JSON, and binary where there is some.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>)> {
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
