//! Surfaces lofted through rings: what the mannequin is made of.

use std::f32::consts::TAU;

use glam::Vec3;

use super::look::Region;

/// A closed curve around `center`: `u` and `v` are half axes at right angles, `power` 2 is an ellipse, more is boxier.
#[derive(Clone, Copy)]
pub(super) struct Ring {
    pub center: Vec3,
    pub u: Vec3,
    pub v: Vec3,
    pub power: f32,
}

impl Ring {
    /// The curve's point at `angle` from u towards v.
    pub(super) fn point(&self, angle: f32) -> Vec3 {
        let bulge = |v: f32| v.signum() * v.abs().powf(2.0 / self.power);
        self.center + self.u * bulge(angle.cos()) + self.v * bulge(angle.sin())
    }
}

/// Joints and weights of one vertex; weights sum to 1 and joints without weight are 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Binding {
    pub joints: [u16; 4],
    pub weights: [f32; 4],
}

/// Vertices and, per region, triangles.
#[derive(Default)]
pub(super) struct Surface {
    pub positions: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    pub bindings: Vec<Binding>,
    pub triangles: [Vec<[u16; 3]>; Region::COUNT],
}

impl Surface {
    /// Adds a closed surface through `rings` of `segments` points, from the point `ends[0]` to the point `ends[1]`.
    /// Rings must turn counter-clockwise about the direction in which they follow each other (u x v points there).
    pub(super) fn loft(&mut self, region: Region, segments: usize, ends: [Vec3; 2], rings: &[Ring]) -> LoftRange {
        let first = self.positions.len();
        let mut faces = Vec::new();
        let at = |ring: usize, i: usize| (first + 1 + ring * segments + i % segments) as u16;
        self.positions.push(ends[0]);
        for ring in rings {
            self.positions.extend((0..segments).map(|i| ring.point(i as f32 / segments as f32 * TAU)));
        }
        self.positions.push(ends[1]);
        let (low, high) = (first as u16, (self.positions.len() - 1) as u16);
        for i in 0..segments {
            faces.push([low, at(0, i + 1), at(0, i)]);
            faces.push([high, at(rings.len() - 1, i), at(rings.len() - 1, i + 1)]);
            for r in 0..rings.len() - 1 {
                faces.push([at(r, i), at(r, i + 1), at(r + 1, i + 1)]);
                faces.push([at(r, i), at(r + 1, i + 1), at(r + 1, i)]);
            }
        }
        self.triangles[region as usize].extend(&faces);
        let range = first..self.positions.len();
        self.normals.resize(range.end, Vec3::ZERO);
        self.bindings.resize(range.end, Binding::default());
        LoftRange { vertices: range, faces }
    }

    /// Gives those faces of a loft whose corners are all where `inside` says to another region.
    pub(super) fn repaint(&mut self, from: Region, to: Region, inside: impl Fn(Vec3) -> bool) {
        let faces = std::mem::take(&mut self.triangles[from as usize]);
        let of = |face: &[u16; 3]| face.iter().all(|&v| inside(self.positions[v as usize]));
        let (moved, kept) = faces.into_iter().partition(of);
        self.triangles[from as usize] = kept;
        let moved: Vec<[u16; 3]> = moved;
        self.triangles[to as usize].extend(moved);
    }

    /// Smooth normals of a loft; call it once the positions are final.
    pub(super) fn smooth(&mut self, loft: &LoftRange) {
        for face in &loft.faces {
            let [a, b, c] = face.map(|i| self.positions[i as usize]);
            let normal = (b - a).cross(c - a);
            face.iter().for_each(|&i| self.normals[i as usize] += normal);
        }
        for normal in &mut self.normals[loft.vertices.clone()] {
            *normal = normal.normalize_or(Vec3::Y);
        }
    }
}

/// What one loft added.
pub(super) struct LoftRange {
    pub vertices: std::ops::Range<usize>,
    faces: Vec<[u16; 3]>,
}
