//! World-file bytes of any content: an error or a world that can be played, checked and written, never a panic.
#![no_main]

use crowdquilt::check::world::check_world;
use crowdquilt::stage::World;
use crowdquilt::stage::world::Roots;
use crowdquilt_fuzz as _;
use glam::DVec2;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(world) = World::from_bytes(bytes) else { return };
    let mut roots = Roots::default();
    for time in [-1.0, 0.0, 3.7, 1e9] {
        let moment = world.moment(time);
        world.roots(&moment, DVec2::ZERO, &mut roots);
        assert_eq!(roots.len(), world.walkers(&moment));
        let people = (0..world.instances()).map(|i| world.people_of(i, [0, 0], &moment).count()).sum::<usize>();
        assert_eq!(roots.len(), people);
    }
    if world.instances() < 20 {
        let _ = check_world(&world);
    }
    assert!(World::from_bytes(&world.to_bytes()).is_ok_and(|again| again.tables() == world.tables()));
});
