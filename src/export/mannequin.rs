//! The mannequin: a dressed body around the canonical skeleton's rest pose, lofted from a few tables of numbers.

use std::f32::consts::TAU;
use std::sync::LazyLock;

use glam::{Quat, Vec3};

use super::loft::{Ring, Surface};
use super::look::Region;
use super::shape::*;
use super::skinning::{Part, bind, mirrored};
use crate::motion::{Build, JOINT_COUNT, Skeleton, canonical};

/// A skinned triangle mesh of a person in the rest pose of the canonical skeleton.
#[derive(Clone, Debug, PartialEq)]
pub struct Mannequin {
    /// Vertex positions, metres.
    pub positions: Vec<Vec3>,
    /// Unit normals.
    pub normals: Vec<Vec3>,
    /// Joints that move each vertex; 0 where the weight is 0.
    pub joints: Vec<[u16; 4]>,
    /// Their weights; they sum to 1.
    pub weights: Vec<[f32; 4]>,
    /// Triangles per [`Region`], counter-clockwise seen from outside.
    pub triangles: [Vec<[u16; 3]>; Region::COUNT],
}

/// The mannequin, built once.
pub fn mannequin() -> &'static Mannequin {
    static MANNEQUIN: LazyLock<Mannequin> = LazyLock::new(build);
    &MANNEQUIN
}

impl Mannequin {
    /// Vertex positions and unit normals of a person of `build` in the rest pose of their own skeleton.
    pub fn grown(&self, build: &Build) -> (Vec<Vec3>, Vec<Vec3>) {
        let (from, to) = (rest(canonical()), rest(&build.skeleton));
        let grow = |v: usize| {
            let (mut place, mut normal) = (Vec3::ZERO, Vec3::ZERO);
            for (&joint, &weight) in self.joints[v].iter().zip(&self.weights[v]) {
                let (j, flesh) = (joint as usize, &build.flesh[joint as usize]);
                let forward = Vec3::Z * flesh.forward;
                place += weight * (to[j] + flesh.scale * (self.positions[v] - from[j]) + forward);
                normal += weight * self.normals[v] / flesh.scale;
            }
            (place, normal.normalize_or(Vec3::Y))
        };
        (0..self.positions.len()).map(grow).unzip()
    }
}

/// Global positions of the joints in the rest pose, metres.
pub(super) fn rest(skeleton: &Skeleton) -> Vec<Vec3> {
    let mut globals = Vec::new();
    skeleton.globals(skeleton.joints[0].offset, &[Quat::IDENTITY; JOINT_COUNT], &mut globals);
    globals.into_iter().map(|g| g.0).collect()
}

const HAIR_SEGMENTS: usize = 16;

fn build() -> Mannequin {
    let mut body = Body(Surface::default());
    body.upright(Region::Seat, Part::Torso, 14, 0.0, 2.3, PELVIS);
    body.upright(Region::Shirt, Part::Torso, 14, 0.0, 2.35, SHIRT);
    body.upright(Region::Skin, Part::Neck, 8, 0.0, 2.0, NECK);
    body.upright(Region::Skin, Part::Head, 14, 0.0, 2.1, HEAD);
    body.upright(Region::Skin, Part::Head, 6, 0.0, 2.0, NOSE);
    body.hair();
    body.upright(Region::LongHair, Part::Head, 12, 0.0, 2.1, LONG_HAIR);
    body.upright(Region::Bun, Part::Head, 8, 0.0, 2.0, BUN);
    body.upright(Region::Visor, Part::Head, 12, 0.0, 2.2, VISOR);
    body.upright(Region::Skirt, Part::Skirt, 16, 0.0, 2.2, SKIRT);
    body.both_sides(|b| b.ear());
    body.both_sides(|b| b.upright(Region::Trousers, Part::Leg, 10, 0.09, 2.1, LEG));
    body.both_sides(|b| b.sideways(Region::Shirt, Part::Arm, 10, SLEEVE));
    body.both_sides(|b| b.sideways(Region::Sleeve, Part::Arm, 8, ARM));
    body.both_sides(|b| b.sideways(Region::Skin, Part::Hand, 8, PALM));
    body.both_sides(Body::fingers);
    body.both_sides(Body::shoe);
    body.0.repaint(Region::Trousers, Region::Shin, |p| p.y < 0.58);
    let Surface { positions, normals, bindings, triangles } = body.0;
    Mannequin {
        positions,
        normals,
        joints: bindings.iter().map(|b| b.joints).collect(),
        weights: bindings.iter().map(|b| b.weights).collect(),
        triangles,
    }
}

