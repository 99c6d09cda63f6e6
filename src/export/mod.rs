//! A finished crowd in the formats of others.
//!
//! [`glb`] writes a whole crowd as one binary glTF file, everybody a [`mannequin`] of their own
//! [build](crate::motion::Build) and [`look`]; [`glb_with`] dresses people as somebody's own characters ([`Avatar`]);
//! [`clip`] and [`bvh`] take one person out; [`clip_glb`] writes a clip on any skeleton.

mod actor;
mod avatar;
mod body;
mod boxes;
mod buffer;
mod clip;
mod clip_glb;
mod glb;
mod loft;
mod look;
mod mannequin;
mod obstacles;
mod shape;
mod skinning;

pub use avatar::Avatar;
pub use clip::{bvh, clip};
pub use clip_glb::clip_glb;
pub use glb::{glb, glb_with};
pub use look::{Look, Region, look};
pub use mannequin::{Mannequin, mannequin};
