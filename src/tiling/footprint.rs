//! Footprints: a few ground discs per frame that cover a body's capsules, arms included. Bodies whose footprints are
//! apart are apart; the planner tests these and leaves the exact capsules to the end.

use glam::{Quat, Vec2, Vec3};

use crate::geom::{Capsule, Ground};
use crate::motion::{Motion, body_capsules};

/// Discs per body.
pub(super) const DISCS: usize = 6;
/// Spacing of the points that stand for a capsule, metres.
const SPACING: f32 = 0.05;

/// The discs of one body at one frame, relative to its path frame: x, z, radius.
pub(super) type Footprint = [Vec3; DISCS];

/// Footprints of all frames of `motion`, each grown by `margin` metres.
pub(super) fn footprints(motion: &Motion, margin: f32) -> Vec<Footprint> {
    let mut globals: Vec<(Vec3, Quat)> = Vec::new();
    let mut capsules = Vec::new();
    let mut atoms = Vec::new();
    let mut centers = [Vec2::ZERO; DISCS];
    (0..motion.len())
        .map(|frame| {
            motion.globals_at(frame, Ground::IDENTITY, &mut globals);
            capsules.clear();
            body_capsules(&globals, &mut capsules);
            atoms.clear();
            capsules.iter().for_each(|c| scatter(c, &mut atoms));
            if frame == 0 {
                centers = spread(&atoms);
            }
            cover(&atoms, &mut centers, margin)
        })
        .collect()
}

/// Radius around the path point within which the whole footprint lies.
pub(super) fn reach(footprint: &Footprint) -> f32 {
    footprint.iter().map(|d| Vec2::new(d.x, d.y).length() + d.z).fold(0.0, f32::max)
}

fn scatter(c: &Capsule, atoms: &mut Vec<Vec3>) {
    let (a, b) = (Vec2::new(c.a.x, c.a.z), Vec2::new(c.b.x, c.b.z));
    let steps = ((b - a).length() / SPACING).ceil().max(1.0) as usize;
    let half = (b - a).length() / steps as f32 * 0.5;
    // A disc of sqrt(r^2 + half^2) at each point covers the stadium's sides between two points.
    let radius = c.radius.hypot(half);
    atoms.extend((0..=steps).map(|i| a.lerp(b, i as f32 / steps as f32).extend(radius)));
}

/// Farthest-point start.
fn spread(atoms: &[Vec3]) -> [Vec2; DISCS] {
    let mut centers = [atoms[0].truncate(); DISCS];
    for k in 1..DISCS {
        let gap = |a: &Vec3| centers[..k].iter().map(|c| c.distance(a.truncate())).fold(f32::INFINITY, f32::min);
        let farthest = atoms.iter().max_by(|a, b| gap(a).total_cmp(&gap(b))).expect("bodies have capsules");
        centers[k] = farthest.truncate();
    }
    centers
}

/// A few rounds of Lloyd's algorithm from the last frame's centres, so that discs move with the body.
fn cover(atoms: &[Vec3], centers: &mut [Vec2; DISCS], margin: f32) -> Footprint {
    let nearest = |centers: &[Vec2; DISCS], a: &Vec3| {
        (0..DISCS).min_by(|&i, &j| centers[i].distance(a.truncate()).total_cmp(&centers[j].distance(a.truncate())))
    };
    for _ in 0..4 {
        let (mut low, mut high) = ([Vec2::INFINITY; DISCS], [Vec2::NEG_INFINITY; DISCS]);
        for atom in atoms {
            let k = nearest(centers, atom).expect("DISCS > 0");
            low[k] = low[k].min(atom.truncate() - atom.z);
            high[k] = high[k].max(atom.truncate() + atom.z);
        }
        for k in 0..DISCS {
            if low[k].is_finite() {
                centers[k] = (low[k] + high[k]) * 0.5;
            }
        }
    }
    let mut discs = centers.map(|c| c.extend(0.0));
    for atom in atoms {
        let k = nearest(centers, atom).expect("DISCS > 0");
        discs[k].z = discs[k].z.max(centers[k].distance(atom.truncate()) + atom.z + margin);
    }
    discs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{JOINT_COUNT, MotionPath};

    #[test]
    fn discs_cover_every_capsule_of_a_body() {
        let motion = Motion {
            path: MotionPath { points: vec![Vec2::ZERO; 2], headings: vec![0.0; 2] },
            heights: vec![0.935; 2],
            rotations: (0..2 * JOINT_COUNT).map(|i| Quat::from_rotation_z(0.1 * (i % 5) as f32)).collect(),
            plants: vec![],
        };
        let discs = footprints(&motion, 0.0);
        let (mut globals, mut capsules) = (vec![], vec![]);
        motion.globals_at(1, Ground::IDENTITY, &mut globals);
        body_capsules(&globals, &mut capsules);
        for c in &capsules {
            for i in 0..=50 {
                for k in 0..24 {
                    let angle = k as f32 / 24.0 * std::f32::consts::TAU;
                    let p = c.a.lerp(c.b, i as f32 / 50.0) + Vec3::new(angle.cos(), 0.0, angle.sin()) * c.radius;
                    let covered = discs[1].iter().any(|d| d.truncate().distance(Vec2::new(p.x, p.z)) <= d.z + 1e-4);
                    assert!(covered, "{p}");
                }
            }
        }
    }
}
