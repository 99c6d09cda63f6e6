//! glTF 2.0, text and binary: skinned people or plain animated nodes.

mod animation;
mod scene;
#[cfg(test)]
mod tests;

pub(crate) use scene::{Source, read};
