//! One clip on any skeleton as a binary glTF file: a node to each joint, and a skin without a mesh, so that readers
//! see a skeleton and its rest pose.

use glam::{Mat4, Quat, Vec3};
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::animation::{Channel, Interpolation, Property, Sampler, Target};
use gltf_json::scene::UnitQuaternion;
use gltf_json::validation::{Checked, USize64};
use gltf_json::{Accessor, Animation, Asset, Buffer, Index, Node, Root, Scene, Skin};

use super::buffer::{Stream, assemble};
use crate::motion::{Clip, Joint};

/// The clip as the bytes of a `.glb` file: a key at every frame, rotations in single precision. Bone ends stand in
/// the nodes' extras as `tip`. O(frames x joints).
pub fn clip_glb(clip: &Clip) -> Vec<u8> {
    let mut root = Root { asset: asset(), ..Default::default() };
    let joints = &clip.skeleton.joints;
    let children = children(joints);
    for (joint, children) in joints.iter().zip(children) {
        root.push(node(joint, children));
    }
    let tops = joints.iter().enumerate().filter(|(_, j)| j.parent.is_none());
    let nodes = tops.map(|(i, _)| Index::new(i as u32)).collect();
    let scene = Scene { nodes, name: Some(clip.name.clone()), extensions: None, extras: Default::default() };
    root.scene = Some(root.push(scene));
    let mut binary = Vec::new();
    if clip.frames() > 0 {
        let bind = inverse_bind_matrices(&mut root, clip, &mut binary);
        let joints = (0..joints.len() as u32).map(Index::new).collect();
        root.push(skin(clip, joints, bind));
        let animation = animation(&mut root, clip, &mut binary);
        root.animations.push(animation);
        root.push(buffer(&binary));
    }
    assemble(&root, binary)
}

fn asset() -> Asset {
    Asset { generator: Some(concat!("Crowdquilt ", env!("CARGO_PKG_VERSION")).into()), ..Default::default() }
}

fn children(joints: &[Joint]) -> Vec<Vec<Index<Node>>> {
    let mut children = vec![Vec::new(); joints.len()];
    for (i, joint) in joints.iter().enumerate() {
        if let Some(parent) = joint.parent {
            children[parent].push(Index::new(i as u32));
        }
    }
    children
}

fn node(joint: &Joint, children: Vec<Index<Node>>) -> Node {
    let tip = joint.tip.map(|tip| serde_json::json!({ "tip": tip.to_array() }));
    Node {
        name: Some(joint.name.clone()),
        children: (!children.is_empty()).then_some(children),
        translation: Some(joint.offset.to_array()),
        rotation: Some(UnitQuaternion(Quat::IDENTITY.to_array())),
        extras: tip.map(|tip| serde_json::value::to_raw_value(&tip).expect("plain data")),
        ..Default::default()
    }
}

fn skin(clip: &Clip, joints: Vec<Index<Node>>, bind: Index<Accessor>) -> Skin {
    Skin {
        joints,
        inverse_bind_matrices: Some(bind),
        skeleton: None,
        name: Some(clip.name.clone()),
        extensions: None,
        extras: Default::default(),
    }
}

/// A skeleton at rest is not turned, so that binding only moves.
fn inverse_bind_matrices(root: &mut Root, clip: &Clip, binary: &mut Vec<u8>) -> Index<Accessor> {
    let mut places: Vec<Vec3> = Vec::with_capacity(clip.skeleton.joints.len());
    for joint in &clip.skeleton.joints {
        places.push(joint.parent.map_or(Vec3::ZERO, |p| places[p]) + joint.offset);
    }
    let matrices: Vec<[f32; 16]> = places.iter().map(|p| Mat4::from_translation(-*p).to_cols_array()).collect();
    let mut stream = Stream::new(0, None, None);
    let index = stream.accessor(root, &matrices, ComponentType::F32, Type::Mat4);
    stream.finish(root, binary);
    index
}

/// One animation with the roots' places and all joints' rotations.
fn animation(root: &mut Root, clip: &Clip, binary: &mut Vec<u8>) -> Animation {
    let mut animation = Animation {
        name: Some(clip.name.clone()),
        channels: Vec::new(),
        samplers: Vec::new(),
        extensions: None,
        extras: Default::default(),
    };
    let times = key_times(root, clip, binary);
    let mut stream = Stream::new(2, None, None);
    let places = stream.accessor(root, &clip.root, ComponentType::F32, Type::Vec3);
    for (j, joint) in clip.skeleton.joints.iter().enumerate() {
        if joint.parent.is_none() {
            add(&mut animation, j, Property::Translation, times, places);
        }
        let turns = continuous((0..clip.frames()).map(|f| clip.pose(f)[j]));
        let turns = stream.accessor(root, &turns, ComponentType::F32, Type::Vec4);
        add(&mut animation, j, Property::Rotation, times, turns);
    }
    stream.finish(root, binary);
    animation
}

fn key_times(root: &mut Root, clip: &Clip, binary: &mut Vec<u8>) -> Index<Accessor> {
    let seconds: Vec<f32> = (0..clip.frames()).map(|f| (f as f64 / f64::from(clip.fps)) as f32).collect();
    let mut stream = Stream::new(1, None, None);
    let index = stream.accessor(root, &seconds, ComponentType::F32, Type::Scalar);
    let accessor = &mut root.accessors[index.value()];
    accessor.min = Some(serde_json::json!([seconds[0]]));
    accessor.max = Some(serde_json::json!([seconds[seconds.len() - 1]]));
    stream.finish(root, binary);
    index
}

fn add(animation: &mut Animation, node: usize, path: Property, input: Index<Accessor>, output: Index<Accessor>) {
    let interpolation = Checked::Valid(Interpolation::Linear);
    let sampler = Sampler { input, output, interpolation, extensions: None, extras: Default::default() };
    let sampler = Index::push(&mut animation.samplers, sampler);
    let node = Index::new(node as u32);
    let target = Target { node, path: Checked::Valid(path), extensions: None, extras: Default::default() };
    animation.channels.push(Channel { sampler, target, extensions: None, extras: Default::default() });
}

fn buffer(binary: &[u8]) -> Buffer {
    Buffer {
        byte_length: USize64::from(binary.len()),
        uri: None,
        name: None,
        extensions: None,
        extras: Default::default(),
    }
}

/// A rotation's track with signs chosen so that neighbours take the short way.
fn continuous(track: impl Iterator<Item = Quat>) -> Vec<Quat> {
    let mut before = Quat::IDENTITY;
    let next = |q: Quat| {
        let q = q.normalize();
        before = if before.dot(q) < 0.0 { -q } else { q };
        before
    };
    track.map(next).collect()
}
