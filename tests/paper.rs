//! The published baseline on a plain patch set.

mod common;

use crowdquilt::tiling::{Method, Options, Phase, Scene, Status, tile};

fn options(seed: u64) -> Options {
    Options { method: Method::Paper, seed, time_secs: 60.0 }
}

#[test]
fn measure() {
    let set = common::plain_set();
    for seed in 1..4 {
        let mut phase = Phase::Mend;
        let outcome = tile(&Scene::demo(), &set, &options(seed), &mut |p| {
            if p.phase != phase || p.secs < 0.5 || (p.secs * 20.0) as i64 % 10 == 0 {
                phase = p.phase;
                eprintln!(
                    "{:?} {} patches {} characters {} danglings share {:.3} energy {:.4} {:.2}s",
                    p.phase, p.patches, p.characters, p.danglings, p.multi_person_share, p.energy, p.secs
                );
            }
            true
        })
        .unwrap();
        eprintln!(
            "seed {seed}: {:?} {} characters {} instances {} danglings {} interpenetrations in {:.2} s",
            outcome.status,
            outcome.crowd.characters.len(),
            outcome.crowd.instances.len(),
            outcome.danglings,
            outcome.interpenetrations,
            outcome.solve_secs
        );
        assert!(!matches!(outcome.status, Status::Imperfect(_)));
    }
}
