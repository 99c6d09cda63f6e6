//! Gathering: new people who come from somewhere, meet for one or more patches of several people, and part again. Put in
//! while the place is still empty, they give a crowd most of its company at next to no cost; what room is left is filled
//! with people who walk alone.

use std::f32::consts::PI;

use glam::Vec2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::bridge::{Goal, Port, Taste, has_easy_closings};
use super::domain::Spot;
use super::draft::Draft;
use super::library::Library;
use super::occupancy::PieceId;
use super::piece::{Company, Rigid};
use super::prefer::Stay;
use super::source::{way_out, with_patience};
use crate::geom::Ground;

/// Places tried for a first patch.
const PLACES: usize = 200;
/// Ways from one patch to the next that are tried until one is free.
const STEPS: usize = 200;
/// Free ones among them that are tried to be walked.
const ENCORES: usize = 4;
/// Ways that are tried out to tell whether one kind can follow another.
const SAMPLES: usize = 16;
/// Ways from a kind on that let its people stay together.
const ENOUGH: usize = 3;
/// A way that this many closings lead along is easy.
const EASY: usize = 2;
/// Room that the ends of a patch must have to walls, metres.
const WALL_ROOM: f32 = 0.4;
/// Ticks of the first patch that are seen at least.
const SEEN: i32 = 15;

/// A kind that the people of another can go on with at once, and how.
#[derive(Clone, Copy)]
struct Encore {
    kind: u32,
    /// Who plays its first role: the second role is played by the next of them, and so on round.
    first: u32,
    /// The closing by which they go there; it need not be deformed. The others have easy ways as well.
    closing: u32,
}

/// By kind, what its people can go on with at once, as people do who stand together.
pub(super) struct Encores(Vec<Vec<Encore>>);

impl Encores {
    /// Asks the table of closings. O(kinds^2 x closings).
    pub fn new(library: &Library) -> Self {
        let kinds = (0..library.set.kinds.len() as u32).into_par_iter();
        Self(kinds.map(|kind| if library.multi.contains(&kind) { of_kind(library, kind) } else { vec![] }).collect())
    }

    /// True if the people of a kind can stay together after it.
    pub fn is_sociable(&self, kind: u32) -> bool {
        self.0[kind as usize].len() >= ENOUGH
    }
}

fn of_kind(library: &Library, kind: u32) -> Vec<Encore> {
    let ends: Vec<Port> = library.roles_of(kind).map(|role| library.ports(role, Ground::IDENTITY, 0).1).collect();
    let people = ends.len() as u32;
    let others = library.multi.iter().filter(|&&k| library.set.kinds[k as usize].people() == ends.len());
    let mut encores = Vec::new();
    for (kind, first) in others.flat_map(|&kind| (0..people).map(move |first| (kind, first))) {
        let count = library.closings_between(ends[first as usize].group, first_group(library, kind)).all.len();
        let samples = SAMPLES.min(count);
        let sampled = (0..samples).map(|k| Encore { kind, first, closing: (k * count / samples) as u32 });
        encores.extend(sampled.filter(|&encore| is_easy(library, &ends, encore)));
    }
    encores
}

/// True if everybody has easy ways from where they are into an encore.
fn is_easy(library: &Library, ends: &[Port], encore: Encore) -> bool {
    let parts = step(library, ends, encore);
    parts.iter().enumerate().skip(1).all(|(k, part)| {
        let from = ends[player(encore, k, ends.len())];
        part.entry.tick > from.tick && has_easy_closings(library, from, part.entry, EASY)
    })
}

fn first_group(library: &Library, kind: u32) -> u32 {
    library.roles[library.first_role[kind as usize] as usize].entry_group
}

