//! The characters of a glTF file as clips.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{DAffine3, DMat4, DQuat, DVec3, DVec4, Mat4};
use gltf_json::accessor::Type;
use gltf_json::animation::{Interpolation, Property};
use gltf_json::buffer::View;
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Animation, Asset, Buffer, Index, Skin};

use super::animation::{Keys, Tracks, tracks, turn};
use crate::Result;
use crate::gltf::{Data, Numbers, Tables, bad, find, open, version};
use crate::motion::import::Capture;
use crate::motion::nodes::{self, Figure, Local, Node, Timing, Tree};
use crate::motion::rate;

/// What is read of a file, besides its bytes.
#[derive(Clone, Copy, Default)]
pub(crate) struct Source<'a> {
    /// Where files beside it lie.
    pub folder: Option<&'a Path>,
    /// Name of the animation; by default each character's first.
    pub animation: Option<&'a str>,
    /// Frames per second; by default those of the keys.
    pub fps: Option<f32>,
}

/// What is read of the JSON; meshes, materials and all else may be as they like.
#[derive(Debug, serde::Deserialize)]
#[serde(rename_all = "camelCase")]
struct Document {
    asset: Asset,
    #[serde(default)]
    accessors: Vec<Accessor>,
    #[serde(default)]
    animations: Vec<Animation>,
    #[serde(default)]
    buffers: Vec<Buffer>,
    #[serde(default)]
    buffer_views: Vec<View>,
    #[serde(default)]
    nodes: Vec<gltf_json::Node>,
    #[serde(default)]
    skins: Vec<Skin>,
    #[serde(default)]
    extensions_required: Vec<String>,
}

impl Document {
    /// # Errors
    /// Another version, or numbers packed in a way that is not read.
    fn supported(&self) -> Result<()> {
        version(&self.asset)?;
        match self.extensions_required.iter().find(|e| e.ends_with("meshopt_compression")) {
            Some(packed) => Err(bad("extensionsRequired", format!("expected plain buffers, found {packed}"))),
            None => Ok(()),
        }
    }

    fn tables(&self) -> Tables<'_> {
        Tables { accessors: &self.accessors, views: &self.buffer_views, buffers: &self.buffers }
    }
}

/// Reads all characters that an animation moves, on one clock, in metres.
///
/// Poses are sampled at the rate of the densest keys, at most 240 per second. Times at which a character is scaled to
/// nothing are left out at its begin and end.
///
/// # Errors
/// One message with the place: a chunk, accessor, channel or node.
pub(crate) fn read(bytes: &[u8], source: Source) -> Result<Capture> {
    let (root, binary) = open::<Document>(bytes)?;
    root.supported()?;
    let mut data = Data::new(root.tables(), binary, bytes.len(), source.folder);
    let animations = chosen(&root, source.animation)?;
    let tree = tree(&root, &mut data, &animations)?;
    let figures = nodes::figures(&tree);
    if figures.is_empty() {
        return Err(bad("animations", "expected an animation that moves a tree of nodes, found none"));
    }
    let tracks = figures.iter().map(|figure| moving(&mut data, &animations, figure)).collect::<Result<Vec<_>>>()?;
    let timing = timing(&tracks, source.fps);
    timing.check(&figures, data.bytes())?;
    let clip = |(figure, tracks): (&Figure, &BTreeMap<usize, Tracks>)| {
        // Keys that are meant to be at a frame are a little beside it: times are in single precision, rates rounded.
        let slack = 0.02 / timing.fps;
        nodes::clip(&tree, figure, timing, |node, time| {
            let rest = &tree.nodes[node].rest;
            tracks.get(&node).map_or(*rest, |keys| keys.local(rest, time, slack))
        })
    };
    let clips = figures.iter().zip(&tracks).map(clip).collect::<Result<Vec<_>>>()?;
    Ok(Capture { clips, metres_per_unit: Some(1.0) })
}

/// The animation of that name, or all.
fn chosen<'a>(root: &'a Document, name: Option<&str>) -> Result<Vec<&'a Animation>> {
    let all = &root.animations;
    let found: Vec<&Animation> = all.iter().filter(|a| name.is_none() || a.name.as_deref() == name).collect();
    if found.is_empty() {
        let names: Vec<String> = all.iter().map(|a| format!("'{}'", a.name.as_deref().unwrap_or_default())).collect();
        let names = if names.is_empty() { "none at all".to_owned() } else { names.join(", ") };
        let wanted = name.map_or("an animation".to_owned(), |name| format!("an animation '{name}'"));
        return Err(bad("import.animation", format!("expected {wanted}, found {names}")));
    }
    Ok(found)
}

/// What the first animation that moves a figure does to it.
fn moving(data: &mut Data, animations: &[&Animation], figure: &Figure) -> Result<BTreeMap<usize, Tracks>> {
    let places: std::collections::BTreeSet<usize> = figure.chain.iter().copied().collect();
    for animation in animations {
        let tracks = tracks(data, animation, |node| places.contains(&node))?;
        if !tracks.is_empty() {
            return Ok(tracks);
        }
    }
    Ok(BTreeMap::new())
}

fn timing(tracks: &[BTreeMap<usize, Tracks>], fps: Option<f32>) -> Timing {
    let all = || tracks.iter().flat_map(BTreeMap::values);
    let moving = || all().flat_map(|t| [&t.translation, &t.rotation]).flatten();
    let any = || moving().chain(all().filter_map(|t| t.scale.as_ref()));
    let begin = any().map(|k| k.times[0]).fold(f32::INFINITY, f32::min);
    let end = any().map(|k| k.times[k.times.len() - 1]).fold(f32::NEG_INFINITY, f32::max);
    let smooth = moving().any(|k| k.interpolation == Interpolation::CubicSpline);
    let keys: Vec<&Keys> = moving().collect();
    let mut times: Vec<&[f32]> = keys.iter().map(|k| &k.times[..]).collect();
    // Most channels share their times.
    times.dedup_by_key(|t| t.as_ptr());
    rate::timing(&times, [begin.into(), end.into()], fps.map(f64::from), smooth)
}

