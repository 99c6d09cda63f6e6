//! Ribbons: how people cross an edge of some colour. Chains of walks of one person each, laid rigidly across the border,
//! the same wherever the colour is met. They are far enough from each other, and from those of all edges that may ever
//! be near, that any tiles whose colours agree fit together.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::Vec2;
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::plane::{Across, mix};
use crate::geom::{Ground, Polygon};
use crate::tiling::Scene;
use crate::tiling::bridge::{Bridge, Goal, NO_INSTANCE, Port, Taste};
use crate::tiling::domain::Domain;
use crate::tiling::draft::{Desk, Draft};
use crate::tiling::library::{Library, Move};
use crate::tiling::piece::{Company, Piece, Shift, depth, footprint, world_discs};
use crate::tiling::tracks::Tracks;
use crate::tiling::tryout::is_clean;
use crate::{Error, Result};

/// A ribbon is at least this long, so that what a stitch at one end changes hardly meets what one at the other does, ticks.
const LONG: i32 = 84;
/// Most patches of a ribbon.
const MOST_PIECES: usize = 16;
/// Some linger at the border for up to so many ticks more, so that it is no emptier there than elsewhere.
const LINGERERS: f32 = 0.8;
const LINGER: i32 = 240;
/// How far from the border the middle of a way across is, metres.
const BESIDE: f32 = 0.4;
/// Ticks of a ribbon that are seen at least.
const SEEN: i32 = 20;
/// Who crosses walks faster than this, m/s, and ahead, or stands.
const BRISK: f32 = 0.6;
const ASKEW: f32 = 0.3;
/// How far from straight across people go, radians.
const ASLANT: f32 = 0.5;
/// Room between a ribbon's ends and the border, and between it and the tiles that it does not join, metres.
const END_ROOM: f32 = 0.15;
const SIDE_ROOM: f32 = 0.1;
/// People who cross at the same time are at least this far apart, metres.
const APART: f32 = 0.9;
/// Ticks of a way to and from a ribbon that are kept free of all others.
const LEAD: i32 = 40;
const TASTE: Taste = Taste { calm: 1.0, compact: 0.0, expansions: 60 };
/// Ways across that are tried for each that is wanted.
const TRIES: usize = 2000;

/// So many people per metre of an edge and per person per m^2 stand on it all the time: others keep off it, and it would
/// be seen.
const DWELLERS: f32 = 0.5;
/// How far from the border they stand, how far they move about, metres, and how slow their patches are, m/s.
const NEAR: f32 = 0.35;
const ASTIR: f32 = 0.4;
const CALM: f32 = 0.25;

/// Somebody who crosses an edge whose lower end is at the origin, or stands on it all the time.
pub(super) struct Crossing {
    /// The patches, in order of time.
    pub pieces: Vec<Piece>,
    /// Some way to where it begins and from where it ends that nobody else who crosses an edge is in.
    pub leads: [Vec<Piece>; 2],
    /// True if towards larger coordinates.
    pub forward: bool,
    /// True if they stand.
    dwells: bool,
    across: Across,
    colour: u32,
}

impl Crossing {
    fn all(&self) -> impl Iterator<Item = &Piece> + Clone {
        self.pieces.iter().chain(self.leads.iter().flatten())
    }

    fn meets(&self, other: &Self, by: Vec2, library: &Library) -> bool {
        let moved = other.all().map(|p| p.clone().shifted(Shift { place: by, ticks: 0 }));
        moved.into_iter().any(|q| self.all().any(|p| are_near(p, &q, library)))
    }
}

fn are_near(a: &Piece, b: &Piece, library: &Library) -> bool {
    let until = |p: &Piece| p.shown_from + p.bodies.len() as i32;
    let mut ticks = a.shown_from.max(b.shown_from)..until(a).min(until(b));
    let apart = |tick: i32| match (a.body(tick), b.body(tick)) {
        (Some(a), Some(b)) => a.position.distance(b.position),
        _ => f32::INFINITY,
    };
    ticks.any(|tick| apart(tick) < APART || depth(library, a, b, tick).is_some())
}

/// All ways across all edges.
pub(super) struct Ribbons {
    all: Vec<Crossing>,
}