struct Body(Surface);

impl Body {
    /// Adds a loft, its normals and its bindings.
    fn add(&mut self, region: Region, part: Part, segments: usize, ends: [Vec3; 2], rings: &[Ring]) {
        let loft = self.0.loft(region, segments, ends, rings);
        self.0.smooth(&loft);
        for v in loft.vertices {
            self.0.bindings[v] = bind(part, self.0.positions[v]);
        }
    }

    /// A loft through horizontal slices, from the ground up.
    fn upright(&mut self, region: Region, part: Part, segments: usize, x: f32, power: f32, slices: Slices) {
        let rings: Vec<Ring> = slices.iter().map(|s| slice(x, power, s)).collect();
        self.add(region, part, segments, [rings[0].center, rings[rings.len() - 1].center], &rings);
    }

    /// A loft along the left arm.
    fn sideways(&mut self, region: Region, part: Part, segments: usize, lengths: Lengths) {
        let ring = |&[x, height, depth]: &[f32; 3]| Ring {
            center: Vec3::new(x, 1.395, 0.0),
            u: Vec3::Y * height,
            v: Vec3::Z * depth,
            power: 2.1,
        };
        let rings: Vec<Ring> = lengths.iter().map(ring).collect();
        self.add(region, part, segments, [rings[0].center, rings[rings.len() - 1].center], &rings);
    }

    fn fingers(&mut self) {
        for [z, length, thickness] in FINGERS {
            self.digit(Vec3::new(0.790, 1.395, z), Vec3::new(1.0, -0.10, z * 2.0), length, thickness);
        }
        self.digit(Vec3::new(0.722, 1.392, 0.022), Vec3::new(0.75, -0.12, 0.66), 0.072, 0.0115);
    }

    /// A finger that bends down a little on its way.
    fn digit(&mut self, from: Vec3, direction: Vec3, length: f32, thickness: f32) {
        let direction = direction.normalize();
        let side = direction.cross(Vec3::Y).normalize();
        let ring = |(along, scale): (f32, f32)| Ring {
            center: from + direction * (along * length) - Vec3::Y * (0.16 * length * along * along),
            u: side.cross(direction) * (thickness * scale * 0.92),
            v: side * (thickness * scale),
            power: 2.0,
        };
        let rings = [(0.0, 0.95), (0.6, 0.98), (0.96, 0.66)].map(ring);
        let tip = rings[2].center + direction * (thickness * 0.35);
        self.add(Region::Skin, Part::Hand, 5, [from, tip], &rings);
    }

    fn shoe(&mut self) {
        let ring = |&[z, width, low, high]: &[f32; 4]| Ring {
            center: Vec3::new(0.09, (low + high) * 0.5, z),
            u: Vec3::X * width,
            v: Vec3::Y * ((high - low) * 0.5),
            power: 2.9,
        };
        let rings: Vec<Ring> = SHOE.iter().map(ring).collect();
        let ends = [Vec3::new(0.09, 0.035, -0.070), Vec3::new(0.09, 0.018, 0.202)];
        self.add(Region::Shoe, Part::Shoe, 10, ends, &rings);
    }

