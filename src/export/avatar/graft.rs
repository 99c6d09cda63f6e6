//! A character's outfit, grafted onto a file in the making.

use std::collections::BTreeMap;

use gltf_json::accessor::{ComponentType, Type};
use gltf_json::buffer::{Target, View};
use gltf_json::mesh::{MorphTarget, Primitive, Semantic};
use gltf_json::texture::Texture;
use gltf_json::validation::{Checked, USize64};
use gltf_json::{Accessor, Image, Index, Mesh, Root};

use super::material::textures;
use super::outfit::{Piece, Sewn};
use super::picture::Picture;
use super::vertices::{self, Set, Vertices};
use super::{Avatar, Graft};
use crate::export::actor::Dress;
use crate::export::body::bounds;
use crate::export::buffer::Stream;

impl Avatar {
    /// Writes everything that people played by this character share.
    pub(in crate::export) fn graft(&self, root: &mut Root, binary: &mut Vec<u8>) -> Graft {
        let outfit = &self.outfit;
        let materials = self.materials(root, binary);
        let mut scion = Scion { root, binary };
        let vertices: Vec<Primitive> = outfit.vertices.iter().map(|v| scion.vertices(v)).collect();
        let corners: Vec<Index<Accessor>> = outfit.corners.iter().map(|c| scion.corners(c)).collect();
        let primitive = |piece: &Piece| Primitive {
            indices: piece.corners.map(|c| corners[c]),
            material: piece.material.map(|m| Index::new(materials + m as u32)),
            mode: Checked::Valid(piece.mode),
            ..vertices[piece.vertices].clone()
        };
        let mesh = |sewn: &Sewn| Mesh {
            extensions: None,
            extras: sewn.extras.clone(),
            name: sewn.name.clone(),
            primitives: sewn.pieces.iter().map(primitive).collect(),
            weights: sewn.weights.clone(),
        };
        let meshes: Vec<Index<Mesh>> = outfit.meshes.iter().map(|sewn| scion.root.push(mesh(sewn))).collect();
        let binds: Vec<Option<Index<Accessor>>> =
            outfit.skins.iter().map(|s| s.matrices.as_ref().map(|m| scion.plain(None, m, Type::Mat4))).collect();
        let dress = |(worn, skin): &(_, usize)| {
            let worn: &super::outfit::Worn = worn;
            let joints = outfit.skins[*skin].joints.clone();
            Dress { mesh: meshes[worn.mesh], bind: binds[*skin], joints, weights: worn.weights.clone() }
        };
        let mut bones = self.bones.clone();
        for (worn, bone) in &outfit.stiff {
            bones[*bone].mesh = Some(meshes[worn.mesh]);
            bones[*bone].weights.clone_from(&worn.weights);
        }
        Graft { dresses: outfit.dresses.iter().map(dress).collect(), bones }
    }

    /// Writes the materials, and all that they need; returns the number of the first.
    fn materials(&self, root: &mut Root, binary: &mut Vec<u8>) -> u32 {
        let outfit = &self.outfit;
        let [images, samplers, paints, materials] =
            [root.images.len(), root.samplers.len(), root.textures.len(), root.materials.len()].map(|n| n as u32);
        for picture in &outfit.pictures {
            paint(picture, root, binary);
        }
        root.samplers.extend(outfit.samplers.iter().cloned());
        root.textures.extend(outfit.textures.iter().map(|texture| Texture {
            sampler: texture.sampler.map(|s| Index::new(samplers + s.value() as u32)),
            source: Index::new(images + texture.source.value() as u32),
            ..texture.clone()
        }));
        for material in &outfit.materials {
            let mut copy = material.clone();
            textures(&mut copy).for_each(|(texture, _)| *texture = Index::new(paints + texture.value() as u32));
            root.materials.push(copy);
        }
        materials
    }
}

fn paint(picture: &Picture, root: &mut Root, binary: &mut Vec<u8>) {
    let view = root.push(View {
        buffer: Index::new(0),
        byte_length: USize64::from(picture.bytes.len()),
        byte_offset: Some(USize64::from(binary.len())),
        byte_stride: None,
        name: None,
        target: None,
        extensions: None,
        extras: None,
    });
    binary.extend_from_slice(&picture.bytes);
    binary.resize(binary.len().next_multiple_of(4), 0);
    root.push(Image {
        buffer_view: Some(view),
        mime_type: Some(picture.format.clone()),
        name: picture.name.clone(),
        uri: None,
        extensions: None,
        extras: None,
    });
}

