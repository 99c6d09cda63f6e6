//! The finished crowd or world: baked, immutable, playable at any time. Imports no solver.

mod crowd;
mod file;
mod laps;
mod prop;
mod tiles;
pub mod world;

pub use crowd::{Character, Crowd, DomainInfo, FragmentUse, Instance};
pub use prop::{Holding, Prop};
pub use world::World;
