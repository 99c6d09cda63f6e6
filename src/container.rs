//! The container of the project's binary files (patch sets, crowds): readable with a dozen lines of
//! JavaScript or Python, loaded without parsing numbers.
//!
//! ```text
//! 8 bytes   magic, e.g. "CQCROWD\0" or "CQPATCH\0"
//! u32 LE    version of that kind of file
//! u32 LE    length of the JSON header in bytes (padded with spaces to a multiple of 8)
//! u64 LE    length of the data in bytes
//! JSON      { ..., "arrays": { name: { "type": "f32|i16|u32|i32|u8", "offset": bytes into the data, "count": elements } } }
//! data      little-endian arrays, each at a multiple of 8 bytes
//! ```

use std::collections::BTreeMap;
use std::path::Path;

use crate::{Error, Result};

/// Numbers that may stand in an array of a container.
pub trait Element: bytemuck::Pod {
    /// The name in the header.
    const NAME: &'static str;
}
impl Element for f32 {
    const NAME: &'static str = "f32";
}
impl Element for i16 {
    const NAME: &'static str = "i16";
}
impl Element for u32 {
    const NAME: &'static str = "u32";
}
impl Element for i32 {
    const NAME: &'static str = "i32";
}
impl Element for u8 {
    const NAME: &'static str = "u8";
}

#[derive(Debug, serde::Serialize, serde::Deserialize)]
struct ArrayInfo {
    #[serde(rename = "type")]
    element: String,
    offset: usize,
    count: usize,
}

const PRELUDE: usize = 24;
const ALIGN: usize = 8;

/// Collects arrays, then writes the file.
#[derive(Default)]
pub struct Writer {
    arrays: BTreeMap<String, ArrayInfo>,
    data: Vec<u8>,
}

impl Writer {
    /// Adds an array under `name`.
    pub fn array<T: Element>(&mut self, name: &str, values: &[T]) {
        self.data.resize(self.data.len().next_multiple_of(ALIGN), 0);
        let info = ArrayInfo { element: T::NAME.into(), offset: self.data.len(), count: values.len() };
        self.arrays.insert(name.into(), info);
        self.data.extend_from_slice(bytemuck::cast_slice(values));
    }

    /// The whole file. `header` must serialise to a JSON object; `arrays` is added to it.
    pub fn finish(self, magic: &[u8; 8], version: u32, header: &impl serde::Serialize) -> Vec<u8> {
        let mut json = serde_json::to_value(header).expect("headers are plain data");
        json["arrays"] = serde_json::to_value(&self.arrays).expect("plain data");
        let mut text = json.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(ALIGN), b' ');
        let mut bytes = Vec::with_capacity(PRELUDE + text.len() + self.data.len());
        bytes.extend_from_slice(magic);
        bytes.extend_from_slice(&version.to_le_bytes());
        bytes.extend_from_slice(&(text.len() as u32).to_le_bytes());
        bytes.extend_from_slice(&(self.data.len() as u64).to_le_bytes());
        bytes.extend_from_slice(&text);
        bytes.extend_from_slice(&self.data);
        bytes
    }
}

/// A container in memory, checked as a whole when opened.
pub struct Reader<'a> {
    header: serde_json::Value,
    arrays: BTreeMap<String, ArrayInfo>,
    data: &'a [u8],
}

