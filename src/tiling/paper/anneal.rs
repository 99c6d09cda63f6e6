//! Algorithm 1: stochastic sampling by simulated annealing (section 5.1). Line numbers are the paper's.

use glam::Vec2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::super::clock::Clock;
use super::super::outcome::Phase;
use super::patchwork::{Patchwork, Placement, Proposal};
use super::ports::Reach;
use super::prefer::Preference;
use crate::geom::Ground;

/// Balances density against danglings in equation 6.
const ALPHA: f32 = 0.2;
/// Boltzmann's constant of line 7.
const K: f32 = 0.03;
/// First temperature.
const T_MAX: f32 = 200.0;
/// Cooling per sample.
const DELTA_T: f32 = 1.0;
/// Once cooled down the temperature stays here: only samples that do not raise the energy are accepted.
const T_MIN: f32 = 1e-6;
/// Failures in a row after which sampling ends: i_max, which the paper does not state.
const I_MAX: usize = 20_000;
/// Sampling also ends once the patches hold this share of the wished people's time. The paper controls density by when
/// sampling ends but does not say how; as Algorithm 2 leads nearly every sampled person to both ends of time, this
/// much ends in about as many people as are wished for.
const FILL: f32 = 0.1;
/// Samples between two looks at the clock.
const CLOCK_EVERY: usize = 64;

/// Equation 6: the tiling energy of `connected` and `dangling` ports.
pub(in crate::tiling) fn energy(connected: usize, dangling: usize) -> f32 {
    let all = (connected + dangling).max(1) as f32;
    dangling as f32 / all + ALPHA / all
}

/// Algorithm 1.
pub(super) fn anneal(
    tiling: &mut Patchwork,
    people: usize,
    preference: &Preference,
    clock: &mut Clock,
    rng: &mut ChaCha8Rng,
) {
    let wish = (FILL * people as f32 * tiling.domain.horizon as f32) as usize;
    let mut proposal = Proposal::default();
    let mut temperature = T_MAX; // 1
    let mut i = 0; // 2
    let mut samples = 0_usize;
    while i < I_MAX && tiling.filled() < wish {
        // 3
        if samples.is_multiple_of(CLOCK_EVERY) && !clock.goes_on(|| tiling.state(Phase::Seed)) {
            return;
        }
        samples += 1;
        let new = random_placement(tiling, preference, rng); // 4
        tiling.propose(new, &Reach::FIRST, &mut proposal); // 5
        let change = energy_change(tiling, &proposal); // 6
        if (-change / (K * temperature)).exp() > rng.random_range(0.0..1.0) // 7
            && tiling.try_insert(&proposal)
        // 8, 9
        {
            i = 0; // 10
        }
        temperature = (temperature - DELTA_T).max(T_MIN); // 13
        i += 1; // 14
    }
}

fn energy_change(tiling: &Patchwork, proposal: &Proposal) -> f32 {
    let (connected, dangling) = proposal.change();
    let then = (tiling.connected() + connected, (tiling.dangling() as isize + dangling) as usize);
    energy(then.0, then.1) - energy(tiling.connected(), tiling.dangling())
}

/// A kind drawn by preference, anywhere in the region and at any time at which it is seen.
fn random_placement(tiling: &Patchwork, preference: &Preference, rng: &mut ChaCha8Rng) -> Placement {
    let (domain, library) = (tiling.domain, tiling.library);
    preference.draw(rng, |kind, rng| {
        let roles = library.roles_of(kind).map(|r| &library.roles[r as usize]);
        let last = roles.map(|r| r.begin + r.ticks).max().expect("a kind has people");
        let (x, z) = (domain.min.x..domain.max.x, domain.min.y..domain.max.y);
        let place = Vec2::new(rng.random_range(x), rng.random_range(z));
        let heading = rng.random_range(-std::f32::consts::PI..std::f32::consts::PI);
        let clock = rng.random_range(1 - last..domain.horizon);
        Placement { kind, world_from_patch: Ground::new(place, heading), clock }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energy_falls_with_density_and_with_every_stitch() {
        assert!((energy(0, 10) - (1.0 + 0.02)).abs() < 1e-6);
        assert!(energy(0, 20) < energy(0, 10));
        assert!(energy(12, 8) < energy(10, 10));
        assert!((energy(100, 0) - 0.002).abs() < 1e-6);
    }
}
