//! A person of a file in the making: nodes, skins and keys of whoever plays it, mannequin or somebody's own character.

use std::collections::BTreeMap;

use glam::{Quat, Vec3};
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::animation::{Channel, Interpolation, Property, Sampler, Target};
use gltf_json::scene::UnitQuaternion;
use gltf_json::validation::{Checked, USize64};
use gltf_json::{Accessor, Animation, Buffer, Index, Mesh, Node, Root, Scene, Skin};

use super::buffer::{Stream, assemble};
use crate::motion::FPS;
use crate::stage::Character;

/// A node of an actor: a joint, or something that joints hang from. Its rest pose is used where no key says otherwise.
#[derive(Clone, Debug)]
pub(super) struct Bone {
    pub name: String,
    /// Index of the parent, smaller than the bone's own; `None` for what hangs from the person's top node.
    pub parent: Option<usize>,
    pub translation: Vec3,
    pub rotation: Quat,
    pub scale: Vec3,
    /// A stiff part that hangs from it: eyes, glasses.
    pub mesh: Option<Index<Mesh>>,
    /// Weights of the stiff part's morph targets, if they are not the mesh's own.
    pub weights: Option<Vec<f32>>,
}

impl Bone {
    pub(super) fn new(name: &str, translation: Vec3) -> Self {
        let (rotation, scale) = (Quat::IDENTITY, Vec3::ONE);
        Self { name: name.into(), parent: None, translation, rotation, scale, mesh: None, weights: None }
    }
}

/// A mesh and how it is bound.
#[derive(Clone, Debug)]
pub(super) struct Dress {
    pub mesh: Index<Mesh>,
    /// Inverse bind matrices; none if they are all identities.
    pub bind: Option<Index<Accessor>>,
    /// The bones they are for.
    pub joints: Vec<usize>,
    /// Weights of the mesh's morph targets, if they are not its own.
    pub weights: Option<Vec<f32>>,
}

/// Keys of an actor, one per frame of the person's motion.
pub(super) struct Keys {
    /// The bone that is moved.
    pub root: usize,
    /// Its translations.
    pub places: Vec<Vec3>,
    /// Bones that turn, and their rotations.
    pub turns: Vec<(usize, Vec<Quat>)>,
}

/// Keys that differ less than this from each other stand for one (translations in metres).
const STILL: f32 = 1e-5;

/// Writes people one after the other.
pub(super) struct Writer {
    root: Root,
    animation: Animation,
    scene: Vec<Index<Node>>,
    last_frame: u32,
    times: Stream,
    vectors: Stream,
    rotations: Stream,
    /// Accessors of key times, by the frames they stand for.
    shared_times: BTreeMap<Vec<u32>, Index<Accessor>>,
}

impl Writer {
    pub(super) fn new(root: Root, last_frame: u32) -> Self {
        let animation = Animation {
            name: Some("crowd".into()),
            channels: Vec::new(),
            samplers: Vec::new(),
            extensions: None,
            extras: Default::default(),
        };
        let first = root.buffer_views.len() as u32;
        let [times, vectors, rotations] = [0, 1, 2].map(|after| Stream::new(first + after, None, None));
        let shared_times = BTreeMap::new();
        Self { root, animation, scene: Vec::new(), last_frame, times, vectors, rotations, shared_times }
    }

    /// Writes one person: a top node, the bones under it, and a mesh node for each dress.
    pub(super) fn person(
        &mut self,
        index: usize,
        character: &Character,
        bones: &[Bone],
        dresses: &[Dress],
        keys: &Keys,
    ) {
        let nodes = self.bones(index, bones, keys);
        let tops = bones.iter().zip(&nodes).filter(|(b, _)| b.parent.is_none()).map(|(_, &n)| n).collect();
        let top = self.root.push(Node {
            name: Some(format!("person_{index}")),
            children: Some(tops),
            extras: presence(index, character),
            ..Default::default()
        });
        self.scene.push(top);
        for (k, dress) in dresses.iter().enumerate() {
            let suffix = if k == 0 { String::new() } else { format!("_{k}") };
            let skin = self.root.push(Skin {
                joints: dress.joints.iter().map(|&j| nodes[j]).collect(),
                inverse_bind_matrices: dress.bind,
                skeleton: Some(nodes[keys.root]).filter(|_| dress.joints.iter().all(|&j| hangs(bones, j, keys.root))),
                name: Some(format!("person_{index}{suffix}")),
                extensions: None,
                extras: Default::default(),
            });
            let body = self.root.push(Node {
                name: Some(format!("person_{index}_body{suffix}")),
                mesh: Some(dress.mesh),
                skin: Some(skin),
                weights: dress.weights.clone(),
                ..Default::default()
            });
            self.scene.push(body);
        }
        self.presence_keys(top, character.begin, character.end());
        self.motion_keys(&nodes, character, keys);
    }

