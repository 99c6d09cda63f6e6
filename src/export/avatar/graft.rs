//! A character's meshes, skins, materials and pictures, grafted onto a file in the making: only what is used, as it is.

use std::collections::BTreeMap;

use gltf_json::buffer::View;
use gltf_json::material::Material;
use gltf_json::texture::{Info, Texture};
use gltf_json::validation::USize64;
use gltf_json::{Accessor, Image, Index, Mesh, Root};

use super::{Avatar, Graft};
use crate::export::actor::Dress;

impl Avatar {
    /// Writes everything that people played by this character share.
    pub(in crate::export) fn graft(&self, root: &mut Root, binary: &mut Vec<u8>) -> Graft {
        let mut scion = Scion { from: &self.json, data: &self.data, root, binary, done: Done::default() };
        let mut dresses = Vec::new();
        for &n in &self.parts.skinned {
            let node = &self.json.nodes[n];
            let (Some(mesh), Some(skin)) = (node.mesh, node.skin) else { continue };
            let skin = &self.json.skins[skin.value()];
            let joints = skin.joints.iter().filter_map(|j| self.parts.bone_of[j.value()]).collect();
            let bind = skin.inverse_bind_matrices.map(|m| scion.accessor(m));
            dresses.push(Dress { mesh: scion.mesh(mesh), bind, joints });
        }
        let mut bones = self.bones.clone();
        for (&n, bone) in self.parts.nodes.iter().zip(&mut bones[1..]) {
            bone.mesh = self.json.nodes[n].mesh.filter(|_| self.json.nodes[n].skin.is_none()).map(|m| scion.mesh(m));
        }
        Graft { dresses, bones }
    }
}

/// New places of what has been copied, by old ones.
#[derive(Default)]
struct Done {
    views: BTreeMap<usize, Index<View>>,
    accessors: BTreeMap<usize, Index<Accessor>>,
    meshes: BTreeMap<usize, Index<Mesh>>,
    materials: BTreeMap<usize, Index<Material>>,
    textures: BTreeMap<usize, Index<Texture>>,
    images: BTreeMap<usize, Index<Image>>,
}

struct Scion<'a> {
    from: &'a Root,
    data: &'a [u8],
    root: &'a mut Root,
    binary: &'a mut Vec<u8>,
    done: Done,
}

impl Scion<'_> {
    fn view(&mut self, index: Index<View>) -> Index<View> {
        if let Some(&done) = self.done.views.get(&index.value()) {
            return done;
        }
        let view = &self.from.buffer_views[index.value()];
        let begin = view.byte_offset.map_or(0, |o| o.0) as usize;
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let offset = Some(USize64::from(self.binary.len()));
        self.binary.extend_from_slice(&self.data[begin..begin + view.byte_length.0 as usize]);
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let copy = View { buffer: Index::new(0), byte_offset: offset, ..view.clone() };
        let made = self.root.push(copy);
        self.done.views.insert(index.value(), made);
        made
    }

    fn accessor(&mut self, index: Index<Accessor>) -> Index<Accessor> {
        if let Some(&done) = self.done.accessors.get(&index.value()) {
            return done;
        }
        let mut copy = self.from.accessors[index.value()].clone();
        copy.buffer_view = copy.buffer_view.map(|v| self.view(v));
        if let Some(sparse) = &mut copy.sparse {
            sparse.indices.buffer_view = self.view(sparse.indices.buffer_view);
            sparse.values.buffer_view = self.view(sparse.values.buffer_view);
        }
        let made = self.root.push(copy);
        self.done.accessors.insert(index.value(), made);
        made
    }

    fn mesh(&mut self, index: Index<Mesh>) -> Index<Mesh> {
        if let Some(&done) = self.done.meshes.get(&index.value()) {
            return done;
        }
        let mut copy = self.from.meshes[index.value()].clone();
        for primitive in &mut copy.primitives {
            primitive.attributes.values_mut().for_each(|a| *a = self.accessor(*a));
            primitive.indices = primitive.indices.map(|i| self.accessor(i));
            primitive.material = primitive.material.map(|m| self.material(m));
            primitive.extensions = None;
            for target in primitive.targets.iter_mut().flatten() {
                for moved in [&mut target.positions, &mut target.normals, &mut target.tangents].into_iter().flatten() {
                    *moved = self.accessor(*moved);
                }
            }
        }
        let made = self.root.push(copy);
        self.done.meshes.insert(index.value(), made);
        made
    }

    fn material(&mut self, index: Index<Material>) -> Index<Material> {
        if let Some(&done) = self.done.materials.get(&index.value()) {
            return done;
        }
        let mut copy = self.from.materials[index.value()].clone();
        copy.extensions = None;
        let pbr = &mut copy.pbr_metallic_roughness;
        pbr.extensions = None;
        let infos = [&mut pbr.base_color_texture, &mut pbr.metallic_roughness_texture, &mut copy.emissive_texture];
        for info in infos.into_iter().flatten() {
            self.info(info);
        }
        if let Some(normal) = &mut copy.normal_texture {
            (normal.index, normal.extensions) = (self.texture(normal.index), None);
        }
        if let Some(occlusion) = &mut copy.occlusion_texture {
            (occlusion.index, occlusion.extensions) = (self.texture(occlusion.index), None);
        }
        let made = self.root.push(copy);
        self.done.materials.insert(index.value(), made);
        made
    }

    fn info(&mut self, info: &mut Info) {
        (info.index, info.extensions) = (self.texture(info.index), None);
    }

    fn texture(&mut self, index: Index<Texture>) -> Index<Texture> {
        if let Some(&done) = self.done.textures.get(&index.value()) {
            return done;
        }
        let mut copy = self.from.textures[index.value()].clone();
        copy.source = self.image(copy.source);
        copy.sampler = copy.sampler.map(|s| self.root.push(self.from.samplers[s.value()].clone()));
        let made = self.root.push(copy);
        self.done.textures.insert(index.value(), made);
        made
    }

    fn image(&mut self, index: Index<Image>) -> Index<Image> {
        if let Some(&done) = self.done.images.get(&index.value()) {
            return done;
        }
        let mut copy = self.from.images[index.value()].clone();
        copy.buffer_view = copy.buffer_view.map(|v| self.view(v));
        let made = self.root.push(copy);
        self.done.images.insert(index.value(), made);
        made
    }
}