fn tree(root: &Document, data: &mut Data, animations: &[&Animation]) -> Result<Tree> {
    let mut nodes: Vec<Node> = root.nodes.iter().map(node).collect();
    for (i, node) in root.nodes.iter().enumerate() {
        for &child in node.children.iter().flatten() {
            find(&root.nodes, child, "nodes", &format!("node {i}"))?;
            if nodes[child.value()].parent.replace(i).is_some() {
                return Err(bad(format!("node {child}"), "expected one parent, found two"));
            }
        }
    }
    for target in animations.iter().flat_map(|a| &a.channels).map(|c| &c.target) {
        if target.path != Checked::Valid(Property::MorphTargetWeights) {
            find(&root.nodes, target.node, "nodes", "animations")?;
            nodes[target.node.value()].animated = true;
        }
    }
    let mut tree = Tree::new(nodes)?;
    skins(root, data, &mut tree)?;
    Ok(tree)
}

fn node(node: &gltf_json::Node) -> Node {
    Node {
        name: node.name.clone().unwrap_or_default(),
        parent: None,
        rest: rest(node),
        joint: false,
        label: None,
        bind: None,
        animated: false,
        shows: node.mesh.is_some() || node.camera.is_some(),
        tip: tip(node),
    }
}

fn rest(node: &gltf_json::Node) -> Local {
    let vector = |v: [f32; 3]| glam::Vec3::from(v).as_dvec3();
    if let Some(matrix) = node.matrix {
        let matrix = Mat4::from_cols_array(&matrix).as_dmat4();
        let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
        return Local { translation, rotation: turn(DVec4::from(rotation)), scale };
    }
    let rotation = node.rotation.map_or(DVec4::W, |q| DVec4::from_array(q.0.map(f64::from)));
    Local {
        translation: node.translation.map_or(DVec3::ZERO, vector),
        rotation: turn(rotation),
        scale: node.scale.map_or(DVec3::ONE, vector),
    }
}

/// The end of a bone, which our own exports of clips note.
fn tip(node: &gltf_json::Node) -> Option<DVec3> {
    #[derive(serde::Deserialize)]
    struct Extras {
        tip: [f64; 3],
    }
    let extras: Extras = serde_json::from_str(node.extras.as_ref()?.get()).ok()?;
    Some(DVec3::from(extras.tip)).filter(|tip| tip.is_finite())
}

/// Marks the skins' joints, with their rotations in the bind pose.
fn skins(root: &Document, data: &mut Data, tree: &mut Tree) -> Result<()> {
    let rest = tree.rest_transforms();
    for (i, skin) in root.skins.iter().enumerate() {
        let place = format!("skin {i}");
        skin.joints.iter().try_for_each(|&j| find(&root.nodes, j, "nodes", &place).map(drop))?;
        let joints: Vec<usize> = skin.joints.iter().map(Index::value).collect();
        let mesh = root.nodes.iter().position(|n| n.skin.is_some_and(|s| s.value() == i));
        let matrices = skin.inverse_bind_matrices.map(|m| data.floats(m, &[Type::Mat4], Numbers::Floats, &place));
        let matrices = matrices.transpose()?;
        let inverse: Vec<DMat4> = matrices.iter().flat_map(|m| m.values.chunks_exact(16)).map(matrix).collect();
        let bind = bind(&joints, &inverse, &rest, mesh);
        for (at, &joint) in joints.iter().enumerate() {
            let node = &mut tree.nodes[joint];
            node.joint = true;
            node.label = node.label.take().or_else(|| skin.name.clone());
            node.bind = node.bind.or_else(|| bind.get(at).copied());
        }
    }
    Ok(())
}

fn matrix(numbers: &[f32]) -> DMat4 {
    let numbers: [f32; 16] = std::array::from_fn(|i| numbers[i]);
    Mat4::from_cols_array(&numbers).as_dmat4()
}

/// Global rotations of the joints in the bind pose, empty where the matrices are no use.
///
/// Inverse bind matrices are relative to the mesh, whose own place the specification ignores; exporters mean the
/// world or the mesh's node. What is nearer to the nodes at rest is taken.
fn bind(joints: &[usize], inverse: &[DMat4], rest: &[DAffine3], mesh: Option<usize>) -> Vec<DQuat> {
    if inverse.len() != joints.len() {
        return Vec::new();
    }
    let mut candidates: Vec<Vec<DQuat>> = Vec::new();
    for world in [Some(DAffine3::IDENTITY), mesh.map(|m| rest[m])].into_iter().flatten() {
        let global = |m: &DMat4| DMat4::from(world) * m.inverse();
        let rotation = |m: DMat4| turn(DVec4::from(m.to_scale_rotation_translation().1));
        let usable = inverse.iter().all(|m| m.determinant().abs() > 1e-18 && global(m).is_finite());
        if usable {
            candidates.push(inverse.iter().map(|m| rotation(global(m))).collect());
        }
    }
    let far = |bind: &Vec<DQuat>| -> f64 {
        let apart = |(&joint, q): (&usize, &DQuat)| {
            let at_rest = turn(DVec4::from(rest[joint].to_scale_rotation_translation().1));
            at_rest.angle_between(*q)
        };
        joints.iter().zip(bind).map(apart).sum()
    };
    candidates.into_iter().min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or_default()
}
