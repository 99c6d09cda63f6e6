//! The numbers of accessors, from the binary chunk, data URIs and files beside the glTF file. Every range is checked;
//! what is decoded stays in proportion to what was read.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use base64::Engine;
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::buffer::View;
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Index};

use super::container::{Document, bad};
use crate::{Error, Result};

/// Decoded floats allowed per byte read: bytes become floats, and a little is shared between accessors.
const FLOATS_PER_BYTE: usize = 8;

/// Reads accessors of one file.
pub(super) struct Data<'a> {
    root: &'a Document,
    binary: Option<&'a [u8]>,
    folder: Option<&'a Path>,
    buffers: BTreeMap<usize, Cow<'a, [u8]>>,
    decoded: BTreeMap<usize, Rc<[f32]>>,
    /// Floats that may still be decoded.
    budget: usize,
    /// Bytes read so far, of the file and those beside it.
    pub bytes: usize,
}

impl<'a> Data<'a> {
    /// `folder` is where files beside it lie; without one they are refused.
    pub fn new(root: &'a Document, binary: Option<&'a [u8]>, bytes: usize, folder: Option<&'a Path>) -> Self {
        let budget = bytes.saturating_mul(FLOATS_PER_BYTE);
        Self { root, binary, folder, buffers: BTreeMap::new(), decoded: BTreeMap::new(), budget, bytes }
    }

    /// All numbers of an accessor, `width` to an element; normalised integers as fractions.
    pub fn floats(&mut self, index: Index<Accessor>, kinds: &[Type]) -> Result<Rc<[f32]>> {
        let at = index.value();
        let place = format!("accessor {at}");
        let root = self.root;
        let accessor = root.accessors.get(at).ok_or_else(|| bad(&place, "expected an accessor, found none"))?;
        let kind = match accessor.type_ {
            Checked::Valid(kind) if kinds.contains(&kind) => kind,
            found => return Err(bad(place, format!("expected {kinds:?}, found {found:?}"))),
        };
        if let Some(known) = self.decoded.get(&at) {
            return Ok(known.clone());
        }
        let decoded: Rc<[f32]> = self.decode(accessor, kind, &place)?.into();
        self.decoded.insert(at, decoded.clone());
        Ok(decoded)
    }

    fn decode(&mut self, accessor: &Accessor, kind: Type, place: &str) -> Result<Vec<f32>> {
        let Checked::Valid(component) = accessor.component_type else {
            return Err(bad(place, "expected a known component type, found another"));
        };
        let (component, width) = (component.0, kind.multiplicity());
        let mut values = match accessor.buffer_view {
            Some(view) => {
                let count = accessor.count.0;
                let offset = accessor.byte_offset.map_or(0, |o| o.0);
                self.elements(view, offset, count, component, width, accessor.normalized, place)?
            }
            None => {
                let count = usize::try_from(accessor.count.0).unwrap_or(usize::MAX).saturating_mul(width);
                self.spend(count, place)?;
                vec![0.0; count]
            }
        };
        if let Some(sparse) = &accessor.sparse {
            let Checked::Valid(index_kind) = sparse.indices.component_type else {
                return Err(bad(place, "expected sparse indices of a known type, found another"));
            };
            let (count, offset) = (sparse.count.0, sparse.indices.byte_offset.0);
            let indices = self.elements(sparse.indices.buffer_view, offset, count, index_kind.0, 1, false, place)?;
            let offset = sparse.values.byte_offset.0;
            let normalized = accessor.normalized;
            let with = self.elements(sparse.values.buffer_view, offset, count, component, width, normalized, place)?;
            for (&index, element) in indices.iter().zip(with.chunks_exact(width)) {
                let first = index as usize * width;
                let target = values.get_mut(first..first + width);
                let target = target
                    .ok_or_else(|| bad(place, format!("expected sparse indices below its count, found {index}")))?;
                target.copy_from_slice(element);
            }
        }
        Ok(values)
    }

    fn spend(&mut self, floats: usize, place: &str) -> Result<()> {
        let left = self.budget.checked_sub(floats);
        self.budget =
            left.ok_or_else(|| bad(place, "expected accessors of no more data than the file's, found more"))?;
        Ok(())
    }

