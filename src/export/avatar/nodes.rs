//! The nodes of a character that are needed: joints, all they hang from, and stiff parts that hang from them.

use std::collections::BTreeSet;

use glam::{Affine3A, Quat, Vec3};
use gltf_json::{Index, Root, Skin};

use crate::Result;
use crate::export::actor::Bone;
use crate::gltf::{bad, find, from_the_top, local};

/// Scales that differ by less than this part count as even.
const EVEN: f32 = 2e-3;
/// By how much bones may be scaled at rest, with all above them, and how far away they may be, in the file's unit:
/// enough for any unit of length, and safe to work with in single precision.
const SCALES: std::ops::RangeInclusive<f32> = 1e-6..=1e6;
const FAR: f32 = 1e9;

#[derive(Debug)]
pub(super) struct Parts {
    /// Nodes, parents first.
    pub nodes: Vec<usize>,
    /// Bone of each node: 1 + its place in `nodes`.
    pub bone_of: Vec<Option<usize>>,
    /// Nodes with a skinned mesh, and their skins.
    pub skinned: Vec<(usize, Index<Skin>)>,
    /// Parents of the nodes in the scene.
    parents: Vec<Option<usize>>,
}

impl Parts {
    /// # Errors
    /// No skinned mesh; nodes that go round in circles; joints that are not in the scene.
    pub fn of(json: &Root) -> Result<Self> {
        let (order, parents) = from_the_top(&json.nodes, &json.scenes, json.scene)?;
        let skinned = |&n: &usize| json.nodes[n].skin.filter(|_| json.nodes[n].mesh.is_some()).map(|skin| (n, skin));
        let skinned: Vec<(usize, Index<Skin>)> = order.iter().filter_map(skinned).collect();
        if skinned.is_empty() {
            let found = if json.meshes.is_empty() { "no mesh" } else { "meshes without a skin" };
            return Err(bad("skins", format!("expected a mesh that is bound to a skeleton, found {found}")));
        }
        let mut joint = joints(json, &order, &skinned)?;
        let mut needed = joint.clone();
        for &n in &order {
            // What hangs from a joint moves with it.
            joint[n] |= parents[n].is_some_and(|p| joint[p]);
            needed[n] |= joint[n] && json.nodes[n].skin.is_none();
        }
        for &n in order.iter().rev() {
            parents[n].into_iter().for_each(|p| needed[p] |= needed[n]);
        }
        let nodes: Vec<usize> = order.into_iter().filter(|&n| needed[n]).collect();
        let mut bone_of = vec![None; json.nodes.len()];
        nodes.iter().enumerate().for_each(|(i, &n)| bone_of[n] = Some(i + 1));
        Ok(Self { nodes, bone_of, skinned, parents })
    }

    /// Names of the nodes, for telling joints.
    pub fn names(&self, json: &Root) -> Vec<String> {
        self.nodes.iter().map(|&n| json.nodes[n].name.clone().unwrap_or_else(|| format!("node_{n}"))).collect()
    }

    /// The bones: one for the character's size, then one for each node.
    ///
    /// # Errors
    /// A node that is scaled unevenly, turned inside out, or so small or far away that it has no place.
    pub fn bones(&self, json: &Root) -> Result<Vec<Bone>> {
        let mut bones = vec![Bone::new("size", Vec3::ZERO)];
        for (&n, name) in self.nodes.iter().zip(self.names(json)) {
            let place = || format!("node {n} ({name})");
            let (scale, rotation, translation) = local(&json.nodes[n]).to_scale_rotation_translation();
            let size = scale.x;
            if !(size > 0.0 && scale.is_finite() && (scale - size).abs().max_element() <= EVEN * size) {
                let problem = format!("expected one scale above 0 along all axes, found {scale}; apply it first");
                return Err(bad(place(), problem));
            }
            if !(translation.is_finite() && rotation.is_finite()) {
                return Err(bad(place(), "expected finite numbers, found others"));
            }
            let parent = self.parents[n].and_then(|p| self.bone_of[p]);
            bones.push(Bone {
                parent: Some(parent.unwrap_or(0)),
                rotation: rotation.normalize(),
                scale: Vec3::splat(size),
                ..Bone::new(&name, translation)
            });
        }
        for ((frame, _), &n) in frames(&bones).iter().skip(1).zip(&self.nodes) {
            let size = frame.matrix3.determinant().cbrt();
            if !(SCALES.contains(&size) && frame.translation.abs().max_element() <= FAR) {
                let found = format!("found it scaled by {size} at {}", frame.translation);
                return Err(bad(format!("node {n}"), format!("expected a size and place in the scene, {found}")));
            }
        }
        Ok(bones)
    }
}

/// Which nodes are joints of the skins in use.
fn joints(json: &Root, order: &[usize], skinned: &[(usize, Index<Skin>)]) -> Result<Vec<bool>> {
    let mut shown = vec![false; json.nodes.len()];
    order.iter().for_each(|&n| shown[n] = true);
    let mut joint = vec![false; json.nodes.len()];
    for &(n, index) in skinned {
        let skin = find(&json.skins, index, "skins", &format!("node {n}"))?;
        let place = format!("skin {index}");
        let nodes: BTreeSet<usize> = skin.joints.iter().map(Index::value).collect();
        if nodes.is_empty() || nodes.len() != skin.joints.len() {
            let found = format!("found {} of {} nodes", skin.joints.len(), nodes.len());
            return Err(bad(place, format!("expected joints, each once, {found}")));
        }
        for &j in &skin.joints {
            find(&json.nodes, j, "nodes", &place)?;
            if !shown[j.value()] {
                return Err(bad(format!("node {j}"), "expected the joint in the scene, found it nowhere"));
            }
            joint[j.value()] = true;
        }
    }
    Ok(joint)
}

/// Global rest transforms of the bones; and apart from them the rotations, which uneven rounding cannot bend.
pub(super) fn frames(bones: &[Bone]) -> Vec<(Affine3A, Quat)> {
    let mut frames: Vec<(Affine3A, Quat)> = Vec::with_capacity(bones.len());
    for bone in bones {
        let own = Affine3A::from_scale_rotation_translation(bone.scale, bone.rotation, bone.translation);
        let (frame, turn) = bone.parent.map_or((Affine3A::IDENTITY, Quat::IDENTITY), |p| frames[p]);
        frames.push((frame * own, (turn * bone.rotation).normalize()));
    }
    frames
}
