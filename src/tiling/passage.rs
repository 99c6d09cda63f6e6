//! Passages: how the people of a patch of several come to it, go on from it to another one together, and part. What is
//! possible depends on the kinds alone, not on where they are put: so it is worked out on open ground, once per kind and
//! only for kinds that are used, with final bodies, and then put wherever there is room.

use std::sync::OnceLock;

use glam::Vec2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::bridge::{Goal, NO_INSTANCE, Port, Taste, has_easy_closings};
use super::domain::Domain;
use super::draft::{Desk, Draft};
use super::library::Library;
use super::occupancy::PieceId;
use super::piece::{Company, Piece};
use super::scene::Scene;
use super::tracks::Tracks;
use super::tryout::is_clean_where;
use crate::geom::{Ground, Polygon};

/// When a patch begins on open ground, ticks: nothing comes before the first tick.
const BEGIN: i32 = 2048;
const HORIZON_SECS: f32 = 136.0;
/// Half the side of the open ground, metres.
const HALF_SIDE: f32 = 25.0;
/// Ticks that coming and parting take at least: as many as a stitch may change a body, and some.
const LEAD: i32 = 24;
/// Passages of a kind that are enough, and tries to find them.
const ENOUGH: usize = 6;
const LEADS: usize = 24;
const ENCORES: usize = 48;
/// Patches drawn to go on with, of which most cannot follow.
const DRAWS: usize = 1500;
/// A way that this many closings lead along is easy.
const EASY: usize = 2;
const TASTE: Taste = Taste { calm: 1.0, expansions: 60 };

/// One role of a placed patch.
#[derive(Clone, Copy)]
pub(super) struct Part {
    /// The role.
    pub role: u32,
    /// Where it begins.
    pub entry: Port,
    /// Where it ends.
    pub exit: Port,
}

/// The roles of a kind placed somewhere, its clock beginning at tick `clock`.
pub(super) fn parts(library: &Library, kind: u32, world_from_patch: Ground, clock: i32) -> Vec<Part> {
    let part = |role| {
        let (entry, exit) = library.ports(role, world_from_patch, clock);
        Part { role, entry, exit }
    };
    library.roles_of(kind).map(part).collect()
}

/// What the people of a patch do before or after it.
pub(super) struct Passage {
    /// The patch that they go on with, if they do.
    pub encore: Option<Encore>,
    /// By role of the patch, the patches on the way, in order of time.
    ways: Vec<Vec<Piece>>,
    /// The instance of the patch, and of the encore.
    ends: [u32; 2],
}

/// A patch that the people of another go on with.
#[derive(Clone, Copy)]
pub(super) struct Encore {
    /// Its kind.
    pub kind: u32,
    /// Who plays its first role: the second role is played by the next of them, and so on round.
    pub first: u32,
    patch_from_patch: Ground,
    ticks: i32,
}

impl Encore {
    /// Who plays role number `k`.
    pub fn player(self, k: usize, people: usize) -> usize {
        (k + self.first as usize) % people
    }

    /// Its roles, after a patch that lies at `world_from_patch` and whose clock begins at `clock`.
    pub fn parts(self, library: &Library, world_from_patch: Ground, clock: i32) -> Vec<Part> {
        parts(library, self.kind, world_from_patch.then(self.patch_from_patch), clock + self.ticks)
    }
}

/// Which passages of a kind are asked for.
#[derive(Clone, Copy)]
pub(super) enum Way {
    /// To it.
    Come,
    /// From it to another one.
    Stay,
    /// From it.
    Part,
}

/// The passages of all kinds.
pub(super) struct Passages<'a> {
    library: &'a Library<'a>,
    ground: Domain,
    known: Vec<[OnceLock<Vec<Passage>>; 3]>,
}

impl<'a> Passages<'a> {
    /// Nothing is known yet.
    pub fn new(library: &'a Library<'a>) -> Self {
        let region = Polygon::rectangle(Vec2::splat(-HALF_SIDE), Vec2::splat(HALF_SIDE));
        let scene = Scene { region, duration_secs: HORIZON_SECS, obstacles: vec![], ..Scene::demo() };
        let ground = Domain::new(&scene).expect("open ground has room");
        Self { library, ground, known: library.set.kinds.iter().map(|_| Default::default()).collect() }
    }

    /// The passages of a kind of several people; worked out when first asked for.
    pub fn of(&self, kind: u32, way: Way) -> &[Passage] {
        self.known[kind as usize][way as usize].get_or_init(|| self.study(kind, way))
    }

    /// The same if they are known.
    pub fn known(&self, kind: u32, way: Way) -> Option<&[Passage]> {
        self.known[kind as usize][way as usize].get().map(Vec::as_slice)
    }