struct Scion<'a> {
    root: &'a mut Root,
    binary: &'a mut Vec<u8>,
}

impl Scion<'_> {
    /// An accessor of floats in a view of its own.
    fn plain<T: bytemuck::Pod>(&mut self, target: Option<Target>, values: &[T], kind: Type) -> Index<Accessor> {
        self.numbers(target, values, ComponentType::F32, kind)
    }

    fn numbers<T: bytemuck::Pod>(
        &mut self,
        target: Option<Target>,
        values: &[T],
        component: ComponentType,
        kind: Type,
    ) -> Index<Accessor> {
        let mut stream = Stream::next(self.root, target, None);
        let index = stream.accessor(self.root, values, component, kind);
        stream.finish(self.root, self.binary);
        index
    }

    fn set(&mut self, set: &Set) -> Index<Accessor> {
        let array = Some(Target::ArrayBuffer);
        match set.kind {
            Type::Vec2 => self.plain::<[f32; 2]>(array, bytemuck::cast_slice(&set.values), set.kind),
            Type::Vec3 => self.plain::<[f32; 3]>(array, bytemuck::cast_slice(&set.values), set.kind),
            _ => self.plain::<[f32; 4]>(array, bytemuck::cast_slice(&set.values), set.kind),
        }
    }

    fn places(&mut self, places: &[glam::Vec3]) -> Index<Accessor> {
        let index = self.plain(Some(Target::ArrayBuffer), places, Type::Vec3);
        let (low, high) = bounds(places);
        let accessor = &mut self.root.accessors[index.value()];
        (accessor.min, accessor.max) = (Some(low), Some(high));
        index
    }

    /// A primitive of these vertices that has nothing else yet.
    fn vertices(&mut self, vertices: &Vertices) -> Primitive {
        let array = Some(Target::ArrayBuffer);
        let mut attributes = BTreeMap::new();
        let mut put = |semantic, index| attributes.insert(Checked::Valid(semantic), index);
        put(Semantic::Positions, self.places(&vertices.places));
        if let Some(normals) = &vertices.normals {
            put(Semantic::Normals, self.plain(array, normals, Type::Vec3));
        }
        if let Some(tangents) = &vertices.tangents {
            put(Semantic::Tangents, self.plain(array, tangents, Type::Vec4));
        }
        for (n, set) in (0..).zip(&vertices.colours) {
            put(Semantic::Colors(n), self.set(set));
        }
        for (n, set) in (0..).zip(&vertices.textured) {
            put(Semantic::TexCoords(n), self.set(set));
        }
        for (n, set) in (0..).zip(&vertices.bound) {
            put(Semantic::Joints(n), self.joints(&set.joints));
            put(Semantic::Weights(n), self.plain(array, &set.weights, Type::Vec4));
        }
        let targets: Vec<MorphTarget> = vertices.targets.iter().map(|t| self.target(t)).collect();
        Primitive {
            attributes,
            targets: Some(targets).filter(|t| !t.is_empty()),
            extensions: None,
            extras: None,
            indices: None,
            material: None,
            mode: Checked::default(),
        }
    }

    /// Joints in bytes if they fit.
    fn joints(&mut self, joints: &[[u16; 4]]) -> Index<Accessor> {
        let array = Some(Target::ArrayBuffer);
        if joints.iter().flatten().all(|&j| j < 256) {
            let bytes: Vec<[u8; 4]> = joints.iter().map(|four| four.map(|j| j as u8)).collect();
            return self.numbers(array, &bytes, ComponentType::U8, Type::Vec4);
        }
        self.numbers(array, joints, ComponentType::U16, Type::Vec4)
    }

    fn target(&mut self, target: &vertices::Target) -> MorphTarget {
        let array = Some(Target::ArrayBuffer);
        MorphTarget {
            positions: target.places.as_ref().map(|p| self.places(p)),
            normals: target.normals.as_ref().map(|n| self.plain(array, n, Type::Vec3)),
            tangents: target.tangents.as_ref().map(|t| self.plain(array, t, Type::Vec3)),
        }
    }

    /// Corners in two bytes if they fit; the highest number of those is no vertex.
    fn corners(&mut self, corners: &[u32]) -> Index<Accessor> {
        let target = Some(Target::ElementArrayBuffer);
        if corners.iter().all(|&c| c < u32::from(u16::MAX)) {
            let short: Vec<u16> = corners.iter().map(|&c| c as u16).collect();
            return self.numbers(target, &short, ComponentType::U16, Type::Scalar);
        }
        self.numbers(target, corners, ComponentType::U32, Type::Scalar)
    }
}