    fn ear(&mut self) {
        let ring = |[y, height]: [f32; 2]| Ring {
            center: Vec3::new(0.072, y, 0.004 - (y - 1.625) * 0.25),
            u: Vec3::Z * height,
            v: Vec3::X * 0.011,
            power: 2.0,
        };
        let rings = [[1.602, 0.007], [1.616, 0.012], [1.643, 0.015], [1.655, 0.006]].map(ring);
        self.add(Region::Skin, Part::Head, 6, [rings[0].center, rings[3].center], &rings);
    }

    /// A cap a little larger than the head, from the hairline (high in front, low behind) to the crown. Its lowest
    /// ring lies below the skin.
    fn hair(&mut self) {
        let heights =
            [(0.0, -0.006), (0.03, 0.006), (0.15, 0.012), (0.35, 0.014), (0.58, 0.014), (0.8, 0.013), (0.95, 0.012)];
        let blank = heights.map(|_| slice(0.0, 2.1, &HEAD[0]));
        let ends = [Vec3::new(0.0, 1.66, 0.0), Vec3::new(0.0, 1.763, 0.0)];
        let loft = self.0.loft(Region::Hair, HAIR_SEGMENTS, ends, &blank);
        for (v, place) in loft.vertices.clone().skip(1).zip(0..heights.len() * HAIR_SEGMENTS) {
            let (climb, lift) = heights[place / HAIR_SEGMENTS];
            let angle = (place % HAIR_SEGMENTS) as f32 / HAIR_SEGMENTS as f32 * TAU;
            let hairline = 1.580 + 0.118 * smooth((angle.cos() + 0.35) / 0.85);
            let height = hairline + (1.749 - hairline) * (1.0 - (1.0 - climb) * (1.0 - climb));
            let p = head_slice(height).point(angle);
            self.0.positions[v] = p + (p - Vec3::new(0.0, 1.655, 0.006)).normalize_or(Vec3::Y) * lift;
        }
        self.0.smooth(&loft);
        for v in loft.vertices {
            self.0.bindings[v] = bind(Part::Head, self.0.positions[v]);
        }
    }

    /// Adds a part for the left side, then its mirror image.
    fn both_sides(&mut self, part: impl FnOnce(&mut Self)) {
        let first = self.0.positions.len();
        let faces = self.0.triangles.each_ref().map(Vec::len);
        part(self);
        let shift = (self.0.positions.len() - first) as u16;
        for v in first..first + shift as usize {
            self.0.positions.push(self.0.positions[v] * Vec3::new(-1.0, 1.0, 1.0));
            self.0.normals.push(self.0.normals[v] * Vec3::new(-1.0, 1.0, 1.0));
            self.0.bindings.push(mirrored(self.0.bindings[v]));
        }
        for (triangles, from) in self.0.triangles.iter_mut().zip(faces) {
            let mirror: Vec<[u16; 3]> =
                triangles[from..].iter().map(|&[a, b, c]| [a, c, b].map(|v| v + shift)).collect();
            triangles.extend(mirror);
        }
    }
}

fn slice(x: f32, power: f32, &[y, width, front, back]: &[f32; 4]) -> Ring {
    Ring {
        center: Vec3::new(x, y, (front + back) * 0.5),
        u: Vec3::Z * ((front - back) * 0.5),
        v: Vec3::X * width,
        power,
    }
}

/// The head's outline at any height.
fn head_slice(y: f32) -> Ring {
    let k = HEAD.iter().rposition(|s| s[0] <= y).unwrap_or(0).min(HEAD.len() - 2);
    let t = (y - HEAD[k][0]) / (HEAD[k + 1][0] - HEAD[k][0]);
    slice(0.0, 2.1, &std::array::from_fn(|i| HEAD[k][i] + (HEAD[k + 1][i] - HEAD[k][i]) * t))
}

