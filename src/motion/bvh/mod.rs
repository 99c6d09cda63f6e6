//! BVH files, read and written.

mod hierarchy;
mod read;
#[cfg(test)]
mod read_tests;

pub use read::{load, read};
