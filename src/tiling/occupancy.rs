//! Who is where when: placed pieces and, per tick, a grid of their bodies.

use std::ops::{ControlFlow, RangeInclusive};

use glam::{Vec2, Vec3};

use super::bridge::NO_INSTANCE;
use super::domain::{Domain, Spot};
use super::footprint::Footprint;
use super::library::Library;
use super::piece::{Body, Rigid, footprint, lifts, overlap, world_discs};
pub(super) use super::piece::{Piece, depth};

/// Cell size of the grid in metres.
const CELL: f32 = 1.0;
/// Most bodies whose path points lie in one cell; a fuller cell counts as blocked.
const CELL_BODIES: usize = 7;

/// Cells beyond which nothing is looked for.
const FAR: f32 = 1024.0;

/// Index of a placed piece.
pub(super) type PieceId = u32;

/// The bodies in one cell at one tick, with what the cheap tests need beside them.
#[derive(Clone, Copy, Default)]
struct Cell {
    count: u32,
    bodies: [Shown; CELL_BODIES],
}

#[derive(Clone, Copy, Default)]
struct Shown {
    id: PieceId,
    position: Vec2,
    reach: f32,
}

/// Whose bodies are asked about.
#[derive(Clone, Copy)]
struct Player<'a> {
    library: &'a Library<'a>,
    role: u32,
    instance: u32,
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

/// All placed pieces.
pub(super) struct Occupancy {
    pieces: Vec<Option<Piece>>,
    free: Vec<PieceId>,
    cells: Vec<Cell>,
    columns: i32,
    rows: i32,
    origin: Vec2,
    max_reach: f32,
}

impl Occupancy {
    /// An empty one.
    pub fn new(domain: &Domain, library: &Library) -> Self {
        let size = ((domain.max - domain.min) / CELL).ceil();
        let (columns, rows) = (size.x as i32 + 1, size.y as i32 + 1);
        Self {
            pieces: vec![],
            free: vec![],
            cells: vec![Cell::default(); (columns * rows * domain.horizon) as usize],
            columns,
            rows,
            origin: domain.min,
            max_reach: library.max_reach,
        }
    }

    /// A placed piece.
    pub fn piece(&self, id: PieceId) -> &Piece {
        self.pieces[id as usize].as_ref().expect("a live piece")
    }

    /// Takes a piece in and shows its bodies.
    pub fn insert(&mut self, piece: Piece) -> PieceId {
        let id = self.free.pop().unwrap_or_else(|| {
            self.pieces.push(None);
            self.pieces.len() as PieceId - 1
        });
        self.pieces[id as usize] = Some(piece);
        self.show(id);
        id
    }

    /// Forgets a piece that is hidden.
    pub fn forget(&mut self, id: PieceId) {
        self.pieces[id as usize] = None;
        self.free.push(id);
    }

    /// Puts another piece in the place of a hidden one, which is answered.
    pub fn replace(&mut self, id: PieceId, piece: Piece) -> Piece {
        let before = self.pieces[id as usize].replace(piece).expect("a live piece");
        self.show(id);
        before
    }

    /// A placed piece, if there is one of this id.
    pub fn get(&self, id: PieceId) -> Option<&Piece> {
        self.pieces.get(id as usize)?.as_ref()
    }

    /// Puts the bodies of a hidden piece back.
    pub fn show(&mut self, id: PieceId) {
        let piece = self.pieces[id as usize].take().expect("a live piece");
        for (tick, body) in (piece.shown_from..).zip(&piece.bodies) {
            let cell = self.cell_of(tick, body.position);
            let cell = &mut self.cells[cell];
            cell.bodies[cell.count as usize] = Shown { id, position: body.position, reach: body.reach };
            cell.count += 1;
        }
        self.pieces[id as usize] = Some(piece);
    }

    /// Takes the bodies of a piece out, keeping the piece.
    pub fn hide(&mut self, id: PieceId) {
        let piece = self.pieces[id as usize].take().expect("a live piece");
        for (tick, body) in (piece.shown_from..).zip(&piece.bodies) {
            let cell = self.cell_of(tick, body.position);
            let cell = &mut self.cells[cell];
            let at = cell.bodies[..cell.count as usize].iter().position(|b| b.id == id).expect("shown");
            cell.count -= 1;
            cell.bodies[at] = cell.bodies[cell.count as usize];
        }
        self.pieces[id as usize] = Some(piece);
    }

    fn cell_of(&self, tick: i32, position: Vec2) -> usize {
        let (x, z) = self.column_and_row(position);
        let (x, z) = (x.clamp(0, self.columns - 1), z.clamp(0, self.rows - 1));
        ((tick * self.rows + z) * self.columns + x) as usize
    }