impl<'a> Reader<'a> {
    /// Opens a container.
    ///
    /// # Errors
    /// Wrong magic, a version that is not among `versions`, cut or overlong bytes, a header that is no JSON object, arrays
    /// outside the data.
    pub fn open(bytes: &'a [u8], magic: &[u8; 8], versions: std::ops::RangeInclusive<u32>) -> Result<Self> {
        let what = String::from_utf8_lossy(&magic[..7]).into_owned();
        let bad = |place: &str, problem: String| Error::invalid(what.clone(), place, problem);
        if bytes.len() < PRELUDE || &bytes[..8] != magic {
            return Err(bad(
                "byte 0",
                format!(
                    "expected the magic bytes {:?}, found {:?}",
                    what,
                    String::from_utf8_lossy(&bytes[..bytes.len().min(7)])
                ),
            ));
        }
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("4 bytes"));
        if !versions.contains(&word(8)) {
            let (from, to) = (versions.start(), versions.end());
            let expected = if from == to { format!("version {to}") } else { format!("version {from} to {to}") };
            return Err(bad("byte 8", format!("expected {expected}, found {}", word(8))));
        }
        let header_len = word(12) as usize;
        let data_len = u64::from_le_bytes(bytes[16..24].try_into().expect("8 bytes")) as usize;
        let expected = PRELUDE.checked_add(header_len).and_then(|n| n.checked_add(data_len));
        if expected != Some(bytes.len()) {
            return Err(bad("byte 12", format!("expected {expected:?} bytes in all, found {}", bytes.len())));
        }
        let header: serde_json::Value = serde_json::from_slice(&bytes[PRELUDE..PRELUDE + header_len])
            .map_err(|e| bad("header", format!("expected a JSON object: {e}")))?;
        let arrays: BTreeMap<String, ArrayInfo> = serde_json::from_value(header["arrays"].clone())
            .map_err(|e| bad("header.arrays", format!("expected a table of arrays: {e}")))?;
        Ok(Self { header, arrays, data: &bytes[PRELUDE + header_len..] })
    }

    /// The header as plain data.
    ///
    /// # Errors
    /// Names the field that is missing or of another type.
    pub fn header<T: serde::de::DeserializeOwned>(&self) -> Result<T> {
        serde_json::from_value(self.header.clone()).map_err(|e| Error::invalid("container", "header", e.to_string()))
    }

    /// Whether there is an array `name`.
    pub fn has(&self, name: &str) -> bool {
        self.arrays.contains_key(name)
    }

    /// The array `name`, copied out.
    ///
    /// # Errors
    /// It is missing, of another type, or lies outside the data.
    pub fn array<T: Element>(&self, name: &str) -> Result<Vec<T>> {
        let bad = |problem: String| Error::invalid("container", format!("array {name}"), problem);
        let info = self.arrays.get(name).ok_or_else(|| bad("expected, not found".into()))?;
        if info.element != T::NAME {
            return Err(bad(format!("expected type {}, found {}", T::NAME, info.element)));
        }
        let range = info.count.checked_mul(size_of::<T>()).and_then(|n| Some(info.offset..info.offset.checked_add(n)?));
        let bytes = range.and_then(|r| self.data.get(r)).ok_or_else(|| bad("lies outside the data".into()))?;
        Ok(bytemuck::allocation::pod_collect_to_vec(bytes))
    }
}

/// Writes `bytes` to `path` so that a reader sees the old file or the new one, never half of it.
///
/// # Errors
/// What the operating system says; nothing half-written stays behind.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    let part = path.with_file_name(name);
    std::fs::write(&part, bytes).and_then(|()| std::fs::rename(&part, path)).map_err(|e| {
        let _ = std::fs::remove_file(&part);
        Error::io(path, e)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Vec<u8> {
        let mut w = Writer::default();
        w.array("a", &[1.0f32, 2.0, 3.0]);
        w.array("b", &[7u8]);
        w.array("c", &[-5i16, 6]);
        w.finish(b"CQTEST\0\0", 3, &serde_json::json!({"name": "x"}))
    }

    #[test]
    fn round_trip() {
        let bytes = sample();
        let r = Reader::open(&bytes, b"CQTEST\0\0", 1..=3).unwrap();
        assert_eq!(r.array::<f32>("a").unwrap(), [1.0, 2.0, 3.0]);
        assert_eq!(r.array::<i16>("c").unwrap(), [-5, 6]);
        assert!(r.array::<f32>("c").is_err());
    }

    #[test]
    fn cut_at_every_length_and_extended_is_an_error() {
        let bytes = sample();
        for n in 0..bytes.len() {
            assert!(Reader::open(&bytes[..n], b"CQTEST\0\0", 1..=3).is_err(), "cut at {n}");
        }
        let mut longer = bytes.clone();
        longer.push(0);
        assert!(Reader::open(&longer, b"CQTEST\0\0", 1..=3).is_err());
        assert!(Reader::open(&bytes, b"CQTEST\0\0", 4..=4).is_err());
        assert!(Reader::open(&bytes, b"CQTEST\0\0", 1..=2).is_err());
        assert!(Reader::open(&bytes, b"CQOTHER\0", 1..=3).is_err());
    }
}
