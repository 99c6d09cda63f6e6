//! From a character's nodes to its outfit: every reference to skins, meshes, materials and pictures is followed once,
//! here, and only what is found on the way is kept. So what is written of it is whole.

use std::collections::BTreeMap;

use glam::Mat4;
use gltf_json::accessor::Type;
use gltf_json::material::Material;
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::texture::{Sampler, Texture};
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Index, Mesh, Root, Skin};

use super::nodes::Parts;
use super::outfit::{Bind, Outfit, Piece, Sewn, Worn};
use super::{material, picture, vertices};
use crate::Result;
use crate::gltf::{Data, Numbers, bad, find};

/// What a texture without a source has.
const NO_SOURCE: usize = u32::MAX as usize;

/// What vertices are made of: accessors of attributes and of morph targets, and the number of joints.
type Cloth = (BTreeMap<Checked<Semantic>, Index<Accessor>>, Vec<[Option<Index<Accessor>>; 3]>, Option<usize>);

/// Places in the outfit by indices of the file.
#[derive(Default)]
struct Done {
    skins: BTreeMap<usize, usize>,
    meshes: BTreeMap<(usize, Option<usize>), usize>,
    vertices: BTreeMap<Cloth, usize>,
    /// And the highest of the corners.
    corners: BTreeMap<usize, (usize, u32)>,
    /// And how many sets of places on textures they need.
    materials: BTreeMap<usize, (usize, u32)>,
    textures: BTreeMap<usize, Index<Texture>>,
    samplers: BTreeMap<usize, Index<Sampler>>,
    pictures: BTreeMap<usize, Index<gltf_json::Image>>,
}

struct Tailor<'a> {
    root: &'a Root,
    data: Data<'a>,
    parts: &'a Parts,
    outfit: Outfit,
    done: Done,
}

/// The outfit that nodes lead to.
///
/// # Errors
/// A reference that leads nowhere; anything that is not what glTF says it is: with its place.
pub(super) fn dress(root: &Root, data: Data, parts: &Parts) -> Result<Outfit> {
    let mut tailor = Tailor { root, data, parts, outfit: Outfit::default(), done: Done::default() };
    for &(n, skin) in &parts.skinned {
        let skin = tailor.skin(skin, &format!("node {n}"))?;
        let joints = tailor.outfit.skins[skin].joints.len();
        if let Some(worn) = tailor.worn(n, Some(joints))? {
            tailor.outfit.dresses.push((worn, skin));
        }
    }
    for (i, &n) in parts.nodes.iter().enumerate().filter(|&(_, &n)| root.nodes[n].skin.is_none()) {
        if let Some(worn) = tailor.worn(n, None)? {
            tailor.outfit.stiff.push((worn, 1 + i));
        }
    }
    Ok(tailor.outfit)
}

fn pushed<T>(list: &mut Vec<T>, new: T) -> usize {
    list.push(new);
    list.len() - 1
}

