//! All that is seen of a character, in the form in which it is written.

use glam::Mat4;
use gltf_json::Extras;
use gltf_json::material::Material;
use gltf_json::mesh::Mode;
use gltf_json::texture::{Sampler, Texture};

use super::picture::Picture;
use super::vertices::Vertices;

/// Numbers and indices in it lead into its own lists.
#[derive(Debug, Default)]
pub(super) struct Outfit {
    /// Meshes that are bound to skins.
    pub dresses: Vec<(Worn, usize)>,
    /// Meshes that hang from bones.
    pub stiff: Vec<(Worn, usize)>,
    pub skins: Vec<Bind>,
    pub meshes: Vec<Sewn>,
    pub vertices: Vec<Vertices>,
    pub corners: Vec<Vec<u32>>,
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    pub samplers: Vec<Sampler>,
    pub pictures: Vec<Picture>,
}

/// A mesh as a node has it.
#[derive(Debug)]
pub(super) struct Worn {
    pub mesh: usize,
    /// Weights of its morph targets, if they are not the mesh's own.
    pub weights: Option<Vec<f32>>,
}

/// A skin: the bones that are its joints, and its inverse bind matrices, none if they are all identities.
#[derive(Debug)]
pub(super) struct Bind {
    pub joints: Vec<usize>,
    pub matrices: Option<Vec<Mat4>>,
}

/// A mesh.
#[derive(Debug)]
pub(super) struct Sewn {
    pub name: Option<String>,
    pub extras: Extras,
    pub weights: Option<Vec<f32>>,
    pub pieces: Vec<Piece>,
}

/// A primitive of a mesh.
#[derive(Debug)]
pub(super) struct Piece {
    pub mode: Mode,
    pub vertices: usize,
    pub corners: Option<usize>,
    pub material: Option<usize>,
}
