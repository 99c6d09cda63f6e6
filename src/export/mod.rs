//! A finished crowd in the formats of others.
//!
//! [`glb`] writes a whole crowd as one binary glTF file with the [`mannequin`] as everybody's body; [`clip`] and
//! [`bvh`] take one person out.

mod body;
mod buffer;
mod clip;
mod glb;
mod loft;
mod look;
mod mannequin;
mod shape;
mod skinning;

pub use clip::{bvh, clip};
pub use glb::glb;
pub use look::{LOOKS, Look, look};
pub use mannequin::{Mannequin, Material, mannequin};
