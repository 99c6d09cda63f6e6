//! The numbers of accessors. Every range is checked; what is decoded stays in proportion to what was read.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;
use std::rc::Rc;

use gltf_json::accessor::{ComponentType, Type};
use gltf_json::buffer::View;
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Buffer, Index};

use super::buffers::Buffers;
use super::{bad, find};
use crate::Result;

/// Decoded floats allowed per byte read: bytes become floats, and a little is shared between accessors.
const FLOATS_PER_BYTE: usize = 8;

/// What leads to a file's numbers.
#[derive(Clone, Copy)]
pub(crate) struct Tables<'a> {
    pub accessors: &'a [Accessor],
    pub views: &'a [View],
    pub buffers: &'a [Buffer],
}

/// The numbers that an accessor may hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Numbers {
    /// Any, normalised integers as fractions.
    Any,
    Floats,
    /// Floats, or normalised integers without a sign.
    Fractions,
    /// Integers without a sign, of at most so many bytes.
    Whole(usize),
}

impl Numbers {
    fn allow(self, component: ComponentType, normalized: bool) -> bool {
        use ComponentType::{F32, U8, U16, U32};
        match self {
            Self::Any => true,
            Self::Floats => component == F32,
            Self::Fractions => component == F32 || (normalized && matches!(component, U8 | U16)),
            Self::Whole(most) => !normalized && matches!(component, U8 | U16 | U32) && component.size() <= most,
        }
    }
}

impl fmt::Display for Numbers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Any => f.write_str("numbers"),
            Self::Floats => f.write_str("floats"),
            Self::Fractions => f.write_str("floats or normalised integers"),
            Self::Whole(most) => write!(f, "whole numbers of at most {most} bytes"),
        }
    }
}

/// The numbers of an accessor, one element after the other; normalised integers as fractions.
pub(crate) struct Elements {
    pub kind: Type,
    pub values: Rc<[f32]>,
}

/// Reads accessors of one file.
pub(crate) struct Data<'a> {
    accessors: &'a [Accessor],
    views: &'a [View],
    buffers: Buffers<'a>,
    decoded: BTreeMap<usize, Rc<[f32]>>,
    /// Floats in memory.
    spent: usize,
}

/// Elements one after the other in a buffer view: an accessor's, or one of the two halves of a sparse one.
struct Run {
    view: Index<View>,
    offset: u64,
    count: u64,
    component: ComponentType,
    width: usize,
}

impl<'a> Data<'a> {
    /// `folder` is where files beside it lie; without one they are refused.
    pub fn new(tables: Tables<'a>, binary: Option<&'a [u8]>, bytes: usize, folder: Option<&'a Path>) -> Self {
        let buffers = Buffers::new(tables.buffers, binary, bytes, folder);
        Self { accessors: tables.accessors, views: tables.views, buffers, decoded: BTreeMap::new(), spent: 0 }
    }

    /// All numbers of an accessor. `place` is where it is asked for.
    ///
    /// # Errors
    /// There is none, it holds something else, or it reaches beyond its data.
    pub fn floats(
        &mut self,
        index: Index<Accessor>,
        kinds: &[Type],
        numbers: Numbers,
        place: &str,
    ) -> Result<Elements> {
        let (accessor, place) = self.accessor(index, kinds, numbers, place)?;
        let kind = accessor.type_.unwrap();
        if let Some(known) = self.decoded.get(&index.value()) {
            return Ok(Elements { kind, values: known.clone() });
        }
        let values: Rc<[f32]> = self.decode(accessor, &place, float)?.into();
        self.decoded.insert(index.value(), values.clone());
        Ok(Elements { kind, values })
    }

    /// As [`Self::floats`], for whole numbers of at most `most` bytes each.
    ///
    /// # Errors
    /// As [`Self::floats`].
    pub fn integers(&mut self, index: Index<Accessor>, kind: Type, most: usize, place: &str) -> Result<Vec<u32>> {
        let (accessor, place) = self.accessor(index, &[kind], Numbers::Whole(most), place)?;
        self.decode(accessor, &place, |bytes, component, _| integer(bytes, component))
    }

    /// An accessor of the right type, and its own place.
    fn accessor(
        &self,
        index: Index<Accessor>,
        kinds: &[Type],
        numbers: Numbers,
        place: &str,
    ) -> Result<(&'a Accessor, String)> {
        let accessor = find(self.accessors, index, "accessors", place)?;
        let place = format!("{place}, accessor {index}");
        let fits = |kind, component| kinds.contains(&kind) && numbers.allow(component, accessor.normalized);
        let found = match (accessor.type_, accessor.component_type) {
            (Checked::Valid(kind), Checked::Valid(component)) if fits(kind, component.0) => {
                return Ok((accessor, place));
            }
            (Checked::Valid(kind), Checked::Valid(component)) if accessor.normalized => {
                format!("{kind:?} of normalised {:?}", component.0)
            }
            (Checked::Valid(kind), Checked::Valid(component)) => format!("{kind:?} of {:?}", component.0),
            _ => "a type that glTF does not know".into(),
        };
        Err(bad(place, format!("expected {kinds:?} of {numbers}, found {found}")))
    }

