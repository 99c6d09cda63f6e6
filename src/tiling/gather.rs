//! Gathering: new people who come from somewhere, meet for one or more patches of several people, and part again. Put in
//! while the place is still empty, they give a crowd most of its company at next to no cost; what room is left is filled
//! with people who walk alone.

use std::f32::consts::PI;

use glam::Vec2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::bridge::{Goal, NO_INSTANCE, Port, Taste};
use super::domain::{Domain, Spot};
use super::draft::Draft;
use super::occupancy::PieceId;
use super::passage::{Part, Passage, Passages, Site, Way, parts, put, shuffled};
use super::piece::{Company, Rigid};
use super::source::{way_out, with_patience};
use super::tryout::is_clean_where;
use crate::geom::Ground;

/// Places tried for a first patch.
const PLACES: usize = 200;
/// Further patches tried for people to stay together.
const ENCORES: usize = 60;
/// Room that the ends of a patch must have to walls, metres.
const WALL_ROOM: f32 = 0.4;
/// Where time comes round, so many ticks are left for the way back to the first patch.
const HOMEWARD: i32 = 120;
/// Ticks of the first patch that are seen at least.
const SEEN: i32 = 15;

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
#[derive(Clone)]
pub(super) struct Life {
    /// The patches, in order.
    pub pieces: Vec<PieceId>,
    begin: Port,
    /// Where it ends so far.
    pub end: Port,
    /// The first and the last patch of several people.
    pub company: Company,
    /// How many patches lead to where it first meets others, and from where it last does.
    led: [usize; 2],
}

impl Life {
    /// One patch.
    pub fn of(part: &Part, id: PieceId, instance: u32) -> Self {
        let company = Company { from: instance, to: instance };
        Self { pieces: vec![id], begin: part.entry, end: part.exit, company, led: [0; 2] }
    }

    /// The patches that lead to where it meets others.
    fn came(&self) -> &[PieceId] {
        &self.pieces[..self.led[0]]
    }

    /// The patches that lead on from there.
    fn parted(&self) -> &[PieceId] {
        &self.pieces[self.pieces.len() - self.led[1]..]
    }

    /// The tick up to which it may go on together: the end of time, or when it must be on the way to where it began.
    fn latest(&self, domain: &Domain) -> i32 {
        if domain.cycle.loops() { self.begin.tick + domain.cycle.ticks() - HOMEWARD } else { domain.horizon }
    }
}

/// A patch that some people are in.
struct Meeting {
    kind: u32,
    world_from_patch: Ground,
    clock: i32,
    instance: u32,
    parts: Vec<Part>,
}

impl Meeting {
    fn site(&self, next: u32) -> Site {
        Site { world_from_patch: self.world_from_patch, clock: self.clock, ends: [self.instance, next] }
    }
}

/// Adds people who meet as wished, each present over the whole time.
pub(super) fn gather(
    draft: &mut Draft,
    passages: &Passages,
    wish: Wish,
    taste: Taste,
    rng: &mut ChaCha8Rng,
) -> Option<()> {
    let meeting = (0..PLACES).find_map(|_| place(draft, wish, rng))?;
    let lives = live(draft, passages, meeting, wish, taste, rng)?;
    // Passages are known to be clean, so that only what leads to and from them is new, and what time cuts off.
    let horizon = draft.base.domain.horizon;
    let [mut early, mut late]: [Vec<PieceId>; 2] = Default::default();
    for life in lives {
        early.extend(life.came().iter().chain(life.pieces.iter().filter(|&&id| draft.piece(id).begin < 0)));
        late.extend(life.parted().iter().chain(life.pieces.iter().filter(|&&id| draft.piece(id).end > horizon)));
        draft.push_track(life.pieces);
    }
    let is_clean = is_clean_where(draft, |id| early.contains(&id)) && is_clean_where(draft, |id| late.contains(&id));
    is_clean.then_some(())
}

/// The lives of new people who are at a meeting: they come, stay together as long as wished, and part.
fn live(
    draft: &mut Draft,
    passages: &Passages,
    mut meeting: Meeting,
    wish: Wish,
    taste: Taste,
    rng: &mut ChaCha8Rng,
) -> Option<Vec<Life>> {
    let ids = draft.add_patch(meeting.parts.iter().map(|p| (p.role, p.entry)))?;
    meeting.instance = draft.piece(ids[0]).instance;
    let mut lives: Vec<Life> =
        meeting.parts.iter().zip(ids).map(|(part, id)| Life::of(part, id, meeting.instance)).collect();
    come_together(draft, passages, &meeting, &mut lives, rng)?;
    let together = time_together(&meeting.parts, draft.base.domain);
    let mut together_from = Together { passages, wish, tries: ENCORES };
    let mut lives = together_from.on(draft, meeting, lives, together, rng)?;
    for life in &mut lives {
        come(draft, life, taste, rng)?;
    }
    for life in &mut lives {
        part(draft, life, taste, rng)?;
    }
    Some(lives)
}

