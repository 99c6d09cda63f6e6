//! The vertices of a character's meshes, checked, and in the form in which every reader takes them: normals and
//! tangents of length 1, colours from 0 to 1, weights that add up to 1, no joint twice.

use glam::{Vec3, Vec4};
use gltf_json::accessor::Type;
use gltf_json::mesh::{MorphTarget, Primitive, Semantic};
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Index};

use crate::Result;
use crate::gltf::{Data, Numbers, bad};

/// Sets of an attribute beyond these are left out; readers know of fewer.
const MOST_SETS: u32 = 8;

/// The vertices of one or several primitives.
#[derive(Debug)]
pub(super) struct Vertices {
    pub places: Vec<Vec3>,
    pub normals: Option<Vec<Vec3>>,
    pub tangents: Option<Vec<Vec4>>,
    /// Sets of colours and of places in textures.
    pub colours: Vec<Set>,
    pub textured: Vec<Set>,
    /// Sets of joints and weights.
    pub bound: Vec<Bound>,
    pub targets: Vec<Target>,
}

/// An attribute of vectors of two, three or four numbers.
#[derive(Debug)]
pub(super) struct Set {
    pub kind: Type,
    pub values: Vec<f32>,
}

/// Four joints of each vertex, and their weights.
#[derive(Debug, Default)]
pub(super) struct Bound {
    pub joints: Vec<[u16; 4]>,
    pub weights: Vec<[f32; 4]>,
}

/// How a morph target moves the vertices.
#[derive(Debug)]
pub(super) struct Target {
    pub places: Option<Vec<Vec3>>,
    pub normals: Option<Vec<Vec3>>,
    pub tangents: Option<Vec<Vec3>>,
}

/// The vertices of a primitive; bound to so many `joints` if its mesh has a skin.
///
/// # Errors
/// An accessor is not there, or of the wrong type or length; a number is not finite; a vertex is bound to a joint that
/// the skin lacks.
pub(super) fn read(data: &mut Data, primitive: &Primitive, joints: Option<usize>, place: &str) -> Result<Vertices> {
    let mut reader = Reader { data, primitive, place, count: None };
    let Some(places) = reader.vectors(&Semantic::Positions)? else {
        return Err(bad(place, "expected POSITION, found none"));
    };
    let normals: Option<Vec<Vec3>> =
        reader.vectors(&Semantic::Normals)?.map(|normals| normals.into_iter().map(unit).collect());
    let tangents = reader.tangents()?.filter(|_| normals.is_some());
    let mut colours = reader.sets(Semantic::Colors, &[Type::Vec3, Type::Vec4])?;
    colours.iter_mut().flat_map(|set| &mut set.values).for_each(|v| *v = v.clamp(0.0, 1.0));
    let textured = reader.sets(Semantic::TexCoords, &[Type::Vec2])?;
    let bound = joints.map(|joints| reader.bound(joints)).transpose()?.unwrap_or_default();
    let base = [normals.is_some(), tangents.is_some()];
    let targets = primitive.targets.iter().flatten().map(|t| reader.target(t, base)).collect::<Result<_>>()?;
    Ok(Vertices { places, normals, tangents, colours, textured, bound, targets })
}

struct Reader<'a, 'b> {
    data: &'a mut Data<'b>,
    primitive: &'a Primitive,
    place: &'a str,
    /// Number of vertices, once it is known.
    count: Option<usize>,
}

impl Reader<'_, '_> {
    fn attribute(&self, semantic: &Semantic) -> Option<(Index<Accessor>, String)> {
        let index = self.primitive.attributes.get(&Checked::Valid(semantic.clone()))?;
        Some((*index, format!("{} {}", self.place, semantic.to_string())))
    }

    /// Numbers of every vertex.
    fn set(&mut self, at: (Index<Accessor>, String), kinds: &[Type], numbers: Numbers) -> Result<Set> {
        let (index, place) = at;
        let found = self.data.floats(index, kinds, numbers, &place)?;
        self.counted(found.values.len(), found.kind, &place)?;
        match found.values.iter().find(|v| !v.is_finite()) {
            Some(value) => Err(bad(place, format!("expected finite numbers, found {value}"))),
            None => Ok(Set { kind: found.kind, values: found.values.to_vec() }),
        }
    }

    /// Checks that all attributes have one element for each vertex. What is kept of them is in memory once more.
    fn counted(&mut self, numbers: usize, kind: Type, place: &str) -> Result<()> {
        self.data.spend(numbers, place)?;
        let found = numbers / kind.multiplicity();
        let count = *self.count.get_or_insert(found.max(1));
        if count == found {
            return Ok(());
        }
        Err(bad(place, format!("expected an element for each of {count} vertices, found {found}")))
    }

    fn vectors(&mut self, semantic: &Semantic) -> Result<Option<Vec<Vec3>>> {
        self.attribute(semantic).map(|at| self.vec3s(at)).transpose()
    }

