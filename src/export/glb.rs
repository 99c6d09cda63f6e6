//! A crowd as one binary glTF file.
//!
//! Every person is one skin and one skinned mesh. The person's top node `person_N`, at the root of the scene, is the
//! parent of the joints and carries `extras: { person, begin_secs, end_secs }`; while the person is absent its scale
//! is keyed to 0, which hides the mesh, since a skinned mesh follows its joints alone. The mesh node `person_N_body`
//! is at the root of the scene too, as viewers want it. Vertices, inverse bind matrices and key times are shared.

use std::collections::BTreeMap;

use glam::{Mat4, Quat, Vec3};
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::animation::{Channel, Interpolation, Property, Sampler, Target};
use gltf_json::scene::UnitQuaternion;
use gltf_json::validation::{Checked, USize64};
use gltf_json::{Accessor, Animation, Asset, Buffer, Index, Mesh, Node, Root, Scene, Skin};

use super::body;
use super::buffer::{Stream, assemble};
use super::look::LOOKS;
use crate::motion::{FPS, JOINT_COUNT, canonical};
use crate::stage::{Character, Crowd};

/// The crowd as the bytes of a `.glb` file: all people with a final motion, one animation, keys at 30 frames a second.
pub fn glb(crowd: &Crowd) -> Vec<u8> {
    let people: Vec<(usize, &Character)> =
        crowd.characters.iter().enumerate().filter(|(_, c)| c.frames() > 0).collect();
    let mut root = Root { asset: asset(), ..Default::default() };
    let mut binary = Vec::new();
    if people.is_empty() {
        root.push(Scene {
            nodes: Vec::new(),
            name: Some("crowd".into()),
            extensions: None,
            extras: Default::default(),
        });
        root.scene = Some(Index::new(0));
        return assemble(&root, binary);
    }
    let count = people.last().map_or(0, |(i, _)| i + 1);
    let meshes = body::meshes(&mut root, &mut binary, count);
    let bind = inverse_bind_matrices(&mut root, &mut binary);
    let mut writer = Writer::new(root, crowd.domain.last_frame);
    for (index, character) in people {
        writer.person(index, character, meshes[index % LOOKS], bind);
    }
    writer.finish(binary)
}

fn asset() -> Asset {
    Asset { generator: Some(concat!("Crowdquilt ", env!("CARGO_PKG_VERSION")).into()), ..Default::default() }
}

/// The canonical rest pose's joints are not turned, so that binding only moves.
fn inverse_bind_matrices(root: &mut Root, binary: &mut Vec<u8>) -> Index<Accessor> {
    let mut rest = Vec::new();
    let skeleton = canonical();
    skeleton.globals(skeleton.joints[0].offset, &[Quat::IDENTITY; JOINT_COUNT], &mut rest);
    let matrices: Vec<[f32; 16]> = rest.iter().map(|(p, _)| Mat4::from_translation(-*p).to_cols_array()).collect();
    let mut stream = Stream::new(body::VIEWS, None, None);
    let index = stream.accessor(root, &matrices, ComponentType::F32, Type::Mat4);
    stream.finish(root, binary);
    index
}

/// Keys that differ less than this from each other stand for one (translations in metres).
const STILL: f32 = 1e-5;

struct Writer {
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
    fn new(root: Root, last_frame: u32) -> Self {
        let view = body::VIEWS + 1;
        let animation = Animation {
            name: Some("crowd".into()),
            channels: Vec::new(),
            samplers: Vec::new(),
            extensions: None,
            extras: Default::default(),
        };
        Self {
            root,
            animation,
            scene: Vec::new(),
            last_frame,
            times: Stream::new(view, None, None),
            vectors: Stream::new(view + 1, None, None),
            rotations: Stream::new(view + 2, None, None),
            shared_times: BTreeMap::new(),
        }
    }

    fn person(&mut self, index: usize, character: &Character, mesh: Index<Mesh>, bind: Index<Accessor>) {
        let joints = self.joints(index, character);
        let top = self.root.push(Node {
            name: Some(format!("person_{index}")),
            children: Some(vec![joints[0]]),
            extras: presence(index, character),
            ..Default::default()
        });
        let skin = self.root.push(Skin {
            joints: joints.clone(),
            inverse_bind_matrices: Some(bind),
            skeleton: Some(joints[0]),
            name: Some(format!("person_{index}")),
            extensions: None,
            extras: Default::default(),
        });
        let body = self.root.push(Node {
            name: Some(format!("person_{index}_body")),
            mesh: Some(mesh),
            skin: Some(skin),
            ..Default::default()
        });
        self.scene.extend([top, body]);
        self.presence_keys(top, character);
        self.motion_keys(&joints, character);
    }

