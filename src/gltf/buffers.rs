//! Buffers: the binary chunk, data URIs and files beside the glTF file.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};

use base64::Engine;
use gltf_json::{Buffer, Index};

use super::{bad, find};
use crate::{Error, Result};

/// The buffers of one file, loaded when they are asked for.
pub(super) struct Buffers<'a> {
    table: &'a [Buffer],
    binary: Option<&'a [u8]>,
    folder: Option<&'a Path>,
    loaded: BTreeMap<usize, Cow<'a, [u8]>>,
    /// Bytes read so far, of the file and those beside it.
    pub bytes: usize,
}

impl<'a> Buffers<'a> {
    pub fn new(table: &'a [Buffer], binary: Option<&'a [u8]>, bytes: usize, folder: Option<&'a Path>) -> Self {
        Self { table, binary, folder, loaded: BTreeMap::new(), bytes }
    }

    /// # Errors
    /// There is none, or it cannot be read.
    pub fn get(&mut self, index: Index<Buffer>, place: &str) -> Result<&[u8]> {
        if !self.loaded.contains_key(&index.value()) {
            let buffer = find(self.table, index, "buffers", place)?;
            let bytes = self.load(buffer, &format!("buffer {index}"))?;
            self.loaded.insert(index.value(), bytes);
        }
        Ok(&self.loaded[&index.value()])
    }

    fn load(&mut self, buffer: &Buffer, place: &str) -> Result<Cow<'a, [u8]>> {
        let Some(uri) = &buffer.uri else {
            return self.binary.map(Cow::Borrowed).ok_or_else(|| bad(place, "expected a binary chunk, found none"));
        };
        if uri.starts_with("data:") {
            return embedded(uri, place).map(Cow::Owned);
        }
        let bytes = self.beside(uri, buffer.byte_length.0, place)?;
        self.bytes += bytes.len();
        Ok(Cow::Owned(bytes))
    }

    /// The first `length` bytes of a file beside the glTF file.
    fn beside(&self, uri: &str, length: u64, place: &str) -> Result<Vec<u8>> {
        let path = PathBuf::from(percent_decoded(uri));
        let Some(folder) = self.folder else {
            let problem =
                format!("expected all data in the file itself, found a link to {uri:.80}; export as one .glb");
            return Err(bad(place, problem));
        };
        if !path.is_relative() || uri.contains("://") {
            return Err(bad(place, format!("expected a file beside it, found {uri:.80}")));
        }
        let path = folder.join(path);
        let failed = |e: std::io::Error| Error::io(&path, e);
        let file = std::fs::File::open(&path).map_err(failed)?;
        if !file.metadata().map_err(failed)?.is_file() {
            return Err(bad(place, format!("expected a file, found {}", path.display())));
        }
        let mut bytes = Vec::new();
        file.take(length).read_to_end(&mut bytes).map_err(failed)?;
        Ok(bytes)
    }
}

/// The bytes of a data URI.
///
/// # Errors
/// It is none in base64.
pub(crate) fn embedded(uri: &str, place: &str) -> Result<Vec<u8>> {
    let text = uri.strip_prefix("data:").and_then(|data| data.split_once(";base64,")).map(|(_, text)| text);
    let text = text.ok_or_else(|| bad(place, format!("expected data in base64, found {uri:.40}")))?;
    let bytes = base64::engine::general_purpose::STANDARD.decode(text.trim_end());
    bytes.map_err(|e| bad(place, format!("expected data in base64, found {e}")))
}

/// A URI's text with `%20` and the like as the bytes they stand for.
fn percent_decoded(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        let code = tail.get(..2).and_then(|hex| u8::from_str_radix(std::str::from_utf8(hex).ok()?, 16).ok());
        match code.filter(|_| *first == b'%') {
            Some(byte) => (bytes.push(byte), rest = &tail[2..]),
            None => (bytes.push(*first), rest = tail),
        };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
