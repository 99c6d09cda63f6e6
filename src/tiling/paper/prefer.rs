//! Equation 7 in the two algorithms: which patches are wanted.
//!
//! The scene's own preference ([`super::super::prefer`]) times what the paper's examples use in the first phase (section
//! 7): larger patches (more people, larger extent, longer) are likelier, f_4 = -ln(people x (1 m2 + extent) x seconds),
//! s_4 = 1. Normalized it is the distribution that Algorithm 1 samples from; it orders the candidates of Algorithm 2.

use glam::Vec2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::super::library::Library;
use super::super::prefer::{Ready, Stay};
use super::patchwork::Placement;
use crate::geom::Ground;
use crate::motion::FPS;
use crate::patch::PatchKind;

/// Places drawn at most for one that is wanted; the last is taken.
const DRAWS: usize = 200;

/// The preference for placements.
pub(super) struct Preference<'a> {
    scene: &'a Ready,
    /// F of each kind by size and labels.
    weights: Vec<f32>,
    cumulative: Vec<f32>,
    /// The middle of each kind in space, seen from the patch, and the tick of its middle in time.
    middles: Vec<(Ground, i32)>,
}

/// The scene's wishes, and larger patches are likelier; those of several people that are not fit to be cast are never
/// wanted.
pub(super) fn preference<'a>(library: &'a Library) -> Preference<'a> {
    let scene = &library.preference;
    let weight = |(k, kind): (usize, &PatchKind)| {
        let fit = kind.people() == 1 || library.multi.contains(&(k as u32));
        if fit { size(kind) * scene.weight_of_kind(k as u32) } else { 0.0 }
    };
    let weights: Vec<f32> = library.set.kinds.iter().enumerate().map(weight).collect();
    let mut sum = 0.0;
    let cumulative = weights.iter().map(|w| {
        sum += w;
        sum
    });
    let middles = library.set.kinds.iter().map(middle).collect();
    Preference { scene, cumulative: cumulative.collect(), weights, middles }
}

fn size(kind: &PatchKind) -> f32 {
    let points = || kind.fragments.iter().flat_map(|f| &f.motion.path.points);
    let low = points().fold(Vec2::INFINITY, |a, &p| a.min(p));
    let high = points().fold(Vec2::NEG_INFINITY, |a, &p| a.max(p));
    kind.people() as f32 * (1.0 + (high - low).element_product()) * frames(kind) as f32 / FPS
}

fn frames(kind: &PatchKind) -> usize {
    kind.fragments.iter().map(|f| f.begin as usize + f.motion.len() - 1).max().unwrap_or(0)
}

/// The mean of everybody's way, the heading of the first person half-way, and the tick half-way.
fn middle(kind: &PatchKind) -> (Ground, i32) {
    let points = || kind.fragments.iter().flat_map(|f| &f.motion.path.points);
    let mean = points().copied().sum::<Vec2>() / points().count().max(1) as f32;
    let first = kind.fragments.first().map(|f| &f.motion.path);
    let heading = first.and_then(|p| p.headings.get(p.headings.len() / 2)).copied().unwrap_or(0.0);
    (Ground::new(mean, heading), frames(kind) as i32 / 2)
}

impl Preference<'_> {
    /// A placement drawn with probability in proportion to F; `anywhere` draws place, direction and time of a kind.
    pub fn draw(&self, rng: &mut ChaCha8Rng, mut anywhere: impl FnMut(u32, &mut ChaCha8Rng) -> Placement) -> Placement {
        let at = rng.random_range(0.0..*self.cumulative.last().expect("at least one kind"));
        let kind = self.cumulative.partition_point(|&c| c <= at).min(self.weights.len() - 1) as u32;
        let mut drawn = anywhere(kind, rng);
        // F of place, direction and time is at most 1.
        for _ in 1..DRAWS {
            if self.scene.is_indifferent() || rng.random_range(0.0..1.0) < self.weight_of_place(&drawn) {
                break;
            }
            drawn = anywhere(kind, rng);
        }
        drawn
    }

    fn weight_of_place(&self, placement: &Placement) -> f32 {
        let (middle, half) = self.middles[placement.kind as usize];
        let stay = Stay::new(placement.world_from_patch.then(middle), placement.clock + half);
        self.scene.weight_of_stay(placement.kind, stay)
    }

    /// True if the kind is wanted at all.
    pub fn wants(&self, kind: u32) -> bool {
        self.weights[kind as usize] > 0.0
    }

    /// A number by which candidates are sorted, small first: the order is that of drawing them one by one by F.
    pub fn rank(&self, placement: &Placement, rng: &mut ChaCha8Rng) -> f32 {
        let weight = self.weights[placement.kind as usize] * self.weight_of_place(placement);
        -rng.random_range(f32::MIN_POSITIVE..1.0).ln() / weight.max(f32::MIN_POSITIVE)
    }
}
