//! Acclaim's captures as CMU publishes them: an ASF file holds the skeleton, an AMC file a motion of it.

mod amc;
mod asf;
mod channel;
mod load;
#[cfg(test)]
mod tests;
mod words;

pub use amc::read;
pub use asf::{Bone, Figure, read as read_skeleton};
pub use channel::Turns;
pub(crate) use load::load;

/// Frames per second of CMU's captures; the format has none.
pub const FPS: f32 = 120.0;
