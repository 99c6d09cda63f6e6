//! The tiling as a search sees it: placed pieces, less those that its proposal takes out, plus those that it puts in.

use std::ops::ControlFlow;

use glam::{Vec2, Vec3};

use super::domain::{Domain, Spot};
use super::footprint::Footprint;
use super::library::Library;
use super::occupancy::{Occupancy, PieceId, Shown};
use super::piece::{Body, Company, Piece, Rigid, Ties, footprint, lifts, overlap, world_discs};
use super::sketch::Sketch;

/// Ticks between those at which a place is looked at.
const QUIET_STEP: usize = 6;

/// What a search looks at.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    /// The patches.
    pub library: &'a Library<'a>,
    /// Walls and time.
    pub domain: &'a Domain,
    /// Who is where.
    pub occupancy: &'a Occupancy,
    /// What is to be changed.
    pub sketch: &'a Sketch,
}

/// Whose bodies are asked about.
#[derive(Clone, Copy)]
struct Player<'a> {
    library: &'a Library<'a>,
    role: u32,
    ties: Ties,
}

impl Player<'_> {
    fn discs(self, body: &Body) -> Footprint {
        world_discs(body, footprint(self.library, self.role, body))
    }

    fn is_inside(self, domain: &Domain, tick: i32, body: &Body) -> bool {
        let lifts = || lifts(self.library, self.role, body);
        let holds = |(d, lift): (Vec3, f32)| domain.holds(Spot { tick, lift }, d.truncate(), d.z);
        domain.holds(Spot::ground(tick), body.position, body.reach)
            || self.discs(body).into_iter().zip(lifts()).all(holds)
    }
}

impl<'a> View<'a> {
    /// The tiling as it is.
    pub fn new(library: &'a Library<'a>, domain: &'a Domain, occupancy: &'a Occupancy) -> Self {
        Self { library, domain, occupancy, sketch: Sketch::EMPTY }
    }

    /// A piece, placed or sketched.
    pub fn piece(self, id: PieceId) -> &'a Piece {
        if Sketch::is_sketched(id) { self.sketch.piece(id) } else { self.occupancy.piece(id) }
    }

    /// True if the piece stays inside the domain and clear of all bodies seen, but for those it is with.
    pub fn is_free(self, piece: &Piece) -> bool {
        let player = Player { library: self.library, role: piece.role, ties: piece.ties() };
        self.is_clear(player, piece.shown_from, piece.bodies.len(), |i| piece.bodies[i])
    }

    /// The same of a role placed rigidly, if it is no part of an instance and leaves no boxes lying.
    pub fn is_free_rigid(self, role: u32, rigid: Rigid, company: Company) -> bool {
        let player = Player { library: self.library, role, ties: rigid.ties(company) };
        let ticks = rigid.ticks(self.domain);
        self.is_clear(player, ticks.start, ticks.len(), |i| rigid.body(ticks.start + i as i32))
    }

    /// Frames are probed coarse to fine.
    fn is_clear(self, player: Player, from: i32, n: usize, body: impl Fn(usize) -> Body) -> bool {
        let free = |i: usize| {
            let (tick, body) = (from + i as i32, body(i));
            player.is_inside(self.domain, tick, &body)
                && self.meet(player, tick, &body, &mut |_| ControlFlow::Break(())).is_continue()
        };
        (0..n).step_by(8).all(free) && (4..n).step_by(8).all(free) && (0..n).filter(|i| i % 4 != 0).all(free)
    }

    /// True if nobody's path point ever comes nearer to a place than some distance, at every few ticks that are looked at.
    pub fn is_quiet(self, place: Vec2, distance: f32) -> bool {
        let is_near =
            |shown: &Shown| self.domain.torus.nearest(shown.position - place).length_squared() < distance * distance;
        let mut near = Vec::new();
        (0..self.domain.horizon).step_by(QUIET_STEP).all(|tick| {
            self.occupancy.near(tick, place, distance, &mut near);
            near.iter().all(|&id| self.sketch.hides(id)) && !self.sketch.at(tick).iter().any(is_near)
        })
    }

    /// The pieces whose bodies are in the way of `piece`, sorted; `None` if a wall or a crush is.
    pub fn blockers(self, piece: &Piece) -> Option<Vec<PieceId>> {
        let player = Player { library: self.library, role: piece.role, ties: piece.ties() };
        let bodies = || (piece.shown_from..).zip(&piece.bodies);
        if !bodies().all(|(tick, body)| player.is_inside(self.domain, tick, body)) {
            return None;
        }
        let mut found = Vec::new();
        for (tick, body) in bodies() {
            let crush = self.meet(player, tick, body, &mut |id| {
                let Some(id) = id else { return ControlFlow::Break(()) };
                found.push(id);
                ControlFlow::Continue(())
            });
            if crush.is_break() {
                return None;
            }
        }
        found.sort_unstable();
        found.dedup();
        Some(found)
    }

    /// Calls `met` with each piece whose body overlaps `body`, or with `None` for a cell that is full, until it breaks.
    fn meet(
        self,
        player: Player,
        tick: i32,
        body: &Body,
        met: &mut impl FnMut(Option<PieceId>) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let (torus, cycle) = (self.domain.torus, self.domain.cycle);
        let mut discs = None;
        let mut overlaps = |shown: &Shown| {
            let (apart, away) = (body.reach + shown.reach, body.position - shown.position);
            let whole = torus.whole(away);
            if (away - whole).length_squared() >= apart * apart || self.sketch.hides(shown.id) {
                return false;
            }
            let other = self.piece(shown.id);
            let their_tick = cycle.fold(tick, other.shown_from);
            if player.ties.join(tick, other.ties(), their_tick) {
                return false;
            }
            let theirs = other.body(their_tick).expect("shown at this tick");
            let own = discs.get_or_insert_with(|| player.discs(body));
            overlap(own, &world_discs(&theirs.moved(whole), footprint(self.library, other.role, theirs)))
        };
        let slot = cycle.slot(tick);
        for shown in self.sketch.at(slot) {
            if overlaps(shown) {
                met(Some(shown.id))?;
            }
        }
        self.occupancy.visit(slot, body.position, body.reach, &mut |shown| match shown {
            None => met(None),
            Some(shown) if overlaps(shown) => met(Some(shown.id)),
            Some(_) => ControlFlow::Continue(()),
        })
    }
}