/// Who plays role number `k` of an encore.
fn player(encore: Encore, k: usize, people: usize) -> usize {
    (k + encore.first as usize) % people
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

/// An encore as it lies if who plays its first role goes there by the closing as it is.
fn step(library: &Library, ends: &[Port], encore: Encore) -> Vec<Part> {
    let from = ends[encore.first as usize];
    let lead = &library.roles[library.first_role[encore.kind as usize] as usize];
    let (closings, closing) = (library.closings_between(from.group, lead.entry_group), encore.closing as usize);
    let world_from_patch = from.at.then(closings.spans[closing].exit).then(lead.entry.inverse());
    let tick = from.tick + closings.all[closing].strand.frames() as i32 - 1;
    parts(library, encore.kind, world_from_patch, tick - lead.begin)
}

/// The roles of a kind placed somewhere.
pub(super) fn parts(library: &Library, kind: u32, world_from_patch: Ground, clock: i32) -> Vec<Part> {
    let part = |role| {
        let (entry, exit) = library.ports(role, world_from_patch, clock);
        Part { role, entry, exit }
    };
    library.roles_of(kind).map(part).collect()
}

/// What a gathering is to be.
#[derive(Clone, Copy)]
pub(super) struct Wish {
    /// With what it begins.
    pub kind: u32,
    /// Ticks that its people should spend together.
    pub together: i32,
    /// Ticks that they must.
    pub least: i32,
}

/// Somebody's life so far. Those who are together come in the order of the roles that they played last.
pub(super) struct Life {
    /// The patches, in order.
    pub pieces: Vec<PieceId>,
    begin: Port,
    /// Where it ends so far.
    pub end: Port,
    /// The first and the last patch of several people.
    pub company: Company,
}

impl Life {
    /// One patch.
    pub fn of(part: &Part, id: PieceId, instance: u32) -> Self {
        let company = Company { from: instance, to: instance };
        Self { pieces: vec![id], begin: part.entry, end: part.exit, company }
    }
}

/// Adds people who meet as wished, each present over the whole time.
pub(super) fn gather(
    draft: &mut Draft,
    encores: &Encores,
    wish: Wish,
    taste: Taste,
    rng: &mut ChaCha8Rng,
) -> Option<()> {
    let first = (0..PLACES).find_map(|_| place(draft, wish, rng))?;
    let horizon = draft.base.domain.horizon;
    let mut together = time_together(&first, horizon);
    let ids = draft.add_patch(first.iter().map(|p| (p.role, p.entry)))?;
    let here = draft.piece(ids[0]).instance;
    let mut lives: Vec<Life> = first.iter().zip(ids).map(|(part, id)| Life::of(part, id, here)).collect();
    let mut kind = wish.kind;
    while together < wish.together && lives.iter().all(|l| l.end.tick < horizon - SEEN) {
        let Some((next, parts)) = go_on(draft, &mut lives, &encores.0[kind as usize], taste, rng) else { break };
        together += time_together(&parts, horizon);
        kind = next;
    }
    if together < wish.least {
        return None;
    }
    for life in &mut lives {
        come(draft, life, taste, rng)?;
    }
    for life in &mut lives {
        part(draft, life, taste, rng)?;
    }
    lives.into_iter().for_each(|life| draft.push_track(life.pieces));
    Some(())
}

/// Ticks of a patch within the domain's time, on average over its people.
fn time_together(parts: &[Part], horizon: i32) -> i32 {
    let ticks = |p: &Part| p.exit.tick.clamp(0, horizon) - p.entry.tick.clamp(0, horizon);
    parts.iter().map(ticks).sum::<i32>() / parts.len() as i32
}

/// The first patch at some place and time that leaves room for what is to follow, if it is free there.
fn place(draft: &Draft, wish: Wish, rng: &mut ChaCha8Rng) -> Option<Vec<Part>> {
    let (library, domain) = (draft.base.library, draft.base.domain);
    let position =
        Vec2::new(rng.random_range(domain.min.x..domain.max.x), rng.random_range(domain.min.y..domain.max.y));
    let world_from_patch = Ground::new(position, rng.random_range(-PI..PI));
    let longest = library.roles_of(wish.kind).map(|r| library.roles[r as usize].ticks).max()?;
    let earliest = SEEN - longest;
    let latest = (domain.horizon - SEEN - wish.together).max(earliest + 1);
    let clock = rng.random_range(earliest..latest);
    if !library.preference.is_wanted(wish.kind, Stay::new(world_from_patch, clock.max(0)), rng) {
        return None;
    }
    let parts = parts(library, wish.kind, world_from_patch, clock);
    is_free(draft, &parts).then_some(parts)
}

fn is_free(draft: &Draft, parts: &[Part]) -> bool {
    let (library, domain) = (draft.base.library, draft.base.domain);
    let outside = |tick: i32| tick < 0 || tick > domain.horizon;
    let room = |p: &Port| outside(p.tick) || domain.holds(Spot::ground(p.tick), p.at.position, WALL_ROOM);
    let rigid = |p: &Part| Rigid::new(library, p.role, p.entry.at, p.entry.tick);
    let view = draft.view();
    parts.iter().all(|p| room(&p.entry) && room(&p.exit))
        && parts.iter().all(|p| view.is_free_rigid(p.role, rigid(p), Company::NONE))
}

/// Leads the people from where they are into another patch together; its kind and parts.
fn go_on(
    draft: &mut Draft,
    lives: &mut [Life],
    encores: &[Encore],
    taste: Taste,
    rng: &mut ChaCha8Rng,
) -> Option<(u32, Vec<Part>)> {
    if encores.is_empty() {
        return None;
    }
    let library = draft.base.library;
    let ends: Vec<Port> = lives.iter().map(|l| l.end).collect();
    let mut tries = 0;
    for _ in 0..STEPS {
        let encore = encores[rng.random_range(0..encores.len())];
        let parts = step(library, &ends, encore);
        let from = |k: usize| ends[player(encore, k, ends.len())];
        let stay = Stay::new(parts[0].entry.at, parts[0].entry.tick);
        if !library.preference.is_wanted(encore.kind, stay, rng) || !is_free(draft, &parts) {
            continue;
        }
        let mark = draft.mark();
        if let Some(ways) = join(draft, &parts, from, lives[0].company.to, taste, rng) {
            let here = draft.piece(ways[0][ways[0].len() - 1]).instance;
            // In the order of the roles that they play now.
            lives.rotate_left(encore.first as usize);
            for (life, (way, part)) in lives.iter_mut().zip(ways.into_iter().zip(&parts)) {
                life.pieces.extend(way);
                (life.end, life.company.to) = (part.exit, here);
            }
            return Some((encore.kind, parts));
        }
        draft.rewind(mark);
        tries += 1;
        if tries == ENCORES {
            break;
        }
    }
    None
}

/// Puts a patch in and leads everybody into it; each one's way, the patch included.
fn join(
    draft: &mut Draft,
    parts: &[Part],
    from: impl Fn(usize) -> Port,
    before: u32,
    taste: Taste,
    rng: &mut ChaCha8Rng,
) -> Option<Vec<Vec<PieceId>>> {
    let ids = draft.add_patch(parts.iter().map(|p| (p.role, p.entry)))?;
    let company = Company { from: before, to: draft.piece(ids[0]).instance };
    let mut lead = |(k, part): (usize, &Part)| {
        let mut way = draft.search(from(k), Goal::Port(part.entry), company, taste, rng)?;
        way.push(ids[k]);
        Some(way)
    };
    parts.iter().enumerate().map(&mut lead).collect()
}

/// Leads somebody from the beginning of time to their first patch.
pub(super) fn come(draft: &mut Draft, life: &mut Life, taste: Taste, rng: &mut ChaCha8Rng) -> Option<()> {
    if life.begin.tick > 0 {
        let company = Company { to: life.company.from, ..Company::NONE };
        let way = lead(draft, life.begin, Goal::Since(0), company, taste, rng)?;
        life.pieces.splice(..0, way);
    }
    Some(())
}

/// Leads somebody from their last patch to the end of time, or out.
pub(super) fn part(draft: &mut Draft, life: &mut Life, taste: Taste, rng: &mut ChaCha8Rng) -> Option<()> {
    let horizon = draft.base.domain.horizon;
    if life.end.tick < horizon {
        let company = Company { from: life.company.to, ..Company::NONE };
        let goal = way_out(draft, life.end, rng);
        life.pieces.extend(lead(draft, life.end, goal, company, with_patience(taste, goal), rng)?);
    }
    Some(())
}

/// A way that keeps clear of those who are met, or at least of everybody else.
fn lead(
    draft: &mut Draft,
    from: Port,
    goal: Goal,
    company: Company,
    taste: Taste,
    rng: &mut ChaCha8Rng,
) -> Option<Vec<PieceId>> {
    let tries = [Company::NONE, Company::NONE, company, company];
    tries.into_iter().find_map(|company| draft.search(from, goal, company, taste, rng))
}
