use super::tile::{UPPER_SIDES, edge_of, of_side};
use super::*;
use crate::motion::canonical;
use crate::refine::{Body, refine_all};
use crate::tiling::bake::uses;
use crate::tiling::common::plain_set;
use crate::tiling::figure::Figure;
use crate::tiling::piece::{Piece, Shift};
use crate::tiling::rehearsal::segments;
use crate::tiling::wang::plane::{Across, SIDES};

const SIDE: f32 = 9.0;

fn scene(columns: f32, rows: f32) -> Scene {
    let region = Polygon::rectangle(Vec2::new(-SIDE, 0.0), Vec2::new((columns - 1.0) * SIDE, rows * SIDE));
    let wang = Wang { tile: SIDE, colours: 2, variants: 1 };
    Scene { wang: Some(wang), ..Scene::new(region, 10.0, (24.0 * columns * rows) as usize) }
}

/// What a scene's tiles are made from.
fn with<T>(scene: &Scene, seed: u64, ask: impl FnOnce(&Workshop, Plane) -> T) -> T {
    let (set, wang) = (plain_set(), scene.wang.unwrap());
    let library = Library::new(&set, scene.limits);
    let (passages, one) = (Passages::new(&library), one_tile(scene, wang));
    let ribbons = ribbons(&library, &one, wang, seed).unwrap();
    let shop =
        Workshop { scene: &one, library: &library, passages: &passages, ribbons: &ribbons, side: wang.tile, seed };
    ask(&shop, Plane::new(scene, wang, seed))
}

/// The final bodies of those who cross an edge.
fn crossers(shop: &Workshop, across: Across, colour: u32, by: Vec2) -> Vec<Body> {
    let domain = Domain::new(shop.scene).unwrap();
    let moved = |p: &Piece| p.clone().shifted(Shift { place: by, ticks: 0 });
    let ribbons = shop.ribbons.of(across, colour);
    let pieces: Vec<Vec<Piece>> = ribbons.map(|c| c.pieces.iter().map(moved).collect()).collect();
    let chains: Vec<_> = pieces.iter().map(|p| uses(shop.library, &domain, p.iter())).collect();
    let people: Vec<_> = chains.iter().map(|c| segments(c)).collect();
    refine_all(&people, domain.last_frame(), domain.torus).bodies
}

fn deepest(a: &Body, b: &Body, horizon: i32) -> f32 {
    let at = |body: &Body, tick: i32| Figure::of(body, canonical(), tick);
    let depth = |tick: i32| Some(at(a, tick)?.depth_into(&at(b, tick)?));
    (0..horizon).filter_map(depth).fold(0.0, f32::max)
}

#[test]
fn nobody_who_crosses_an_edge_meets_anybody_who_crosses_another() {
    with(&scene(2.0, 2.0), 3, |shop, _| {
        // The sides of a tile, and the edges that meet in its lower corner.
        let sides = (0..SIDES).map(|side| (of_side(side).0, edge_of(side, SIDE)));
        let corner = [(Across::X, Vec2::new(0.0, -SIDE)), (Across::Z, Vec2::new(-SIDE, 0.0))];
        let edges: Vec<_> = sides.chain(corner).collect();
        let bodies: Vec<[Vec<Body>; 2]> =
            edges.iter().map(|&(across, by)| [0, 1].map(|colour| crossers(shop, across, colour, by))).collect();
        let mut pairs = 0;
        for (i, own) in bodies.iter().enumerate() {
            for colour in own {
                assert!(colour.len() >= 2);
                // Those of one edge and colour, and any of other edges.
                let others = bodies[..i].iter().flatten().flatten();
                for (n, a) in colour.iter().enumerate() {
                    for b in colour[..n].iter().chain(others.clone()) {
                        assert_eq!(deepest(a, b, 301), 0.0, "edge {i}");
                        pairs += 1;
                    }
                }
            }
        }
        println!("{pairs} pairs");
    });
}