    #[expect(clippy::too_many_arguments, reason = "an accessor, or one of the two halves of a sparse one")]
    fn elements(
        &mut self,
        view: Index<View>,
        offset: u64,
        count: u64,
        component: ComponentType,
        width: usize,
        normalized: bool,
        place: &str,
    ) -> Result<Vec<f32>> {
        let size = component.size();
        let count = usize::try_from(count).unwrap_or(usize::MAX);
        self.spend(count.saturating_mul(width), place)?;
        let (bytes, stride) = self.view(view, place)?;
        let stride = stride.unwrap_or(size * width).max(1);
        let offset = usize::try_from(offset).unwrap_or(usize::MAX);
        let needed = match count {
            0 => offset,
            n => (n - 1).saturating_mul(stride).saturating_add(size * width).saturating_add(offset),
        };
        if needed > bytes.len() {
            let problem = format!("expected {needed} bytes of its buffer view, found {}", bytes.len());
            return Err(bad(place, problem));
        }
        let mut values = Vec::with_capacity(count * width);
        for element in bytes[offset..].chunks(stride).take(count) {
            values.extend(element.chunks_exact(size).take(width).map(|c| value(c, component, normalized)));
        }
        Ok(values)
    }

    fn view(&mut self, index: Index<View>, place: &str) -> Result<(&[u8], Option<usize>)> {
        let root = self.root;
        let at = index.value();
        let view =
            root.buffer_views.get(at).ok_or_else(|| bad(place, format!("expected buffer view {at}, found none")))?;
        let begin = usize::try_from(view.byte_offset.map_or(0, |o| o.0)).unwrap_or(usize::MAX);
        let end = begin.saturating_add(usize::try_from(view.byte_length.0).unwrap_or(usize::MAX));
        let buffer = self.buffer(view.buffer.value())?;
        let found = buffer.len();
        let bytes = buffer.get(begin..end).ok_or_else(|| {
            bad(format!("buffer view {at}"), format!("expected a buffer of {end} bytes, found {found}"))
        })?;
        Ok((bytes, view.byte_stride.map(|s| s.0)))
    }

    fn buffer(&mut self, index: usize) -> Result<&[u8]> {
        if !self.buffers.contains_key(&index) {
            let buffer = self.load(index)?;
            self.buffers.insert(index, buffer);
        }
        Ok(&self.buffers[&index])
    }

    fn load(&mut self, index: usize) -> Result<Cow<'a, [u8]>> {
        let place = format!("buffer {index}");
        let buffer = self.root.buffers.get(index).ok_or_else(|| bad(&place, "expected a buffer, found none"))?;
        let Some(uri) = &buffer.uri else {
            return self.binary.map(Cow::Borrowed).ok_or_else(|| bad(&place, "expected a binary chunk, found none"));
        };
        if let Some(data) = uri.strip_prefix("data:") {
            let text = data.split_once(";base64,").map(|(_, text)| text);
            let text = text.ok_or_else(|| bad(&place, "expected data in base64, found another encoding"))?;
            let bytes = base64::engine::general_purpose::STANDARD.decode(text.trim_end());
            return bytes.map(Cow::Owned).map_err(|e| bad(place, format!("expected data in base64, found {e}")));
        }
        let bytes = self.beside(uri, buffer.byte_length.0, &place)?;
        self.bytes += bytes.len();
        self.budget = self.budget.saturating_add(bytes.len().saturating_mul(FLOATS_PER_BYTE));
        Ok(Cow::Owned(bytes))
    }

    /// The first `length` bytes of a file beside the glTF file.
    fn beside(&self, uri: &str, length: u64, place: &str) -> Result<Vec<u8>> {
        let path = PathBuf::from(percent_decoded(uri));
        let folder = self.folder.filter(|_| path.is_relative() && !uri.contains("://"));
        let folder = folder.ok_or_else(|| bad(place, format!("expected a file beside it, found {uri:.80}")))?;
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

/// One number, little-endian; normalised integers as fractions (glTF 2.0, section 3.6.2.2).
fn value(bytes: &[u8], component: ComponentType, normalized: bool) -> f32 {
    let (value, full) = match (component, bytes) {
        (ComponentType::I8, &[a, ..]) => (f32::from(a as i8), 127.0),
        (ComponentType::U8, &[a, ..]) => (f32::from(a), 255.0),
        (ComponentType::I16, &[a, b, ..]) => (f32::from(i16::from_le_bytes([a, b])), 32767.0),
        (ComponentType::U16, &[a, b, ..]) => (f32::from(u16::from_le_bytes([a, b])), 65535.0),
        (ComponentType::U32, &[a, b, c, d, ..]) => return u32::from_le_bytes([a, b, c, d]) as f32,
        (ComponentType::F32, &[a, b, c, d, ..]) => return f32::from_le_bytes([a, b, c, d]),
        _ => return 0.0,
    };
    if normalized { (value / full).max(-1.0) } else { value }
}
