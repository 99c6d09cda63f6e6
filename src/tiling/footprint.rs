//! Footprints: a few ground discs per frame that cover a body's capsules, arms included, and the box in its hands.
//! Bodies whose footprints are apart are apart; the planner tests these and leaves the exact shapes to the end.

use glam::{Quat, Vec2, Vec3};

use crate::geom::{Capsule, Cuboid, Ground};
use crate::motion::body_capsules;
use crate::patch::{PatchKind, PatchProp};

/// Discs per body.
pub(super) const DISCS: usize = 6;
/// Spacing of the points that stand for a capsule, metres.
const SPACING: f32 = 0.05;

/// The discs of one body at one frame, relative to its path frame: x, z, radius.
pub(super) type Footprint = [Vec3; DISCS];

/// How high what each disc covers is above the ground at its lowest, metres.
pub(super) type Lifts = [f32; DISCS];

/// A point that stands for a part of a body: x, z, radius; and how high the part is at its lowest.
type Atom = (Vec3, f32);

/// Footprints of all frames of a role, each grown by `margin` metres. A box that lies there covers ground from the
/// first frame of who takes it up, and to the last of who puts it down.
pub(super) fn footprints(kind: &PatchKind, role: u32, margin: f32) -> Vec<(Footprint, Lifts)> {
    let fragment = &kind.fragments[role as usize];
    let motion = &fragment.motion;
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
            let clock = fragment.begin + frame as u32;
            for prop in kind.props.iter().filter(|p| is_minded(p, role, clock)) {
                let place = prop.place(kind, clock).expect("minded");
                let from_path = place.carried(motion.path.at(frame).inverse());
                strew(&Cuboid::new(from_path, prop.size), &mut atoms);
            }
            if frame == 0 {
                centers = spread(&atoms);
            }
            cover(&atoms, &mut centers, margin)
        })
        .collect()
}

/// True if a box counts as part of a role's body at a frame of the clock: while it is in the hands, and while it rests
/// for who had it before or has it next, or for who alone sits on it.
fn is_minded(prop: &PatchProp, role: u32, clock: u32) -> bool {
    if prop.holds.is_empty() {
        return prop.sat.first().is_some_and(|s| s.role == role);
    }
    let mut held = prop.holds.iter().filter(|h| h.begin <= clock && clock <= h.end).peekable();
    if held.peek().is_some() {
        return held.any(|h| h.role == role);
    }
    let next = prop.holds.iter().position(|h| clock < h.begin);
    let before = next.unwrap_or(prop.holds.len()).checked_sub(1);
    [before, next].into_iter().flatten().any(|k| prop.holds[k].role == role)
}

/// The discs of a box that lies there, relative to its place: a row of circles across and one along.
pub(super) fn lying(size: [f32; 3], margin: f32) -> Footprint {
    let (across, along) = (size[0].max(size[2]), size[0].min(size[2]));
    let radius = (across / (DISCS / 2) as f32).hypot(along / 2.0) / 2.0 + margin;
    std::array::from_fn(|k| {
        let x = ((k % 3) as f32 - 1.0) * across / 3.0;
        let z = ((k / 3) as f32 - 0.5) * along / 2.0;
        if size[0] >= size[2] { Vec3::new(x, z, radius) } else { Vec3::new(z, x, radius) }
    })
}

/// Radius around the path point within which the whole footprint lies.
pub(super) fn reach(footprint: &Footprint) -> f32 {
    footprint.iter().map(|d| Vec2::new(d.x, d.y).length() + d.z).fold(0.0, f32::max)
}

fn scatter(c: &Capsule, atoms: &mut Vec<Atom>) {
    let (a, b) = (Vec2::new(c.a.x, c.a.z), Vec2::new(c.b.x, c.b.z));
    let steps = ((b - a).length() / SPACING).ceil().max(1.0) as usize;
    let half = (b - a).length() / steps as f32 * 0.5;
    // A disc of sqrt(r^2 + half^2) at each point covers the stadium's sides between two points.
    let radius = c.radius.hypot(half);
    let sag = c.radius + (c.b.y - c.a.y).abs() / steps as f32 * 0.5;
    atoms.extend((0..=steps).map(|i| {
        let at = c.a.lerp(c.b, i as f32 / steps as f32);
        (Vec3::new(at.x, at.z, radius), at.y - sag)
    }));
}

