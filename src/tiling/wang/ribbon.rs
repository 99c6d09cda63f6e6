//! Ribbons: how people cross an edge of some colour. Chains of walks of one person each, laid rigidly across the border,
//! the same wherever the colour is met. They are far enough from each other, and keep within the square whose corners are the
//! edge's ends and the middles of the tiles that it joins, so that any tiles whose colours agree fit together.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::Vec2;
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::plane::Across;
use crate::geom::{Ground, Polygon};
use crate::tiling::Scene;
use crate::tiling::bridge::{Bridge, Goal, NO_INSTANCE, Port, Taste};
use crate::tiling::domain::Domain;
use crate::tiling::draft::{Desk, Draft};
use crate::tiling::library::{Library, Move};
use crate::tiling::piece::{Company, Piece, depth};
use crate::tiling::tracks::Tracks;
use crate::tiling::tryout::is_clean;
use crate::{Error, Result};

/// A ribbon is at least this long, so that what a stitch at one end changes hardly meets what one at the other does, ticks.
const LONG: i32 = 84;
/// Most patches of a ribbon.
const MOST_PIECES: usize = 16;
/// How far from the border the middle of a way across is, metres.
const BESIDE: f32 = 0.4;
/// Ticks of a ribbon that are seen at least.
const SEEN: i32 = 20;
/// Who crosses walks faster than this, m/s, and ahead.
const BRISK: f32 = 0.6;
const ASKEW: f32 = 0.3;
/// How far from straight across people go, radians.
const ASLANT: f32 = 0.5;
/// Room between a ribbon's ends and the border, metres.
const END_ROOM: f32 = 0.15;
/// People who cross at the same time are at least this far apart, metres.
const APART: f32 = 0.9;
/// Ticks of a way to and from a ribbon that are kept free of all others.
const LEAD: i32 = 40;
const TASTE: Taste = Taste { calm: 1.0, compact: 0.0, expansions: 60 };
/// Ways across that are tried for each that is wanted.
const TRIES: usize = 2000;

/// Somebody who crosses an edge whose lower end is at the origin.
pub(super) struct Crossing {
    /// The patches, in order of time.
    pub pieces: Vec<Piece>,
    /// Some way to where it begins and from where it ends that nobody else who crosses an edge is in.
    pub leads: [Vec<Piece>; 2],
    /// True if towards larger coordinates.
    pub forward: bool,
}

impl Crossing {
    /// The patches and the ways to and from them.
    pub fn all(&self) -> impl Iterator<Item = &Piece> + Clone {
        self.pieces.iter().chain(self.leads.iter().flatten())
    }

    fn meets(&self, other: &Self, library: &Library) -> bool {
        self.all().any(|p| other.all().any(|q| are_near(p, q, library)))
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

/// So many ways across an edge of a plane of tiles each like `one`, `side` metres wide: as many one way as the other.
///
/// # Errors
/// There is no room for them.
pub(super) fn ribbons(
    library: &Library,
    one: &Scene,
    (across, side, count): (Across, f32, usize),
    seed: u64,
) -> Result<Vec<Crossing>> {
    let (walks, others): (Vec<&Move>, Vec<&Move>) = light_moves(library).into_iter().partition(|m| is_brisk(m));
    if walks.is_empty() {
        let problem = "expected a kind of one person who walks with empty hands, to cross edges of tiles; found none";
        return Err(Error::invalid("patch set", "kinds", problem));
    }
    let drawing = Drawing { library, place: Place::new(one, across, side)?, walks, others, side, across };
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut ribbons: Vec<Crossing> = Vec::with_capacity(count);
    for k in 0..count {
        let fits = |c: &Crossing| ribbons.iter().all(|other| !c.meets(other, library));
        let found = (0..TRIES).find_map(|_| drawing.crossing(k % 2 == 0, &mut rng).filter(fits));
        ribbons.push(found.ok_or_else(|| no_room(side, count))?);
    }
    Ok(ribbons)
}

fn no_room(side: f32, count: usize) -> Error {
    let problem = format!(
        "expected room for {count} people to cross each edge of {side} m without meeting, found none; make tiles larger \
         or people fewer"
    );
    Error::invalid("scene", "wang", problem)
}

/// True if a move is one of somebody who walks.
fn is_brisk(m: &Move) -> bool {
    m.speed > BRISK && m.askew < ASKEW
}

/// What people do alone with empty hands, on the ground.
fn light_moves<'l>(library: &'l Library) -> Vec<&'l Move> {
    let light = |m: &&Move| {
        let role = &library.roles[m.role as usize];
        ![role.entry_group, role.exit_group].iter().any(|&g| library.laden[g as usize])
            && !role.leaves_box()
            && role.leap.is_none()
    };
    library.forward.iter().flatten().filter(light).collect()
}

/// The square that a ribbon keeps within, and its halves before and beyond the edge.
struct Place {
    whole: Domain,
    halves: [Domain; 2],
}

impl Place {
    fn new(one: &Scene, across: Across, side: f32) -> Result<Self> {
        let corner = |beyond: f32| on_edge(across, side * 0.5, side * beyond);
        let (from, to) = (Vec2::ZERO, on_edge(across, side, 0.0));
        let domain = |corners: &[Vec2]| {
            let region = Polygon::new(corners.to_vec()).expect("corners that go round once");
            Domain::new(&Scene { region, ..one.clone() })
        };
        let halves = [domain(&[from, to, corner(-0.5)])?, domain(&[from, to, corner(0.5)])?];
        Ok(Self { whole: domain(&[from, corner(-0.5), to, corner(0.5)])?, halves })
    }
}

