//! FBX, binary and text: the characters of a file as clips. The format is read by the library ufbx, which also turns
//! axes and units to ours and evaluates curves; here its scene becomes our tree of nodes.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DMat3, DQuat, DVec3};
use ufbx::{AnimStack, CoordinateAxes, ElementType, LoadOpts, Scene, SceneRoot};

use super::import::Capture;
use super::nodes::{self, Figure, Local, Node, Timing, Tree};
use super::rate;
use crate::{Error, Result};

fn bad(place: impl Into<String>, problem: impl Into<String>) -> Error {
    Error::invalid("FBX", place, problem)
}

/// Reads all characters that an animation moves, on one clock, in metres, y up.
///
/// Limb nodes are joints; without any, animated nodes are. Poses are sampled at the rate of the keys, or the file's
/// own where its keys are sparser. `animation` names a take; by default each character has the first that moves it.
///
/// # Errors
/// What ufbx says of a broken file, a take that is not there, nothing that moves.
pub(crate) fn read(bytes: &[u8], animation: Option<&str>, fps: Option<f32>) -> Result<Capture> {
    let scene = open(bytes)?;
    let stacks = chosen(&scene, animation)?;
    let tree = tree(&scene, &stacks)?;
    let figures = nodes::figures(&tree);
    if figures.is_empty() {
        return Err(bad("animation", "expected an animation that moves a tree of nodes, found none"));
    }
    let moved: Vec<Moved> = figures.iter().filter_map(|figure| moved(&stacks, figure)).collect();
    let timing = timing(&scene, &moved, fps);
    timing.check(&figures, bytes.len())?;
    let clip = |(figure, moved): (&Figure, &Moved)| {
        nodes::clip(&tree, figure, timing, |node, time| match moved.nodes.contains(&node) {
            true => local(&ufbx::evaluate_transform(&moved.stack.anim, &scene.nodes[node], time)),
            false => tree.nodes[node].rest,
        })
    };
    let clips = figures.iter().zip(&moved).map(clip).collect::<Result<Vec<_>>>()?;
    Ok(Capture { clips, metres_per_unit: Some(1.0) })
}

/// The file's scene, y up and in metres. Packed data may not unpack to memory out of proportion.
fn open(bytes: &[u8]) -> Result<SceneRoot> {
    let memory_limit = bytes.len().saturating_mul(64).saturating_add(16 << 20);
    let limit = || ufbx::AllocatorOpts { memory_limit, ..Default::default() };
    let options = LoadOpts {
        temp_allocator: limit(),
        result_allocator: limit(),
        ignore_geometry: true,
        ignore_embedded: true,
        skip_skin_vertices: true,
        target_axes: CoordinateAxes::right_handed_y_up(),
        target_unit_meters: 1.0,
        inherit_mode_handling: ufbx::InheritModeHandling::Compensate,
        node_depth_limit: nodes::DEEPEST as u32,
        file_format: ufbx::FileFormat::Fbx,
        ..Default::default()
    };
    ufbx::load_memory(bytes, options)
        .map_err(|e| bad("file", format!("expected an FBX file, found: {}", &*e.description)))
}

/// The take of that name, or all.
fn chosen<'a>(scene: &'a Scene, name: Option<&str>) -> Result<Vec<&'a AnimStack>> {
    let all = || scene.anim_stacks.into_iter();
    let found: Vec<&AnimStack> = all().filter(|s| name.is_none_or(|n| *s.element.name == *n)).collect();
    if found.is_empty() {
        let names: Vec<String> = all().map(|s| format!("'{}'", &*s.element.name)).collect();
        let names = if names.is_empty() { "none at all".to_owned() } else { names.join(", ") };
        let wanted = name.map_or("a take".to_owned(), |name| format!("a take '{name}'"));
        return Err(bad("import.animation", format!("expected {wanted}, found {names}")));
    }
    Ok(found)
}

fn tree(scene: &Scene, stacks: &[&AnimStack]) -> Result<Tree> {
    let place: BTreeMap<u32, usize> = scene.nodes.iter().enumerate().map(|(i, n)| (n.element.element_id, i)).collect();
    let mut nodes: Vec<Node> = scene.nodes.iter().map(|node| plain(node, &place)).collect();
    for stack in stacks {
        for node in animated(stack) {
            if let Some(node) = place.get(&node).and_then(|&i| nodes.get_mut(i)) {
                node.animated = true;
            }
        }
    }
    let mut bind = |node: &ufbx::Node, matrix: &ufbx::Matrix| {
        if let Some(node) = place.get(&node.element.element_id).and_then(|&i| nodes.get_mut(i)) {
            node.bind = node.bind.or_else(|| rotation(matrix));
        }
    };
    for cluster in &scene.skin_clusters {
        if let Some(bone) = &cluster.bone_node {
            bind(bone, &cluster.bind_to_world);
        }
    }
    for pose in scene.poses.into_iter().filter(|p| p.is_bind_pose) {
        pose.bone_poses.iter().for_each(|bone| bind(&bone.bone_node, &bone.bone_to_world));
    }
    Tree::new(nodes)
}