    /// The joints' nodes, posed as in the person's first frame.
    fn joints(&mut self, index: usize, character: &Character) -> Vec<Index<Node>> {
        let first = self.root.nodes.len() as u32;
        let skeleton = canonical();
        for (j, joint) in skeleton.joints.iter().enumerate() {
            let children = (0..JOINT_COUNT).filter(|&c| skeleton.joints[c].parent == Some(j));
            let children: Vec<Index<Node>> = children.map(|c| Index::new(first + c as u32)).collect();
            let place = if j == 0 { character.root[0] } else { joint.offset };
            self.root.push(Node {
                name: Some(format!("person_{index}_{}", joint.name)),
                children: (!children.is_empty()).then_some(children),
                translation: Some(place.to_array()),
                rotation: Some(UnitQuaternion(character.pose(0)[j].normalize().to_array())),
                ..Default::default()
            });
        }
        (first..first + JOINT_COUNT as u32).map(Index::new).collect()
    }

    fn presence_keys(&mut self, top: Index<Node>, character: &Character) {
        let (mut frames, mut scales) = (Vec::new(), Vec::new());
        let mut key = |frame: u32, scale: f32| {
            frames.push(frame);
            scales.push(Vec3::splat(scale));
        };
        if character.begin > 0 {
            key(0, 0.0);
        }
        key(character.begin, 1.0);
        if character.end() < self.last_frame {
            key(character.end() + 1, 0.0);
        }
        if frames.len() > 1 {
            let output = self.vectors.accessor(&mut self.root, &scales, ComponentType::F32, Type::Vec3);
            self.channel(top, Property::Scale, frames, output, Interpolation::Step);
        }
    }

    fn motion_keys(&mut self, joints: &[Index<Node>], character: &Character) {
        let all: Vec<u32> = (character.begin..=character.end()).collect();
        let ends: Vec<u32> = if all.len() > 1 { vec![character.begin, character.end()] } else { all.clone() };
        let frames = |still: bool| if still { ends.clone() } else { all.clone() };
        let still = character.root.iter().all(|p| p.distance(character.root[0]) < STILL);
        let keys: Vec<Vec3> = frames(still).iter().map(|f| character.root[(f - character.begin) as usize]).collect();
        let output = self.vectors.accessor(&mut self.root, &keys, ComponentType::F32, Type::Vec3);
        self.channel(joints[0], Property::Translation, frames(still), output, Interpolation::Linear);
        for (j, &node) in joints.iter().enumerate() {
            let track = continuous((0..character.frames()).map(|i| character.pose(i)[j]));
            let still = track.iter().all(|q| q == &track[0]);
            let keys: Vec<[i16; 4]> = frames(still).iter().map(|f| track[(f - character.begin) as usize]).collect();
            let output = self.rotations.accessor(&mut self.root, &keys, ComponentType::I16, Type::Vec4);
            self.channel(node, Property::Rotation, frames(still), output, Interpolation::Linear);
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

    fn finish(self, mut binary: Vec<u8>) -> Vec<u8> {
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

fn secs(frame: u32) -> f32 {
    frame as f32 / FPS
}

fn presence(person: usize, character: &Character) -> gltf_json::Extras {
    let extras = serde_json::json!({
        "person": person,
        "begin_secs": secs(character.begin),
        "end_secs": secs(character.end()),
    });
    Some(serde_json::value::to_raw_value(&extras).expect("plain data"))
}

/// A rotation's track as normalised 16-bit integers, signs chosen so that neighbours take the short way.
fn continuous(track: impl Iterator<Item = Quat>) -> Vec<[i16; 4]> {
    let mut before = Quat::IDENTITY;
    let pack = |q: Quat| {
        let q = q.normalize();
        before = if before.dot(q) < 0.0 { -q } else { q };
        crate::patch::pack_rotation(before)
    };
    track.map(pack).collect()
}
