//! Skeleton, pose, clip, take; importers, retargeting, foot plants.

pub(crate) mod arm;
pub mod asfamc;
mod body;
mod build;
pub mod bvh;
mod clip;
pub mod collection;
pub mod contacts;
pub(crate) mod fade;
mod fbx;
pub mod gait;
mod gltf;
pub mod ik;
pub mod import;
pub mod limits;
pub mod mirror;
mod nodes;
mod path;
pub mod plants;
pub mod pose;
pub mod presets;
pub mod quality;
mod rate;
pub mod reach;
pub mod retarget;
mod skeleton;
pub mod symptoms;
pub mod take;
#[cfg(test)]
pub(crate) mod testing;
pub mod together;

pub(crate) use build::{ANKLE_HEIGHT, BuildRows};
pub(crate) use skeleton::bone_length;

pub use body::{BODY_CAPSULES, BodyCapsule, BodyPart, body_capsules, shape};
pub use build::{Build, Flesh, Proportions};
pub use clip::Clip;
pub use mirror::motion as mirror;
pub use path::{Foot, Motion, MotionPath, Plant};
pub use skeleton::{JOINT_COUNT, Joint, JointId, Skeleton, canonical, joint};

/// Samples per second of all motion inside the system.
pub const FPS: f32 = 30.0;