impl Ribbons {
    /// For so many colours, so many people crossing each edge of a plane whose tiles are `side` metres wide.
    ///
    /// # Errors
    /// There is no room for them.
    pub fn new(library: &Library, one: &Scene, (side, colours, count): (f32, u32, usize), seed: u64) -> Result<Self> {
        let mut ribbons = Self { all: vec![] };
        let walks = walks(library);
        if !walks.iter().any(|m| is_brisk(m)) {
            let problem =
                "expected a kind of one person who walks with empty hands, to cross edges of tiles; found none";
            return Err(Error::invalid("patch set", "kinds", problem));
        }
        let grounds = Grounds::new(one, side)?;
        let drawing = Drawing { library, grounds: &grounds, walks, side };
        for (colour, across) in (0..colours).flat_map(|c| [(c, Across::X), (c, Across::Z)]) {
            let mut rng = ChaCha8Rng::seed_from_u64(mix(mix(seed ^ u64::from(colour)) ^ across as u64));
            for k in 0..count {
                // Who lingers finds room less often: it is settled before.
                let lingers = rng.random_range(0.0..1.0) < LINGERERS;
                let linger = if lingers { rng.random_range(LINGER / 3..LINGER) } else { 0 };
                let draw = |n: usize, rng: &mut ChaCha8Rng| {
                    let length = LONG + if n < TRIES / 2 { linger } else { 0 };
                    drawing.crossing((across, colour), k % 2 == 0, length, rng)
                };
                let fits = |c: &Crossing| ribbons.have_room(c, side, library);
                let found = (0..TRIES).find_map(|n| draw(n, &mut rng).filter(fits));
                ribbons.all.push(found.ok_or_else(|| no_room(side, count))?);
            }
        }
        ribbons.settle(&drawing, one, colours, seed);
        Ok(ribbons)
    }

    /// Lets people stand on all edges, where there is room.
    fn settle(&mut self, drawing: &Drawing, one: &Scene, colours: u32, seed: u64) {
        let density = one.characters as f32 / one.region.area();
        let count = (DWELLERS * density * drawing.side).round() as usize;
        for (colour, across) in (0..colours).flat_map(|c| [(c, Across::X), (c, Across::Z)]) {
            let mut rng = ChaCha8Rng::seed_from_u64(mix(mix(!seed ^ u64::from(colour)) ^ across as u64));
            for _ in 0..count {
                let fits = |c: &Crossing| self.have_room(c, drawing.side, drawing.library);
                let found = (0..TRIES).find_map(|_| drawing.dweller((across, colour), &mut rng).filter(fits));
                self.all.extend(found);
            }
        }
    }

    /// The ways across an edge.
    pub fn of(&self, across: Across, colour: u32) -> impl Iterator<Item = &Crossing> + Clone {
        self.on(across, colour).filter(|c| !c.dwells)
    }

    /// Who stands on an edge.
    pub fn dwellers(&self, across: Across, colour: u32) -> impl Iterator<Item = &Crossing> + Clone {
        self.on(across, colour).filter(|c| c.dwells)
    }

    fn on(&self, across: Across, colour: u32) -> impl Iterator<Item = &Crossing> + Clone {
        self.all.iter().filter(move |c| c.across == across && c.colour == colour)
    }

    /// True if nobody is ever near to one more, whatever colours the edges around have.
    fn have_room(&self, new: &Crossing, side: f32, library: &Library) -> bool {
        let offsets = || (0..9).map(|n| Vec2::new((n % 3 - 1) as f32, (n / 3 - 1) as f32) * side);
        let is_other = |c: &Crossing, by: Vec2| by == Vec2::ZERO && c.across == new.across && c.colour != new.colour;
        let clear = |c: &Crossing| offsets().all(|by| is_other(c, by) || !new.meets(c, by, library));
        let own = offsets().filter(|&by| by != Vec2::ZERO).all(|by| !new.meets(new, by, library));
        own && self.all.iter().all(clear)
    }
}

fn no_room(side: f32, count: usize) -> Error {
    let problem = format!(
        "expected room for {count} people to cross each edge of {side} m without meeting, found none; make tiles larger, \
         or colours or people fewer"
    );
    Error::invalid("scene", "wang", problem)
}

/// True if a move is one of somebody who walks.
fn is_brisk(m: &Move) -> bool {
    m.speed > BRISK && m.askew < ASKEW
}

/// All walks ahead, and what people do who stand, with empty hands.
fn walks<'l>(library: &'l Library) -> Vec<&'l Move> {
    let light = |m: &Move| {
        let role = &library.roles[m.role as usize];
        ![role.entry_group, role.exit_group].iter().any(|&g| library.laden[g as usize])
            && !role.leaves_box()
            && role.leap.is_none()
    };
    let fits = |m: &&Move| (m.speed < BRISK || m.askew < ASKEW) && light(m);
    library.forward.iter().flatten().filter(fits).collect()
}