    fn study(&self, kind: u32, way: Way) -> Vec<Passage> {
        let tracks = Tracks::on_open_ground(self.library, &self.ground);
        let mut desk = Desk::default();
        let mut study = Study {
            draft: Draft::new(&tracks, &mut desk),
            parts: parts(self.library, kind, Ground::IDENTITY, BEGIN),
            rng: ChaCha8Rng::seed_from_u64(u64::from(kind) << 2 | way as u64),
        };
        let mut found = Vec::new();
        match way {
            Way::Stay => {
                let (mut draws, mut tries) = (0, 0);
                while found.len() < ENOUGH && draws < DRAWS && tries < ENCORES {
                    draws += 1;
                    let Some(encore) = study.draw() else { continue };
                    tries += 1;
                    found.extend(study.go_on(encore));
                }
            }
            Way::Come | Way::Part => {
                for _ in 0..LEADS {
                    found.extend(study.lead(matches!(way, Way::Come)));
                    if found.len() == ENOUGH {
                        break;
                    }
                }
            }
        }
        found
    }
}

/// A kind on open ground.
struct Study<'a> {
    draft: Draft<'a>,
    parts: Vec<Part>,
    rng: ChaCha8Rng,
}

impl Study<'_> {
    /// The patch and its instance.
    fn put(&mut self) -> Option<(Vec<PieceId>, u32)> {
        self.draft.restart();
        let ids = self.draft.add_patch(self.parts.iter().map(|p| (p.role, p.entry)))?;
        let here = self.draft.piece(ids[0]).instance;
        Some((ids, here))
    }

    /// Ways of all to the patch, or from it.
    fn lead(&mut self, come: bool) -> Option<Passage> {
        let (ids, here) = self.put()?;
        let mut ways = Vec::new();
        for k in 0..self.parts.len() {
            let Part { entry, exit, .. } = self.parts[k];
            let (from, goal, company) = match come {
                true => (entry, Goal::Since(entry.tick - LEAD), Company { from: NO_INSTANCE, to: here }),
                false => (exit, Goal::Until(exit.tick + LEAD), Company { from: here, to: NO_INSTANCE }),
            };
            ways.push(self.draft.search(from, goal, company, TASTE, &mut self.rng)?);
        }
        let chain = |(way, &id): (&Vec<PieceId>, &PieceId)| match come {
            true => [way.as_slice(), &[id]].concat(),
            false => [&[id], way.as_slice()].concat(),
        };
        let chains: Vec<Vec<PieceId>> = ways.iter().zip(&ids).map(chain).collect();
        self.passage(None, ways, chains, [here, NO_INSTANCE])
    }

    /// A patch that may follow, where somebody goes there by a closing as it is and the others have easy ways.
    fn draw(&mut self) -> Option<Encore> {
        let library = self.draft.base.library;
        let people = self.parts.len();
        let next = library.multi[self.rng.random_range(0..library.multi.len())];
        if library.set.kinds[next as usize].people() != people {
            return None;
        }
        let first = self.rng.random_range(0..people as u32);
        let from = self.parts[first as usize].exit;
        let lead = &library.roles[library.first_role[next as usize] as usize];
        let closings = library.closings_between(from.group, lead.entry_group);
        if closings.all.is_empty() {
            return None;
        }
        let closing = self.rng.random_range(0..closings.all.len());
        let patch_from_patch = from.at.then(closings.spans[closing].exit).then(lead.entry.inverse());
        let tick = from.tick + closings.all[closing].strand.frames() as i32 - 1;
        let encore = Encore { kind: next, first, patch_from_patch, ticks: tick - lead.begin - BEGIN };
        let parts = encore.parts(library, Ground::IDENTITY, BEGIN);
        let easy = (1..people).all(|k| {
            let from = self.parts[encore.player(k, people)].exit;
            parts[k].entry.tick > from.tick && has_easy_closings(library, from, parts[k].entry, EASY)
        });
        easy.then_some(encore)
    }

    /// Leads everybody to an encore.
    fn go_on(&mut self, encore: Encore) -> Option<Passage> {
        let (ids, here) = self.put()?;
        let library = self.draft.base.library;
        let (people, parts) = (ids.len(), encore.parts(library, Ground::IDENTITY, BEGIN));
        let next = self.draft.add_patch(parts.iter().map(|p| (p.role, p.entry)))?;
        let there = self.draft.piece(next[0]).instance;
        let (mut ways, mut chains) = (vec![vec![]; people], Vec::new());
        for (k, part) in parts.iter().enumerate() {
            let player = encore.player(k, people);
            let company = Company { from: here, to: there };
            let from = self.parts[player].exit;
            let way = self.draft.search(from, Goal::Port(part.entry), company, TASTE, &mut self.rng)?;
            chains.push([&[ids[player]], way.as_slice(), &[next[k]]].concat());
            ways[player] = way;
        }
        self.passage(Some(encore), ways, chains, [here, there])
    }

    /// What was found, if everybody moves cleanly and no box is left lying.
    fn passage(
        &mut self,
        encore: Option<Encore>,
        ways: Vec<Vec<PieceId>>,
        chains: Vec<Vec<PieceId>>,
        ends: [u32; 2],
    ) -> Option<Passage> {
        chains.into_iter().for_each(|chain| self.draft.push_track(chain));
        let piece = |id: PieceId| self.draft.piece(id);
        let is_way = |id| ways.iter().flatten().any(|&way| way == id);
        if ways.iter().flatten().any(|&id| piece(id).leaves_box()) || !is_clean_where(&self.draft, is_way) {
            return None;
        }
        let ways = ways.into_iter().map(|way| way.into_iter().map(|id| piece(id).clone()).collect()).collect();
        Some(Passage { encore, ways, ends })
    }
}

