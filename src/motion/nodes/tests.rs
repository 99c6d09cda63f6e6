//! Which nodes make a character.

use glam::{DQuat, DVec3};

use super::{Figure, Local, Node, Timing, Tree, clip, figures};

/// Nodes by name and parent; those whose name ends in `*` move, those in `#` show something.
fn tree(nodes: &[(&str, Option<usize>)]) -> Tree {
    let local = Local { translation: DVec3::Y, rotation: DQuat::IDENTITY, scale: DVec3::ONE };
    let node = |&(name, parent): &(&str, Option<usize>)| Node {
        name: name.trim_end_matches(['*', '#']).into(),
        parent,
        rest: local,
        joint: false,
        label: None,
        bind: None,
        animated: name.ends_with('*'),
        shows: name.ends_with('#'),
        tip: None,
    };
    Tree::new(nodes.iter().map(node).collect()).unwrap()
}

/// A person of nine moving nodes below `parent`, of which the first is number `first`.
fn person(first: usize, parent: Option<usize>) -> Vec<(&'static str, Option<usize>)> {
    let mut nodes = vec![("hips*", parent)];
    nodes.extend((0..8).map(|i| ("joint*", Some(first + i))));
    nodes
}

fn sizes(found: &[Figure]) -> Vec<(&str, usize)> {
    found.iter().map(|f| (f.name.as_str(), f.joints.len())).collect()
}

#[test]
fn people_that_share_a_holder_are_apart() {
    let mut nodes = vec![("scene", None)];
    nodes.extend(person(1, Some(0)));
    nodes.extend(person(10, Some(0)));
    assert_eq!(sizes(&figures(&tree(&nodes))), [("scene", 9), ("hips", 9)]);
}

#[test]
fn still_hips_keep_their_legs() {
    let mut nodes = vec![("scene", None), ("hips", Some(0))];
    for first in [2, 5, 8] {
        nodes.extend([("leg*", Some(1)), ("shin*", Some(first)), ("foot*", Some(first + 1))]);
    }
    assert_eq!(sizes(&figures(&tree(&nodes))), [("scene", 10)]);
}

#[test]
fn meshes_and_cameras_are_no_joints() {
    let mut nodes = person(0, None);
    nodes.extend([("shirt#", Some(0)), ("camera*", None), ("lens", Some(10))]);
    assert_eq!(sizes(&figures(&tree(&nodes))), [("hips", 9)]);
}

#[test]
fn marked_joints_decide_and_nodes_between_them_do_not() {
    let mut nodes =
        tree(&[("rig", None), ("hips*", Some(0)), ("between", Some(1)), ("head", Some(2)), ("other*", None)]);
    for i in [1, 3] {
        nodes.nodes[i].joint = true;
    }
    let found = figures(&nodes);
    assert_eq!(sizes(&found), [("rig", 2)]);
    assert_eq!((found[0].parents.clone(), found[0].chain.clone()), (vec![None, Some(0)], vec![0, 1, 2, 3]));
    let timing = Timing { begin: 0.0, fps: 30.0, frames: 2 };
    let clip = clip(&nodes, &found[0], timing, |node, _| nodes.nodes[node].rest).unwrap();
    assert_eq!(clip.skeleton.joints[1].offset, glam::Vec3::new(0.0, 2.0, 0.0));
}

#[test]
fn nothing_that_moves_is_nobody() {
    assert!(figures(&tree(&[("a", None), ("b", Some(0))])).is_empty());
}

#[test]
fn a_deep_tree_is_refused() {
    let nodes: Vec<Node> =
        (0..2000usize).map(|i| Node { parent: i.checked_sub(1), ..tree(&[("a", None)]).nodes[0].clone() }).collect();
    let error = Tree::new(nodes).unwrap_err().to_string();
    assert!(error.contains("node 1000: expected at most 1000 nodes above each other"), "{error}");
}
