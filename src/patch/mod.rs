//! Motion patches: fragments of one or more people's motion with ports, contacts and labels, and the set of them.

mod file;
mod set;

pub(crate) use file::{pack_rotation, unpack_rotation};

pub use set::{Contact, Fragment, PatchKind, PatchSet, PoseGroup, Touch};