/// Where a passage is put: its patch's place and clock, and the instances of the patch and the encore.
#[derive(Clone, Copy)]
pub(super) struct Site {
    /// Of the patch.
    pub world_from_patch: Ground,
    /// Of the patch.
    pub clock: i32,
    /// Of the patch and the encore.
    pub ends: [u32; 2],
}

/// Puts the ways of a passage into a draft, those of the roles that `goes`; `None` and nothing is put if there is no room.
pub(super) fn put(
    draft: &mut Draft,
    passage: &Passage,
    site: Site,
    goes: impl Fn(usize, &Piece) -> bool,
) -> Option<Vec<Vec<PieceId>>> {
    let (mark, mut ways) = (draft.mark(), Vec::new());
    let number = |instance: u32| match passage.ends.iter().position(|&end| end == instance) {
        Some(k) if instance != NO_INSTANCE => site.ends[k],
        _ => instance,
    };
    for (role, way) in passage.ways.iter().enumerate() {
        let mut ids = Vec::new();
        let moved = |piece: &Piece| piece.moved(draft.base.domain, site.world_from_patch, site.clock - BEGIN);
        for mut piece in way.iter().map(moved).filter(|piece| goes(role, piece)).collect::<Vec<_>>() {
            piece.company = Company { from: number(piece.company.from), to: number(piece.company.to) };
            if !draft.view().is_free(&piece) {
                draft.rewind(mark);
                return None;
            }
            ids.push(draft.add(piece));
        }
        ways.push(ids);
    }
    Some(ways)
}

/// The passages of a list in random order, those to what is wanted first.
pub(super) fn shuffled<'p>(library: &Library, passages: &'p [Passage], rng: &mut ChaCha8Rng) -> Vec<&'p Passage> {
    let weight = |p: &Passage| p.encore.map_or(1.0, |e| library.preference.weight_of_kind(e.kind));
    // The first of many exponential waits is each one's with a probability in proportion to its rate.
    let mut wait = |p: &Passage| -rng.random_range(f32::MIN_POSITIVE..1.0f32).ln() / weight(p);
    let mut order: Vec<(f32, &Passage)> = passages.iter().map(|p| (wait(p), p)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    order.into_iter().map(|(_, p)| p).collect()
}

#[cfg(test)]
mod tests {
    use super::super::common::plain_set;
    use super::super::view::View;
    use super::*;
    use crate::deform::Limits;
    use crate::patch::PatchSet;

    const WAYS: [Way; 3] = [Way::Come, Way::Stay, Way::Part];

    fn with<T>(set: &PatchSet, ask: impl FnOnce(&Library, &Passages) -> T) -> T {
        let library = Library::new(set, Limits::default());
        ask(&library, &Passages::new(&library))
    }

    /// The plain set, and two who stand before each other.
    fn sociable_set() -> PatchSet {
        let mut set = plain_set();
        let mut kind = set.kinds.iter().find(|k| k.name == "idle-40").expect("somebody stands").clone();
        kind.name = "talk".into();
        kind.fragments.push(kind.fragments[0].clone());
        for (fragment, at) in kind.fragments.iter_mut().zip([0.0, std::f32::consts::PI]) {
            let path = &mut fragment.motion.path;
            path.points.fill(Vec2::new(0.0, -0.6 * at.cos()));
            path.headings.fill(at);
        }
        set.kinds.push(kind);
        set
    }

