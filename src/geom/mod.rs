//! Transforms of the ground plane, polygons, capsules.

mod capsule;
pub mod complex;
mod ground;
mod polygon;

pub use capsule::Capsule;
pub use ground::{Ground, Turn, wrap_angle};
pub use polygon::Polygon;
