//! Passages: how the people of a patch of several come to it, go on from it to another one together, and part. What is
//! possible depends on the kinds alone, not on where they are put: so it is worked out on open ground, once per kind and
//! only for kinds that are used, with final bodies, and then put wherever there is room.

use std::sync::OnceLock;

use glam::Vec2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::bridge::{NO_INSTANCE, Port};
use super::domain::Domain;
use super::draft::Draft;
use super::library::Library;
use super::occupancy::PieceId;
use super::piece::{Company, Piece};
use super::scene::Scene;
use super::study::{BRIEF, passages};
use crate::geom::{Ground, Polygon};
use crate::patch::study::{self, Encore, End, Step};

/// When a patch begins on open ground, ticks: nothing comes before the first tick.
pub(super) const BEGIN: i32 = 2048;
const HORIZON_SECS: f32 = 136.0;
/// Half the side of the open ground, metres.
const HALF_SIDE: f32 = 25.0;
/// The instances that passages of a study lead from and to, in the order of [`End`].
const ENDS: [u32; 3] = [NO_INSTANCE, NO_INSTANCE - 1, NO_INSTANCE - 2];

/// Where passages are found.
pub(super) fn open_ground() -> Domain {
    let region = Polygon::rectangle(Vec2::splat(-HALF_SIDE), Vec2::splat(HALF_SIDE));
    let scene = Scene { region, duration_secs: HORIZON_SECS, obstacles: vec![], ..Scene::demo() };
    Domain::new(&scene).expect("open ground has room")
}

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
    pub ways: Vec<Vec<Piece>>,
    /// The instance of the patch, and of the encore.
    pub ends: [u32; 2],
}

impl Encore {
    /// Who plays role number `k`.
    pub(super) fn player(self, k: usize, people: usize) -> usize {
        (k + self.first as usize) % people
    }

    /// Its roles, after a patch that lies at `world_from_patch` and whose clock begins at `clock`.
    pub(super) fn parts(self, library: &Library, world_from_patch: Ground, clock: i32) -> Vec<Part> {
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
        Self { library, ground: open_ground(), known: library.set.kinds.iter().map(|_| Default::default()).collect() }
    }

    /// The passages of a kind of several people; worked out when first asked for.
    pub fn of(&self, kind: u32, way: Way) -> &[Passage] {
        self.known[kind as usize][way as usize].get_or_init(|| {
            self.remembered(kind, way).unwrap_or_else(|| passages(self.library, &self.ground, kind, way, BRIEF))
        })
    }

    /// Works those of all kinds out, so that what is known does not depend on who asks first.
    pub fn work_out_all(&self) {
        let ways = |&kind: &u32| [(kind, Way::Come), (kind, Way::Stay), (kind, Way::Part)];
        let all: Vec<(u32, Way)> = self.library.multi.iter().flat_map(ways).collect();
        all.into_par_iter().with_max_len(1).for_each(|(kind, way)| {
            self.of(kind, way);
        });
    }

    /// The same if they are known.
    pub fn known(&self, kind: u32, way: Way) -> Option<&[Passage]> {
        self.known[kind as usize][way as usize].get().map(Vec::as_slice)
    }

    /// What was found out beforehand, with pieces that can be put; `None` where nothing was.
    fn remembered(&self, kind: u32, way: Way) -> Option<Vec<Passage>> {
        let study = self.library.set.study.as_ref().filter(|study| study.limits == self.library.limits)?;
        let ways = study.kinds[kind as usize].as_ref()?;
        let cast = |p: &&study::Passage| p.encore.is_none_or(|e| self.library.multi.contains(&e.kind));
        Some(ways[way as usize].iter().filter(cast).map(|p| self.revived(p)).collect())
    }

    fn revived(&self, passage: &study::Passage) -> Passage {
        let revive = |step: &Step| {
            let [begin, end] = step.ticks.map(|tick| BEGIN + tick);
            let role = self.library.first_role[step.kind as usize];
            let piece = match &step.path {
                Some(path) => Piece::along(self.library, &self.ground, role, NO_INSTANCE, path.clone(), begin, end),
                None => Piece::rigid(self.library, &self.ground, role, NO_INSTANCE, step.entry, begin),
            };
            let [from, to] = step.ends.map(|end| ENDS[end as usize]);
            Piece { company: Company { from, to }, ..piece }
        };
        let ways = passage.ways.iter().map(|way| way.iter().map(revive).collect()).collect();
        Passage { encore: passage.encore, ways, ends: [ENDS[End::Patch as usize], ENDS[End::Encore as usize]] }
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
    use super::super::bridge::Port;
    use super::super::common::plain_set;
    use super::super::draft::Desk;
    use super::super::study::LEAD;
    use super::super::tracks::Tracks;
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
        let mut set = sociable_set();
        all_join(&set);
        super::super::study(&mut set, Limits::default(), &|_| true).unwrap();
        all_join(&PatchSet::from_bytes(&set.to_bytes()).unwrap());
    }

    fn all_join(set: &PatchSet) {
        with(set, |library, passages| {
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
