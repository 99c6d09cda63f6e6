//! Crowdquilt stitches motion capture into crowds.
//!
//! The modules are the stages of the pipeline and read top to bottom; a stage
//! uses only those above it (and [`stage`], [`export`] and [`check`] use no solver).

pub mod check;
pub mod container;
pub mod deform;
pub mod error;
pub mod export;
pub mod geom;
mod gltf;
pub mod motion;
pub mod patch;
pub mod refine;
pub mod samples;
pub mod stage;
pub mod tiling;
pub mod world;

#[cfg(test)]
extern crate self as crowdquilt;

pub use error::{Error, Result};
