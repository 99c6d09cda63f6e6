//! The tree of nodes.

use glam::{Mat4, Quat, Vec3};
use gltf_json::{Index, Node, Scene};

use super::{bad, find};
use crate::Result;

/// Nodes of the scene that is shown, parents before children; and the parents of all nodes.
///
/// # Errors
/// There is no scene, or a node has two parents.
pub(crate) fn from_the_top(
    nodes: &[Node],
    scenes: &[Scene],
    scene: Option<Index<Scene>>,
) -> Result<(Vec<usize>, Vec<Option<usize>>)> {
    let scene = find(scenes, scene.unwrap_or(Index::new(0)), "scenes", "scene")?;
    let mut parents = vec![None; nodes.len()];
    let mut seen = vec![false; nodes.len()];
    let mut order = Vec::new();
    let mut open: Vec<(Index<Node>, Option<usize>)> = scene.nodes.iter().rev().map(|&n| (n, None)).collect();
    while let Some((index, parent)) = open.pop() {
        let place = || parent.map_or("scene".into(), |p| format!("node {p}"));
        let (n, node) = (index.value(), find(nodes, index, "nodes", &place())?);
        if std::mem::replace(&mut seen[n], true) {
            return Err(bad(format!("node {n}"), "expected one parent, found two"));
        }
        parents[n] = parent;
        order.push(n);
        open.extend(node.children.iter().flatten().rev().map(|&child| (child, Some(n))));
    }
    Ok((order, parents))
}

/// From a node's own coordinates to its parent's.
pub(crate) fn local(node: &Node) -> Mat4 {
    if let Some(matrix) = node.matrix {
        return Mat4::from_cols_array(&matrix);
    }
    let rotation = node.rotation.map_or(Quat::IDENTITY, |q| Quat::from_array(q.0));
    let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { Quat::IDENTITY };
    let (scale, place) = (node.scale.map_or(Vec3::ONE, Vec3::from), node.translation.map_or(Vec3::ZERO, Vec3::from));
    Mat4::from_scale_rotation_translation(scale, rotation, place)
}