    /// Writes a stiff thing that is there from frame `begin` on, at a place per frame.
    pub(super) fn thing(
        &mut self,
        name: &str,
        mesh: Index<Mesh>,
        begin: u32,
        places: &[(Vec3, Quat)],
        extras: &serde_json::Value,
    ) {
        let Some(first) = places.first() else { return };
        let node = self.root.push(Node {
            name: Some(name.into()),
            mesh: Some(mesh),
            translation: Some(first.0.to_array()),
            rotation: Some(UnitQuaternion(first.1.to_array())),
            extras: Some(serde_json::value::to_raw_value(extras).expect("plain data")),
            ..Default::default()
        });
        self.scene.push(node);
        self.presence_keys(node, begin, begin + places.len() as u32 - 1);
        // Keys at both ends of every time over which it lies still.
        let last = places.len() - 1;
        let differs = |i: usize| i == 0 || i == last || places[i] != places[i - 1] || places[i] != places[i + 1];
        let kept: Vec<usize> = (0..=last).filter(|&i| differs(i)).collect();
        let frames: Vec<u32> = kept.iter().map(|&i| begin + i as u32).collect();
        let ways: Vec<Vec3> = kept.iter().map(|&i| places[i].0).collect();
        let turns = continuous(&kept.iter().map(|&i| places[i].1).collect::<Vec<_>>());
        let output = self.vectors.accessor(&mut self.root, &ways, ComponentType::F32, Type::Vec3);
        self.channel(node, Property::Translation, frames.clone(), output, Interpolation::Linear);
        let output = self.rotations.accessor(&mut self.root, &turns, ComponentType::I16, Type::Vec4);
        self.channel(node, Property::Rotation, frames, output, Interpolation::Linear);
    }

    /// The bones' nodes, posed as in the person's first frame.
    fn bones(&mut self, index: usize, bones: &[Bone], keys: &Keys) -> Vec<Index<Node>> {
        let first = self.root.nodes.len() as u32;
        let mut children: Vec<Vec<Index<Node>>> = vec![Vec::new(); bones.len()];
        for (b, bone) in bones.iter().enumerate() {
            if let Some(parent) = bone.parent {
                children[parent].push(Index::new(first + b as u32));
            }
        }
        for ((b, bone), children) in bones.iter().enumerate().zip(children) {
            let place = if b == keys.root { keys.places[0] } else { bone.translation };
            let turn = keys.turns.iter().find(|(t, _)| *t == b).map_or(bone.rotation, |(_, turns)| turns[0]);
            self.root.push(Node {
                name: Some(format!("person_{index}_{}", bone.name)),
                children: (!children.is_empty()).then_some(children),
                translation: Some(place.to_array()),
                rotation: Some(UnitQuaternion(turn.normalize().to_array())),
                scale: (bone.scale != Vec3::ONE).then_some(bone.scale.to_array()),
                mesh: bone.mesh,
                weights: bone.weights.clone(),
                ..Default::default()
            });
        }
        (first..first + bones.len() as u32).map(Index::new).collect()
    }

    /// Hides what hangs from a node outside of some frames.
    fn presence_keys(&mut self, top: Index<Node>, begin: u32, end: u32) {
        let (mut frames, mut scales) = (Vec::new(), Vec::new());
        let mut key = |frame: u32, scale: f32| {
            frames.push(frame);
            scales.push(Vec3::splat(scale));
        };
        if begin > 0 {
            key(0, 0.0);
        }
        key(begin, 1.0);
        if end < self.last_frame {
            key(end + 1, 0.0);
        }
        if frames.len() > 1 {
            let output = self.vectors.accessor(&mut self.root, &scales, ComponentType::F32, Type::Vec3);
            self.channel(top, Property::Scale, frames, output, Interpolation::Step);
        }
    }

