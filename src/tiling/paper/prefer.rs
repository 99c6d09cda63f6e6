//! Equation 7: which patches are wanted.
//!
//! F = exp(-f_1(x, y)/s_1) exp(-f_2(theta)/s_2) exp(-f_3(t)/s_3) exp(-f_4(l)/s_4). As in the paper's examples (section
//! 7) place, direction and time are left to chance, f_1 = f_2 = f_3 = 0, and larger patches (more people, larger
//! extent, longer) are likelier: f_4 = -ln(people x (1 m2 + extent) x seconds), s_4 = 1.

use glam::Vec2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::super::library::Library;
use crate::motion::FPS;
use crate::patch::PatchKind;

/// The preference for each kind.
pub(super) struct Preference {
    weights: Vec<f32>,
    cumulative: Vec<f32>,
}

/// Larger patches are likelier; those of several people that are not fit to be cast are never wanted.
pub(super) fn by_size(library: &Library) -> Preference {
    let weight = |(k, kind): (usize, &PatchKind)| {
        let fit = kind.people() == 1 || library.multi.contains(&(k as u32));
        if fit { size(kind) } else { 0.0 }
    };
    let weights: Vec<f32> = library.set.kinds.iter().enumerate().map(weight).collect();
    let mut sum = 0.0;
    let cumulative = weights.iter().map(|w| {
        sum += w;
        sum
    });
    Preference { cumulative: cumulative.collect(), weights }
}

fn size(kind: &PatchKind) -> f32 {
    let points = || kind.fragments.iter().flat_map(|f| &f.motion.path.points);
    let low = points().fold(Vec2::INFINITY, |a, &p| a.min(p));
    let high = points().fold(Vec2::NEG_INFINITY, |a, &p| a.max(p));
    let frames = kind.fragments.iter().map(|f| f.begin as usize + f.motion.len() - 1).max().unwrap_or(0);
    kind.people() as f32 * (1.0 + (high - low).element_product()) * frames as f32 / FPS
}

impl Preference {
    /// A kind drawn with probability in proportion to F.
    pub fn draw(&self, rng: &mut ChaCha8Rng) -> u32 {
        let at = rng.random_range(0.0..*self.cumulative.last().expect("at least one kind"));
        self.cumulative.partition_point(|&c| c <= at).min(self.weights.len() - 1) as u32
    }

    /// True if the kind is wanted at all.
    pub fn wants(&self, kind: u32) -> bool {
        self.weights[kind as usize] > 0.0
    }

    /// A number by which candidates are sorted, small first: the order is that of drawing them one by one by F.
    pub fn rank(&self, kind: u32, rng: &mut ChaCha8Rng) -> f32 {
        -rng.random_range(f32::MIN_POSITIVE..1.0).ln() / self.weights[kind as usize]
    }
}
