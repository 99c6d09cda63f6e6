//! Visits: people who come in over the border of a small place whose time comes round, meet, and go out over another border
//! on time.
//!
//! Where and when they cross is given, as ports: a walk of one person is laid rigidly across the border, so that it is there at
//! the moment, that way, about as fast. Then patches of several people are put in, and bridges lead from the borders to them and from them to other borders, to the tick. Who leads to whom is open, so that what
//! does not fit is tried with somebody else; who meets nobody goes straight across. All is seen modulo the period: whoever
//! comes a lap later keeps clear of whoever is still there.

use glam::Vec2;
use rand::seq::{IndexedRandom, SliceRandom};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::bake::uses;
use super::bridge::{Goal, NO_INSTANCE, Port, Taste};
use super::demands::check_set;
use super::domain::Domain;
use super::draft::{Desk, Draft};
use super::faults::{Haste, captured_depth};
use super::figure::{Figure, TOLERANCE};
use super::library::{Library, Move};
use super::occupancy::PieceId;
use super::passage::{Part, parts};
use super::piece::{Company, Piece, Shift};
use super::rehearsal::segments;
use super::tracks::Tracks;
use super::{Periodic, Scene};
use crate::deform::Limits;
use crate::geom::{Ground, Polygon, Torus};
use crate::motion::{FPS, canonical};
use crate::patch::{PatchKind, PatchSet};
use crate::refine::{Body, refine_all};

/// Whoever crosses a border walks faster than this, m/s, ahead, and turns no more than this, radians.
const BRISK: f32 = 0.6;
const ASKEW: f32 = 0.2;
const STRAIGHT: f32 = 0.12;
/// The walk across a border lasts so many ticks, and is at the border after this part of it when coming in.
const CROSSING: std::ops::RangeInclusive<i32> = 26..=64;
const EARLY: f32 = 0.3;
/// Beginnings from scratch, and places that are tried for a meeting.
const BEGINNINGS: u64 = 24;
const PLACES: usize = 600;
/// People of a meeting are led from and to so many crossings at most before it is given up.
const CROSSINGS: usize = 3;
/// Mean speeds on the way between crossings and meetings, m/s, and seconds that may be spent besides.
const PACE: [f32; 2] = [0.65, 1.35];
const SPARE: f32 = 2.0;
/// Where people meet is so far inside, metres.
const INSIDE: f32 = 1.5;
const TASTE: Taste = Taste { calm: 1.0, compact: 0.0, expansions: 500 };
/// Joints may turn this much faster than in the captures.
const RUSH: f32 = 1.2;
/// Kinds whose people are deeper in each other than this are left out, metres: captured bodies were thinner than ours.
const EMBRACE: f32 = 0.06;

/// Somebody crosses the border once per period.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// Where, metres.
    pub place: Vec2,
    /// Which way and how fast, m/s.
    pub velocity: Vec2,
    /// When, seconds.
    pub secs: f32,
    /// Over which edge: nobody leaves by the one that they came by.
    pub edge: usize,
}

/// A place to be filled.
pub(crate) struct Place<'a> {
    /// Everybody stays inside, but for the crossings.
    pub outline: &'a Polygon,
    /// Seconds after which it repeats.
    pub period: f32,
    /// Who comes in.
    pub comes: &'a [Crossing],
    /// Who goes out; as many.
    pub goes: &'a [Crossing],
}

/// Somebody's way through the place.
pub(crate) struct Visit {
    /// Which of those who come in.
    pub comes: usize,
    /// Which of those who go out.
    pub goes: usize,
    /// How many periods later than the period it came in that is.
    pub laps: u32,
    /// When its first frame is, seconds since the begin of the period it comes in.
    pub begin: f32,
    /// The final body, from before it comes in until after it goes out.
    pub body: Body,
}

/// Somebody's pieces: `ids` in order of time, led to laps earlier and from laps later than the crossings' own.
struct Life {
    comes: usize,
    goes: usize,
    shifts: [i32; 2],
    ids: Vec<PieceId>,
}