    #[test]
    fn everybody_comes_parts_and_goes_on_by_pieces_that_join() {
        with(&sociable_set(), |library, passages| {
            let close = |a: Port, b: Port| {
                a.tick == b.tick && a.group == b.group && a.at.position.distance(b.at.position) < 1e-3
            };
            let mut encores = 0;
            for (&kind, way) in library.multi.iter().flat_map(|kind| WAYS.map(|way| (kind, way))) {
                let here = parts(library, kind, Ground::IDENTITY, BEGIN);
                assert!(matches!(way, Way::Stay) || !passages.of(kind, way).is_empty());
                for passage in passages.of(kind, way) {
                    let there = passage.encore.map(|e| (e, e.parts(library, Ground::IDENTITY, BEGIN)));
                    encores += usize::from(there.is_some());
                    for (role, pieces) in passage.ways.iter().enumerate() {
                        let (first, last) = (library.entry_of(&pieces[0]), library.exit_of(&pieces[pieces.len() - 1]));
                        let joints = pieces.windows(2).map(|w| (library.exit_of(&w[0]), library.entry_of(&w[1])));
                        assert!(joints.into_iter().all(|(exit, entry)| close(exit, entry)));
                        match way {
                            Way::Come => assert!(close(last, here[role].entry) && last.tick - first.tick >= LEAD),
                            Way::Part => assert!(close(first, here[role].exit) && last.tick - first.tick >= LEAD),
                            Way::Stay => {
                                let (encore, there) = there.as_ref().expect("people go on");
                                let next = (0..there.len()).find(|&k| encore.player(k, there.len()) == role);
                                assert!(close(first, here[role].exit) && close(last, there[next.unwrap()].entry));
                            }
                        }
                    }
                }
            }
            assert!(encores > 0, "nobody ever goes on");
        });
    }

    #[test]
    fn wherever_a_passage_is_put_it_is_the_same_and_free() {
        with(&sociable_set(), |library, passages| {
            let domain = Domain::new(&Scene::demo()).unwrap();
            let tracks = Tracks::new(library, &domain);
            let mut desk = Desk::default();
            let kind = library.multi[library.multi.len() - 1];
            for (clock, heading) in [(60, 0.4), (300, -2.5), (-40, 1.0)] {
                let at = Ground::new(Vec2::splat(6.0), heading);
                for passage in WAYS.into_iter().flat_map(|way| passages.of(kind, way)) {
                    let mut draft = Draft::new(&tracks, &mut desk);
                    let ids =
                        draft.add_patch(parts(library, kind, at, clock).iter().map(|p| (p.role, p.entry))).unwrap();
                    let site = Site {
                        world_from_patch: at,
                        clock,
                        ends: [draft.piece(ids[0]).instance, draft.new_instance()],
                    };
                    let ways = put(&mut draft, passage, site, |_, _| true).expect("an empty place has room");
                    for (role, way) in ways.iter().enumerate() {
                        for (piece, &id) in passage.ways[role].iter().zip(way) {
                            let put = draft.piece(id);
                            assert_eq!((put.begin - clock, put.role), (piece.begin - BEGIN, piece.role));
                            assert!(put.entry().position.distance(at.then(piece.entry()).position) < 1e-3);
                        }
                    }
                    let blocked = View::new(library, &domain, &tracks.occupancy);
                    assert!(ways.iter().flatten().all(|&id| blocked.is_free(draft.piece(id))));
                }
            }
        });
    }

    #[test]
    fn where_there_is_no_room_nothing_is_left_behind() {
        with(&plain_set(), |library, passages| {
            let domain = Domain::new(&Scene::demo()).unwrap();
            let tracks = Tracks::new(library, &domain);
            let mut desk = Desk::default();
            let mut draft = Draft::new(&tracks, &mut desk);
            let kind = library.multi[0];
            // In the corner people would come through the walls.
            let site = Site { world_from_patch: Ground::new(Vec2::ZERO, 0.0), clock: 100, ends: [1, 2] };
            for passage in passages.of(kind, Way::Come) {
                assert!(put(&mut draft, passage, site, |_, _| true).is_none());
            }
            assert!(draft.finish().pieces.is_empty());
        });
    }

    #[test]
    fn a_study_is_the_same_for_everybody_who_asks() {
        let studied = || {
            with(&sociable_set(), |library, passages| {
                let ways =
                    |passage: &Passage| passage.ways.iter().flatten().map(|p| (p.role, p.begin)).collect::<Vec<_>>();
                let of = |kind| WAYS.map(|way| passages.of(kind, way).iter().map(ways).collect::<Vec<_>>());
                library.multi.iter().rev().map(|&kind| of(kind)).collect::<Vec<_>>()
            })
        };
        assert_eq!(studied(), studied());
    }
}
