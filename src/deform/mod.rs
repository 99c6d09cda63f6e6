//! Deformation of motion paths in space and time, as rigid as possible (paper section 3).

mod band;
mod limits;
mod nodes;
mod strain;
mod strand;
mod system;
mod web;

pub use limits::Limits;
pub use strain::{Broken, Most, Strain};
pub use strand::Strand;
pub use web::{Bond, Deformed, Handle, Hold, Thread, Web};
