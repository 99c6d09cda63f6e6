//! Mannequins as glTF: vertices once per build, triangles once per cut of clothes, a mesh per person's look.

use std::collections::BTreeMap;

use glam::{Mat4, Vec3};
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::buffer::Target;
use gltf_json::material::{PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Index, Material, Mesh, Root, Value};

use super::actor::{Bone, Dress};
use super::buffer::Stream;
use super::look::{Look, Region, look_in_team};
use super::mannequin::{mannequin, rest};
use crate::motion::{Build, JOINT_COUNT};

type Attributes = BTreeMap<Checked<Semantic>, Index<Accessor>>;

/// What a material is like besides its colour: name and roughness.
type Cloth = (&'static str, f32);

/// The mannequins of a file in the making.
pub(super) struct Wardrobe {
    /// Vertices of each build.
    attributes: Vec<Attributes>,
    /// Inverse bind matrices of each build.
    binds: Vec<Index<Accessor>>,
    /// The bones of each build.
    bones: Vec<Vec<Bone>>,
    /// Triangles by the regions they cover.
    cuts: BTreeMap<Vec<Region>, Index<Accessor>>,
    /// Meshes by build and look.
    meshes: BTreeMap<(usize, Look), Index<Mesh>>,
}

/// What decides how somebody looks.
#[derive(Clone, Copy)]
pub(super) struct Number {
    /// The person.
    pub person: usize,
    /// Index of the build.
    pub build: usize,
    /// Index of the team, if of one.
    pub team: Option<u32>,
}

impl Number {
    fn look(&self) -> Look {
        look_in_team(self.person, self.team)
    }
}

impl Wardrobe {
    /// Writes what people of `builds` with the numbers `people` need.
    pub(super) fn new(root: &mut Root, binary: &mut Vec<u8>, builds: &[impl AsRef<Build>], people: &[Number]) -> Self {
        let builds: Vec<&Build> = builds.iter().map(AsRef::as_ref).collect();
        let attributes = attributes(root, binary, &builds);
        let binds = binds(root, binary, &builds);
        let bones = builds.iter().map(|b| bones(b)).collect();
        let cuts = cuts(root, binary, people.iter().map(Number::look));
        let mut wardrobe = Self { attributes, binds, bones, cuts, meshes: BTreeMap::new() };
        for number in people {
            wardrobe.sew(root, number.build, number.look());
        }
        wardrobe
    }

    /// The bones of a build.
    pub(super) fn bones(&self, build: usize) -> &[Bone] {
        &self.bones[build]
    }

    /// Mesh and skin of a person.
    pub(super) fn dress(&self, number: &Number) -> Dress {
        let (mesh, bind) = (self.meshes[&(number.build, number.look())], self.binds[number.build]);
        Dress { mesh, bind: Some(bind), joints: (0..JOINT_COUNT).collect(), weights: None }
    }

    fn sew(&mut self, root: &mut Root, build: usize, look: Look) {
        if self.meshes.contains_key(&(build, look)) {
            return;
        }
        let primitives = pieces(&look).into_iter().map(|((color, cloth), regions)| Primitive {
            attributes: self.attributes[build].clone(),
            indices: Some(self.cuts[&regions]),
            material: Some(material(root, color, cloth)),
            mode: Checked::Valid(Mode::Triangles),
            targets: None,
            extensions: None,
            extras: Default::default(),
        });
        let primitives = primitives.collect();
        let name = Some(format!("mannequin_{}", self.meshes.len()));
        let mesh = root.push(Mesh { primitives, name, weights: None, extensions: None, extras: Default::default() });
        self.meshes.insert((build, look), mesh);
    }
}

/// What a look consists of: regions of the same colour and cloth are one piece.
fn pieces(look: &Look) -> Vec<((u32, Cloth), Vec<Region>)> {
    let mut pieces: Vec<((u32, Cloth), Vec<Region>)> = Vec::new();
    let skin = look[Region::Skin as usize];
    for region in Region::ALL {
        let Some(color) = look[region as usize].filter(|_| !mannequin().triangles[region as usize].is_empty()) else {
            continue;
        };
        let of = (color, cloth(region, Some(color) == skin));
        match pieces.iter_mut().find(|(key, _)| *key == of) {
            Some((_, regions)) => regions.push(region),
            None => pieces.push((of, vec![region])),
        }
    }
    pieces
}

fn cloth(region: Region, bare: bool) -> Cloth {
    match region {
        Region::Skin => ("skin", 0.55),
        Region::Sleeve | Region::Shin | Region::Trousers if bare => ("skin", 0.55),
        Region::Hair | Region::LongHair | Region::Bun | Region::Visor => ("hair", 0.6),
        Region::Shirt | Region::Sleeve => ("shirt", 0.85),
        Region::Trousers | Region::Shin | Region::Skirt | Region::Seat => ("trousers", 0.85),
        Region::Shoe | Region::Sole => ("shoes", 0.5),
    }
}

/// Vertices of each build; joints and weights are the same for all.
fn attributes(root: &mut Root, binary: &mut Vec<u8>, builds: &[&Build]) -> Vec<Attributes> {
    let body = mannequin();
    let grown: Vec<_> = builds.iter().map(|b| body.grown(b)).collect();
    let mut out = vec![Attributes::new(); builds.len()];
    let mut stream = Stream::next(root, Some(Target::ArrayBuffer), Some(12));
    for ((positions, _), out) in grown.iter().zip(&mut out) {
        let index = stream.accessor(root, positions, ComponentType::F32, Type::Vec3);
        let (low, high) = bounds(positions);
        let accessor = &mut root.accessors[index.value()];
        (accessor.min, accessor.max) = (Some(low), Some(high));
        out.insert(Checked::Valid(Semantic::Positions), index);
    }
    stream.finish(root, binary);
    let mut stream = Stream::next(root, Some(Target::ArrayBuffer), Some(12));
    for ((_, normals), out) in grown.iter().zip(&mut out) {
        let index = stream.accessor(root, normals, ComponentType::F32, Type::Vec3);
        out.insert(Checked::Valid(Semantic::Normals), index);
    }
    stream.finish(root, binary);
    let joints: Vec<[u8; 4]> = body.joints.iter().map(|j| j.map(|j| j as u8)).collect();
    let mut stream = Stream::next(root, Some(Target::ArrayBuffer), Some(4));
    let joints = stream.accessor(root, &joints, ComponentType::U8, Type::Vec4);
    stream.finish(root, binary);
    let mut stream = Stream::next(root, Some(Target::ArrayBuffer), Some(16));
    let weights = stream.accessor(root, &body.weights, ComponentType::F32, Type::Vec4);
    stream.finish(root, binary);
    for out in &mut out {
        out.insert(Checked::Valid(Semantic::Joints(0)), joints);
        out.insert(Checked::Valid(Semantic::Weights(0)), weights);
    }
    out
}

pub(super) fn bounds(points: &[Vec3]) -> (Value, Value) {
    let (low, high) = points.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), &p| (a.min(p), b.max(p)));
    (serde_json::json!(low.to_array()), serde_json::json!(high.to_array()))
}