/// Open ground, and the tiles before and beyond an edge, by axis.
struct Grounds {
    open: Domain,
    tiles: [[Domain; 2]; 2],
}

impl Grounds {
    fn new(one: &Scene, side: f32) -> Result<Self> {
        let domain = |low: Vec2, high: Vec2| {
            Domain::new(&Scene { region: Polygon::rectangle(low * side, high * side), ..one.clone() })
        };
        let tile = |low: Vec2| domain(low, low + 1.0);
        Ok(Self {
            open: domain(Vec2::NEG_ONE, Vec2::splat(2.0))?,
            tiles: [[tile(Vec2::NEG_X)?, tile(Vec2::ZERO)?], [tile(Vec2::NEG_Y)?, tile(Vec2::ZERO)?]],
        })
    }
}

/// What crossings are drawn from.
struct Drawing<'a> {
    library: &'a Library<'a>,
    grounds: &'a Grounds,
    walks: Vec<&'a Move>,
    side: f32,
}

impl Drawing<'_> {
    /// Somebody who crosses somewhere, some time, if that is possible as drawn.
    fn crossing(
        &self,
        (across, colour): (Across, u32),
        forward: bool,
        length: i32,
        rng: &mut ChaCha8Rng,
    ) -> Option<Crossing> {
        let roles = self.chain(length, rng);
        let length: i32 = roles.iter().map(|m| m.ticks).sum();
        let horizon = self.grounds.open.horizon;
        if length < LONG.min(SEEN + horizon) {
            return None;
        }
        let begin = rng.random_range(SEEN - length..(horizon - SEEN).max(SEEN - length + 1));
        let along = rng.random_range(0.0..self.side);
        let aslant = rng.random_range(-ASLANT..ASLANT);
        let way = self.lay(&roles, Ground::IDENTITY, begin);
        // The middle of the way is at the border.
        let middle = way.iter().find(|p| p.end - begin > length / 2)?;
        let middle = middle.path.at(middle.path.len() / 2).position;
        let leads = way.last()?.exit().position;
        let heading = match across {
            Across::X => FRAC_PI_2,
            Across::Z => 0.0,
        };
        let heading = heading + aslant + if forward { 0.0 } else { PI } - leads.x.atan2(leads.y);
        let beside = rng.random_range(-BESIDE..BESIDE);
        let on_border = match across {
            Across::X => Vec2::new(beside, along),
            Across::Z => Vec2::new(along, beside),
        };
        let from = Ground::new(on_border - Ground::new(Vec2::ZERO, heading).apply(middle), heading);
        let mut crossing = Crossing {
            pieces: self.lay(&roles, from, begin),
            leads: Default::default(),
            forward,
            dwells: false,
            across,
            colour,
        };
        if !self.is_across(&crossing) || !self.is_clean(&crossing) {
            return None;
        }
        crossing.leads = self.leads(&crossing, rng)?;
        Some(crossing)
    }

    /// Somebody who stands somewhere on an edge from the beginning of time to its end, if that is possible as drawn.
    fn dweller(&self, (across, colour): (Across, u32), rng: &mut ChaCha8Rng) -> Option<Crossing> {
        let mut chain = vec![*self.walks.iter().filter(|m| m.speed < CALM).copied().collect::<Vec<_>>().choose(rng)?];
        let begin = -rng.random_range(0..chain[0].ticks);
        let mut end = begin + chain[0].ticks;
        while end < self.grounds.open.horizon {
            let group = chain[chain.len() - 1].group;
            let follows = |m: &&&Move| m.speed < CALM && self.library.roles[m.role as usize].entry_group == group;
            let next = *self.walks.iter().filter(follows).collect::<Vec<_>>().choose(rng)?;
            chain.push(next);
            end += next.ticks;
        }
        let (along, beside) = (rng.random_range(0.0..self.side), rng.random_range(-NEAR..NEAR));
        let at = match across {
            Across::X => Vec2::new(beside, along),
            Across::Z => Vec2::new(along, beside),
        };
        let pieces = self.lay(&chain, Ground::new(at, rng.random_range(-PI..PI)), begin);
        let stays = pieces.iter().all(|p| p.exit().position.distance(at) < ASTIR);
        let crossing = Crossing { pieces, leads: Default::default(), forward: true, dwells: true, across, colour };
        (stays && self.is_within(&crossing) && self.is_clean(&crossing)).then_some(crossing)
    }

    /// A way to where a crossing begins, and one from where it ends.
    fn leads(&self, crossing: &Crossing, rng: &mut ChaCha8Rng) -> Option<[Vec<Piece>; 2]> {
        let [lower, upper] = &self.grounds.tiles[crossing.across as usize];
        let (before, beyond) = if crossing.forward { (lower, upper) } else { (upper, lower) };
        let entry = self.library.entry_of(&crossing.pieces[0]);
        let exit = self.library.exit_of(crossing.pieces.last()?);
        let mut lead = |domain: &Domain, from: Port, goal: Goal| {
            let ground = Tracks::on_open_ground(self.library, domain);
            Bridge::default().search(ground.view(), from, goal, Company::NONE, TASTE, rng)
        };
        let horizon = self.grounds.open.horizon;
        let mut leads: [Vec<Piece>; 2] = Default::default();
        if entry.tick > 0 {
            leads[0] = lead(before, entry, Goal::Since((entry.tick - LEAD).max(0)))?;
        }
        if exit.tick < horizon {
            leads[1] = lead(beyond, exit, Goal::Until((exit.tick + LEAD).min(horizon)))?;
        }
        Some(leads)
    }

    /// Walks that follow each other, at least so many ticks long, those in the middle standing if it is longer than needed.
    fn chain(&self, length: i32, rng: &mut ChaCha8Rng) -> Vec<&Move> {
        let mut chain = vec![*self.walks.choose(rng).expect("some walk")];
        let mut ticks = chain[0].ticks;
        while ticks < length && chain.len() < MOST_PIECES {
            let group = chain[chain.len() - 1].group;
            // People stand on the border, not before and after it.
            let stands = length > LONG && (LONG / 2..length - LONG / 2).contains(&ticks);
            let follows = |m: &&&Move| self.library.roles[m.role as usize].entry_group == group;
            let all: Vec<&Move> = self.walks.iter().filter(follows).copied().collect();
            let liked: Vec<&Move> = all.iter().filter(|m| is_brisk(m) != stands).copied().collect();
            let Some(&next) = liked.choose(rng).or_else(|| all.choose(rng)) else { break };
            chain.push(next);
            ticks += next.ticks;
        }
        chain
    }

    fn lay(&self, roles: &[&Move], mut from: Ground, mut begin: i32) -> Vec<Piece> {
        let mut pieces = Vec::new();
        for step in roles {
            let piece = Piece::rigid(self.library, &self.grounds.open, step.role, NO_INSTANCE, from, begin);
            (from, begin) = (piece.exit(), piece.end);
            pieces.push(piece);
        }
        pieces
    }

    /// True if it begins on one side and ends on the other, and comes to no other tiles than these two.
    fn is_across(&self, crossing: &Crossing) -> bool {
        let sign = if crossing.forward { 1.0 } else { -1.0 };
        let beyond = |place: Vec2| split(place, crossing.across).1 * sign;
        let last = crossing.pieces.len() - 1;
        let (entry, exit) = (crossing.pieces[0].entry(), crossing.pieces[last].exit());
        let reach = self.library.max_reach.min(0.6) + END_ROOM;
        beyond(entry.position) < -reach && beyond(exit.position) > reach && self.is_within(crossing)
    }

    /// True if it comes to no other tiles than the two that the edge joins.
    fn is_within(&self, crossing: &Crossing) -> bool {
        let sides = |along: f32, room: f32| along > room && along < self.side - room;
        let inside = |piece: &Piece| {
            piece.bodies.iter().all(|body| {
                let discs = world_discs(body, footprint(self.library, piece.role, body));
                discs.iter().all(|d| {
                    let (along, depth) = split(d.truncate(), crossing.across);
                    sides(along, d.z + SIDE_ROOM) && depth.abs() + d.z < self.side * 0.5
                })
            })
        };
        crossing.pieces.iter().all(inside)
    }

    /// True if it is walked as people can.
    fn is_clean(&self, crossing: &Crossing) -> bool {
        let mut desk = Desk::default();
        let ground = Tracks::on_open_ground(self.library, &self.grounds.open);
        let mut draft = Draft::new(&ground, &mut desk);
        let ids = crossing.pieces.iter().map(|p| draft.add(p.clone())).collect();
        draft.push_track(ids);
        is_clean(&draft)
    }
}

/// How far along an edge, and beyond it, a place is.
fn split(place: Vec2, across: Across) -> (f32, f32) {
    match across {
        Across::X => (place.y, place.x),
        Across::Z => (place.x, place.y),
    }
}
