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
    passages.work_out_all();
    let edges = Edges::new(&passages, &library, &one, wang, (seed, 60.0)).unwrap();
    let shop = Workshop { scene: &one, library: &library, passages: &passages, edges: &edges, side: wang.tile, seed };
    ask(&shop, Plane::new(scene, wang, seed))
}

/// The final bodies of those who cross an edge and of those who live on it.
fn people_of(shop: &Workshop, across: Across, colour: u32, by: Vec2) -> Vec<Body> {
    let domain = Domain::new(shop.scene).unwrap();
    let edge = shop.edges.of(across, colour);
    let lives = edge.crossings.iter().map(|c| &c.pieces).chain(&edge.dwellers);
    let moved = |p: &Piece| p.clone().shifted(Shift { place: by, ticks: 0 });
    let pieces: Vec<Vec<Piece>> = lives.map(|life| life.iter().map(moved).collect()).collect();
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
fn nobody_at_an_edge_runs_into_anybody_at_another() {
    with(&scene(2.0, 2.0), 3, |shop, _| {
        // The sides of a tile, and the edges that meet in its lower corner.
        let sides = (0..SIDES).map(|side| (of_side(side).0, edge_of(side, SIDE)));
        let corner = [(Across::X, Vec2::new(0.0, -SIDE)), (Across::Z, Vec2::new(-SIDE, 0.0))];
        let edges: Vec<_> = sides.chain(corner).collect();
        let bodies: Vec<[Vec<Body>; 2]> =
            edges.iter().map(|&(across, by)| [0, 1].map(|colour| people_of(shop, across, colour, by))).collect();
        let mut pairs = 0;
        for (i, own) in bodies.iter().enumerate() {
            for colour in own {
                assert!(colour.len() >= 4);
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
        let people = Layout { plane, tiles: &tiles, edges: shop.edges, side: SIDE }.people();
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
        // Who lives on an upper border is counted in this tile, and put in with the plane.
        let dwellers: Vec<&Vec<Piece>> = shop.edges(key, &UPPER_SIDES).flat_map(|(edge, _)| &edge.dwellers).collect();
        assert!(!dwellers.is_empty());
        assert_eq!(tile.stays.len(), shop.scene.characters + go - dwellers.len());
        let all_the_time = |d: &&Vec<Piece>| d[0].begin <= 0 && d[d.len() - 1].end >= domain.horizon;
        assert!(dwellers.iter().all(all_the_time));
    });
}

#[test]
fn borders_are_as_full_and_as_sociable_as_the_inside() {
    let scene = Scene { interaction: 0.2, ..scene(4.0, 4.0) };
    with(&scene, 11, |shop, plane| {
        let tiles = build(shop, plane, &Options::default(), &mut |_| true).unwrap();
        let people = Layout { plane, tiles: &tiles, edges: shop.edges, side: SIDE }.people();
        // Ticks near inner borders, far from them and at the rim, and how many of them in patches of several people.
        let mut ticks = [[0.0f32; 2]; 3];
        for (piece, body) in people.iter().flatten().flat_map(|p| p.bodies.iter().map(move |b| (p, b))) {
            let place = is_near_a_border(&scene, body.position).map_or(2, |near| usize::from(!near));
            ticks[place][0] += 1.0;
            ticks[place][1] += f32::from(u8::from(shop.library.people_of(piece.role) > 1));
        }
        let [near, far, rim] = ticks;
        let cell = |n: usize| (Vec2::new((n % 360) as f32, (n / 360) as f32) + 0.5) * 0.1 - Vec2::X * SIDE;
        let count =
            |wanted: bool| (0..360 * 360).filter(|&n| is_near_a_border(&scene, cell(n)) == Some(wanted)).count();
        let density = near[0] / count(true) as f32 / (far[0] / count(false) as f32);
        let company = near[1] / near[0] / (far[1] / far[0]);
        let share = (near[1] + far[1] + rim[1]) / (near[0] + far[0] + rim[0]);
        println!("beside the inside: {density:.2} as dense, {company:.2} as sociable; {share:.3} together");
        assert!((0.75..1.35).contains(&density) && (0.7..1.4).contains(&company) && share >= scene.interaction);
    });
}

/// Whether a place is within a metre of an inner border; nothing at the rim, which is a wall.
fn is_near_a_border(scene: &Scene, place: Vec2) -> Option<bool> {
    if -scene.region.signed_distance(place) < 1.0 {
        return None;
    }
    let away = (place - (place / SIDE).round() * SIDE).abs();
    Some(away.min_element() < 1.0)
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
