//! Boxes that people carry: cardboard, with a strip of tape over the top, down two sides and under the bottom.

use std::collections::BTreeMap;

use glam::{Quat, Vec3};
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::buffer::Target;
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Index, Material, Mesh, Root};

use super::actor::Writer;
use super::body::{bounds, plain_material};
use super::buffer::Stream;
use crate::stage::{Crowd, Prop};

/// Colour of the board and of the tape, as RGB.
const BOARD: u32 = 0xb68a5a;
const TAPE: u32 = 0xd9c7a3;
/// Width of the tape and how thick it lies on the board, metres.
const TAPE_WIDTH: f32 = 0.05;
const TAPE_LIFT: f32 = 0.0008;
/// How far the tape reaches down the sides, as a part of the box's height.
const TAPE_END: f32 = 0.3;

/// A flat piece: its middle, and the halves of its two edges; their cross product points out of the box.
type Face = [Vec3; 3];

/// The meshes of a crowd's boxes, one for each size, by box.
pub(super) fn meshes(root: &mut Root, binary: &mut Vec<u8>, crowd: &Crowd) -> Vec<Index<Mesh>> {
    if crowd.props.is_empty() {
        return vec![];
    }
    let materials = [("board", BOARD, 0.95), ("tape", TAPE, 0.6)];
    let materials = materials.map(|(name, color, rough)| plain_material(root, name, color, rough));
    let mut known: BTreeMap<[u32; 3], Index<Mesh>> = BTreeMap::new();
    let mut mesh = |prop: &Prop| {
        let key = prop.size.map(f32::to_bits);
        *known.entry(key).or_insert_with(|| mesh(root, binary, prop.size, &materials))
    };
    crowd.props.iter().map(&mut mesh).collect()
}

/// Writes every box as a node with keys.
pub(super) fn write(writer: &mut Writer, crowd: &Crowd, meshes: &[Index<Mesh>]) {
    for (i, (prop, &mesh)) in crowd.props.iter().zip(meshes).enumerate() {
        let places: Vec<(Vec3, Quat)> =
            prop.places.iter().map(|p| (p.middle, Quat::from_rotation_y(p.heading))).collect();
        let extras = serde_json::json!({ "box": i, "size": prop.size });
        writer.thing(&format!("box_{i}"), mesh, prop.begin, &places, &extras);
    }
}

fn mesh(root: &mut Root, binary: &mut Vec<u8>, size: [f32; 3], materials: &[Index<Material>; 2]) -> Index<Mesh> {
    let half = 0.5 * Vec3::from_array(size);
    let primitives = [(board(half), materials[0]), (tape(half), materials[1])];
    let primitives = primitives.map(|(faces, material)| primitive(root, binary, &faces, material));
    root.push(Mesh {
        name: Some("box".into()),
        primitives: primitives.into(),
        weights: None,
        extensions: None,
        extras: Default::default(),
    })
}

/// The six sides.
fn board(half: Vec3) -> Vec<Face> {
    let [x, y, z] = [Vec3::X * half.x, Vec3::Y * half.y, Vec3::Z * half.z];
    vec![[x, y, z], [-x, z, y], [y, z, x], [-y, x, z], [z, x, y], [-z, y, x]]
}

/// Strips over the top and the bottom, and down the sides of the width.
fn tape(half: Vec3) -> Vec<Face> {
    let [x, y] = [Vec3::X * (half.x + TAPE_LIFT), Vec3::Y * (half.y + TAPE_LIFT)];
    let across = Vec3::Z * 0.5 * TAPE_WIDTH;
    let end = y * (0.5 * TAPE_END);
    let mut faces = vec![[y, across, x], [-y, x, across]];
    for side in [x, -x] {
        for height in [y - end, end - y] {
            let (u, v) = if side.x > 0.0 { (end, across) } else { (across, end) };
            faces.push([side + height, u, v]);
        }
    }
    faces
}

fn primitive(root: &mut Root, binary: &mut Vec<u8>, faces: &[Face], material: Index<Material>) -> Primitive {
    let (mut positions, mut normals, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    for &[middle, u, v] in faces {
        let first = positions.len() as u16;
        positions.extend([middle - u - v, middle + u - v, middle + u + v, middle - u + v]);
        normals.extend([u.cross(v).normalize(); 4]);
        indices.extend([0u16, 1, 2, 0, 2, 3].map(|k| first + k));
    }
    let mut vectors = |values: &[Vec3]| -> Index<Accessor> {
        let mut stream = Stream::next(root, Some(Target::ArrayBuffer), Some(12));
        let index = stream.accessor(root, values, ComponentType::F32, Type::Vec3);
        stream.finish(root, binary);
        index
    };
    let (places, normals) = (vectors(&positions), vectors(&normals));
    let accessor = &mut root.accessors[places.value()];
    let (low, high) = bounds(&positions);
    (accessor.min, accessor.max) = (Some(low), Some(high));
    let mut stream = Stream::next(root, Some(Target::ElementArrayBuffer), None);
    let triangles = stream.accessor(root, &indices, ComponentType::U16, Type::Scalar);
    stream.finish(root, binary);
    Primitive {
        attributes: [(Semantic::Positions, places), (Semantic::Normals, normals)]
            .map(|(semantic, index)| (Checked::Valid(semantic), index))
            .into(),
        indices: Some(triangles),
        material: Some(material),
        mode: Checked::Valid(Mode::Triangles),
        targets: None,
        extensions: None,
        extras: Default::default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_look_out_of_the_box_and_lie_on_it() {
        let half = Vec3::new(0.2, 0.15, 0.1);
        for [middle, u, v] in board(half).into_iter().chain(tape(half)) {
            let out = u.cross(v).normalize();
            assert!(out.abs().max_element() > 0.999 && out.dot(middle) > 0.09, "{middle} {out}");
            for corner in [middle + u + v, middle - u - v, middle + u - v, middle - u + v] {
                let beyond = corner.abs() - half;
                assert!(beyond.max_element() < 0.001 && beyond.max_element() > -1e-6, "{corner}");
            }
        }
        let area: f32 = board(half).iter().map(|[_, u, v]| 4.0 * u.cross(*v).length()).sum();
        let expected = 8.0 * (half.x * half.y + half.y * half.z + half.z * half.x);
        assert!((area - expected).abs() < 1e-5);
    }
}
