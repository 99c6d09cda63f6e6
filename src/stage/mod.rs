//! The finished crowd: baked, immutable, playable at any time. Imports no solver.

mod crowd;
mod file;

pub use crowd::{Character, Crowd, DomainInfo, FragmentUse, Instance};