/// What crossings are drawn from.
struct Drawing<'a> {
    library: &'a Library<'a>,
    place: Place,
    /// Walks straight ahead, and all else, of which something may have to come between two walks.
    walks: Vec<&'a Move>,
    others: Vec<&'a Move>,
    side: f32,
    across: Across,
}

impl<'a> Drawing<'a> {
    /// Somebody who crosses somewhere, some time, if that is possible as drawn.
    fn crossing(&self, forward: bool, rng: &mut ChaCha8Rng) -> Option<Crossing> {
        let roles = self.chain(rng);
        let length: i32 = roles.iter().map(|m| m.ticks).sum();
        let horizon = self.place.whole.horizon;
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
        let heading = match self.across {
            Across::X => FRAC_PI_2,
            Across::Z => 0.0,
        };
        let heading = heading + aslant + if forward { 0.0 } else { PI } - leads.x.atan2(leads.y);
        let beside = rng.random_range(-BESIDE..BESIDE);
        let on_border = on_edge(self.across, along, beside);
        let from = Ground::new(on_border - Ground::new(Vec2::ZERO, heading).apply(middle), heading);
        let mut crossing = Crossing { pieces: self.lay(&roles, from, begin), leads: Default::default(), forward };
        if !self.is_across(&crossing) || !self.is_clean(&crossing) {
            return None;
        }
        crossing.leads = self.leads(&crossing, rng)?;
        Some(crossing)
    }

    /// A way to where a crossing begins, and one from where it ends.
    fn leads(&self, crossing: &Crossing, rng: &mut ChaCha8Rng) -> Option<[Vec<Piece>; 2]> {
        let [lower, upper] = &self.place.halves;
        let (before, beyond) = if crossing.forward { (lower, upper) } else { (upper, lower) };
        let entry = self.library.entry_of(&crossing.pieces[0]);
        let exit = self.library.exit_of(crossing.pieces.last()?);
        let mut lead = |domain: &Domain, from: Port, goal: Goal| {
            let ground = Tracks::on_open_ground(self.library, domain);
            Bridge::default().search(ground.view(), from, goal, Company::NONE, TASTE, rng)
        };
        let horizon = self.place.whole.horizon;
        let mut leads: [Vec<Piece>; 2] = Default::default();
        if entry.tick > 0 {
            leads[0] = lead(before, entry, Goal::Since((entry.tick - LEAD).max(0)))?;
        }
        if exit.tick < horizon {
            leads[1] = lead(beyond, exit, Goal::Until((exit.tick + LEAD).min(horizon)))?;
        }
        Some(leads)
    }

    /// Walks that follow each other, long enough if there are such.
    fn chain(&self, rng: &mut ChaCha8Rng) -> Vec<&'a Move> {
        let mut chain = vec![*self.walks.choose(rng).expect("some walk")];
        let mut ticks = chain[0].ticks;
        while ticks < LONG && chain.len() < MOST_PIECES {
            let group = chain[chain.len() - 1].group;
            let follows = |m: &&&Move| self.library.roles[m.role as usize].entry_group == group;
            let following = |moves: &[&'a Move]| moves.iter().filter(follows).copied().collect::<Vec<_>>();
            let next = |moves, rng: &mut ChaCha8Rng| following(moves).choose(rng).copied();
            let Some(next) = next(&self.walks, rng).or_else(|| next(&self.others, rng)) else { break };
            chain.push(next);
            ticks += next.ticks;
        }
        chain
    }

    fn lay(&self, roles: &[&Move], mut from: Ground, mut begin: i32) -> Vec<Piece> {
        let mut pieces = Vec::new();
        for step in roles {
            let piece = Piece::rigid(self.library, &self.place.whole, step.role, NO_INSTANCE, from, begin);
            (from, begin) = (piece.exit(), piece.end);
            pieces.push(piece);
        }
        pieces
    }

    /// True if it begins on one side and ends on the other, and keeps within its square.
    fn is_across(&self, crossing: &Crossing) -> bool {
        let sign = if crossing.forward { 1.0 } else { -1.0 };
        let beyond = |place: Vec2| sign * if self.across == Across::X { place.x } else { place.y };
        let last = crossing.pieces.len() - 1;
        let (entry, exit) = (crossing.pieces[0].entry(), crossing.pieces[last].exit());
        let reach = self.library.max_reach.min(0.6) + END_ROOM;
        let ground = Tracks::on_open_ground(self.library, &self.place.whole);
        beyond(entry.position) < -reach
            && beyond(exit.position) > reach
            && crossing.pieces.iter().all(|piece| ground.view().is_free(piece))
    }

    /// True if it is walked as people can.
    fn is_clean(&self, crossing: &Crossing) -> bool {
        let mut desk = Desk::default();
        let ground = Tracks::on_open_ground(self.library, &self.place.whole);
        let mut draft = Draft::new(&ground, &mut desk);
        let ids = crossing.pieces.iter().map(|p| draft.add(p.clone())).collect();
        draft.push_track(ids);
        is_clean(&draft)
    }
}

/// The place so far along an edge whose lower end is at the origin, and so far beyond it.
pub(super) fn on_edge(across: Across, along: f32, beyond: f32) -> Vec2 {
    match across {
        Across::X => Vec2::new(beyond, along),
        Across::Z => Vec2::new(along, beyond),
    }
}