    fn motion_keys(&mut self, nodes: &[Index<Node>], character: &Character, keys: &Keys) {
        let all: Vec<u32> = (character.begin..=character.end()).collect();
        let ends: Vec<u32> = if all.len() > 1 { vec![character.begin, character.end()] } else { all.clone() };
        let frames = |still: bool| if still { ends.clone() } else { all.clone() };
        let still = keys.places.iter().all(|p| p.distance(keys.places[0]) < STILL);
        let places: Vec<Vec3> = frames(still).iter().map(|f| keys.places[(f - character.begin) as usize]).collect();
        let output = self.vectors.accessor(&mut self.root, &places, ComponentType::F32, Type::Vec3);
        self.channel(nodes[keys.root], Property::Translation, frames(still), output, Interpolation::Linear);
        for (bone, turns) in &keys.turns {
            let track = continuous(turns);
            let still = track.iter().all(|q| q == &track[0]);
            let turns: Vec<[i16; 4]> = frames(still).iter().map(|f| track[(f - character.begin) as usize]).collect();
            let output = self.rotations.accessor(&mut self.root, &turns, ComponentType::I16, Type::Vec4);
            self.channel(nodes[*bone], Property::Rotation, frames(still), output, Interpolation::Linear);
        }
    }

    fn channel(
        &mut self,
        node: Index<Node>,
        path: Property,
        frames: Vec<u32>,
        output: Index<Accessor>,
        interpolation: Interpolation,
    ) {
        let sampler = Sampler {
            input: self.key_times(frames),
            output,
            interpolation: Checked::Valid(interpolation),
            extensions: None,
            extras: Default::default(),
        };
        let target = Target { node, path: Checked::Valid(path), extensions: None, extras: Default::default() };
        let sampler = Index::push(&mut self.animation.samplers, sampler);
        self.animation.channels.push(Channel { sampler, target, extensions: None, extras: Default::default() });
    }

    fn key_times(&mut self, frames: Vec<u32>) -> Index<Accessor> {
        if let Some(&index) = self.shared_times.get(&frames) {
            return index;
        }
        let seconds: Vec<f32> = frames.iter().map(|&f| secs(f)).collect();
        let index = self.times.accessor(&mut self.root, &seconds, ComponentType::F32, Type::Scalar);
        let accessor = &mut self.root.accessors[index.value()];
        accessor.min = Some(serde_json::json!([seconds[0]]));
        accessor.max = Some(serde_json::json!([seconds[seconds.len() - 1]]));
        self.shared_times.insert(frames, index);
        index
    }

    /// The file.
    pub(super) fn finish(self, mut binary: Vec<u8>) -> Vec<u8> {
        let mut root = self.root;
        for stream in [self.times, self.vectors, self.rotations] {
            stream.finish(&mut root, &mut binary);
        }
        root.animations.push(self.animation);
        let scene =
            Scene { nodes: self.scene, name: Some("crowd".into()), extensions: None, extras: Default::default() };
        root.scene = Some(root.push(scene));
        root.push(Buffer {
            byte_length: USize64::from(binary.len()),
            uri: None,
            name: None,
            extensions: None,
            extras: Default::default(),
        });
        assemble(&root, binary)
    }
}

/// Whether a bone is `top` or below it.
fn hangs(bones: &[Bone], bone: usize, top: usize) -> bool {
    std::iter::successors(Some(bone), |&b| bones[b].parent).any(|b| b == top)
}

fn secs(frame: u32) -> f32 {
    frame as f32 / FPS
}

fn presence(person: usize, character: &Character) -> gltf_json::Extras {
    let extras = serde_json::json!({
        "person": person,
        "begin_secs": secs(character.begin),
        "end_secs": secs(character.end()),
        "build": character.build.name,
    });
    Some(serde_json::value::to_raw_value(&extras).expect("plain data"))
}

/// A rotation's track as normalised 16-bit integers, signs chosen so that neighbours take the short way.
fn continuous(track: &[Quat]) -> Vec<[i16; 4]> {
    let mut before = Quat::IDENTITY;
    let pack = |q: &Quat| {
        let q = q.normalize();
        before = if before.dot(q) < 0.0 { -q } else { q };
        crate::patch::pack_rotation(before)
    };
    track.iter().map(pack).collect()
}
