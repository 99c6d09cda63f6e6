//! BVH files, read and written.

mod hierarchy;
mod read;
#[cfg(test)]
mod read_tests;
mod write;

pub(crate) use read::MIN_FPS;
pub use read::{load, read};
pub use write::write;