/// Ticks of a patch within the domain's time, on average over its people.
fn time_together(parts: &[Part], domain: &Domain) -> i32 {
    let ticks = |p: &Part| domain.seen(p.entry.tick, p.exit.tick).len() as i32;
    parts.iter().map(ticks).sum::<i32>() / parts.len() as i32
}

/// The first patch at some place and time that leaves room for what is to follow, if it is free there.
fn place(draft: &Draft, wish: Wish, rng: &mut ChaCha8Rng) -> Option<Meeting> {
    let (library, domain) = (draft.base.library, draft.base.domain);
    let position =
        Vec2::new(rng.random_range(domain.min.x..domain.max.x), rng.random_range(domain.min.y..domain.max.y));
    let world_from_patch = Ground::new(position, rng.random_range(-PI..PI));
    let longest = library.roles_of(wish.kind).map(|r| library.roles[r as usize].ticks).max()?;
    let earliest = if domain.cycle.loops() { 0 } else { SEEN - longest };
    let latest = if domain.cycle.loops() { domain.horizon } else { domain.horizon - SEEN - wish.together };
    let clock = rng.random_range(earliest..latest.max(earliest + 1));
    if !library.preference.is_wanted_there(wish.kind, domain.stay(world_from_patch, clock.max(0)), rng) {
        return None;
    }
    let parts = parts(library, wish.kind, world_from_patch, clock);
    let meeting = Meeting { kind: wish.kind, world_from_patch, clock, instance: NO_INSTANCE, parts };
    is_free(draft, &meeting.parts).then_some(meeting)
}

fn is_free(draft: &Draft, parts: &[Part]) -> bool {
    let (library, domain) = (draft.base.library, draft.base.domain);
    let room = |p: &Port| domain.is_unseen(p.tick) || domain.holds(Spot::ground(p.tick), p.at.position, WALL_ROOM);
    let rigid = |p: &Part| Rigid::new(library, p.role, p.entry.at, p.entry.tick);
    let view = draft.view();
    parts.iter().all(|p| room(&p.entry) && room(&p.exit))
        && parts.iter().all(|p| view.is_free_rigid(p.role, rigid(p), Company::NONE))
}

/// How people stay together and part: a search in depth, since whoever goes on anyhow soon is where nothing leads on.
struct Together<'p> {
    passages: &'p Passages<'p>,
    wish: Wish,
    /// Patches that may still be tried.
    tries: usize,
}

impl Together<'_> {
    /// The lives of people who have been together for some ticks, until they have parted.
    fn on(
        &mut self,
        draft: &mut Draft,
        meeting: Meeting,
        lives: Vec<Life>,
        together: i32,
        rng: &mut ChaCha8Rng,
    ) -> Option<Vec<Life>> {
        let (library, domain) = (draft.base.library, draft.base.domain);
        let is_late = lives.iter().any(|l| l.end.tick >= l.latest(domain) - SEEN);
        if together < self.wish.together && !is_late {
            for passage in shuffled(library, self.passages.of(meeting.kind, Way::Stay), rng) {
                let mark = draft.mark();
                let Some((next, lives)) = self.go_on(draft, passage, &meeting, &lives, rng) else { continue };
                let together = together + time_together(&next.parts, domain);
                if let Some(lives) = self.on(draft, next, lives, together, rng) {
                    return Some(lives);
                }
                draft.rewind(mark);
            }
        }
        if together < self.wish.least { None } else { part_ways(draft, self.passages, &meeting, lives, rng) }
    }

    /// Leads the people into another patch together.
    fn go_on(
        &mut self,
        draft: &mut Draft,
        passage: &Passage,
        meeting: &Meeting,
        lives: &[Life],
        rng: &mut ChaCha8Rng,
    ) -> Option<(Meeting, Vec<Life>)> {
        let (library, domain) = (draft.base.library, draft.base.domain);
        let encore = passage.encore.expect("people go on");
        let parts = encore.parts(library, meeting.world_from_patch, meeting.clock);
        let (kind, stay) = (encore.kind, domain.stay(parts[0].entry.at, parts[0].entry.tick));
        let latest = lives.iter().map(|l| l.latest(domain)).min()?;
        let too_late = domain.cycle.loops() && parts.iter().any(|p| p.exit.tick > latest);
        if too_late || !library.preference.is_wanted_there(kind, stay, rng) || !is_free(draft, &parts) {
            return None;
        }
        self.tries = self.tries.checked_sub(1)?;
        let mark = draft.mark();
        let ids = draft.add_patch(parts.iter().map(|p| (p.role, p.entry)))?;
        let instance = draft.piece(ids[0]).instance;
        let Some(ways) = put(draft, passage, meeting.site(instance), |_, _| true) else {
            draft.rewind(mark);
            return None;
        };
        let mut lives = lives.to_vec();
        lives.iter_mut().zip(ways).for_each(|(life, way)| life.pieces.extend(way));
        // In the order of the roles that they play now.
        lives.rotate_left(encore.first as usize);
        for (life, (&id, part)) in lives.iter_mut().zip(ids.iter().zip(&parts)) {
            life.pieces.push(id);
            (life.end, life.company.to) = (part.exit, instance);
        }
        let lead = &library.roles[parts[0].role as usize];
        let world_from_patch = parts[0].entry.at.then(lead.entry.inverse());
        Some((Meeting { kind, world_from_patch, clock: parts[0].entry.tick - lead.begin, instance, parts }, lives))
    }
}

