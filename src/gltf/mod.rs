//! glTF 2.0 files taken apart, for captures, characters and floors alike: the container, the tree of nodes, and the numbers that
//! accessors stand for. Every reference is followed through [`find`], every range is checked.

mod buffers;
mod container;
mod data;
mod nodes;

use gltf_json::Index;

use crate::{Error, Result};

pub(crate) use buffers::embedded;
pub(crate) use container::{open, version};
pub(crate) use data::{Data, Numbers, Tables};
pub(crate) use nodes::{from_the_top, local};

pub(crate) fn bad(place: impl Into<String>, problem: impl Into<String>) -> Error {
    Error::invalid("glTF", place, problem)
}

/// What an index leads to; `place` is where the index is written.
///
/// # Errors
/// There is no such thing.
pub(crate) fn find<'a, T>(all: &'a [T], index: Index<T>, things: &str, place: &str) -> Result<&'a T> {
    let missing = || bad(place, format!("expected one of {} {things}, found number {index}", all.len()));
    all.get(index.value()).ok_or_else(missing)
}
