//! glTF 2.0, text and binary: skinned people or plain animated nodes.

mod animation;
mod container;
mod data;
mod scene;
#[cfg(test)]
mod tests;

pub(crate) use container::chunks;
pub(crate) use scene::{Source, read};