#[test]
fn who_leaves_a_tile_enters_the_next_at_the_same_place_and_tick() {
    let scene = scene(3.0, 3.0);
    with(&scene, 5, |shop, plane| {
        let tiles = build(shop, plane, &Options::default(), &mut |_| true).unwrap();
        let (horizon, library) = (Domain::new(&scene).unwrap().horizon, shop.library);
        let people = Layout { plane, tiles: &tiles, ribbons: shop.ribbons, side: SIDE }.people();
        assert_eq!(people.len(), scene.characters);
        let (mut roles, mut crossed) = (std::collections::BTreeSet::new(), 0);
        for pieces in &people {
            assert!(pieces[0].begin <= 0 && pieces[pieces.len() - 1].end >= horizon);
            for joint in pieces.windows(2) {
                let (exit, entry) = (library.exit_of(&joint[0]), library.entry_of(&joint[1]));
                assert_eq!((exit.tick, exit.group), (entry.tick, entry.group));
                assert!(exit.at.position.distance(entry.at.position) < 1e-3);
            }
            assert!(pieces.iter().all(|p| roles.insert((p.instance, p.role))), "a role is one person's");
            let tile = |p: &Piece| (p.entry().position / SIDE).floor();
            crossed += usize::from(pieces.iter().any(|p| tile(p) != tile(&pieces[0])));
        }
        let crossings: usize = tiles.len() * 4 - 12;
        println!("{crossed} of {} people cross {} sides", people.len(), crossings);
        assert!(crossed >= crossings);
    });
}

#[test]
fn everybody_but_those_who_cross_stays_in_the_tile() {
    with(&scene(3.0, 3.0), 7, |shop, plane| {
        let key = plane.key([0, 1]);
        assert!(key.sides.iter().all(Option::is_some));
        let tile = shop.build(key, 60.0).unwrap();
        let domain = Domain::new(shop.scene).unwrap();
        let is_in = |p: &Vec2| domain.exact_clearance(*p) > 0.1;
        let own = tile.stays.iter().flat_map(|s| &s.pieces);
        // What is before the first tick and after the last is not seen.
        let seen = own.clone().filter(|p| p.begin >= 0 && p.end <= domain.horizon);
        assert!(seen.clone().count() > 50 && seen.into_iter().all(|p| p.path.points.iter().all(is_in)));
        let come = tile.stays.iter().filter(|s| s.from.is_some()).count();
        let go = tile.stays.iter().filter(|s| s.to.is_some()).count();
        assert!(come > 0 && come == go);
        // Who stands on an upper border is counted in this tile, and belongs to two.
        let dwellers = shop.dwellers(key, &UPPER_SIDES);
        assert!(!dwellers.is_empty());
        assert_eq!(tile.stays.len(), shop.scene.characters + go - dwellers.len());
        let all_the_time = |d: &Vec<Piece>| d[0].begin <= 0 && d[d.len() - 1].end >= domain.horizon;
        assert!(dwellers.iter().all(all_the_time));
    });
}

#[test]
fn all_that_tiles_cannot_have_is_named_at_once() {
    let mut scene = scene(2.0, 2.0);
    assert_eq!(problems(&scene), []);
    scene.obstacles.push(Polygon::rectangle(Vec2::ONE, Vec2::splat(2.0)).into());
    scene.periodic.t = true;
    scene.region = Polygon::rectangle(Vec2::ZERO, Vec2::new(18.0, 19.0));
    let found: Vec<&str> = problems(&scene).into_iter().map(|p| p.0).collect();
    assert_eq!(found, ["obstacle", "periodic", "region"]);
    let told = possible(&scene).unwrap_err().to_string();
    assert!(told.contains("whole tiles of 9 m") && told.contains("[18, 19]"), "{told}");
    scene.wang = None;
    assert_eq!(problems(&scene), []);
}
