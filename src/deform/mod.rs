//! Deformation of motion paths in space and time, as rigid as possible (paper section 3).

mod band;
mod limits;
mod strand;
mod system;
mod web;

pub use limits::Limits;
pub use strand::Strand;
pub use web::{Deformed, Handle, Hold, Web};
