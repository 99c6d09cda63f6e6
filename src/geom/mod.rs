//! Transforms of the ground plane, polygons, capsules.

mod capsule;
mod ground;
mod polygon;

pub use capsule::Capsule;
pub use ground::{Ground, Turn, wrap_angle};
pub use polygon::Polygon;
