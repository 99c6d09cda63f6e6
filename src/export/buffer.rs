//! The binary chunk of a GLB: streams of numbers, and the accessors that point into them.

use gltf_json::accessor::{ComponentType, GenericComponentType, Type};
use gltf_json::buffer::{Stride, Target, View};
use gltf_json::validation::{Checked, USize64};
use gltf_json::{Accessor, Index, Root};

/// One buffer view in the making; its accessors follow each other in it.
pub(super) struct Stream {
    view: u32,
    bytes: Vec<u8>,
    target: Option<Target>,
    stride: Option<usize>,
}

impl Stream {
    /// The stream of buffer view number `view`; views must be finished in the order of their numbers.
    pub(super) fn new(view: u32, target: Option<Target>, stride: Option<usize>) -> Self {
        Self { view, bytes: Vec::new(), target, stride }
    }

    /// The stream of the next buffer view; it must be finished before the one after it.
    pub(super) fn next(root: &Root, target: Option<Target>, stride: Option<usize>) -> Self {
        Self::new(root.buffer_views.len() as u32, target, stride)
    }

    /// Appends `values` and an accessor to them. Every element must be a multiple of four bytes.
    pub(super) fn accessor<T: bytemuck::Pod>(
        &mut self,
        root: &mut Root,
        values: &[T],
        component: ComponentType,
        kind: Type,
    ) -> Index<Accessor> {
        let accessor = Accessor {
            buffer_view: Some(Index::new(self.view)),
            byte_offset: Some(USize64::from(self.bytes.len())),
            count: USize64::from(values.len()),
            component_type: Checked::Valid(GenericComponentType(component)),
            type_: Checked::Valid(kind),
            // Integers here are fractions (rotations), except indices.
            normalized: matches!(component, ComponentType::I16),
            extensions: None,
            extras: Default::default(),
            min: None,
            max: None,
            name: None,
            sparse: None,
        };
        self.bytes.extend_from_slice(bytemuck::cast_slice(values));
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        root.push(accessor)
    }

    /// Appends the stream to the binary chunk and its view to the file.
    pub(super) fn finish(self, root: &mut Root, binary: &mut Vec<u8>) {
        debug_assert_eq!(root.buffer_views.len(), self.view as usize);
        root.push(View {
            buffer: Index::new(0),
            byte_length: USize64::from(self.bytes.len()),
            byte_offset: Some(USize64::from(binary.len())),
            byte_stride: self.stride.map(Stride),
            name: None,
            target: self.target.map(Checked::Valid),
            extensions: None,
            extras: Default::default(),
        });
        binary.extend(self.bytes);
    }
}

/// Header, JSON chunk and binary chunk as one GLB file (glTF 2.0, section 4).
pub(super) fn assemble(root: &Root, binary: Vec<u8>) -> Vec<u8> {
    let mut json = serde_json::to_vec(root).expect("glTF is plain data");
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + json.len() + if binary.is_empty() { 0 } else { 8 + binary.len() };
    let mut out = Vec::with_capacity(length);
    let word = |out: &mut Vec<u8>, v: usize| out.extend_from_slice(&(v as u32).to_le_bytes());
    out.extend_from_slice(b"glTF");
    word(&mut out, 2);
    word(&mut out, length);
    word(&mut out, json.len());
    out.extend_from_slice(b"JSON");
    out.extend_from_slice(&json);
    if !binary.is_empty() {
        word(&mut out, binary.len());
        out.extend_from_slice(b"BIN\0");
        out.extend_from_slice(&binary);
    }
    out
}
