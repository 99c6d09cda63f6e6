//! What a proposal would change: pieces taken out of the tiling and pieces put in, seen by its own searches only.

use super::occupancy::{PieceId, Shown};
use super::piece::Piece;
use crate::geom::Cycle;

/// Ids of pieces that are only sketched begin here.
const SKETCHED: PieceId = 1 << 31;

/// Pieces taken out and pieces put in.
#[derive(Default)]
pub(super) struct Sketch {
    hidden: Vec<PieceId>,
    pieces: Vec<Piece>,
    /// The bodies of `pieces` by tick of the first lap.
    shown: Vec<Vec<Shown>>,
    cycle: Cycle,
}

/// How far a sketch was at some moment.
#[derive(Clone, Copy)]
pub(super) struct Mark {
    hidden: usize,
    pieces: usize,
}

impl Sketch {
    /// One that changes nothing.
    pub const EMPTY: &'static Self =
        &Self { hidden: Vec::new(), pieces: Vec::new(), shown: Vec::new(), cycle: Cycle::NEVER };

    /// Forgets everything and begins anew where time comes round like this.
    pub fn begin(&mut self, cycle: Cycle) {
        self.take();
        self.cycle = cycle;
    }

    /// True for ids of pieces that are in no tiling yet.
    pub fn is_sketched(id: PieceId) -> bool {
        id >= SKETCHED
    }

    /// Index of a sketched piece among those taken by [`Sketch::take`].
    pub fn index(id: PieceId) -> usize {
        (id - SKETCHED) as usize
    }

    /// A sketched piece.
    pub fn piece(&self, id: PieceId) -> &Piece {
        &self.pieces[Self::index(id)]
    }

    /// True if a piece of the tiling is taken out. Few are.
    pub fn hides(&self, id: PieceId) -> bool {
        self.hidden.contains(&id)
    }

    /// Sketched bodies at a tick of the first lap.
    pub fn at(&self, tick: i32) -> &[Shown] {
        self.shown.get(tick as usize).map_or(&[], Vec::as_slice)
    }

    /// Takes a piece of the tiling out.
    pub fn hide(&mut self, id: PieceId) {
        self.hidden.push(id);
    }

    /// Puts a piece in.
    pub fn add(&mut self, piece: Piece) -> PieceId {
        let id = SKETCHED + self.pieces.len() as PieceId;
        for (tick, body) in (piece.shown_from..).zip(&piece.bodies) {
            let slot = self.cycle.slot(tick) as usize;
            if self.shown.len() <= slot {
                self.shown.resize_with(slot + 1, Vec::new);
            }
            self.shown[slot].push(Shown { id, position: body.position, reach: body.reach });
        }
        self.pieces.push(piece);
        id
    }

    /// How far it is.
    pub fn mark(&self) -> Mark {
        Mark { hidden: self.hidden.len(), pieces: self.pieces.len() }
    }

    /// Back to how far it was.
    pub fn rewind(&mut self, mark: Mark) {
        self.hidden.truncate(mark.hidden);
        while self.pieces.len() > mark.pieces {
            let piece = self.pieces.pop().expect("longer than the mark");
            self.unshow(&piece);
        }
    }

    /// Ids of the pieces taken out, and the pieces put in; it is empty afterwards.
    pub fn take(&mut self) -> (Vec<PieceId>, Vec<Piece>) {
        let pieces = std::mem::take(&mut self.pieces);
        pieces.iter().rev().for_each(|piece| self.unshow(piece));
        (std::mem::take(&mut self.hidden), pieces)
    }

    /// Takes out the bodies of the piece that was put in last.
    fn unshow(&mut self, piece: &Piece) {
        let ticks = (piece.shown_from..).take(piece.bodies.len());
        for tick in ticks {
            self.shown[self.cycle.slot(tick) as usize].pop();
        }
    }
}
