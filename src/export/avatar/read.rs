//! Reading a character's file: what is there, and whether it can be used.

use glam::{Affine3A, Mat4, Quat, Vec3};
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::mesh::Semantic;
use gltf_json::validation::Checked::Valid;
use gltf_json::{Node, Root};

use super::bad;
use crate::Result;
use crate::export::actor::Bone;
use crate::motion::gltf::chunks;

/// Scales that differ by less than this part count as even.
const EVEN: f32 = 2e-3;

/// The JSON and the binary chunk of a GLB, references and ranges checked.
pub(super) fn open(bytes: &[u8]) -> Result<(Root, Vec<u8>)> {
    if !bytes.starts_with(b"glTF") {
        return Err(bad("byte 0", "expected a binary glTF file (.glb), found something else"));
    }
    let (json, data) = chunks(bytes)?;
    let place = |e: &serde_json::Error| format!("JSON line {} column {}", e.line(), e.column());
    let json: Root = serde_json::from_slice(json).map_err(|e| bad(place(&e), e.to_string()))?;
    attributes(&json)?;
    // The crate's own reader of the container panics on some broken ones; of its document all references are checked.
    let json = gltf::Document::from_json(json).map_err(|e| bad("glTF", e.to_string()))?.into_json();
    let data = data.unwrap_or_default().to_vec();
    if !json.extensions_required.is_empty() {
        let names = json.extensions_required.join(", ");
        return Err(bad("extensionsRequired", format!("expected plain glTF 2.0, found {names}; export without")));
    }
    for (i, buffer) in json.buffers.iter().enumerate() {
        if i > 0 || buffer.uri.is_some() {
            let problem = "expected all data in the file itself, found some elsewhere; export as one .glb";
            return Err(bad(format!("buffer {i}"), problem));
        }
    }
    for (i, image) in json.images.iter().enumerate() {
        if image.uri.as_ref().is_some_and(|uri| !uri.starts_with("data:")) {
            let problem = "expected the picture in the file itself, found a link; export as one .glb";
            return Err(bad(format!("image {i}"), problem));
        }
    }
    ranges(&json, data.len())?;
    Ok((json, data))
}

/// Every attribute of a mesh is there and holds the numbers that it may: of others the crate panics.
fn attributes(json: &Root) -> Result<()> {
    use ComponentType::{F32, U8, U16};
    use Semantic::{Joints, Positions, Weights};
    for (m, mesh) in json.meshes.iter().enumerate() {
        for (semantic, index) in mesh.primitives.iter().flat_map(|p| &p.attributes) {
            let Some(accessor) = json.accessors.get(index.value()) else {
                let problem = format!("expected one of {} accessors, found {index}", json.accessors.len());
                return Err(bad(format!("mesh {m}"), problem));
            };
            let (Valid(component), Valid(kind)) = (accessor.component_type, accessor.type_) else { continue };
            let sound = match semantic {
                Valid(Positions) => component.0 == F32 && kind == Type::Vec3,
                Valid(Joints(_)) => matches!(component.0, U8 | U16) && kind == Type::Vec4,
                Valid(Weights(_)) => matches!(component.0, F32 | U8 | U16) && kind == Type::Vec4,
                _ => true,
            };
            if !sound {
                let problem = format!("expected numbers fit for {semantic:?}, found {:?} {kind:?}", component.0);
                return Err(bad(format!("mesh {m}, accessor {index}"), problem));
            }
        }
    }
    Ok(())
}

/// Every view lies in the data, every accessor in its view.
fn ranges(json: &Root, length: usize) -> Result<()> {
    for (i, view) in json.buffer_views.iter().enumerate() {
        let end = view.byte_offset.map_or(0, |o| o.0).saturating_add(view.byte_length.0);
        if end > length as u64 {
            return Err(bad(format!("bufferView {i}"), format!("expected {end} bytes of data, found {length}")));
        }
    }
    let fits = |view: usize, offset: u64, stride: Option<u64>, count: u64, size: u64| {
        let stride = stride.unwrap_or(size);
        let end = offset.saturating_add(count.saturating_sub(1).saturating_mul(stride)).saturating_add(size);
        count == 0 || end <= json.buffer_views[view].byte_length.0
    };
    for (i, accessor) in json.accessors.iter().enumerate() {
        let (component, kind) = (accessor.component_type.unwrap().0, accessor.type_.unwrap());
        let size = (component.size() * kind.multiplicity()) as u64;
        let mut sound = accessor.buffer_view.is_none_or(|view| {
            let stride = json.buffer_views[view.value()].byte_stride.map(|s| s.0 as u64);
            fits(view.value(), accessor.byte_offset.map_or(0, |o| o.0), stride, accessor.count.0, size)
        });
        if let Some(sparse) = &accessor.sparse {
            let (indices, values) = (&sparse.indices, &sparse.values);
            let width = indices.component_type.unwrap().0.size() as u64;
            sound &= sparse.count.0 <= accessor.count.0
                && fits(indices.buffer_view.value(), indices.byte_offset.0, None, sparse.count.0, width)
                && fits(values.buffer_view.value(), values.byte_offset.0, None, sparse.count.0, size);
        }
        if !sound {
            return Err(bad(format!("accessor {i}"), "reaches beyond its data"));
        }
    }
    Ok(())
}