    /// The elements of an accessor whose types are known to be valid.
    fn decode<T: Copy + Default>(
        &mut self,
        accessor: &Accessor,
        place: &str,
        number: fn(&[u8], ComponentType, bool) -> T,
    ) -> Result<Vec<T>> {
        let (component, width) = (accessor.component_type.unwrap().0, accessor.type_.unwrap().multiplicity());
        let plain = |bytes: &[u8]| number(bytes, component, accessor.normalized);
        let mut values = match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.map_or(0, |o| o.0);
                self.run(Run { view, offset, count: accessor.count.0, component, width }, place, plain)?
            }
            None => {
                let count = size(accessor.count.0).saturating_mul(width);
                self.spend(count, place)?;
                vec![T::default(); count]
            }
        };
        let Some(sparse) = &accessor.sparse else { return Ok(values) };
        let Checked::Valid(kind) = sparse.indices.component_type else {
            return Err(bad(place, "expected sparse indices of a known type, found another"));
        };
        let (indices, others, count) = (&sparse.indices, &sparse.values, sparse.count.0);
        let (view, offset) = (indices.buffer_view, indices.byte_offset.0);
        let run = Run { view, offset, count, component: kind.0, width: 1 };
        let indices = self.run(run, place, |bytes| integer(bytes, kind.0))?;
        let (view, offset) = (others.buffer_view, others.byte_offset.0);
        let with = self.run(Run { view, offset, count, component, width }, place, plain)?;
        for (&index, element) in indices.iter().zip(with.chunks_exact(width)) {
            let first = (index as usize).saturating_mul(width);
            let target = values.get_mut(first..first.saturating_add(width));
            let beyond = || bad(place, format!("expected sparse indices below its count, found {index}"));
            target.ok_or_else(beyond)?.copy_from_slice(element);
        }
        Ok(values)
    }

    /// Takes note of so many more floats in memory; what others make of the numbers counts as well.
    ///
    /// # Errors
    /// The file is too small for so many.
    pub fn spend(&mut self, floats: usize, place: &str) -> Result<()> {
        self.spent = self.spent.saturating_add(floats);
        if self.spent <= self.bytes().saturating_mul(FLOATS_PER_BYTE) {
            return Ok(());
        }
        Err(bad(place, "expected accessors of no more data than the file's, found more"))
    }

    /// Bytes read so far, of the file and those beside it.
    pub fn bytes(&self) -> usize {
        self.buffers.bytes
    }

    fn run<T>(&mut self, run: Run, place: &str, number: impl Fn(&[u8]) -> T) -> Result<Vec<T>> {
        let (length, count, offset) = (run.component.size(), size(run.count), size(run.offset));
        let element = length * run.width;
        // Files beside it count once they are loaded.
        self.view(run.view, place)?;
        self.spend(count.saturating_mul(run.width), place)?;
        let (bytes, stride) = self.view(run.view, place)?;
        let stride = stride.unwrap_or(element);
        if stride < element {
            return Err(bad(place, format!("expected elements at least {element} bytes apart, found {stride}")));
        }
        let needed = match count {
            0 => offset,
            n => (n - 1).saturating_mul(stride).saturating_add(element).saturating_add(offset),
        };
        if needed > bytes.len() {
            let problem = format!("expected {needed} bytes of its buffer view, found {}", bytes.len());
            return Err(bad(place, problem));
        }
        let mut values = Vec::with_capacity(count * run.width);
        for element in bytes[offset..].chunks(stride).take(count) {
            values.extend(element.chunks_exact(length).take(run.width).map(&number));
        }
        Ok(values)
    }

    /// The bytes of a buffer view, and how far apart their elements are.
    ///
    /// # Errors
    /// There is none, or it reaches beyond its buffer.
    pub fn view(&mut self, index: Index<View>, place: &str) -> Result<(&[u8], Option<usize>)> {
        let view = find(self.views, index, "buffer views", place)?;
        let begin = size(view.byte_offset.map_or(0, |o| o.0));
        let end = begin.saturating_add(size(view.byte_length.0));
        let place = format!("buffer view {index}");
        let buffer = self.buffers.get(view.buffer, &place)?;
        let beyond = || bad(&place, format!("expected a buffer of {end} bytes, found {}", buffer.len()));
        Ok((buffer.get(begin..end).ok_or_else(beyond)?, view.byte_stride.map(|s| s.0)))
    }
}

fn size(n: u64) -> usize {
    usize::try_from(n).unwrap_or(usize::MAX)
}

/// One number, little-endian; normalised integers as fractions (glTF 2.0, section 3.6.2.2).
fn float(bytes: &[u8], component: ComponentType, normalized: bool) -> f32 {
    let (value, full) = match (component, bytes) {
        (ComponentType::I8, &[a, ..]) => (f32::from(a as i8), 127.0),
        (ComponentType::I16, &[a, b, ..]) => (f32::from(i16::from_le_bytes([a, b])), 32767.0),
        (ComponentType::F32, &[a, b, c, d, ..]) => return f32::from_le_bytes([a, b, c, d]),
        (ComponentType::U8, _) => (integer(bytes, component) as f32, 255.0),
        (ComponentType::U16, _) => (integer(bytes, component) as f32, 65535.0),
        _ => return integer(bytes, component) as f32,
    };
    if normalized { (value / full).max(-1.0) } else { value }
}

/// One whole number without a sign, little-endian.
fn integer(bytes: &[u8], component: ComponentType) -> u32 {
    match (component, bytes) {
        (ComponentType::U8, &[a, ..]) => a.into(),
        (ComponentType::U16, &[a, b, ..]) => u16::from_le_bytes([a, b]).into(),
        (ComponentType::U32, &[a, b, c, d, ..]) => u32::from_le_bytes([a, b, c, d]),
        _ => 0,
    }
}