/// Puts in how the people come to their first patch, those who are not in it from the beginning.
fn come_together(
    draft: &mut Draft,
    passages: &Passages,
    meeting: &Meeting,
    lives: &mut [Life],
    rng: &mut ChaCha8Rng,
) -> Option<()> {
    let (library, loops) = (draft.base.library, draft.base.domain.cycle.loops());
    let comes: Vec<bool> = lives.iter().map(|l| loops || l.begin.tick > 0).collect();
    if !comes.contains(&true) {
        return Some(());
    }
    let ways = shuffled(library, passages.of(meeting.kind, Way::Come), rng).into_iter().find_map(|passage| {
        put(draft, passage, meeting.site(NO_INSTANCE), |role, piece| comes[role] && (loops || piece.end > 0))
    })?;
    for (life, way) in lives.iter_mut().zip(ways) {
        if let Some(&first) = way.first() {
            life.begin = draft.base.library.entry_of(draft.piece(first));
            life.company.from = NO_INSTANCE;
        }
        life.pieces.splice(..0, way);
    }
    Some(())
}

/// Puts in how they part after their last one.
fn part_ways(
    draft: &mut Draft,
    passages: &Passages,
    meeting: &Meeting,
    mut lives: Vec<Life>,
    rng: &mut ChaCha8Rng,
) -> Option<Vec<Life>> {
    let (library, loops, horizon) = (draft.base.library, draft.base.domain.cycle.loops(), draft.base.domain.horizon);
    let parts: Vec<bool> = lives.iter().map(|l| loops || l.end.tick < horizon).collect();
    if !parts.contains(&true) {
        return Some(lives);
    }
    let ways = shuffled(library, passages.of(meeting.kind, Way::Part), rng).into_iter().find_map(|passage| {
        put(draft, passage, meeting.site(NO_INSTANCE), |role, piece| parts[role] && (loops || piece.begin < horizon))
    })?;
    for (life, way) in lives.iter_mut().zip(ways) {
        if let Some(&last) = way.last() {
            life.end = draft.base.library.exit_of(draft.piece(last));
            life.company.to = NO_INSTANCE;
        }
        life.pieces.extend(way);
    }
    Some(lives)
}

/// Leads somebody from the beginning of time to their first patch.
pub(super) fn come(draft: &mut Draft, life: &mut Life, taste: Taste, rng: &mut ChaCha8Rng) -> Option<()> {
    if life.begin.tick > 0 && !draft.base.domain.cycle.loops() {
        let company = Company { to: life.company.from, ..Company::NONE };
        let way = lead(draft, life.begin, Goal::Since(0), company, taste, rng)?;
        life.led[0] = way.len();
        life.pieces.splice(..0, way);
    }
    Some(())
}

/// Leads somebody from their last patch to the end of time, or out, or round to their first one.
pub(super) fn part(draft: &mut Draft, life: &mut Life, taste: Taste, rng: &mut ChaCha8Rng) -> Option<()> {
    let horizon = draft.base.domain.horizon;
    let way = if draft.base.domain.cycle.loops() {
        let company = Company { from: life.company.to, to: life.company.from };
        let mut tries = [Company::NONE, company].into_iter();
        tries.find_map(|company| draft.come_round(life.end, life.begin, company, taste, rng))?
    } else if life.end.tick < horizon {
        let company = Company { from: life.company.to, ..Company::NONE };
        let goal = way_out(draft, life.end, rng);
        lead(draft, life.end, goal, company, with_patience(taste, goal), rng)?
    } else {
        vec![]
    };
    life.led[1] = way.len();
    life.pieces.extend(way);
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