/// The nodes of a character that are needed: joints, all they hang from, and stiff parts that hang from them.
#[derive(Debug)]
pub(super) struct Parts {
    /// Nodes, parents first.
    pub nodes: Vec<usize>,
    /// Bone of each node: 1 + its place in `nodes`.
    pub bone_of: Vec<Option<usize>>,
    /// Nodes with a skinned mesh.
    pub skinned: Vec<usize>,
    parents: Vec<Option<usize>>,
}

impl Parts {
    /// # Errors
    /// No skinned mesh; nodes that go round in circles.
    pub fn of(json: &Root) -> Result<Self> {
        let order = from_the_top(json)?;
        let mut parents = vec![None; json.nodes.len()];
        for (n, node) in json.nodes.iter().enumerate() {
            node.children.iter().flatten().for_each(|child| parents[child.value()] = Some(n));
        }
        let skinned = |n: &usize| json.nodes[*n].mesh.is_some() && json.nodes[*n].skin.is_some();
        let skinned: Vec<usize> = order.iter().copied().filter(skinned).collect();
        if skinned.is_empty() {
            let found = if json.meshes.is_empty() { "no mesh" } else { "meshes without a skin" };
            return Err(bad("skins", format!("expected a mesh that is bound to a skeleton, found {found}")));
        }
        let mut joint = vec![false; json.nodes.len()];
        let mut needed = vec![false; json.nodes.len()];
        for n in &skinned {
            let skin = json.nodes[*n].skin.expect("these have one");
            for j in &json.skins[skin.value()].joints {
                joint[j.value()] = true;
                std::iter::successors(Some(j.value()), |&j| parents[j]).for_each(|j| needed[j] = true);
            }
        }
        for &n in &order {
            // What hangs from a joint moves with it.
            let hangs = parents[n].is_some_and(|p| joint[p]);
            joint[n] |= hangs;
            needed[n] |= hangs && !skinned.contains(&n);
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
    /// A node that is scaled unevenly or turned inside out.
    pub fn bones(&self, json: &Root) -> Result<Vec<Bone>> {
        let mut bones = vec![Bone::new("size", Vec3::ZERO)];
        for (&n, name) in self.nodes.iter().zip(self.names(json)) {
            let (scale, rotation, translation) = local(&json.nodes[n]).to_scale_rotation_translation();
            let size = scale.x;
            if !(size > 0.0 && scale.is_finite() && (scale - size).abs().max_element() <= EVEN * size) {
                let problem = format!("expected one scale above 0 along all axes, found {scale}; apply it first");
                return Err(bad(format!("node {n} ({name})"), problem));
            }
            if !(translation.is_finite() && rotation.is_finite()) {
                return Err(bad(format!("node {n} ({name})"), "expected finite numbers, found others"));
            }
            let parent = self.parents[n].and_then(|p| self.bone_of[p]);
            bones.push(Bone {
                parent: Some(parent.unwrap_or(0)),
                rotation: rotation.normalize(),
                scale: Vec3::splat(size),
                ..Bone::new(&name, translation)
            });
        }
        Ok(bones)
    }
}

/// Nodes of the scene that is shown, parents before children.
fn from_the_top(json: &Root) -> Result<Vec<usize>> {
    let scene = json.scene.map_or(0, |s| s.value());
    let Some(scene) = json.scenes.get(scene) else { return Err(bad("scenes", "expected a scene, found none")) };
    let mut order: Vec<usize> = Vec::new();
    let mut seen = vec![false; json.nodes.len()];
    let mut open: Vec<usize> = scene.nodes.iter().rev().map(|n| n.value()).collect();
    while let Some(n) = open.pop() {
        if std::mem::replace(&mut seen[n], true) {
            return Err(bad(format!("node {n}"), "expected one parent, found two"));
        }
        order.push(n);
        open.extend(json.nodes[n].children.iter().flatten().rev().map(|c| c.value()));
    }
    let joints = json.skins.iter().flat_map(|s| &s.joints).map(|j| j.value());
    match joints.into_iter().find(|&j| !seen[j]) {
        Some(lost) => Err(bad(format!("node {lost}"), "expected the joint in the scene, found it nowhere")),
        None => Ok(order),
    }
}

fn local(node: &Node) -> Mat4 {
    if let Some(matrix) = node.matrix {
        return Mat4::from_cols_array(&matrix);
    }
    let rotation = node.rotation.map_or(Quat::IDENTITY, |q| Quat::from_array(q.0));
    let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { Quat::IDENTITY };
    let (scale, place) = (node.scale.map_or(Vec3::ONE, Vec3::from), node.translation.map_or(Vec3::ZERO, Vec3::from));
    Mat4::from_scale_rotation_translation(scale, rotation, place)
}

/// Global rest transforms of the bones.
pub(super) fn globals(bones: &[Bone]) -> Vec<(Vec3, Quat)> {
    frames(bones).into_iter().map(|(frame, turn)| (frame.translation.into(), turn)).collect()
}

/// The same with scale; and apart from it the rotation, which uneven rounding cannot bend.
fn frames(bones: &[Bone]) -> Vec<(Affine3A, Quat)> {
    let mut frames: Vec<(Affine3A, Quat)> = Vec::with_capacity(bones.len());
    for bone in bones {
        let own = Affine3A::from_scale_rotation_translation(bone.scale, bone.rotation, bone.translation);
        let (frame, turn) = bone.parent.map_or((Affine3A::IDENTITY, Quat::IDENTITY), |p| frames[p]);
        frames.push((frame * own, (turn * bone.rotation).normalize()));
    }
    frames
}

/// How low the skinned meshes reach along `up` in the rest pose.
pub(super) fn lowest(json: &Root, data: &[u8], parts: &Parts, bones: &[Bone], up: Vec3) -> Result<f32> {
    let document = gltf::Document::from_json(json.clone()).map_err(|e| bad("glTF", e.to_string()))?;
    let frames = frames(bones);
    let mut low = f32::INFINITY;
    for node in document.nodes().filter(|n| parts.skinned.contains(&n.index())) {
        let (Some(skin), Some(mesh)) = (node.skin(), node.mesh()) else { continue };
        let bind = skin.reader(|_| Some(data)).read_inverse_bind_matrices();
        let bind: Vec<Mat4> = bind.into_iter().flatten().map(|m| Mat4::from_cols_array_2d(&m)).collect();
        let joint = |(k, node): (usize, gltf::Node)| {
            let frame = parts.bone_of[node.index()].map_or(Affine3A::IDENTITY, |b| frames[b].0);
            Mat4::from(frame) * bind.get(k).copied().unwrap_or_default()
        };
        let joints: Vec<Mat4> = skin.joints().enumerate().map(joint).collect();
        low = mesh.primitives().map(|p| lowest_vertex(&p, data, &joints, up)).fold(low, f32::min);
    }
    if low.is_finite() { Ok(low) } else { Err(bad("meshes", "expected vertices bound to joints, found none")) }
}

fn lowest_vertex(primitive: &gltf::Primitive, data: &[u8], joints: &[Mat4], up: Vec3) -> f32 {
    let reader = primitive.reader(|_| Some(data));
    let (Some(places), Some(by), Some(weights)) =
        (reader.read_positions(), reader.read_joints(0), reader.read_weights(0))
    else {
        return f32::INFINITY;
    };
    let height = |((place, by), weights): (([f32; 3], [u16; 4]), [f32; 4])| {
        let height = |k: usize| {
            let matrix = joints.get(by[k] as usize).copied().unwrap_or_default();
            weights[k] * matrix.transform_point3(place.into()).dot(up)
        };
        (0..4).map(height).sum::<f32>()
    };
    places.zip(by.into_u16()).zip(weights.into_f32()).map(height).fold(f32::INFINITY, f32::min)
}
