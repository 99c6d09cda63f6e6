//! Studying a set: how the people of its kinds come, go on together and part, found on open ground with final bodies, once
//! and thoroughly for a patch set (`PatchSet::study`), or briefly for a kind of a set that comes without.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::Scene;
use super::bridge::{Goal, NO_INSTANCE, Taste, has_easy_closings};
use super::demands::admitted;
use super::domain::Domain;
use super::draft::{Desk, Draft};
use super::library::Library;
use super::occupancy::PieceId;
use super::outcome::Method;
use super::passage::{BEGIN, Part, Passage, Way, open_ground, parts};
use super::piece::{Company, Piece};
use super::tracks::Tracks;
use super::tryout::is_clean_where;
use crate::deform::Limits;
use crate::geom::Ground;
use crate::patch::PatchSet;
use crate::patch::study::{self as patch, Encore, End, Step, Study};
use crate::{Error, Result};

/// Ticks that coming and parting take at least: as many as a stitch may change a body, and some.
pub(super) const LEAD: i32 = 24;
/// A way that this many closings lead along is easy.
const EASY: usize = 2;
const TASTE: Taste = Taste { calm: 1.0, compact: 0.0, expansions: 60 };

/// How much is found out.
#[derive(Clone, Copy)]
pub(super) struct Effort {
    /// Passages of a kind that are enough.
    enough: usize,
    /// Tries to find ones to or from it.
    leads: usize,
    /// Tries to find ones to an encore.
    encores: usize,
    /// Patches drawn to go on with, of which most cannot follow.
    draws: usize,
}

/// While people wait for a crowd.
pub(super) const BRIEF: Effort = Effort { enough: 6, leads: 24, encores: 48, draws: 1500 };
/// Kinds between two reports of progress.
const CHUNK: usize = 16;
/// When a set is made.
const THOROUGH: Effort = Effort { enough: 16, leads: 48, encores: 200, draws: 8000 };

/// Finds out how the people of a set's kinds come, go on together and part, for tiling with it within `limits`; what was
/// known before is forgotten. Kinds that only some scenes use (jumps over something, hops) are left out.
///
/// `progress` is told how much is done, from 0 to 1, and stops by returning false; the set is without a study then. The same
/// set gives the same study for any number of threads. O(kinds of several people x tries).
///
/// # Errors
/// The set cannot be tiled with at all, or stopped.
pub fn study(set: &mut PatchSet, limits: Limits, progress: &dyn Fn(f32) -> bool) -> Result<()> {
    set.study = None;
    let plain = admitted(&Scene::demo(), set, Method::Engine)?;
    let library = Library::new(&plain, limits);
    let index: Vec<u32> = plain.kinds.iter().map(|kind| index_of(set, &kind.name)).collect();
    let (ground, mut kinds) = (open_ground(), vec![None; set.kinds.len()]);
    let ways = |&kind: &u32| {
        let found = [Way::Come, Way::Stay, Way::Part].map(|way| passages(&library, &ground, kind, way, THOROUGH));
        (kind, found.map(|list| list.iter().map(|passage| kept(&library, &ground, passage, &index)).collect()))
    };
    for (done, some) in library.multi.chunks(CHUNK).enumerate() {
        if !progress((done * CHUNK) as f32 / library.multi.len() as f32) {
            return Err(Error::Stopped);
        }
        let found: Vec<(u32, [_; 3])> = some.par_iter().with_max_len(1).map(ways).collect();
        found.into_iter().for_each(|(kind, ways)| kinds[index[kind as usize] as usize] = Some(ways));
    }
    drop(library);
    drop(plain);
    set.study = Some(Study { limits, kinds });
    Ok(())
}

fn index_of(set: &PatchSet, name: &str) -> u32 {
    set.kinds.iter().position(|kind| kind.name == name).expect("one of its kinds") as u32
}

/// A passage as it is kept, with the kinds' indices as they are there.
fn kept(library: &Library, ground: &Domain, passage: &Passage, index: &[u32]) -> patch::Passage {
    let [here, there] = passage.ends;
    let end = |instance: u32| match instance {
        NO_INSTANCE => End::Alone,
        i if i == here => End::Patch,
        i => {
            debug_assert_eq!(i, there);
            End::Encore
        }
    };
    let step = |piece: &Piece| {
        let entry = piece.entry();
        let as_captured = Piece::rigid(library, ground, piece.role, NO_INSTANCE, entry, piece.begin);
        let is_deformed = piece.end != as_captured.end || piece.path != as_captured.path;
        Step {
            kind: index[library.roles[piece.role as usize].kind as usize],
            ticks: [piece.begin - BEGIN, piece.end - BEGIN],
            ends: [piece.company.from, piece.company.to].map(end),
            entry,
            path: is_deformed.then(|| piece.path.clone()),
        }
    };
    let encore = passage.encore.map(|e| Encore { kind: index[e.kind as usize], ..e });
    patch::Passage { encore, ways: passage.ways.iter().map(|way| way.iter().map(step).collect()).collect() }
}

