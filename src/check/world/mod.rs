//! Verifies crowd patches and worlds made of them, from the finished curves alone.
//!
//! Shares data types with `world`, but no code with its solver: curves are evaluated here anew. Nothing can slip
//! through between samples: every person is followed along chords a quarter of the path's step long, and what the curve
//! may leave a chord by (acceleration x time^2 / 8, the acceleration of a cubic spline being greatest at its knots)
//! counts against it.

mod acts;
mod baked;
mod curve;
mod distance;
mod feet;
mod patch;
mod tiles;

pub use baked::check_world;
pub use patch::{PatchReport, check_patch};
pub use tiles::{Placed, TilesReport, check_tiles};

/// Stored points are in single precision: what is held exactly may be off by this much, metres.
const ROUNDING: f64 = 1e-4;
