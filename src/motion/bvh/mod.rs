//! BVH files, read and written.

mod write;

pub use write::write;
