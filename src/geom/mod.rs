//! Transforms of the ground plane, polygons, circles, obstacles, capsules, boxes, domains that repeat.

mod capsule;
mod circle;
pub mod complex;
mod cuboid;
mod gate;
mod ground;
mod obstacle;
mod polygon;
mod rotation;
mod torus;
mod trigonometry;

pub use capsule::Capsule;
pub use circle::{Disc, smallest_circle};
pub use cuboid::{Cuboid, Upright};
pub use gate::Gate;
pub use ground::{Ground, Turn, wrap_angle};
pub use obstacle::{Obstacle, Waypoint};
pub use polygon::Polygon;
pub(crate) use rotation::Rotation;
pub use torus::{Cycle, Periodic, Torus};
pub(crate) use trigonometry::sin_cos;