/// Points around a box's ground plan, discs without radius.
fn strew(cuboid: &Cuboid, atoms: &mut Vec<Atom>) {
    let bottom = cuboid.at.middle.y - cuboid.half.y;
    let plan = cuboid.plan();
    for (i, corner) in plan.into_iter().enumerate() {
        let next = plan[(i + 1) % plan.len()];
        let steps = ((next - corner).length() / SPACING).ceil().max(1.0) as usize;
        let half = (next - corner).length() / steps as f32 * 0.5;
        atoms.extend((0..steps).map(|k| (corner.lerp(next, (k as f32 + 0.5) / steps as f32).extend(half), bottom)));
    }
}

/// Farthest-point start.
fn spread(atoms: &[Atom]) -> [Vec2; DISCS] {
    let place = |a: &Atom| a.0.truncate();
    let mut centers = [place(&atoms[0]); DISCS];
    for k in 1..DISCS {
        let gap = |a: &Atom| centers[..k].iter().map(|c| c.distance(place(a))).fold(f32::INFINITY, f32::min);
        let farthest = atoms.iter().max_by(|a, b| gap(a).total_cmp(&gap(b))).expect("bodies have capsules");
        centers[k] = place(farthest);
    }
    centers
}

/// A few rounds of Lloyd's algorithm from the last frame's centres, so that discs move with the body.
fn cover(atoms: &[Atom], centers: &mut [Vec2; DISCS], margin: f32) -> (Footprint, Lifts) {
    let nearest = |centers: &[Vec2; DISCS], a: &Vec3| {
        (0..DISCS).min_by(|&i, &j| centers[i].distance(a.truncate()).total_cmp(&centers[j].distance(a.truncate())))
    };
    for _ in 0..4 {
        let (mut low, mut high) = ([Vec2::INFINITY; DISCS], [Vec2::NEG_INFINITY; DISCS]);
        for (atom, _) in atoms {
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
    let (mut discs, mut lifts) = (centers.map(|c| c.extend(0.0)), [f32::INFINITY; DISCS]);
    for (atom, lift) in atoms {
        let k = nearest(centers, atom).expect("DISCS > 0");
        discs[k].z = discs[k].z.max(centers[k].distance(atom.truncate()) + atom.z + margin);
        lifts[k] = lifts[k].min(lift - margin);
    }
    (discs, lifts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{JOINT_COUNT, Motion, MotionPath};
    use crate::patch::Fragment;

    #[test]
    fn discs_cover_every_capsule_of_a_body() {
        let motion = Motion {
            path: MotionPath { points: vec![Vec2::ZERO; 2], headings: vec![0.0; 2] },
            heights: vec![0.935; 2],
            rotations: (0..2 * JOINT_COUNT).map(|i| Quat::from_rotation_z(0.1 * (i % 5) as f32)).collect(),
            plants: vec![],
        };
        let fragment = Fragment { motion: motion.clone(), begin: 0, entry_group: 0, exit_group: 0 };
        let kind = PatchKind { fragments: vec![fragment], ..PatchKind::default() };
        let discs = footprints(&kind, 0, 0.0);
        let (mut globals, mut capsules) = (vec![], vec![]);
        motion.globals_at(1, Ground::IDENTITY, &mut globals);
        body_capsules(&globals, &mut capsules);
        for c in &capsules {
            for i in 0..=50 {
                for k in 0..24 {
                    let angle = k as f32 / 24.0 * std::f32::consts::TAU;
                    let p = c.a.lerp(c.b, i as f32 / 50.0) + Vec3::new(angle.cos(), 0.0, angle.sin()) * c.radius;
                    let covered = discs[1].0.iter().any(|d| d.truncate().distance(Vec2::new(p.x, p.z)) <= d.z + 1e-4);
                    assert!(covered, "{p}");
                }
            }
        }
    }

    #[test]
    fn discs_cover_a_box_that_lies_there() {
        for size in [[0.36, 0.26, 0.30], [0.2, 0.2, 0.5], [0.3, 0.1, 0.3]] {
            let discs = lying(size, 0.0);
            for i in 0..=40 {
                for k in 0..=40 {
                    let p = Vec2::new(size[0] * (i as f32 / 40.0 - 0.5), size[2] * (k as f32 / 40.0 - 0.5));
                    assert!(discs.iter().any(|d| d.truncate().distance(p) <= d.z + 1e-4), "{size:?}: {p}");
                }
            }
            assert!(reach(&discs) < 0.5 * size[0].hypot(size[2]) + 0.08);
        }
    }
}
