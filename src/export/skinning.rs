//! Which joints move a point of the mannequin's surface.

use glam::Vec3;

use super::loft::Binding;
use crate::motion::joint::*;

/// The parts of the body that are bound in their own ways. Limbs are given for the left side (+x).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Part {
    Torso,
    Neck,
    Head,
    Arm,
    Hand,
    Leg,
    Shoe,
    Skirt,
}

/// The binding of the point `p` of the rest pose.
pub(super) fn bind(part: Part, p: Vec3) -> Binding {
    match part {
        Part::Torso => torso(p),
        Part::Neck => chain(p.y, &[(SPINE2, 0.0), (NECK, 1.46), (HEAD, 1.55)], 0.05),
        Part::Head => binding(&[(HEAD, 1.0)]),
        Part::Arm => {
            chain(p.x, &[(LEFT_SHOULDER, -9.0), (LEFT_ARM, 0.155), (LEFT_FORE_ARM, 0.455), (LEFT_HAND, 0.705)], 0.04)
        }
        Part::Hand => binding(&[(LEFT_HAND, 1.0)]),
        Part::Leg => chain(-p.y, &[(HIPS, -9.0), (LEFT_UP_LEG, -0.88), (LEFT_LEG, -0.485)], 0.05),
        Part::Skirt => skirt(p),
        Part::Shoe => chain(p.z, &[(LEFT_FOOT, -9.0), (LEFT_TOE, 0.125)], 0.025),
    }
}

/// The same binding on the other side of the body.
pub(super) fn mirrored(binding: Binding) -> Binding {
    let joints =
        std::array::from_fn(|i| if binding.weights[i] > 0.0 { mirror(binding.joints[i] as usize) as u16 } else { 0 });
    Binding { joints, ..binding }
}

fn torso(p: Vec3) -> Binding {
    let back = [(HIPS, -9.0), (SPINE, 1.02), (SPINE1, 1.16), (SPINE2, 1.29)];
    let spine = chain(p.y, &back, 0.06);
    // The tops of the shoulders follow the collar bones.
    let collar = 0.7 * ramp(p.x.abs(), 0.05, 0.15) * ramp(p.y, 1.27, 1.38);
    let shoulder = if p.x > 0.0 { LEFT_SHOULDER } else { RIGHT_SHOULDER };
    let mut all: Vec<(usize, f32)> = vec![(shoulder, collar)];
    all.extend((0..4).map(|i| (spine.joints[i] as usize, spine.weights[i] * (1.0 - collar))));
    binding(&all)
}

/// A skirt hangs from the hips and is carried by both thighs, each on its own side.
fn skirt(p: Vec3) -> Binding {
    let (legs, left) = (ramp(-p.y, -0.95, -0.78), ramp(p.x, -0.11, 0.11));
    binding(&[(HIPS, 1.0 - legs), (LEFT_UP_LEG, legs * left), (RIGHT_UP_LEG, legs * (1.0 - left))])
}

/// Each joint takes over from the one before where `at` passes its knot, over `half` to both sides.
fn chain(at: f32, knots: &[(usize, f32)], half: f32) -> Binding {
    let taken = |k: usize| knots.get(k).map_or(0.0, |&(_, knot)| ramp(at, knot - half, knot + half));
    let weights: Vec<(usize, f32)> = knots
        .iter()
        .enumerate()
        .map(|(k, &(joint, _))| (joint, (if k == 0 { 1.0 } else { taken(k) }) - taken(k + 1)))
        .collect();
    binding(&weights)
}

fn ramp(v: f32, from: f32, to: f32) -> f32 {
    let t = ((v - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// The four largest weights, normalised.
fn binding(weights: &[(usize, f32)]) -> Binding {
    let mut sorted: Vec<(usize, f32)> = weights.iter().copied().filter(|w| w.1 > 1e-3).collect();
    sorted.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    sorted.truncate(4);
    let sum: f32 = sorted.iter().map(|w| w.1).sum();
    let mut out = Binding::default();
    for (i, (joint, weight)) in sorted.into_iter().enumerate() {
        (out.joints[i], out.weights[i]) = (joint as u16, weight / sum);
    }
    out
}
