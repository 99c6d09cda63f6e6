//! Tiling: packing motion patches into a domain so that no port dangles and nobody collides.

mod audition;
mod bake;
mod boxes;
mod bridge;
mod builds;
mod crew;
mod domain;
mod draft;
mod engine;
mod enrich;
mod faults;
mod figure;
mod footprint;
mod gather;
mod library;
mod mend;
mod occupancy;
mod outcome;
mod paper;
mod piece;
mod plan;
mod rehearsal;
mod scene;
mod seed;
mod sketch;
mod tracks;
mod view;

#[cfg(test)]
#[path = "../../tests/common/mod.rs"]
mod common;
#[cfg(test)]
mod oracle_tests;

pub use engine::tile;
pub use outcome::{Method, Options, Outcome, Phase, Progress, Status};
pub use scene::Scene;
