//! The engine on a plain patch set.

mod common;

use crowdquilt::tiling::{Options, Scene, Status, tile};

#[test]
fn demo_scene_is_tiled_perfectly() {
    let set = common::plain_set();
    assert!(set.validate().is_empty(), "{:?}", set.validate());
    for seed in 1..4 {
        let options = Options { seed, time_secs: 60.0, ..Options::default() };
        let outcome = tile(&Scene::demo(), &set, &options, &mut |p| {
            eprintln!("{:?} {} {} {:.3} {:.2}s", p.phase, p.patches, p.characters, p.multi_person_share, p.secs);
            true
        })
        .unwrap();
        eprintln!(
            "seed {seed}: {:?} {} characters {} instances in {:.2} s",
            outcome.status,
            outcome.crowd.characters.len(),
            outcome.crowd.instances.len(),
            outcome.solve_secs
        );
        assert_eq!(outcome.status, Status::Perfect);
    }
}