    /// May be outside the grid. A cast rounds towards zero, which is down once the number is above it; calls of `floor`
    /// would cost more than all the rest.
    fn column_and_row(&self, position: Vec2) -> (i32, i32) {
        let c = (position - self.origin) / CELL + FAR;
        (c.x as i32 - FAR as i32, c.y as i32 - FAR as i32)
    }

    /// True if the piece stays inside the domain and clear of all bodies shown, but for those of its own instance.
    pub fn is_free(&self, library: &Library, domain: &Domain, piece: &Piece) -> bool {
        let player = Player { library, role: piece.role, instance: piece.instance };
        self.is_clear(domain, player, piece.shown_from, piece.bodies.len(), |i| piece.bodies[i])
    }

    /// The same of a role placed rigidly, if it is no part of an instance and leaves no boxes lying.
    pub fn is_free_rigid(&self, library: &Library, domain: &Domain, role: u32, rigid: Rigid) -> bool {
        let (player, ticks) = (Player { library, role, instance: NO_INSTANCE }, rigid.ticks(domain));
        self.is_clear(domain, player, ticks.start, ticks.len(), |i| rigid.body(ticks.start + i as i32))
    }

    /// Frames are probed coarse to fine.
    fn is_clear(&self, domain: &Domain, player: Player, from: i32, n: usize, body: impl Fn(usize) -> Body) -> bool {
        let free = |i: usize| {
            let body = body(i);
            player.is_inside(domain, from + i as i32, &body)
                && self.meet(player, from + i as i32, &body, &mut |_| ControlFlow::Break(())).is_continue()
        };
        (0..n).step_by(8).all(free) && (4..n).step_by(8).all(free) && (0..n).filter(|i| i % 4 != 0).all(free)
    }

    /// The pieces whose bodies are in the way of `piece`, sorted; `None` if a wall or a crush is.
    pub fn blockers(&self, library: &Library, domain: &Domain, piece: &Piece) -> Option<Vec<PieceId>> {
        let player = Player { library, role: piece.role, instance: piece.instance };
        if !(piece.shown_from..).zip(&piece.bodies).all(|(tick, body)| player.is_inside(domain, tick, body)) {
            return None;
        }
        let mut found = Vec::new();
        for (tick, body) in (piece.shown_from..).zip(&piece.bodies) {
            let crush = self.meet(player, tick, body, &mut |id| {
                if let Some(id) = id {
                    found.push(id);
                    return ControlFlow::Continue(());
                }
                ControlFlow::Break(())
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
        &self,
        player: Player,
        tick: i32,
        body: &Body,
        met: &mut impl FnMut(Option<PieceId>) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let library = player.library;
        let reach = body.reach + self.max_reach;
        let mut discs = None;
        let (columns, rows) = self.cells_within(body.position, reach);
        for z in rows {
            for x in columns.clone() {
                let cell = &self.cells[((tick * self.rows + z) * self.columns + x) as usize];
                if cell.count as usize == CELL_BODIES {
                    met(None)?;
                }
                for shown in &cell.bodies[..cell.count as usize] {
                    let apart = body.reach + shown.reach;
                    if body.position.distance_squared(shown.position) >= apart * apart {
                        continue;
                    }
                    let other = self.piece(shown.id);
                    if other.instance == player.instance && player.instance != NO_INSTANCE {
                        continue;
                    }
                    let theirs = other.body(tick).expect("shown at this tick");
                    let own = discs.get_or_insert_with(|| player.discs(body));
                    if overlap(own, &world_discs(theirs, footprint(library, other.role, theirs))) {
                        met(Some(shown.id))?;
                    }
                }
            }
        }
        ControlFlow::Continue(())
    }

    fn cells_within(&self, position: Vec2, distance: f32) -> (RangeInclusive<i32>, RangeInclusive<i32>) {
        let (low, high) = (self.column_and_row(position - distance), self.column_and_row(position + distance));
        (low.0.max(0)..=high.0.min(self.columns - 1), low.1.max(0)..=high.1.min(self.rows - 1))
    }

    /// Ids of the pieces whose people's path points lie within `distance` of `position` at `tick`, in no particular order.
    pub fn near(&self, tick: i32, position: Vec2, distance: f32, out: &mut Vec<PieceId>) {
        out.clear();
        let (columns, rows) = self.cells_within(position, distance);
        for z in rows {
            for x in columns.clone() {
                let cell = &self.cells[((tick * self.rows + z) * self.columns + x) as usize];
                let near = |b: &&Shown| b.position.distance_squared(position) < distance * distance;
                let near = cell.bodies[..cell.count as usize].iter().filter(near).map(|b| b.id);
                out.extend(near.filter(|&id| self.piece(id).is_played(tick)));
            }
        }
    }
}