/// The rest pose's joints are not turned, so that binding only moves.
fn binds(root: &mut Root, binary: &mut Vec<u8>, builds: &[&Build]) -> Vec<Index<Accessor>> {
    let mut stream = Stream::next(root, None, None);
    let matrices = |b: &&Build| -> Vec<[f32; 16]> {
        rest(&b.skeleton).into_iter().map(|p| Mat4::from_translation(-p).to_cols_array()).collect()
    };
    let accessors =
        builds.iter().map(|b| stream.accessor(root, &matrices(b), ComponentType::F32, Type::Mat4)).collect();
    stream.finish(root, binary);
    accessors
}

fn bones(build: &Build) -> Vec<Bone> {
    let bone = |j: &crate::motion::Joint| Bone { parent: j.parent, ..Bone::new(&j.name, j.offset) };
    build.skeleton.joints.iter().map(bone).collect()
}

/// Triangles for every piece of clothing that one of the looks has.
fn cuts(
    root: &mut Root,
    binary: &mut Vec<u8>,
    looks: impl Iterator<Item = Look>,
) -> BTreeMap<Vec<Region>, Index<Accessor>> {
    let mut stream = Stream::next(root, Some(Target::ElementArrayBuffer), None);
    let mut cuts = BTreeMap::new();
    for (_, regions) in looks.flat_map(|look| pieces(&look)) {
        let triangles = regions.iter().flat_map(|&r| &mannequin().triangles[r as usize]).flatten();
        cuts.entry(regions.clone()).or_insert_with(|| {
            let flat: Vec<u16> = triangles.copied().collect();
            stream.accessor(root, &flat, ComponentType::U16, Type::Scalar)
        });
    }
    stream.finish(root, binary);
    cuts
}

/// A material that does not shine.
pub(super) fn plain_material(root: &mut Root, name: &str, color: u32, roughness: f32) -> Index<Material> {
    let [_, r, g, b] = color.to_be_bytes();
    root.push(Material {
        name: Some(name.into()),
        pbr_metallic_roughness: PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor([linear(r), linear(g), linear(b), 1.0]),
            metallic_factor: StrengthFactor(0.0),
            roughness_factor: StrengthFactor(roughness),
            ..Default::default()
        },
        ..Default::default()
    })
}

/// The material of that colour; the one that is there already if another look has it too.
fn material(root: &mut Root, color: u32, (cloth, rough): Cloth) -> Index<Material> {
    let name = format!("{cloth}_{color:06x}");
    if let Some(i) = root.materials.iter().position(|m| m.name.as_ref() == Some(&name)) {
        return Index::new(i as u32);
    }
    plain_material(root, &name, color, rough)
}

/// An sRGB byte as a linear fraction.
fn linear(byte: u8) -> f32 {
    let v = byte as f32 / 255.0;
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}