impl Tailor<'_> {
    /// The mesh of a node, bound to so many joints if it has a skin.
    fn worn(&mut self, node: usize, joints: Option<usize>) -> Result<Option<Worn>> {
        let (place, node) = (format!("node {node}"), &self.root.nodes[node]);
        let Some(index) = node.mesh else { return Ok(None) };
        let mesh = match self.done.meshes.get(&(index.value(), joints)) {
            Some(&done) => done,
            None => {
                let sewn = self.sew(find(&self.root.meshes, index, "meshes", &place)?, index, joints)?;
                let mesh = pushed(&mut self.outfit.meshes, sewn);
                self.done.meshes.insert((index.value(), joints), mesh);
                mesh
            }
        };
        let targets = self.targets(&self.outfit.meshes[mesh].pieces[0]);
        Ok(Some(Worn { mesh, weights: morph(node.weights.as_ref(), targets, &place)? }))
    }

    fn targets(&self, piece: &Piece) -> usize {
        self.outfit.vertices[piece.vertices].targets.len()
    }

    fn sew(&mut self, mesh: &Mesh, index: Index<Mesh>, joints: Option<usize>) -> Result<Sewn> {
        let mut pieces = Vec::with_capacity(mesh.primitives.len());
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let place = format!("mesh {index} primitive {p}");
            pieces.push(self.piece(primitive, joints, &place)?);
            let [first, targets] = [0, p].map(|p: usize| self.targets(&pieces[p]));
            if targets != first {
                return Err(bad(place, format!("expected {first} morph targets as in the first, found {targets}")));
            }
        }
        let place = format!("mesh {index}");
        let Some(first) = pieces.first() else { return Err(bad(place, "expected a primitive, found none")) };
        let weights = morph(mesh.weights.as_ref(), self.targets(first), &place)?;
        Ok(Sewn { name: mesh.name.clone(), extras: mesh.extras.clone(), weights, pieces })
    }

    fn piece(&mut self, primitive: &Primitive, joints: Option<usize>, place: &str) -> Result<Piece> {
        let Checked::Valid(mode) = primitive.mode else {
            return Err(bad(place, "expected a mode of glTF 2.0, found another"));
        };
        let vertices = self.vertices(primitive, joints, place)?;
        let all = &self.outfit.vertices[vertices];
        let (count, textured) = (all.places.len(), all.textured.len());
        let corners = primitive.indices.map(|i| self.corners(i, count, place)).transpose()?;
        let drawn = corners.map_or(count, |c| self.outfit.corners[c].len());
        if !whole(mode, drawn) {
            return Err(bad(place, format!("expected whole {mode:?}, found {drawn} corners")));
        }
        let material = primitive.material.map(|m| self.material(m, textured, place)).transpose()?;
        Ok(Piece { mode, vertices, corners, material })
    }

    fn vertices(&mut self, primitive: &Primitive, joints: Option<usize>, place: &str) -> Result<usize> {
        let targets = primitive.targets.iter().flatten().map(|t| [t.positions, t.normals, t.tangents]).collect();
        let key = (primitive.attributes.clone(), targets, joints);
        if let Some(&done) = self.done.vertices.get(&key) {
            return Ok(done);
        }
        let read = vertices::read(&mut self.data, primitive, joints, place)?;
        let made = pushed(&mut self.outfit.vertices, read);
        self.done.vertices.insert(key, made);
        Ok(made)
    }

    /// Numbers of vertices, all below `count`.
    fn corners(&mut self, index: Index<Accessor>, count: usize, place: &str) -> Result<usize> {
        let place = format!("{place} indices");
        let (made, highest) = match self.done.corners.get(&index.value()) {
            Some(&done) => done,
            None => {
                let corners = self.data.integers(index, Type::Scalar, 4, &place)?;
                let highest = corners.iter().copied().max().unwrap_or(0);
                let made = (pushed(&mut self.outfit.corners, corners), highest);
                self.done.corners.insert(index.value(), made);
                made
            }
        };
        if highest as usize >= count {
            return Err(bad(place, format!("expected numbers of {count} vertices, found number {highest}")));
        }
        Ok(made)
    }

    /// A material of vertices that have so many sets of places on textures.
    fn material(&mut self, index: Index<Material>, textured: usize, place: &str) -> Result<usize> {
        let (made, needed) = match self.done.materials.get(&index.value()) {
            Some(&done) => done,
            None => {
                let found = find(&self.root.materials, index, "materials", place)?;
                let place = format!("material {index}");
                let mut plain = material::plain(found, &place)?;
                let mut needed = 0;
                for (texture, set) in material::textures(&mut plain) {
                    *texture = self.texture(*texture, &place)?;
                    needed = needed.max(set.saturating_add(1));
                }
                let made = (pushed(&mut self.outfit.materials, plain), needed);
                self.done.materials.insert(index.value(), made);
                made
            }
        };
        if needed as usize > textured {
            let problem = format!("expected TEXCOORD_{} for material {index}, found none", needed - 1);
            return Err(bad(place, problem));
        }
        Ok(made)
    }

    fn texture(&mut self, index: Index<Texture>, place: &str) -> Result<Index<Texture>> {
        if let Some(&done) = self.done.textures.get(&index.value()) {
            return Ok(done);
        }
        let texture = find(&self.root.textures, index, "textures", place)?;
        let place = format!("texture {index}");
        if texture.source.value() == NO_SOURCE {
            return Err(bad(place, "expected a PNG or JPEG picture, found none"));
        }
        let source = match self.done.pictures.get(&texture.source.value()) {
            Some(&done) => done,
            None => {
                let picture = picture::read(self.root, &mut self.data, texture.source, &place)?;
                let made = Index::new(pushed(&mut self.outfit.pictures, picture) as u32);
                self.done.pictures.insert(texture.source.value(), made);
                made
            }
        };
        let sampler = texture.sampler.map(|s| self.sampler(s, &place)).transpose()?;
        let copy = Texture { source, sampler, name: texture.name.clone(), extensions: None, extras: None };
        let made = Index::new(pushed(&mut self.outfit.textures, copy) as u32);
        self.done.textures.insert(index.value(), made);
        Ok(made)
    }

    fn sampler(&mut self, index: Index<Sampler>, place: &str) -> Result<Index<Sampler>> {
        if let Some(&done) = self.done.samplers.get(&index.value()) {
            return Ok(done);
        }
        let found = find(&self.root.samplers, index, "samplers", place)?;
        let copy = material::sampler(found, &format!("sampler {index}"))?;
        let made = Index::new(pushed(&mut self.outfit.samplers, copy) as u32);
        self.done.samplers.insert(index.value(), made);
        Ok(made)
    }

    fn skin(&mut self, index: Index<Skin>, place: &str) -> Result<usize> {
        if let Some(&done) = self.done.skins.get(&index.value()) {
            return Ok(done);
        }
        let skin = find(&self.root.skins, index, "skins", place)?;
        let place = format!("skin {index}");
        let joints: Vec<usize> = skin.joints.iter().filter_map(|j| self.parts.bone_of[j.value()]).collect();
        let matrices = skin.inverse_bind_matrices.map(|m| self.matrices(m, joints.len(), &place)).transpose()?;
        let made = pushed(&mut self.outfit.skins, Bind { joints, matrices });
        self.done.skins.insert(index.value(), made);
        Ok(made)
    }

    fn matrices(&mut self, index: Index<Accessor>, joints: usize, place: &str) -> Result<Vec<Mat4>> {
        let values = self.data.floats(index, &[Type::Mat4], Numbers::Floats, place)?.values;
        let mut matrices: Vec<Mat4> = values.chunks_exact(16).take(joints).map(Mat4::from_cols_slice).collect();
        if matrices.len() < joints {
            let problem =
                format!("expected an inverse bind matrix for each of {joints} joints, found {}", matrices.len());
            return Err(bad(place, problem));
        }
        for (k, m) in matrices.iter_mut().enumerate() {
            if !m.is_finite() || !m.row(3).abs_diff_eq(glam::Vec4::W, 1e-3) {
                return Err(bad(place, format!("expected inverse bind matrices without perspective, found {m} ({k})")));
            }
            // Rounding would be an error in the eyes of strict readers.
            m.x_axis.w = 0.0;
            m.y_axis.w = 0.0;
            m.z_axis.w = 0.0;
            m.w_axis.w = 1.0;
        }
        Ok(matrices)
    }
}

/// Weights of morph targets, one for each.
fn morph(weights: Option<&Vec<f32>>, targets: usize, place: &str) -> Result<Option<Vec<f32>>> {
    let Some(weights) = weights.filter(|_| targets > 0) else { return Ok(None) };
    if weights.len() == targets && weights.iter().all(|w| w.is_finite()) {
        return Ok(Some(weights.clone()));
    }
    Err(bad(place, format!("expected {targets} finite weights of morph targets, found {weights:?}")))
}

/// Whether so many corners make whole points, lines or triangles.
fn whole(mode: Mode, corners: usize) -> bool {
    match mode {
        Mode::Points => corners > 0,
        Mode::Lines => corners > 0 && corners.is_multiple_of(2),
        Mode::LineLoop | Mode::LineStrip => corners >= 2,
        Mode::Triangles => corners > 0 && corners.is_multiple_of(3),
        Mode::TriangleStrip | Mode::TriangleFan => corners >= 3,
    }
}
