//! Bridging against brute force: on a small place with few patches every chain of rigidly placed patches can be
//! listed, with disc tests that share no code with the planner's grid.

use glam::Vec2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::Scene;
use super::bridge::{Bridge, Goal, NO_INSTANCE, Port, Taste};
use super::common::plain_set;
use super::domain::Domain;
use super::library::Library;
use super::occupancy::Occupancy;
use super::piece::{Company, Piece};
use super::view::View;
use crate::geom::{Ground, Polygon, wrap_angle};
use crate::patch::PatchSet;

const KINDS: [&str; 9] =
    ["half-1-1", "half-1-2", "cycle-1", "turn-1", "turn1", "start-left", "stop-left", "idle-20", "meeting-0"];
/// Longest chains listed.
const DEPTH: usize = 4;
/// The planner joins no patches closer to a wall than this, metres.
const JOINT_ROOM: f32 = 0.3;
/// Searches per question.
const CHANCES: usize = 12;

fn small_set() -> PatchSet {
    let mut set = plain_set();
    set.kinds.retain(|k| KINDS.contains(&k.name.as_str()));
    assert_eq!(set.kinds.len(), KINDS.len());
    set
}

fn small_scene() -> Scene {
    Scene {
        region: Polygon::rectangle(Vec2::ZERO, Vec2::new(5.0, 4.0)),
        obstacles: vec![Polygon::rectangle(Vec2::new(2.2, 1.6), Vec2::new(2.8, 2.4)).into()],
        duration_secs: 4.0,
        ..Scene::demo()
    }
}

/// Everything a case is made of.
struct Case<'a> {
    library: &'a Library<'a>,
    domain: &'a Domain,
    others: Vec<Piece>,
    occupancy: Occupancy,
    from: Port,
}

/// The discs of a piece at a tick: centre and radius.
fn discs(library: &Library, piece: &Piece, tick: i32) -> Vec<(Vec2, f32)> {
    if tick < piece.begin || tick >= piece.end {
        return vec![];
    }
    let last = piece.path.len() - 1;
    let at = (tick - piece.begin) as f32 * last as f32 / (piece.end - piece.begin) as f32;
    let i = (at.floor() as usize).min(last - 1);
    let t = at - i as f32;
    let (a, b) = (piece.path.at(i), piece.path.at(i + 1));
    let now = Ground::new(a.position.lerp(b.position, t), a.heading * (1.0 - t) + b.heading * t);
    let footprint = &library.roles[piece.role as usize].footprints[(at + 0.5) as usize];
    footprint.iter().map(|d| (now.apply(Vec2::new(d.x, d.y)), d.z)).collect()
}

impl Case<'_> {
    /// By how much a piece keeps away from walls and others at the worst; negative if it hits one.
    fn room(&self, piece: &Piece) -> f32 {
        let mut least = f32::INFINITY;
        for tick in piece.begin.max(0)..piece.end.min(self.domain.horizon) {
            for (center, radius) in discs(self.library, piece, tick) {
                least = least.min(self.domain.exact_clearance(center) - radius);
                for other in &self.others {
                    for (c, r) in discs(self.library, other, tick) {
                        least = least.min(center.distance(c) - radius - r);
                    }
                }
            }
        }
        least
    }

    /// All ports that free chains of up to DEPTH rigidly placed single-person patches lead to, with the least room
    /// that any of the chain's patches has.
    fn reachable(&self) -> Vec<(Port, f32)> {
        let mut found = vec![(self.from, f32::INFINITY)];
        let mut level = found.clone();
        for _ in 0..DEPTH {
            let mut next = Vec::new();
            for (port, room) in level {
                for (r, role) in self.library.roles.iter().enumerate() {
                    let single = self.library.set.kinds[role.kind as usize].people() == 1;
                    if !single || role.entry_group != port.group || port.tick >= self.domain.horizon {
                        continue;
                    }
                    let piece = Piece::rigid(self.library, self.domain, r as u32, NO_INSTANCE, port.at, port.tick);
                    let room = room.min(self.room(&piece));
                    let at = piece.exit();
                    let near_wall = self.domain.exact_clearance(at.position) < JOINT_ROOM;
                    if room >= 0.0 && (!near_wall || piece.end > self.domain.horizon) {
                        next.push((Port { at, tick: piece.end, group: role.exit_group }, room));
                    }
                }
            }
            found.extend(&next);
            level = next;
        }
        found
    }

    /// A bridge and the number of searches it took. Of states that hardly differ the search keeps one, and which one
    /// is chance: it may be the one that leads nowhere, so the search is given a few chances.
    fn search(&self, goal: Goal, rng: &mut ChaCha8Rng) -> (Option<Vec<Piece>>, usize) {
        let view = View::new(self.library, self.domain, &self.occupancy);
        let taste = Taste { calm: 1.0, compact: 0.0, expansions: 20_000 };
        let mut tries = 0;
        let found =
            std::iter::repeat_with(|| Bridge::default().search(view, self.from, goal, Company::NONE, taste, rng));
        let found = found.take(CHANCES).inspect(|_| tries += 1).find_map(|chain| chain);
        (found, tries)
    }

    /// Asserts that a chain is stitched exactly, is deformed within the limits only, and hits nothing.
    fn assert_valid(&self, chain: &[Piece], goal: Goal) {
        let mut at = self.from;
        for piece in chain {
            let role = &self.library.roles[piece.role as usize];
            assert_meets(at, Port { at: piece.entry(), tick: piece.begin, group: role.entry_group });
            at = Port { at: piece.exit(), tick: piece.end, group: role.exit_group };
            self.assert_within_limits(piece);
            let room = self.room(piece);
            assert!(room > -1e-4, "{room}");
        }
        match goal {
            Goal::Port(to) => assert_meets(at, to),
            Goal::Until(tick) => assert!(at.tick >= tick),
            Goal::Since(_) => unreachable!("not asked for"),
        }
    }

    fn assert_within_limits(&self, piece: &Piece) {
        let (role, limits) = (&self.library.roles[piece.role as usize], &self.library.limits);
        let (fewest, most) = limits.tick_range(role.path.len());
        assert!((fewest..=most).contains(&(piece.end - piece.begin)));
        assert_eq!(piece.path.len(), role.path.len());
        for i in 1..piece.path.len() {
            let length = |p: &[Vec2]| p[i].distance(p[i - 1]);
            assert!((length(&piece.path.points) - length(&role.path.points)).abs() <= limits.stretch + 3e-4);
            let turned = |h: &[f32]| h[i] - h[i - 1];
            assert!((turned(&piece.path.headings) - turned(&role.path.headings)).abs() <= limits.bend + 1e-4);
        }
    }
}