fn smooth(t: f32) -> f32 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::joint;

    #[test]
    fn is_small_symmetric_and_as_tall_as_the_skeleton() {
        let m = mannequin();
        let triangles: usize = m.triangles.iter().map(Vec::len).sum();
        assert!((1500..=3800).contains(&triangles), "{triangles}");
        let top = m.positions.iter().map(|p| p.y).fold(f32::MIN, f32::max);
        let bottom = m.positions.iter().map(|p| p.y).fold(f32::MAX, f32::min);
        assert!((1.74..1.78).contains(&top) && bottom.abs() < 0.01, "{bottom} to {top}");
        for p in &m.positions {
            let twin = Vec3::new(-p.x, p.y, p.z);
            assert!(m.positions.iter().any(|q| q.distance(twin) < 1e-4), "{p} has no twin");
        }
    }

    #[test]
    fn every_surface_is_closed_and_turned_outward_in_every_build() {
        let m = mannequin();
        let mut edges = std::collections::BTreeMap::new();
        for &[a, b, c] in m.triangles.iter().flatten() {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((from.min(to), from.max(to))).or_insert(0) += if from < to { 1 } else { -1 };
            }
        }
        assert!(edges.values().all(|&n| n == 0), "a hole");
        for build in Build::catalogue().iter().flatten() {
            let (positions, normals) = m.grown(build);
            assert!(normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4));
            let volume: f32 = m
                .triangles
                .iter()
                .flatten()
                .map(|t| t.map(|v| positions[v as usize]))
                .map(|[p, q, r]| p.dot(q.cross(r)) / 6.0)
                .sum();
            assert!((0.06..0.18).contains(&volume), "{}: {volume} cubic metres", build.name);
            for &[a, b, c] in m.triangles.iter().flatten() {
                let [p, q, r] = [a, b, c].map(|v| positions[v as usize]);
                let n = (q - p).cross(r - p).normalize_or_zero();
                assert!(n.dot(normals[a as usize]) > -0.6, "{}: a face turned inside out at {p}", build.name);
            }
        }
    }

    #[test]
    fn builds_are_as_tall_as_their_bones_and_stand_on_the_floor() {
        let m = mannequin();
        let (same, _) = m.grown(&Build::canonical());
        assert!(same.iter().zip(&m.positions).all(|(a, b)| a.distance(*b) < 1e-5));
        for build in Build::catalogue().iter().flatten() {
            let heights: Vec<f32> = m.grown(build).0.iter().map(|p| p.y).collect();
            let (top, bottom) =
                (heights.iter().copied().fold(f32::MIN, f32::max), heights.iter().copied().fold(f32::MAX, f32::min));
            assert!((top - build.stature()).abs() < 0.03 && bottom.abs() < 0.01, "{}: {bottom} to {top}", build.name);
        }
    }

    #[test]
    fn bindings_are_normalised_and_on_their_own_side() {
        let m = mannequin();
        let mut used = [false; JOINT_COUNT];
        // Both thighs carry the middle of a skirt.
        let skirt: Vec<u16> = m.triangles[Region::Skirt as usize].iter().flatten().copied().collect();
        for (v, ((p, joints), weights)) in m.positions.iter().zip(&m.joints).zip(&m.weights).enumerate() {
            assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-5);
            for (&j, &w) in joints.iter().zip(weights) {
                assert!(w > 0.0 || j == 0, "joint {j} without weight");
                used[j as usize] |= w > 0.0;
                let side = if joint::mirror(j as usize) == j as usize { 0.0 } else { canonical_x(j as usize) };
                assert!(w == 0.0 || side * p.x > -0.01 || skirt.contains(&(v as u16)), "joint {j} moves {p}");
            }
        }
        assert!(used.iter().all(|&u| u), "{used:?}");
    }

    fn canonical_x(joint: usize) -> f32 {
        let mut globals = Vec::new();
        crate::motion::canonical().globals(Vec3::ZERO, &[glam::Quat::IDENTITY; JOINT_COUNT], &mut globals);
        globals[joint].0.x.signum()
    }
}
