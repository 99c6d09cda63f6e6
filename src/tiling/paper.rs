//! The published baseline: Algorithms 1 and 2 of "Tiling Motion Patches" (Hyun, Kim, Hwang, Lee 2013), section 5.
//!
//! `anneal` is Algorithm 1 and equation 6, `search` Algorithm 2, `prefer` equation 7. What the two algorithms call
//! "add, stitch, deform, IsValid, NoCollision" is in `patchwork`, the table of danglings in `ports`, deformation of
//! one role in `shape`.
//!
//! Departures, none of which changes what is searched: adjacent patches deform by closed-form strands in place of one
//! joint linear system (the stitched port is the midpoint of the two, which is where the joint system of two equal
//! strings would put it); a patch of several people keeps its interaction rigid and bends its legs only; it also keeps
//! its time, while patches of one person are rescaled to whole ticks. Where final bodies are at fault after all
//! (they interpenetrate, or move faster than captured), a patch is removed and Algorithm 2 runs again.

mod anneal;
mod patchwork;
mod ports;
mod prefer;
mod search;
mod shape;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use self::patchwork::Patchwork;
use super::Scene;
use super::bake::{Chains, bake};
use super::clock::Clock;
use super::domain::Domain;
use super::engine::wishes;
use super::library::Library;
use super::outcome::{Options, Outcome, Phase, Progress, Status};
use super::rehearsal::Rehearsal;
use crate::patch::PatchSet;

pub(super) use anneal::energy;

/// Rounds of removing patches whose final bodies are at fault.
const MEND_ROUNDS: usize = 30;

/// Tiles as published. O(samples + danglings x candidates x jitters), each with a few frames' work.
pub(super) fn tile(
    scene: &Scene,
    set: &PatchSet,
    domain: &Domain,
    options: &Options,
    progress: &mut dyn FnMut(&Progress) -> bool,
) -> Outcome {
    let mut clock = Clock::new(options.time_secs, progress);
    let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
    let library = Library::new(set, scene.limits).preferring(&scene.preference);
    let mut tiling = Patchwork::new(&library, domain);
    let preference = prefer::preference(&library);

    anneal::anneal(&mut tiling, scene.characters, &preference, &mut clock, &mut rng);
    let mut search = search::Search::new(preference);
    search.close(&mut tiling, &mut clock, &mut rng);
    let (lists, rehearsal) = mend(&mut tiling, &mut search, &mut clock, &mut rng);

    let danglings = tiling.dangling();
    let (chains, left) = (tiling.chains(&lists), rehearsal.faults.len());
    let status = status(danglings, left, chains, scene);
    let crowd = bake(chains, scene, options.seed, rehearsal);
    Outcome { crowd, status, danglings, interpenetrations: left, solve_secs: clock.secs(), unkept: None }
}

/// Tests the final bodies; where there is a fault, removes a patch and closes the gap anew.
fn mend(
    tiling: &mut Patchwork,
    search: &mut search::Search,
    clock: &mut Clock,
    rng: &mut ChaCha8Rng,
) -> (Vec<Vec<u32>>, Rehearsal) {
    let mut round = 0;
    loop {
        let lists = tiling.characters();
        let chains = tiling.chains(&lists);
        let rehearsal = Rehearsal::of(chains);
        round += 1;
        if rehearsal.faults.is_empty() || round > MEND_ROUNDS || !clock.goes_on(|| tiling.state(Phase::Mend)) {
            return (lists, rehearsal);
        }
        let faults = rehearsal.faults.iter();
        let mut culprits: Vec<u32> = faults.map(|f| chains.smaller_instance(f.a, f.b, f.tick)).collect();
        culprits.sort_unstable();
        culprits.dedup();
        culprits.into_iter().for_each(|instance| search.discard(tiling, instance));
        search.close(tiling, clock, rng);
    }
}

fn status(danglings: usize, faults: usize, chains: Chains, scene: &Scene) -> Status {
    match (danglings, faults) {
        (0, 0) => wishes(chains, scene),
        (0, _) => Status::Imperfect(format!("{faults} faults of the final bodies are left")),
        (_, 0) => Status::Imperfect(format!("{danglings} entries and exits are left dangling")),
        _ => Status::Imperfect(format!("{danglings} danglings and {faults} faults of the final bodies are left")),
    }
}