fn assert_meets(a: Port, b: Port) {
    assert!(a.at.position.distance(b.at.position) < 1e-3, "{a:?} {b:?}");
    assert!(wrap_angle(a.at.heading - b.at.heading).abs() < 1e-3, "{a:?} {b:?}");
    assert_eq!((a.tick, a.group), (b.tick, b.group));
}

/// A few people standing and walking about, and someone who has to go on from a port.
fn case<'a>(library: &'a Library<'a>, domain: &'a Domain, people: usize, rng: &mut ChaCha8Rng) -> Option<Case<'a>> {
    let from = Port { at: somewhere(rng), tick: rng.random_range(0..20), group: rng.random_range(0..3) };
    let occupancy = Occupancy::new(domain, library);
    let mut case = Case { library, domain, others: vec![], occupancy, from };
    for instance in 0..people {
        let role = rng.random_range(0..library.roles.len() as u32);
        let begin = rng.random_range(-20..100);
        let piece = Piece::rigid(library, domain, role, instance as u32, somewhere(rng), begin);
        let free = case.room(&piece) >= 1e-4;
        // The planner's own answer is the brute-force one, but where the two differ by rounding.
        if case.room(&piece).abs() > 1e-4 {
            assert_eq!(View::new(library, domain, &case.occupancy).is_free(&piece), free);
        }
        if free {
            case.occupancy.insert(piece.clone());
            case.others.push(piece);
        }
    }
    let start = Piece::rigid(library, domain, role_from(library, from.group)?, NO_INSTANCE, from.at, from.tick);
    (case.room(&start) > 0.0).then_some(case)
}

fn role_from(library: &Library, group: u32) -> Option<u32> {
    library.forward[group as usize].first().map(|m| m.role)
}

fn somewhere(rng: &mut ChaCha8Rng) -> Ground {
    let place = Vec2::new(rng.random_range(0.4..4.6), rng.random_range(0.4..3.6));
    Ground::new(place, rng.random_range(-std::f32::consts::PI..std::f32::consts::PI))
}

#[test]
fn wherever_an_exact_chain_exists_a_bridge_is_found_and_every_bridge_is_valid() {
    let (set, scene) = (small_set(), small_scene());
    let (library, domain) = (Library::new(&set, scene.limits), Domain::new(&scene).unwrap());
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let (mut asked, mut unlucky, mut crowded) = (0, 0, 0);
    while asked < 1000 {
        let Some(case) = case(&library, &domain, 6, &mut rng) else { continue };
        let ends = case.reachable();
        let (to, room) = ends[rng.random_range(0..ends.len())];
        if to.tick == case.from.tick || room < 1e-3 {
            continue;
        }
        asked += 1;
        crowded += usize::from(room < 0.1);
        let (chain, tries) = case.search(Goal::Port(to), &mut rng);
        let chain = chain.unwrap_or_else(|| panic!("no bridge from {:?} to {to:?}, room {room}", case.from));
        case.assert_valid(&chain, Goal::Port(to));
        unlucky += usize::from(tries > 1);
    }
    assert!(crowded > 200, "{crowded}");
    assert!(unlucky <= 10, "{unlucky} of {asked} needed more than one search");
}

#[test]
fn the_edge_of_time_is_reached_if_and_only_if_a_rigid_chain_reaches_it() {
    let (set, scene) = (small_set(), small_scene());
    let (library, domain) = (Library::new(&set, scene.limits), Domain::new(&scene).unwrap());
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    let (mut reached, mut stuck, mut unlucky) = (0, 0, 0);
    while reached < 300 || stuck < 30 {
        let Some(case) = case(&library, &domain, 14, &mut rng) else { continue };
        // Far enough to be hard, near enough for every chain to be listed.
        let until = case.from.tick + 50;
        let ends = case.reachable();
        let there: Vec<f32> = ends.iter().filter(|e| e.0.tick >= until).map(|e| e.1).collect();
        let most_room = there.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let complete = ends.iter().filter(|e| e.0.tick < until).all(|e| e.0.tick - case.from.tick < 50);
        let (found, tries) = case.search(Goal::Until(until), &mut rng);
        if let Some(chain) = &found {
            case.assert_valid(chain, Goal::Until(until));
            reached += 1;
            unlucky += usize::from(tries > 1);
        }
        if most_room > 1e-3 {
            assert!(found.is_some(), "{:?} {most_room}", case.from);
        } else if there.is_empty() && complete {
            assert!(found.is_none(), "brute force finds no way");
            stuck += 1;
        }
    }
    assert!(unlucky <= 15, "{unlucky} of {reached} needed more than one search");
}
