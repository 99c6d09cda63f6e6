//! The tiling's books are right after any sequence of insertions and removals.

use rand::{RngExt, SeedableRng};

use super::super::super::common::plain_set;
use super::super::prefer;
use super::*;
use crate::tiling::Scene;
use rand_chacha::ChaCha8Rng;

/// Everything the tiling keeps on the side, counted anew.
fn audit(tiling: &Patchwork) {
    let pieces: Vec<PieceId> = tiling.instances.iter().flatten().flat_map(|i| i.pieces.clone()).collect();
    let (mut connected, mut dangling) = (0, Vec::new());
    for id in pieces.iter().flat_map(|&p| [2 * p + ENTRY, 2 * p + EXIT]) {
        let port = tiling.port(id);
        match tiling.partners[id as usize] {
            NONE if tiling.is_active(port.tick) => dangling.push(id),
            NONE => {}
            partner => {
                connected += 1;
                assert_eq!(tiling.partners[partner as usize], id);
                assert_ne!(partner % 2, id % 2);
                let theirs = tiling.port(partner);
                assert!(same(port.at, theirs.at), "{port:?} {theirs:?}");
                assert_eq!((port.tick, port.group), (theirs.tick, theirs.group));
            }
        }
    }
    dangling.sort_unstable();
    let mut table = tiling.danglings();
    table.sort_unstable();
    assert_eq!(table, dangling);
    assert!(table.iter().all(|&d| tiling.dangles(d)));
    assert_eq!(tiling.connected(), connected);
    assert_eq!(tiling.filled, pieces.iter().map(|&p| tiling.occupancy.piece(p).ticks_inside()).sum::<usize>());
    let deepest = |a: PieceId, b: PieceId| {
        let (a, b) = (tiling.occupancy.piece(a), tiling.occupancy.piece(b));
        a.instance == b.instance
            || (a.begin.max(b.begin)..a.end.min(b.end)).all(|t| depth(tiling.library, a, b, t).is_none())
    };
    assert!(pieces.iter().all(|&a| pieces.iter().all(|&b| a == b || deepest(a, b))));
}

#[test]
fn books_are_right_after_insertions_and_removals() {
    let (set, scene) = (plain_set(), Scene::demo());
    let domain = Domain::new(&scene).unwrap();
    let library = Library::new(&set, scene.limits);
    let mut tiling = Patchwork::new(&library, &domain);
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut clock_progress = |_: &Progress| true;
    let mut clock = crate::tiling::clock::Clock::new(1000.0, &mut clock_progress);
    super::super::anneal::anneal(&mut tiling, 150, &prefer::preference(&library), &mut clock, &mut rng);
    audit(&tiling);
    let mut proposal = Proposal::default();
    let (mut stitched, mut stitched_twice) = (0, 0);
    for round in 0..3000 {
        let danglings = tiling.danglings();
        let d = danglings[rng.random_range(0..danglings.len())];
        let port = tiling.port(d);
        let fits: Vec<&crate::tiling::library::Role> = library
            .roles
            .iter()
            .filter(|r| if d % 2 == EXIT { r.entry_group == port.group } else { r.exit_group == port.group })
            .collect();
        let role = fits[rng.random_range(0..fits.len())];
        let near = Ground::new(
            port.at.position + glam::Vec2::new(rng.random_range(-0.2..0.2), rng.random_range(-0.2..0.2)),
            port.at.heading + rng.random_range(-0.2..0.2),
        );
        let entry = if d % 2 == EXIT { near } else { near.then(role.exit.inverse()) };
        let begin = if d % 2 == EXIT { port.tick } else { port.tick - role.ticks };
        let placement = Placement {
            kind: role.kind,
            world_from_patch: entry.then(role.entry.inverse()),
            clock: begin - role.begin + rng.random_range(-2..=2),
        };
        let before = (tiling.dangling() as isize, tiling.connected());
        tiling.propose(placement, &Reach::FIRST, &mut proposal);
        let change = proposal.change();
        let inserted = tiling.try_insert(&proposal);
        let expected = if inserted { (before.0 + change.1, before.1 + change.0) } else { before };
        assert_eq!((tiling.dangling() as isize, tiling.connected()), expected);
        if inserted {
            stitched += usize::from(!proposal.stitches.is_empty());
            stitched_twice += usize::from(proposal.stitches.len() > 1);
        }
        if round % 7 == 0 {
            tiling.remove(rng.random_range(0..tiling.instances.len() as u32));
        }
        if round % 500 == 0 {
            audit(&tiling);
        }
    }
    audit(&tiling);
    assert!(stitched > 100 && stitched_twice > 0, "{stitched} {stitched_twice}");
    for instance in 0..tiling.instances.len() as u32 {
        tiling.remove(instance);
    }
    audit(&tiling);
    assert_eq!((tiling.dangling(), tiling.connected(), tiling.filled), (0, 0, 0));
}