    fn vec3s(&mut self, at: (Index<Accessor>, String)) -> Result<Vec<Vec3>> {
        let set = self.set(at, &[Type::Vec3], Numbers::Floats)?;
        Ok(set.values.chunks_exact(3).map(Vec3::from_slice).collect())
    }

    fn tangents(&mut self) -> Result<Option<Vec<Vec4>>> {
        let Some(at) = self.attribute(&Semantic::Tangents) else { return Ok(None) };
        let set = self.set(at, &[Type::Vec4], Numbers::Floats)?;
        let tangent = |v: &[f32]| unit(Vec3::from_slice(v)).extend(1.0f32.copysign(v[3]));
        Ok(Some(set.values.chunks_exact(4).map(tangent).collect()))
    }

    /// Sets number 0, 1, ... of an attribute that may have several, up to the first that is missing.
    fn sets(&mut self, semantic: fn(u32) -> Semantic, kinds: &[Type]) -> Result<Vec<Set>> {
        let mut sets = Vec::new();
        for n in 0..MOST_SETS {
            let Some(at) = self.attribute(&semantic(n)) else { break };
            sets.push(self.set(at, kinds, Numbers::Fractions)?);
        }
        Ok(sets)
    }

    fn bound(&mut self, joints: usize) -> Result<Vec<Bound>> {
        let weights = self.sets(Semantic::Weights, &[Type::Vec4])?;
        let mut numbers = Vec::new();
        for n in 0..weights.len() {
            let Some((index, place)) = self.attribute(&Semantic::Joints(n as u32)) else { break };
            let found = self.data.integers(index, Type::Vec4, 2, &place)?;
            self.counted(found.len(), Type::Vec4, &place)?;
            numbers.push(found);
        }
        if numbers.is_empty() || numbers.len() != weights.len() {
            let found = format!("found JOINTS of {} sets and WEIGHTS of {}", numbers.len(), weights.len());
            return Err(bad(self.place, format!("expected joints and their weights for all vertices, {found}")));
        }
        let mut bound: Vec<Bound> = weights.iter().map(|_| Bound::default()).collect();
        for v in 0..self.count.unwrap_or(0) {
            let four = |n: usize| (0..4).map(move |k| (n, 4 * v + k));
            let all = (0..bound.len()).flat_map(four).map(|(n, at)| (numbers[n][at], weights[n].values[at]));
            let held = held(&all.collect::<Vec<_>>(), joints);
            let held = held.map_err(|problem| bad(format!("{} vertex {v}", self.place), problem))?;
            for (set, four) in bound.iter_mut().zip(held.chunks_exact(4)) {
                set.joints.push(std::array::from_fn(|k| four[k].0));
                set.weights.push(std::array::from_fn(|k| four[k].1));
            }
        }
        Ok(bound)
    }

    /// A morph target; normals and tangents only where the vertices have some that they can move.
    fn target(&mut self, target: &MorphTarget, [normals, tangents]: [bool; 2]) -> Result<Target> {
        let place = format!("{} target", self.place);
        let mut read = |index: Option<Index<Accessor>>| index.map(|i| self.vec3s((i, place.clone()))).transpose();
        let target = Target {
            places: read(target.positions)?,
            normals: read(target.normals.filter(|_| normals))?,
            tangents: read(target.tangents.filter(|_| tangents))?,
        };
        if target.places.is_none() && target.normals.is_none() && target.tangents.is_none() {
            return Err(bad(place, "expected POSITION, found none"));
        }
        Ok(target)
    }
}

/// A direction; up if it is none.
fn unit(v: Vec3) -> Vec3 {
    v.as_dvec3().normalize_or(glam::DVec3::Y).as_vec3()
}

/// One vertex's joints, each once, and their weights as parts of 1; where there is no weight, joint 0.
fn held(joints: &[(u32, f32)], most: usize) -> std::result::Result<Vec<(u16, f32)>, String> {
    let total: f64 = joints.iter().map(|j| f64::from(j.1)).sum();
    let mut held = vec![(0, 0.0); joints.len()];
    let mut used = 0;
    for &(joint, weight) in joints {
        if weight < 0.0 {
            return Err(format!("expected weights of 0 and more, found {weight}"));
        }
        let part = (f64::from(weight) / total) as f32;
        if part.is_nan() || part == 0.0 {
            continue;
        }
        if joint as usize >= most {
            return Err(format!("expected one of the skin's {most} joints, found number {joint}"));
        }
        let joint = joint as u16;
        match held[..used].iter_mut().find(|h| h.0 == joint) {
            Some(same) => same.1 += part,
            None => (held[used], used) = ((joint, part), used + 1),
        }
    }
    if used == 0 {
        // Bound to nothing: it stays with the first joint, as in other readers.
        held[0] = (joints[0].0.min(most as u32 - 1) as u16, 1.0);
    }
    Ok(held)
}
