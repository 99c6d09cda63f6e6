//! Walls and obstacles: prisms, moved about where they move.

use glam::{Quat, Vec2, Vec3};
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::buffer::Target;
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Index, Mesh, Root};

use super::actor::Writer;
use super::body::{bounds, plain_material};
use super::buffer::Stream;
use crate::geom::{Obstacle, Polygon};
use crate::motion::FPS;
use crate::stage::Crowd;

/// Colours of what stands and of what moves or can be got over, as RGB.
const STILL: u32 = 0x9a958c;
const MOVING: u32 = 0xb5794a;
/// How high walls and moving things are drawn that are over all heads, metres; as in the viewer, so that people are seen.
const WALL: f32 = 1.1;
const TALL: f32 = 1.9;

/// Corners with the normals of the faces they are of, and triangles of them.
#[derive(Default)]
struct Prism {
    points: Vec<Vec3>,
    normals: Vec<Vec3>,
    triangles: Vec<u16>,
}

/// The meshes of a crowd's obstacles, in their order; none for those that have no triangles or too many.
pub(super) fn meshes(root: &mut Root, binary: &mut Vec<u8>, crowd: &Crowd) -> Vec<Option<Index<Mesh>>> {
    let mut mesh = |obstacle: &Obstacle| {
        let prism = Prism::new(&obstacle.outline, height(obstacle));
        let drawn = !prism.triangles.is_empty() && prism.points.len() < usize::from(u16::MAX);
        drawn.then(|| mesh(root, binary, &prism, if obstacle.is_wall() { STILL } else { MOVING }))
    };
    crowd.domain.obstacles.iter().map(&mut mesh).collect()
}

fn height(obstacle: &Obstacle) -> f32 {
    obstacle.height.unwrap_or(if obstacle.path.is_empty() { WALL } else { TALL })
}

/// Writes every obstacle as a node, with keys if it moves.
pub(super) fn write(writer: &mut Writer, crowd: &Crowd, meshes: &[Option<Index<Mesh>>]) {
    for (i, (obstacle, mesh)) in crowd.domain.obstacles.iter().zip(meshes).enumerate() {
        let Some(mesh) = *mesh else { continue };
        let place = |frame: u32| {
            let at = obstacle.place(frame as f32 / FPS);
            (Vec3::new(at.position.x, 0.0, at.position.y), Quat::from_rotation_y(at.heading))
        };
        let places: Vec<(Vec3, Quat)> = (0..=crowd.domain.last_frame).map(place).collect();
        let extras = serde_json::json!({ "obstacle": i, "height": obstacle.height });
        writer.thing(&format!("obstacle_{i}"), mesh, 0, &places, &extras);
    }
}

impl Prism {
    /// The sides and the top of a prism on the ground.
    fn new(outline: &Polygon, height: f32) -> Self {
        let mut corners = outline.points.clone();
        // Seen from above with x right and z down, the way round in which sides look out.
        if turning(&corners) < 0.0 {
            corners.reverse();
        }
        let mut prism = Self::default();
        let at = |p: Vec2, y: f32| Vec3::new(p.x, y, p.y);
        for (i, &a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            let out = Vec3::new((b - a).y, 0.0, -(b - a).x).normalize_or_zero();
            let face = [at(a, 0.0), at(a, height), at(b, height), at(b, 0.0)];
            prism.add(&face, out, &[0, 1, 2, 0, 2, 3]);
        }
        let top: Vec<Vec3> = corners.iter().map(|&p| at(p, height)).collect();
        prism.add(&top, Vec3::Y, &ears(&corners));
        prism
    }

    fn add(&mut self, points: &[Vec3], normal: Vec3, triangles: &[usize]) {
        let first = self.points.len();
        self.points.extend(points);
        self.normals.extend(vec![normal; points.len()]);
        self.triangles.extend(triangles.iter().map(|k| (first + k) as u16));
    }
}

/// Twice the area within, positive where x turns to z.
fn turning(corners: &[Vec2]) -> f32 {
    (0..corners.len()).map(|i| corners[i].perp_dot(corners[(i + 1) % corners.len()])).sum()
}

