//! Who is where when: placed pieces and, per tick, a grid of their bodies.

use std::ops::{ControlFlow, RangeInclusive};

use glam::Vec2;

use super::domain::Domain;
use super::library::Library;
use super::piece::Piece;
use crate::geom::{Cycle, Torus};

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

/// A body as the cheap tests see it.
#[derive(Clone, Copy, Default)]
pub(super) struct Shown {
    /// Its piece.
    pub id: PieceId,
    /// Where its path point is.
    pub position: Vec2,
    /// It does not reach further from there.
    pub reach: f32,
}

/// All placed pieces.
pub(super) struct Occupancy {
    pieces: Vec<Option<Piece>>,
    free: Vec<PieceId>,
    cells: Vec<Cell>,
    columns: i32,
    rows: i32,
    origin: Vec2,
    per_metre: Vec2,
    torus: Torus,
    cycle: Cycle,
    max_reach: f32,
}

impl Occupancy {
    /// An empty one.
    pub fn new(domain: &Domain, library: &Library) -> Self {
        let cells = (domain.max - domain.min) / CELL;
        // A whole number of cells, a little larger ones, where the domain repeats; else one more than is needed.
        let repeats = domain.torus.period().cmpgt(Vec2::ZERO);
        let count = Vec2::select(repeats, cells.floor(), cells.ceil() + 1.0);
        let per_metre = Vec2::select(repeats, count / (domain.max - domain.min), Vec2::splat(1.0 / CELL));
        let (columns, rows) = (count.x as i32, count.y as i32);
        Self {
            pieces: vec![],
            free: vec![],
            cells: vec![Cell::default(); (columns * rows * domain.horizon) as usize],
            columns,
            rows,
            origin: domain.min,
            per_metre,
            torus: domain.torus,
            cycle: domain.cycle,
            max_reach: library.max_reach,
        }
    }

    /// One in which nothing is ever placed.
    pub fn none() -> Self {
        let (columns, rows, origin, max_reach) = (0, 0, Vec2::ZERO, 0.0);
        let (per_metre, torus, cycle) = (Vec2::ONE, Torus::default(), Cycle::default());
        let (pieces, free, cells) = (vec![], vec![], vec![]);
        Self { pieces, free, cells, columns, rows, origin, per_metre, max_reach, torus, cycle }
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

    /// Takes a piece in without a grid.
    pub fn keep(&mut self, piece: Piece) -> PieceId {
        self.pieces.push(Some(piece));
        self.pieces.len() as PieceId - 1
    }

    /// The same pieces with a grid; without one as they were if they are too crowded for it.
    pub fn opened(self, domain: &Domain, library: &Library) -> Result<Self, Box<Self>> {
        let mut open = Self { pieces: self.pieces, free: self.free, ..Self::new(domain, library) };
        match (0..open.pieces.len()).all(|id| open.show_if_room(id as PieceId)) {
            true => Ok(open),
            false => Err(Box::new(Self { cells: vec![], ..open })),
        }
    }

    fn show_if_room(&mut self, id: PieceId) -> bool {
        let room = self.get(id).is_none_or(|piece| self.has_room(piece));
        if room && self.get(id).is_some() {
            self.show(id);
        }
        room
    }

    /// True if there is room in the grid for all bodies of a piece.
    pub fn has_room(&self, piece: &Piece) -> bool {
        let room = |(tick, at): (i32, Vec2)| (self.cells[self.cell_of(tick, at)].count as usize) < CELL_BODIES;
        (piece.shown_from..).zip(piece.bodies.iter().map(|b| b.position)).all(room)
    }

    /// Gives the grid's memory back; from now on only pieces can be asked for.
    pub fn close(&mut self) {
        self.cells = Vec::new();
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
        let period = self.torus.period();
        let (x, z) = (inside(x, self.columns, period.x), inside(z, self.rows, period.y));
        ((self.cycle.slot(tick) * self.rows + z) * self.columns + x) as usize
    }

    /// May be outside the grid. A cast rounds towards zero, which is down once the number is above it; calls of `floor`
    /// would cost more than all the rest.
    fn column_and_row(&self, position: Vec2) -> (i32, i32) {
        let c = (position - self.origin) * self.per_metre + FAR;
        (c.x as i32 - FAR as i32, c.y as i32 - FAR as i32)
    }

    /// Calls `see` with each body at a tick of the first lap that may reach to within `reach` of `position`, or with `None` for a cell that is
    /// full, until it breaks.
    #[inline]
    pub fn visit(
        &self,
        tick: i32,
        position: Vec2,
        reach: f32,
        see: &mut impl FnMut(Option<&Shown>) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let (columns, rows) = self.cells_within(position, reach + self.max_reach);
        for z in rows {
            let z = around(z, self.rows);
            for x in columns.clone() {
                let x = around(x, self.columns);
                let cell = &self.cells[((tick * self.rows + z) * self.columns + x) as usize];
                if cell.count as usize == CELL_BODIES {
                    see(None)?;
                }
                for shown in &cell.bodies[..cell.count as usize] {
                    see(Some(shown))?;
                }
            }
        }
        ControlFlow::Continue(())
    }

    fn cells_within(&self, position: Vec2, distance: f32) -> (RangeInclusive<i32>, RangeInclusive<i32>) {
        let (low, high) = (self.column_and_row(position - distance), self.column_and_row(position + distance));
        let period = self.torus.period();
        (span(low.0, high.0, self.columns, period.x), span(low.1, high.1, self.rows, period.y))
    }

    /// Ids of the pieces whose people's path points lie within `distance` of `position` at `tick`, in no particular order.
    pub fn near(&self, tick: i32, position: Vec2, distance: f32, out: &mut Vec<PieceId>) {
        out.clear();
        let (columns, rows) = self.cells_within(position, distance);
        let (slot, is_played) = (self.cycle.slot(tick), |id: &PieceId| {
            let piece = self.piece(*id);
            piece.is_played(self.cycle.fold(tick, piece.shown_from))
        });
        for z in rows {
            let z = around(z, self.rows);
            for x in columns.clone() {
                let cell = &self.cells[((slot * self.rows + z) * self.columns + around(x, self.columns)) as usize];
                let near =
                    |b: &&Shown| self.torus.nearest(b.position - position).length_squared() < distance * distance;
                let near = cell.bodies[..cell.count as usize].iter().filter(near).map(|b| b.id);
                out.extend(near.filter(is_played));
            }
        }
    }
}

/// A cell that exists, along one axis of so many: the same one where the domain repeats, else the nearest.
fn inside(at: i32, count: i32, period: f32) -> i32 {
    if period > 0.0 { at.rem_euclid(count) } else { at.clamp(0, count - 1) }
}

/// Cells along one axis, none of them twice. Where the domain repeats some may lie beyond the last: see [`around`].
fn span(low: i32, high: i32, count: i32, period: f32) -> RangeInclusive<i32> {
    if period > 0.0 {
        let first = low.rem_euclid(count);
        return first..=first + (high - low).min(count - 1);
    }
    low.max(0)..=high.min(count - 1)
}

/// A cell of a span that lies beyond the last, from the first one on.
#[inline]
fn around(at: i32, count: i32) -> i32 {
    if at < count { at } else { at - count }
}
