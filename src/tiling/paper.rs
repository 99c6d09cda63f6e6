//! Algorithms 1 and 2 of "Tiling Motion Patches".

use super::Scene;
use super::domain::Domain;
use super::outcome::{Options, Outcome, Progress};
use crate::patch::PatchSet;

/// Equation 6: the tiling energy of `connected` and `dangling` ports, alpha = 0.2.
pub(super) fn energy(connected: usize, dangling: usize) -> f32 {
    const ALPHA: f32 = 0.2;
    let all = (connected + dangling).max(1) as f32;
    dangling as f32 / all + ALPHA / all
}

pub(super) fn tile(_: &Scene, _: &PatchSet, _: &Domain, _: &Options, _: &mut dyn FnMut(&Progress) -> bool) -> Outcome {
    todo!()
}
