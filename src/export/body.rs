//! The mannequin as glTF: shared vertices, one mesh per look.

use glam::Vec3;
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::buffer::Target;
use gltf_json::material::{PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Index, Material as GltfMaterial, Mesh, Root, Value};

use super::buffer::Stream;
use super::look::{LOOKS, look};
use super::mannequin::{Material, mannequin};

/// Buffer views of the vertices: positions, normals, joints, weights, indices.
pub(super) const VIEWS: u32 = 5;

type Attributes = std::collections::BTreeMap<Checked<Semantic>, Index<Accessor>>;

/// Writes the mannequin's vertices once and a mesh for each of the first `people` people's looks. The mesh of
/// person p is number `p % LOOKS`.
pub(super) fn meshes(root: &mut Root, binary: &mut Vec<u8>, people: usize) -> Vec<Index<Mesh>> {
    let body = mannequin();
    let attributes = attributes(root, binary);
    let mut stream = Stream::new(4, Some(Target::ElementArrayBuffer), None);
    let indices = body.triangles.each_ref().map(|triangles| {
        let flat: &[u16] = bytemuck::cast_slice(triangles);
        stream.accessor(root, flat, ComponentType::U16, Type::Scalar)
    });
    stream.finish(root, binary);
    (0..people.min(LOOKS)).map(|person| mesh(root, person, &attributes, &indices)).collect()
}

fn attributes(root: &mut Root, binary: &mut Vec<u8>) -> Attributes {
    let body = mannequin();
    let mut out = Attributes::new();
    let mut add =
        |view: u32, semantic: Semantic, stride: usize, bytes: &dyn Fn(&mut Stream, &mut Root) -> Index<Accessor>| {
            let mut stream = Stream::new(view, Some(Target::ArrayBuffer), Some(stride));
            let accessor = bytes(&mut stream, root);
            out.insert(Checked::Valid(semantic), accessor);
            stream.finish(root, binary);
        };
    add(0, Semantic::Positions, 12, &|s, root| {
        let index = s.accessor(root, &body.positions, ComponentType::F32, Type::Vec3);
        let (low, high) = bounds(&body.positions);
        let accessor = &mut root.accessors[index.value()];
        (accessor.min, accessor.max) = (Some(low), Some(high));
        index
    });
    add(1, Semantic::Normals, 12, &|s, root| s.accessor(root, &body.normals, ComponentType::F32, Type::Vec3));
    let joints: Vec<[u8; 4]> = body.joints.iter().map(|j| j.map(|j| j as u8)).collect();
    add(2, Semantic::Joints(0), 4, &|s, root| s.accessor(root, &joints, ComponentType::U8, Type::Vec4));
    add(3, Semantic::Weights(0), 16, &|s, root| s.accessor(root, &body.weights, ComponentType::F32, Type::Vec4));
    out
}

fn bounds(points: &[Vec3]) -> (Value, Value) {
    let (low, high) = points.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), &p| (a.min(p), b.max(p)));
    (serde_json::json!(low.to_array()), serde_json::json!(high.to_array()))
}

fn mesh(root: &mut Root, person: usize, attributes: &Attributes, indices: &[Index<Accessor>]) -> Index<Mesh> {
    let colors = look(person);
    let primitives = Material::ALL.iter().zip(indices).zip(colors).map(|((&material, &indices), color)| Primitive {
        attributes: attributes.clone(),
        indices: Some(indices),
        material: Some(self::material(root, material, color)),
        mode: Checked::Valid(Mode::Triangles),
        targets: None,
        extensions: None,
        extras: Default::default(),
    });
    let primitives = primitives.collect();
    root.push(Mesh {
        primitives,
        name: Some(format!("mannequin_{person}")),
        weights: None,
        extensions: None,
        extras: Default::default(),
    })
}

/// The material of that colour; the one that is there already if another look has it too.
fn material(root: &mut Root, material: Material, [r, g, b]: [f32; 3]) -> Index<GltfMaterial> {
    let color = [r, g, b, 1.0];
    let same = |m: &GltfMaterial| {
        m.pbr_metallic_roughness.base_color_factor.0 == color
            && m.name.as_deref().is_some_and(|name| name.starts_with(material.name()))
    };
    if let Some(i) = root.materials.iter().position(same) {
        return Index::new(i as u32);
    }
    let rough = [0.85, 0.85, 0.55, 0.6, 0.5][material as usize];
    root.push(GltfMaterial {
        name: Some(format!("{}_{}", material.name(), root.materials.len())),
        pbr_metallic_roughness: PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor(color),
            metallic_factor: StrengthFactor(0.0),
            roughness_factor: StrengthFactor(rough),
            ..Default::default()
        },
        ..Default::default()
    })
}
