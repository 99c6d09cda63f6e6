//! The triangles of a glTF file's scene, in place.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{DMat4, DVec3, Vec3};
use gltf_json::accessor::Type;
use gltf_json::buffer::View;
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Asset, Buffer, Index, Material, Mesh, Node, Scene};

use super::clip::plan;
use crate::Result;
use crate::gltf::{Data, Numbers, Tables, bad, find, from_the_top, local, open, version};
use crate::world::area::FARTHEST;
use crate::world::area::sign::{Meaning, Sign, meaning};

/// Larger meshes are refused.
const MOST_TRIANGLES: usize = 1_000_000;
/// In plan, triangles of less are no floor, square metres.
const SMALLEST: f64 = 1e-8;

/// A triangle of the scene.
pub(super) struct Triangle {
    /// In plan counter-clockwise with x right and z up.
    pub corners: [DVec3; 3],
    /// The template of the ground that it is; none if it is no floor.
    pub template: Option<usize>,
    /// Height of its plane: at the origin, and by x and z.
    plane: DVec3,
}

impl Triangle {
    fn new(corners: [DVec3; 3], two_sided: bool, template: Option<usize>, slope_deg: f64) -> Self {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a);
        let up = if two_sided { normal.y.abs() } else { normal.y };
        let floor = 0.5 * up > SMALLEST && up >= slope_deg.to_radians().cos() * normal.length() * (1.0 - 1e-9);
        let corners = if plan(b - a).perp_dot(plan(c - a)) < 0.0 { [a, c, b] } else { corners };
        let [slope_x, slope_z] = [-normal.x / normal.y, -normal.z / normal.y];
        let plane = DVec3::new(a.y - slope_x * a.x - slope_z * a.z, slope_x, slope_z);
        Self { corners, template: template.filter(|_| floor), plane }
    }

    /// How far its plane is below a point; of a floor.
    pub fn below(&self, p: DVec3) -> f64 {
        p.y - self.plane.x - self.plane.y * p.x - self.plane.z * p.z
    }

    /// Its middle.
    pub fn middle(&self) -> DVec3 {
        self.corners.iter().sum::<DVec3>() / 3.0
    }

    /// Its area in plan, square metres.
    pub fn area(&self) -> f64 {
        let [a, b, c] = self.corners.map(plan);
        0.5 * (b - a).perp_dot(c - a)
    }
}

/// What is read of the JSON.
#[derive(serde::Deserialize)]
#[serde(rename_all = "camelCase")]
struct Document {
    asset: Asset,
    #[serde(default)]
    accessors: Vec<Accessor>,
    #[serde(default)]
    buffers: Vec<Buffer>,
    #[serde(default)]
    buffer_views: Vec<View>,
    #[serde(default)]
    materials: Vec<Material>,
    #[serde(default)]
    meshes: Vec<Mesh>,
    #[serde(default)]
    nodes: Vec<Node>,
    #[serde(default)]
    scenes: Vec<Scene>,
    scene: Option<Index<Scene>>,
    #[serde(default)]
    extensions_required: Vec<String>,
}

/// A part of a mesh in its own coordinates.
struct Part {
    corners: Vec<[Vec3; 3]>,
    two_sided: bool,
    meaning: Option<Meaning>,
}

/// All triangles of the scene that is shown. What is no triangle is told.
pub(super) fn read(
    bytes: &[u8],
    folder: Option<&Path>,
    slope_deg: f64,
    signs: &[Sign],
    notes: &mut Vec<String>,
) -> Result<Vec<Triangle>> {
    let (document, binary) = open::<Document>(bytes)?;
    version(&document.asset)?;
    if let Some(packed) = document.extensions_required.iter().find(|e| e.ends_with("compression")) {
        return Err(bad("extensionsRequired", format!("expected plain buffers, found {packed}")));
    }
    let tables = Tables { accessors: &document.accessors, views: &document.buffer_views, buffers: &document.buffers };
    let mut reader = Reader {
        document: &document,
        data: Data::new(tables, binary, bytes.len(), folder),
        signs,
        parts: BTreeMap::new(),
        other: 0,
    };
    let (order, parents) = from_the_top(&document.nodes, &document.scenes, document.scene)?;
    // Place of every node in the world, and what its name or one above it says.
    let mut places: Vec<(DMat4, Option<Meaning>)> = vec![(DMat4::IDENTITY, None); document.nodes.len()];
    let mut found = Vec::new();
    for n in order {
        let node = &document.nodes[n];
        let (above, inherited) = parents[n].map_or((DMat4::IDENTITY, None), |p| places[p]);
        let named = node.name.as_deref().and_then(|name| meaning(name, signs)).or(inherited);
        places[n] = (above * local(node).as_dmat4(), named);
        if let Some(mesh) = node.mesh {
            let place = format!("node {n}");
            reader.mesh(mesh, &place)?;
            for part in &reader.parts[&mesh.value()] {
                part.put(places[n], slope_deg, &place, &mut found)?;
            }
        }
    }
    if reader.other > 0 {
        notes.push(format!("{} parts of meshes that are lines or points were left out", reader.other));
    }
    match found.len() {
        0 => Err(bad("meshes", "expected triangles in the scene, found none")),
        _ => Ok(found),
    }
}

