//! The finished crowd: baked, immutable, playable at any time. Imports no solver.

mod crowd;
mod file;
mod prop;

pub use crowd::{Character, Crowd, DomainInfo, FragmentUse, Instance};
pub use prop::{Holding, Prop};