/// The kinds of a set that visitors can play.
pub(crate) fn playable(set: &PatchSet, meant: impl Fn(&PatchKind) -> bool) -> PatchSet {
    let odd = |k: &PatchKind| k.labels.iter().any(|l| l == "jump" || l == "hop" || l == "staged");
    set.only(|k| k.props.is_empty() && !odd(k) && (k.people() == 1 || (meant(k) && depth(k) < EMBRACE)))
}

/// How deep the people of a kind are in each other at most, metres.
fn depth(kind: &PatchKind) -> f32 {
    let mut globals = Vec::new();
    let ends = kind.fragments.iter().map(|f| f.begin + f.motion.len() as u32);
    let deepest = (0..ends.max().unwrap_or(0)).map(|clock| {
        let there = kind.fragments.iter().filter_map(|f| {
            let frame = clock.checked_sub(f.begin)? as usize;
            (frame < f.motion.len()).then(|| {
                f.motion.globals(frame, &mut globals);
                Figure::new(&globals)
            })
        });
        let figures: Vec<Figure> = there.collect();
        let pairs = figures.iter().enumerate().flat_map(|(i, a)| figures[..i].iter().map(move |b| a.depth_into(b)));
        pairs.fold(0.0, f32::max)
    });
    deepest.fold(0.0, f32::max)
}

/// Fills a place; `None` if no way was found for everybody. The same seed gives the same visits.
pub(crate) fn visits(place: &Place, set: &PatchSet, seed: u64) -> Option<Vec<Visit>> {
    check_set(set).ok()?;
    let library = Library::new(set, Limits::TIGHT);
    let scene = Scene::new(place.outline.clone(), place.period, 0);
    let looped = Scene { periodic: Periodic { t: true, ..Periodic::default() }, ..scene.clone() };
    let domain = Domain::new(&looped).ok()?;
    (0..BEGINNINGS).find_map(|again| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed.wrapping_add(again.wrapping_mul(0x9e37_79b9_7f4a_7c15)));
        let crossings = lay_all(place, &library, &domain, &mut rng)?;
        let hosting = Hosting { place, crossings: &crossings, lap: domain.horizon };
        hosting.visits(&library, &domain, &scene, &mut rng)
    })
}

/// The walks across the border: of who comes in, of who goes out.
fn lay_all(place: &Place, library: &Library, domain: &Domain, rng: &mut ChaCha8Rng) -> Option<[Vec<Piece>; 2]> {
    let walks: Vec<&Move> = library.forward.iter().flatten().filter(|m| is_across(m)).collect();
    let mut lay = |crossings: &[Crossing], share: f32| -> Option<Vec<Piece>> {
        crossings.iter().map(|c| lay(c, share, &walks, library, domain, rng)).collect()
    };
    Some([lay(place.comes, EARLY)?, lay(place.goes, 1.0 - EARLY)?])
}

fn is_across(m: &Move) -> bool {
    m.speed > BRISK && m.askew < ASKEW && m.to.heading.abs() < STRAIGHT && CROSSING.contains(&m.ticks)
}

/// A walk that is at a crossing when and as it should, its speed among the three nearest to the crossing's.
fn lay(
    crossing: &Crossing,
    share: f32,
    walks: &[&Move],
    library: &Library,
    domain: &Domain,
    rng: &mut ChaCha8Rng,
) -> Option<Piece> {
    let mut walks = walks.to_vec();
    let off = |m: &Move| (m.speed - crossing.velocity.length()).abs();
    walks.sort_by(|a, b| off(a).total_cmp(&off(b)));
    let best = off(walks.first()?);
    let near: Vec<&Move> = walks.into_iter().take_while(|m| off(m) < best + 0.05).collect();
    let role = near.choose(rng)?.role;
    let path = &library.roles[role as usize].path;
    let last = (path.points.len() - 1) as f32;
    let when = crossing.secs * FPS;
    let begin = (when - share * last).round();
    let at = (when - begin).clamp(0.0, last - 1e-3);
    let here = path.points[at as usize].lerp(path.points[at as usize + 1], at.fract());
    let along = path.points[path.points.len() - 1] - path.points[0];
    let heading = crossing.velocity.x.atan2(crossing.velocity.y) - along.x.atan2(along.y);
    let from = Ground::new(crossing.place - Ground::new(Vec2::ZERO, heading).apply(here), heading);
    Some(Piece::rigid(library, domain, role, NO_INSTANCE, from, begin as i32))
}