fn plain(node: &ufbx::Node, place: &BTreeMap<u32, usize>) -> Node {
    // "Bob:Hips": the namespace is the character's name.
    let name = node.element.name.to_string();
    let label = name.rsplit_once(':').map(|(space, _)| space.to_owned());
    Node {
        name,
        parent: node.parent.as_ref().and_then(|p| place.get(&p.element.element_id).copied()),
        rest: local(&node.local_transform),
        joint: node.attrib_type == ElementType::Bone,
        label,
        bind: None,
        animated: false,
        shows: matches!(node.attrib_type, ElementType::Mesh | ElementType::Camera | ElementType::Light),
        tip: None,
    }
}

/// The curves' properties that place a node.
const PLACES: [&str; 3] = ["Lcl Translation", "Lcl Rotation", "Lcl Scaling"];

/// Element ids of the nodes that a take moves.
fn animated(stack: &AnimStack) -> BTreeSet<u32> {
    let layers = stack.layers.into_iter();
    let props = layers.flat_map(|layer| &layer.anim_props).filter(|prop| PLACES.contains(&&*prop.prop_name));
    props
        .filter(|p| p.anim_value.curves.iter().flatten().any(|c| !c.keyframes.is_empty()))
        .map(|p| p.element.element_id)
        .collect()
}

/// A figure's take, and which of its nodes move in it.
struct Moved<'a> {
    stack: &'a AnimStack,
    nodes: BTreeSet<usize>,
    times: Vec<Vec<f32>>,
}

/// The first take that moves a figure.
fn moved<'a>(stacks: &[&'a AnimStack], figure: &Figure) -> Option<Moved<'a>> {
    stacks.iter().find_map(|stack| {
        let (mut nodes, mut times) = (BTreeSet::new(), Vec::new());
        let chain: BTreeSet<usize> = figure.chain.iter().copied().collect();
        let layers = stack.layers.into_iter();
        for prop in layers.flat_map(|layer| &layer.anim_props).filter(|prop| PLACES.contains(&&*prop.prop_name)) {
            let node = prop.element.typed_id as usize;
            if prop.element.type_ != ElementType::Node || !chain.contains(&node) {
                continue;
            }
            for curve in prop.anim_value.curves.iter().flatten().filter(|c| !c.keyframes.is_empty()) {
                nodes.insert(node);
                times.push(curve.keyframes.iter().map(|k| k.time as f32).collect());
            }
        }
        (!nodes.is_empty()).then_some(Moved { stack, nodes, times })
    })
}

/// When to sample: over the keys, but not outside what the takes play.
fn timing(scene: &Scene, moved: &[Moved], fps: Option<f32>) -> Timing {
    let times: Vec<&[f32]> = moved.iter().flat_map(|m| &m.times).map(Vec::as_slice).collect();
    let first = times.iter().map(|t| f64::from(t[0])).fold(f64::INFINITY, f64::min);
    let last = times.iter().map(|t| f64::from(t[t.len() - 1])).fold(f64::NEG_INFINITY, f64::max);
    let begin = moved.iter().map(|m| m.stack.time_begin).fold(f64::INFINITY, f64::min);
    let end = moved.iter().map(|m| m.stack.time_end).fold(f64::NEG_INFINITY, f64::max);
    let played = [first.max(begin), last.min(end)];
    let span = if played[0] < played[1] { played } else { [first, last] };
    let by_keys = rate::timing(&times, span, fps.map(f64::from), false);
    let own = scene.settings.frames_per_second;
    if fps.is_none() && (1.0..=240.0).contains(&own) && by_keys.fps < 0.99 * own {
        return rate::timing(&times, span, Some(own), false);
    }
    by_keys
}

fn local(transform: &ufbx::Transform) -> Local {
    let (t, q, s) = (&transform.translation, &transform.rotation, &transform.scale);
    let rotation = DQuat::from_xyzw(q.x, q.y, q.z, q.w);
    let usable = rotation.is_finite() && rotation.length_squared() > 1e-12;
    Local {
        translation: DVec3::new(t.x, t.y, t.z),
        rotation: if usable { rotation.normalize() } else { DQuat::IDENTITY },
        scale: DVec3::new(s.x, s.y, s.z),
    }
}

/// The rotation of a transform, if it has one.
fn rotation(m: &ufbx::Matrix) -> Option<DQuat> {
    let columns = [[m.m00, m.m10, m.m20], [m.m01, m.m11, m.m21], [m.m02, m.m12, m.m22]];
    let columns = columns.map(|c| DVec3::from(c).try_normalize());
    let [Some(x), Some(y), Some(z)] = columns else { return None };
    let matrix = DMat3::from_cols(x, y, z);
    let proper = matrix.is_finite() && (matrix.determinant() - 1.0).abs() < 1e-3;
    proper.then(|| DQuat::from_mat3(&matrix).normalize())
}

#[cfg(test)]
mod tests;
