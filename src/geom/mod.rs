//! Transforms of the ground plane, polygons, capsules, boxes.

mod capsule;
pub mod complex;
mod cuboid;
mod ground;
mod polygon;

pub use capsule::Capsule;
pub use cuboid::{Cuboid, Upright};
pub use ground::{Ground, Turn, wrap_angle};
pub use polygon::Polygon;