/// Who comes, who goes, and what there is to do.
struct Hosting<'a> {
    place: &'a Place<'a>,
    crossings: &'a [Vec<Piece>; 2],
    /// Ticks of a period.
    lap: i32,
}

/// Crossings that nobody uses yet: of who comes, of who goes.
type Open = [Vec<usize>; 2];

impl Hosting<'_> {
    fn visits(&self, library: &Library, domain: &Domain, scene: &Scene, rng: &mut ChaCha8Rng) -> Option<Vec<Visit>> {
        let mut tracks = Tracks::new(library, domain);
        let _ = tracks.fix(self.crossings.iter());
        let mut desk = Desk::default();
        let mut draft = Draft::new(&tracks, &mut desk);
        let lives = self.lives(&mut draft, rng)?;
        let chains: Vec<Vec<Piece>> = lives.iter().map(|life| self.chain(&draft, life)).collect();
        let bodies = played(library, scene, &chains)?;
        self.are_clean(library, domain, &chains, &bodies).then(|| {
            lives.iter().zip(chains).zip(bodies).map(|((life, chain), body)| self.visit(life, &chain, body)).collect()
        })
    }

    /// Lives of all who come: as many as possible meet, the others go straight across.
    fn lives(&self, draft: &mut Draft, rng: &mut ChaCha8Rng) -> Option<Vec<Life>> {
        let mut open: Open = self.crossings.each_ref().map(|all| (0..all.len()).collect());
        let mut lives = Vec::new();
        let kinds = &draft.base.library.multi;
        for _ in 0..PLACES {
            let fitting: Vec<u32> =
                kinds.iter().copied().filter(|&k| draft.base.library.roles_of(k).len() <= open[0].len()).collect();
            let Some(&kind) = fitting.choose(rng) else { break };
            let mark = draft.mark();
            match self.meeting(draft, kind, &open, rng) {
                Some(met) => {
                    open[0].retain(|i| met.iter().all(|life| life.comes != *i));
                    open[1].retain(|i| met.iter().all(|life| life.goes != *i));
                    lives.extend(met);
                }
                None => draft.rewind(mark),
            }
        }
        if lives.is_empty() {
            return None;
        }
        open.iter_mut().for_each(|list| list.shuffle(rng));
        while let Some(comes) = open[0].pop() {
            let (place, life) =
                (0..open[1].len()).find_map(|k| Some((k, self.passer(draft, comes, open[1][k], rng)?)))?;
            open[1].remove(place);
            lives.push(life);
        }
        Some(lives)
    }

    /// Somebody who meets nobody.
    fn passer(&self, draft: &mut Draft, comes: usize, goes: usize, rng: &mut ChaCha8Rng) -> Option<Life> {
        if self.place.comes[comes].edge == self.place.goes[goes].edge {
            return None;
        }
        let library = draft.base.library;
        let from = library.exit_of(&self.crossings[0][comes]);
        let to = library.entry_of(&self.crossings[1][goes]);
        let lap = self.late(from, to)?;
        let ids = draft.search(from, Goal::Port(later(to, lap)), Company::NONE, TASTE, rng)?;
        Some(Life { comes, goes, shifts: [0, lap], ids })
    }

    /// By how many ticks (whole laps) `to` must be later, so that a person gets there from `from` at an easy pace.
    fn late(&self, from: Port, to: Port) -> Option<i32> {
        let far = from.at.position.distance(to.at.position);
        let (least, most) = (far / PACE[1], far / PACE[0] + SPARE);
        let least_ticks = (least * FPS).ceil() as i32;
        let ticks = least_ticks + (to.tick - from.tick - least_ticks).rem_euclid(self.lap);
        (ticks as f32 <= most * FPS).then_some(ticks - (to.tick - from.tick))
    }

    /// Some who meet somewhere, led from crossings that are open to others.
    fn meeting(&self, draft: &mut Draft, kind: u32, open: &Open, rng: &mut ChaCha8Rng) -> Option<Vec<Life>> {
        let (library, domain) = (draft.base.library, draft.base.domain);
        let range = |low: f32, high: f32, rng: &mut ChaCha8Rng| low + (high - low) * rng.random::<f32>();
        let at = Vec2::new(
            range(domain.min.x + INSIDE, domain.max.x - INSIDE, rng),
            range(domain.min.y + INSIDE, domain.max.y - INSIDE, rng),
        );
        let at = Ground::new(at, range(-std::f32::consts::PI, std::f32::consts::PI, rng));
        let clock = rng.random_range(0..self.lap);
        let roles = parts(library, kind, at, clock);
        // Before anything is searched: everybody must have somewhere to come from and to go to.
        let hopeful = |p: &Part| {
            !self.ways_in(draft, p, open).is_empty() && !self.ways_out(draft, p, open, usize::MAX).is_empty()
        };
        if !roles.iter().all(hopeful) {
            return None;
        }
        let ids = draft.add_patch(roles.iter().map(|p| (p.role, p.entry)))?;
        let instance = draft.piece(ids[0]).instance;
        let (mut open, mut lives) = (open.clone(), Vec::new());
        for (part, &id) in roles.iter().zip(&ids) {
            let life = self.visitor(draft, (part, id, instance), &open, rng)?;
            open[0].retain(|&i| i != life.comes);
            open[1].retain(|&i| i != life.goes);
            lives.push(life);
        }
        Some(lives)
    }

    /// Leads somebody from an open crossing to a role, and from there to another crossing.
    fn visitor(
        &self,
        draft: &mut Draft,
        (part, id, instance): (&Part, PieceId, u32),
        open: &Open,
        rng: &mut ChaCha8Rng,
    ) -> Option<Life> {
        let arriving = Company { to: instance, ..Company::NONE };
        let (comes, early, way_in) = self.ways_in(draft, part, open).into_iter().find_map(|(i, lap)| {
            let from = later(draft.base.library.exit_of(&self.crossings[0][i]), lap);
            Some((i, lap, draft.search(from, Goal::Port(part.entry), arriving, TASTE, rng)?))
        })?;
        let parting = Company { from: instance, ..Company::NONE };
        let edge = self.place.comes[comes].edge;
        let (goes, late, way_out) = self.ways_out(draft, part, open, edge).into_iter().find_map(|(i, lap)| {
            let to = later(draft.base.library.entry_of(&self.crossings[1][i]), lap);
            Some((i, lap, draft.search(part.exit, Goal::Port(to), parting, TASTE, rng)?))
        })?;
        let ids = [way_in, vec![id], way_out].concat();
        Some(Life { comes, goes, shifts: [early, late], ids })
    }

    /// Open crossings from which somebody gets to a role at an easy pace, and how many ticks (whole laps) later they are then.
    fn ways_in(&self, draft: &Draft, part: &Part, open: &Open) -> Vec<(usize, i32)> {
        let from = |i: usize| draft.base.library.exit_of(&self.crossings[0][i]);
        let ways = open[0].iter().filter_map(|&i| Some((i, -self.late(from(i), part.entry)?)));
        ways.take(CROSSINGS).collect()
    }

    /// The same from a role on, not back over the edge that somebody came by.
    fn ways_out(&self, draft: &Draft, part: &Part, open: &Open, edge: usize) -> Vec<(usize, i32)> {
        let to = |i: usize| draft.base.library.entry_of(&self.crossings[1][i]);
        let others = open[1].iter().filter(|&&i| self.place.goes[i].edge != edge);
        others.filter_map(|&i| Some((i, self.late(part.exit, to(i))?))).take(CROSSINGS).collect()
    }

    /// All pieces of a life, the crossings included, on one clock.
    fn chain(&self, draft: &Draft, life: &Life) -> Vec<Piece> {
        let shift = |piece: &Piece, ticks: i32| piece.clone().shifted(Shift { place: Vec2::ZERO, ticks });
        let first = shift(&self.crossings[0][life.comes], life.shifts[0]);
        let last = shift(&self.crossings[1][life.goes], life.shifts[1]);
        let between = life.ids.iter().map(|&id| draft.piece(id).clone());
        std::iter::once(first).chain(between).chain([last]).collect()
    }

    /// True if everybody moves as people can, and nobody runs into anybody else, nor into whoever comes laps later.
    fn are_clean(&self, library: &Library, domain: &Domain, chains: &[Vec<Piece>], bodies: &[Body]) -> bool {
        let haste = Haste::new(library, RUSH);
        let sound = |b: &Body| b.strained.is_empty() && !(1..b.root.len()).any(|f| haste.is_exceeded(b, f));
        let laps = 1 + bodies.iter().map(|b| b.root.len() as i32).max().unwrap_or(0) / self.lap;
        let pairs = (0..bodies.len()).flat_map(|i| (0..=i).map(move |j| (i, j)));
        bodies.iter().all(sound)
            && pairs.into_iter().all(|(i, j)| {
                let from = if i == j { 1 } else { -2 * laps };
                (from..=2 * laps)
                    .all(|lap| self.are_apart(library, domain, [&chains[i], &chains[j]], [&bodies[i], &bodies[j]], lap))
            })
    }

    /// True if two people are never deeper in each other than they were captured, the second `lap` periods later.
    fn are_apart(
        &self,
        library: &Library,
        domain: &Domain,
        chains: [&Vec<Piece>; 2],
        [a, b]: [&Body; 2],
        lap: i32,
    ) -> bool {
        let shift = lap * self.lap;
        let (from, to) = (a.begin as i32, a.begin as i32 + a.root.len() as i32);
        let ticks = from.max(b.begin as i32 + shift)..to.min(b.begin as i32 + b.root.len() as i32 + shift);
        ticks.into_iter().all(|tick| {
            let places =
                [(a, tick), (b, tick - shift)].map(|(body, tick)| body.root[(tick - body.begin as i32) as usize]);
            if places[0].distance_squared(places[1]) > 4.9 {
                return true;
            }
            let figure = |body: &Body, tick: i32| Figure::of(body, canonical(), tick).expect("within its frames");
            let depth = figure(a, tick).depth_into(&figure(b, tick - shift));
            let piece = |chain: &'_ Vec<Piece>| chain.iter().position(|p| tick < p.end + START);
            let together = || match (piece(chains[0]), piece(chains[1])) {
                (Some(p), Some(q)) if lap == 0 => {
                    let pieces = [Some(&chains[0][p]), Some(&chains[1][q])];
                    captured_depth(library, domain, pieces, tick - START)
                }
                _ => 0.0,
            };
            depth <= TOLERANCE || depth <= TOLERANCE + together()
        })
    }

    fn visit(&self, life: &Life, chain: &[Piece], body: Body) -> Visit {
        let laps = (life.shifts[1] - life.shifts[0]) / self.lap;
        debug_assert!(chain.windows(2).all(|w| w[0].end == w[1].begin), "pieces follow each other");
        // Bodies were played on a clock that is ahead.
        let first = body.begin as i32 - START - life.shifts[0];
        Visit { comes: life.comes, goes: life.goes, laps: laps.max(0) as u32, begin: first as f32 / FPS, body }
    }
}

fn later(port: Port, ticks: i32) -> Port {
    Port { tick: port.tick + ticks, ..port }
}

/// Bodies are played on a clock that is ahead by so many ticks, so that nothing is before its beginning.
const START: i32 = 3000;

/// The final bodies of people on one clock, in time that does not come round.
fn played(library: &Library, scene: &Scene, chains: &[Vec<Piece>]) -> Option<Vec<Body>> {
    let last = chains.iter().flatten().map(|p| p.end).max()? + START + 30;
    let domain = Domain::new(&Scene { duration_secs: last as f32 / FPS, ..scene.clone() }).ok()?;
    let ahead = |piece: &Piece| piece.clone().shifted(Shift { place: Vec2::ZERO, ticks: START });
    let chains: Vec<Vec<Piece>> = chains.iter().map(|chain| chain.iter().map(ahead).collect()).collect();
    let all: Vec<_> = chains.iter().map(|chain| uses(library, &domain, chain.iter())).collect();
    let people: Vec<_> = all.iter().map(|uses| segments(uses)).collect();
    Some(refine_all(&people, last as u32, Torus::default()).bodies)
}
