//! Deformation of motion paths in space and time, as rigid as possible (paper section 3).

mod limits;
mod strand;

pub use limits::Limits;
pub use strand::Strand;