/// The passages of a kind.
pub(super) fn passages(library: &Library, ground: &Domain, kind: u32, way: Way, effort: Effort) -> Vec<Passage> {
    let tracks = Tracks::on_open_ground(library, ground);
    let mut desk = Desk::default();
    let mut search = Search {
        draft: Draft::new(&tracks, &mut desk),
        parts: parts(library, kind, Ground::IDENTITY, BEGIN),
        rng: ChaCha8Rng::seed_from_u64(u64::from(kind) << 2 | way as u64),
    };
    let mut found = Vec::new();
    match way {
        Way::Stay => {
            let (mut draws, mut tries) = (0, 0);
            while found.len() < effort.enough && draws < effort.draws && tries < effort.encores {
                draws += 1;
                let Some(encore) = search.draw() else { continue };
                tries += 1;
                found.extend(search.go_on(encore));
            }
        }
        Way::Come | Way::Part => {
            for _ in 0..effort.leads {
                found.extend(search.lead(matches!(way, Way::Come)));
                if found.len() == effort.enough {
                    break;
                }
            }
        }
    }
    found
}

/// A kind on open ground.
struct Search<'a> {
    draft: Draft<'a>,
    parts: Vec<Part>,
    rng: ChaCha8Rng,
}

impl Search<'_> {
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

#[cfg(test)]
mod tests {
    use super::super::common::plain_set;
    use super::*;

    fn studied() -> PatchSet {
        let mut set = plain_set();
        study(&mut set, Limits::default(), &|_| true).unwrap();
        set
    }

    #[test]
    fn a_study_is_kept_in_the_file_bit_by_bit() {
        let set = studied();
        assert!(set.study.as_ref().unwrap().kinds.iter().flatten().flatten().any(|passages| !passages.is_empty()));
        assert_eq!(PatchSet::from_bytes(&set.to_bytes()).unwrap().study, set.study);
    }

    #[test]
    fn it_is_the_same_for_any_number_of_threads() {
        let with = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(studied);
        assert_eq!(with(1).study, with(3).study);
    }

    #[test]
    fn who_stops_it_gets_none() {
        let mut set = studied();
        assert!(matches!(study(&mut set, Limits::default(), &|_| false), Err(Error::Stopped)));
        assert!(set.study.is_none());
    }

    #[test]
    fn what_needs_a_kind_that_is_left_out_is_not_known_any_more() {
        let set = studied();
        let all = set.only(|_| true);
        assert_eq!(all, set);
        let study = set.study.as_ref().unwrap();
        let used: Vec<u32> = study
            .kinds
            .iter()
            .flatten()
            .flatten()
            .flatten()
            .flat_map(|p| p.ways.iter().flatten())
            .map(|s| s.kind)
            .collect();
        let without = set.only(|kind| kind.name != set.kinds[used[0] as usize].name);
        assert_eq!(without.kinds.len() + 1, set.kinds.len());
        assert!(without.validate().is_empty());
        let known = |set: &PatchSet| set.study.as_ref().unwrap().kinds.iter().flatten().count();
        assert!(known(&without) < known(&set));
    }

    #[test]
    fn broken_studies_are_told() {
        let set = studied();
        let broken = |spoil: &dyn Fn(&mut Study)| {
            let mut set = set.clone();
            spoil(set.study.as_mut().unwrap());
            PatchSet::from_bytes(&set.to_bytes()).unwrap_err().to_string()
        };
        fn step(study: &mut Study) -> &mut Step {
            let ways = study.kinds.iter_mut().flatten().flatten().flatten().flat_map(|p| &mut p.ways);
            ways.flatten().next().unwrap()
        }
        let name = |message: String| assert!(message.contains("study of kind"), "{message}");
        name(broken(&|study| step(study).kind = 10_000));
        name(broken(&|study| step(study).entry.position.x = f32::NAN));
        name(broken(&|study| step(study).ticks[1] = i32::MAX));
        name(broken(&|study| step(study).ticks = [i32::MAX, i32::MIN]));
        let short = broken(&|study| study.kinds.truncate(1));
        assert!(short.contains("expected what was found out about"), "{short}");
    }
}
