//! Where a character's soles are.

use std::collections::BTreeSet;

use glam::{Mat4, Vec3};

use super::nodes::frames;
use super::outfit::Outfit;
use super::vertices::Vertices;
use crate::export::actor::Bone;

/// How low the skinned meshes reach along `up` in the rest pose.
pub(super) fn lowest(outfit: &Outfit, bones: &[Bone], up: Vec3) -> f32 {
    let frames = frames(bones);
    let mut low = f32::INFINITY;
    let mut seen = BTreeSet::new();
    for (worn, skin) in &outfit.dresses {
        let bind = &outfit.skins[*skin];
        let matrix = |k: usize| bind.matrices.as_ref().map_or(Mat4::IDENTITY, |m| m[k]);
        let joints: Vec<Mat4> =
            bind.joints.iter().enumerate().map(|(k, &bone)| Mat4::from(frames[bone].0) * matrix(k)).collect();
        for piece in outfit.meshes[worn.mesh].pieces.iter().filter(|piece| seen.insert((*skin, piece.vertices))) {
            low = low.min(lowest_vertex(&outfit.vertices[piece.vertices], &joints, up));
        }
    }
    low
}

fn lowest_vertex(vertices: &Vertices, joints: &[Mat4], up: Vec3) -> f32 {
    let height = |(v, &place): (usize, &Vec3)| -> f32 {
        let part = |j: u16, w: f32| if w > 0.0 { w * joints[j as usize].transform_point3(place).dot(up) } else { 0.0 };
        vertices.bound.iter().flat_map(|set| (0..4).map(move |k| part(set.joints[v][k], set.weights[v][k]))).sum()
    };
    vertices.places.iter().enumerate().map(height).fold(f32::INFINITY, f32::min)
}