impl Part {
    /// Adds its triangles at a node's place.
    fn put(
        &self,
        (world_from_own, named): (DMat4, Option<Meaning>),
        slope_deg: f64,
        place: &str,
        found: &mut Vec<Triangle>,
    ) -> Result<()> {
        if found.len() + self.corners.len() > MOST_TRIANGLES {
            let problem =
                format!("expected at most {MOST_TRIANGLES} triangles, found more; a mesh for collisions will do");
            return Err(bad(place, problem));
        }
        let template = match self.meaning.or(named) {
            Some(Meaning::Template(template)) => Some(template),
            Some(Meaning::Blocked) => None,
            None => Some(0),
        };
        let mirrored = world_from_own.determinant() < 0.0;
        for corners in &self.corners {
            let [a, b, c] = corners.map(|p| world_from_own.transform_point3(p.as_dvec3()));
            if let Some(p) = [a, b, c].iter().find(|p| p.abs().max_element() > FARTHEST || !p.is_finite()) {
                let problem = format!("expected places within {FARTHEST} m of the origin, found {p} m");
                return Err(bad(place, problem));
            }
            let corners = if mirrored { [a, c, b] } else { [a, b, c] };
            found.push(Triangle::new(corners, self.two_sided, template, slope_deg));
        }
        Ok(())
    }
}

struct Reader<'a> {
    document: &'a Document,
    data: Data<'a>,
    signs: &'a [Sign],
    /// Parts of every mesh that was asked for.
    parts: BTreeMap<usize, Vec<Part>>,
    /// How many parts are no triangles.
    other: usize,
}

impl Reader<'_> {
    fn mesh(&mut self, index: Index<Mesh>, place: &str) -> Result<()> {
        let mesh = find(&self.document.meshes, index, "meshes", place)?;
        if self.parts.contains_key(&index.value()) {
            return Ok(());
        }
        let mut parts = Vec::new();
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            parts.extend(self.part(primitive, &format!("mesh {index} primitive {p}"))?);
        }
        self.parts.insert(index.value(), parts);
        Ok(())
    }

    fn part(&mut self, primitive: &Primitive, place: &str) -> Result<Option<Part>> {
        let mode = match primitive.mode {
            Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => mode,
            Checked::Valid(_) => {
                self.other += 1;
                return Ok(None);
            }
            Checked::Invalid => return Err(bad(place, "expected a mode of glTF 2.0, found another")),
        };
        let Some(&positions) = primitive.attributes.get(&Checked::Valid(Semantic::Positions)) else {
            return Err(bad(place, "expected POSITION, found none"));
        };
        let numbers = self.data.floats(positions, &[Type::Vec3], Numbers::Floats, place)?;
        let vertices: Vec<Vec3> = numbers.values.chunks_exact(3).map(Vec3::from_slice).collect();
        let indices = match primitive.indices {
            Some(indices) => self.data.integers(indices, Type::Scalar, 4, place)?,
            None => (0..vertices.len() as u32).collect(),
        };
        if let Some(index) = indices.iter().find(|&&i| i as usize >= vertices.len()) {
            let problem = format!("expected numbers of {} vertices, found number {index}", vertices.len());
            return Err(bad(place, problem));
        }
        let material = primitive.material.map(|m| find(&self.document.materials, m, "materials", place)).transpose()?;
        let corners = triangles(mode, &indices).into_iter().map(|t| t.map(|v| vertices[v as usize])).collect();
        Ok(Some(Part {
            corners,
            two_sided: material.is_some_and(|m| m.double_sided),
            meaning: material.and_then(|m| meaning(m.name.as_deref()?, self.signs)),
        }))
    }
}

/// Corners of every triangle (glTF 2.0, section 3.7.2.1).
fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => {
            let turned = |(i, t): (usize, &[u32])| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[0], t[2], t[1]] };
            indices.windows(3).enumerate().map(turned).collect()
        }
        Mode::TriangleFan => indices.windows(2).skip(1).map(|t| [indices[0], t[0], t[1]]).collect(),
        _ => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
    }
}
