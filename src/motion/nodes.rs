//! Trees of animated nodes, as FBX and glTF hold them, as clips: whose joints are whose, and the change from a rest
//! pose of any rotations to one without.

mod convert;
mod figures;

use std::collections::BTreeMap;

use glam::{DAffine3, DQuat, DVec3};

use super::{Clip, JointId};
use crate::{Error, Result};

/// A transform relative to the parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Local {
    pub translation: DVec3,
    pub rotation: DQuat,
    pub scale: DVec3,
}

impl Local {
    fn affine(&self) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}

/// One node of a file's scene.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub name: String,
    pub parent: Option<usize>,
    pub rest: Local,
    /// Whether the file says that it is a joint (bone), and what it calls the whole skeleton.
    pub joint: bool,
    pub label: Option<String>,
    /// Global rotation in the bind pose, where the file has one.
    pub bind: Option<DQuat>,
    /// Whether an animation moves it.
    pub animated: bool,
    /// Whether it shows something (mesh, camera, light), and so is no joint unless it moves.
    pub shows: bool,
    /// Where the bone ends, in the node's own frame at rest.
    pub tip: Option<DVec3>,
}

/// A scene's nodes; `order` lists them parents first.
#[derive(Debug)]
pub(crate) struct Tree {
    pub nodes: Vec<Node>,
    order: Vec<usize>,
}

/// Nodes deeper than this are refused, lest what is worked out along the way down fills the memory.
pub(crate) const DEEPEST: usize = 1000;

impl Tree {
    /// # Errors
    /// A node is its own ancestor, or lies too deep (named by number).
    pub fn new(nodes: Vec<Node>) -> Result<Self> {
        let mut children = vec![Vec::new(); nodes.len()];
        let mut order: Vec<usize> = Vec::with_capacity(nodes.len());
        for (i, node) in nodes.iter().enumerate() {
            match node.parent {
                Some(parent) => children[parent].push(i),
                None => order.push(i),
            }
        }
        let mut at = 0;
        while at < order.len() {
            order.extend(&children[order[at]]);
            at += 1;
        }
        let mut depth = vec![0; nodes.len()];
        for &i in &order {
            depth[i] = 1 + nodes[i].parent.map_or(0, |p| depth[p]);
        }
        let bad = |i: usize, problem: String| Error::invalid("nodes", format!("node {i}"), problem);
        if let Some(own) = depth.iter().position(|&d| d == 0) {
            return Err(bad(own, "expected a tree, found a node that is its own ancestor".into()));
        }
        match depth.iter().position(|&d| d > DEEPEST) {
            Some(deep) => {
                Err(bad(deep, format!("expected at most {DEEPEST} nodes above each other, found {}", depth[deep])))
            }
            None => Ok(Self { nodes, order }),
        }
    }

    /// Global transforms of all nodes at rest.
    pub fn rest_transforms(&self) -> Vec<DAffine3> {
        let mut global = vec![DAffine3::IDENTITY; self.nodes.len()];
        for &i in &self.order {
            let node = &self.nodes[i];
            global[i] = node.parent.map_or(DAffine3::IDENTITY, |p| global[p]) * node.rest.affine();
        }
        global
    }

    /// Global rotations of all nodes at rest.
    fn rest_rotations(&self) -> Vec<DQuat> {
        let mut global = vec![DQuat::IDENTITY; self.nodes.len()];
        for &i in &self.order {
            let node = &self.nodes[i];
            global[i] = (node.parent.map_or(DQuat::IDENTITY, |p| global[p]) * node.rest.rotation).normalize();
        }
        global
    }
}

/// One character: its joints, parents first; the first is the root.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Figure {
    pub name: String,
    pub joints: Vec<usize>,
    /// By joint, the place of its parent in `joints`.
    pub parents: Vec<Option<JointId>>,
    /// The joints and all nodes above them, parents first.
    pub chain: Vec<usize>,
}

/// The moments at which an animation is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Timing {
    pub begin: f64,
    pub fps: f64,
    pub frames: usize,
}

impl Timing {
    pub fn time(&self, frame: usize) -> f64 {
        self.begin + frame as f64 / self.fps
    }

    /// # Errors
    /// So many poses that a small file would fill the memory.
    pub fn check(&self, figures: &[Figure], bytes: usize) -> Result<()> {
        let joints: usize = figures.iter().map(|f| f.chain.len()).sum();
        let (poses, most) = (self.frames.saturating_mul(joints), bytes.saturating_mul(16).saturating_add(1 << 20));
        if poses <= most {
            return Ok(());
        }
        let found =
            format!("{} frames at {} per second of {joints} joints and nodes above them", self.frames, self.fps);
        let expected = format!("expected no more poses of joints than {most} for a file of its size");
        Err(Error::invalid("animation", "import.fps", format!("{expected}, found {found}")))
    }
}

/// The global place and rotation of a figure's joints at one moment, and whether it is shown (not scaled to nothing).
struct Moment {
    joints: Vec<(DVec3, DQuat)>,
    shown: bool,
}

/// The tree's own state while moments are worked out.
struct Posed {
    affine: BTreeMap<usize, (DAffine3, DQuat)>,
}

impl Posed {
    fn new() -> Self {
        Self { affine: BTreeMap::new() }
    }

    fn at(&mut self, tree: &Tree, figure: &Figure, mut local: impl FnMut(usize) -> Local) -> Moment {
        for &i in &figure.chain {
            let own = local(i);
            let above = tree.nodes[i].parent.and_then(|p| self.affine.get(&p)).copied();
            let (affine, rotation) = above.unwrap_or((DAffine3::IDENTITY, DQuat::IDENTITY));
            self.affine.insert(i, (affine * own.affine(), (rotation * own.rotation).normalize()));
        }
        let place = |joint: &usize| (self.affine[joint].0.translation, self.affine[joint].1);
        let size = self.affine[&figure.joints[0]].0.matrix3.determinant().abs();
        Moment { joints: figure.joints.iter().map(place).collect(), shown: size > 1e-18 }
    }
}

/// The characters of a scene, see [`figures::find`].
pub(crate) fn figures(tree: &Tree) -> Vec<Figure> {
    figures::find(tree)
}

/// The motion of a figure whose nodes are at `local(node, seconds)`; frames before and after it is shown are left out.
///
/// # Errors
/// The figure is never shown, or a place is not a number.
pub(crate) fn clip(
    tree: &Tree,
    figure: &Figure,
    timing: Timing,
    local: impl FnMut(usize, f64) -> Local,
) -> Result<Clip> {
    convert::clip(tree, figure, timing, local)
}

#[cfg(test)]
mod tests;