/// Triangles that fill a simple polygon, x turning to z, each looking up: ears are cut off one by one. O(corners^3).
fn ears(corners: &[Vec2]) -> Vec<usize> {
    let mut left: Vec<usize> = (0..corners.len()).collect();
    let mut triangles = Vec::new();
    while left.len() > 2 {
        let n = left.len();
        let ear = |i: &usize| {
            let [a, b, c] = [left[(i + n - 1) % n], left[*i], left[(i + 1) % n]];
            let [p, q, r] = [a, b, c].map(|k| corners[k]);
            let others = left.iter().filter(|&&k| ![a, b, c].contains(&k));
            (q - p).perp_dot(r - p) > 0.0 && others.into_iter().all(|&k| !is_within(corners[k], [p, q, r]))
        };
        // Of rounding there may be none: then any corner will do.
        let i = (0..n).find(ear).unwrap_or(0);
        triangles.extend([left[(i + n - 1) % n], left[(i + 1) % n], left[i]]);
        left.remove(i);
    }
    triangles
}

fn is_within(p: Vec2, [a, b, c]: [Vec2; 3]) -> bool {
    [(a, b), (b, c), (c, a)].into_iter().all(|(from, to)| (to - from).perp_dot(p - from) >= 0.0)
}

fn mesh(root: &mut Root, binary: &mut Vec<u8>, prism: &Prism, color: u32) -> Index<Mesh> {
    let material = plain_material(root, "obstacle", color, 0.9);
    let mut vectors = |values: &[Vec3]| -> Index<Accessor> {
        let mut stream = Stream::next(root, Some(Target::ArrayBuffer), Some(12));
        let index = stream.accessor(root, values, ComponentType::F32, Type::Vec3);
        stream.finish(root, binary);
        index
    };
    let (places, normals) = (vectors(&prism.points), vectors(&prism.normals));
    let (low, high) = bounds(&prism.points);
    let accessor = &mut root.accessors[places.value()];
    (accessor.min, accessor.max) = (Some(low), Some(high));
    let mut stream = Stream::next(root, Some(Target::ElementArrayBuffer), None);
    let triangles = stream.accessor(root, &prism.triangles, ComponentType::U16, Type::Scalar);
    stream.finish(root, binary);
    let primitive = Primitive {
        attributes: [(Semantic::Positions, places), (Semantic::Normals, normals)]
            .map(|(semantic, index)| (Checked::Valid(semantic), index))
            .into(),
        indices: Some(triangles),
        material: Some(material),
        mode: Checked::Valid(Mode::Triangles),
        targets: None,
        extensions: None,
        extras: Default::default(),
    };
    let name = Some("obstacle".into());
    root.push(Mesh { name, primitives: vec![primitive], weights: None, extensions: None, extras: Default::default() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_look_out_and_the_top_fills_the_outline_either_way_round() {
        let mut corners = [(0.0, 0.0), (4.0, 0.0), (4.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0)]
            .map(|(x, z)| Vec2::new(x, z))
            .to_vec();
        for _ in 0..2 {
            let outline = Polygon::new(corners.clone()).unwrap();
            let prism = Prism::new(&outline, 0.5);
            let mut top = 0.0;
            for t in prism.triangles.chunks(3) {
                let [a, b, c] = [t[0], t[1], t[2]].map(|k| prism.points[usize::from(k)]);
                let (normal, seen) = (prism.normals[usize::from(t[0])], (b - a).cross(c - a));
                assert!(seen.dot(normal) > 0.999 * seen.length() && seen.length() > 1e-3, "{a} {b} {c}: {normal}");
                let middle = (a + b + c) / 3.0 + normal * 0.01;
                assert!(normal.y > 0.5 || outline.signed_distance(Vec2::new(middle.x, middle.z)) > 0.0);
                top += if normal.y > 0.5 { 0.5 * seen.length() } else { 0.0 };
            }
            assert!((top - outline.area()).abs() < 1e-4, "{top}");
            corners.reverse();
        }
    }
}
