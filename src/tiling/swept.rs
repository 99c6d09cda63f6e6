//! Swept ground: where somebody is at some time. Who stands all the time needs ground that nobody else ever sweeps, so
//! where it is dense those are let in first who sweep little, or what is swept already.

use glam::Vec2;

use super::library::Library;
use super::piece::Piece;
use super::tracks::{Change, Tracks};

/// Side of a cell, metres.
const CELL: f32 = 0.15;
/// Ticks between those that are looked at; nobody goes much farther than a cell in that time.
const STEP: usize = 4;
/// Nobody's middle finds room so near to another body, metres.
const ROOM: f32 = 0.25;

/// The cells of the ground on which nobody else can stand all the time.
pub(super) struct Swept<'a> {
    library: &'a Library<'a>,
    origin: Vec2,
    columns: usize,
    rows: usize,
    cells: Vec<bool>,
}

impl<'a> Swept<'a> {
    /// What the people of a tiling sweep.
    pub fn of(tracks: &Tracks<'a>) -> Self {
        let domain = tracks.domain;
        let count = ((domain.max - domain.min) / CELL).ceil();
        let (columns, rows) = (count.x as usize, count.y as usize);
        let cells = vec![false; columns * rows];
        let mut swept = Self { library: tracks.library, origin: domain.min, columns, rows, cells };
        let cells = swept.new_cells(tracks.tracks.iter().flatten().map(|&id| tracks.piece(id)));
        swept.take(&cells);
        swept
    }

    /// The cells that only a change sweeps, sorted.
    pub fn newly(&self, change: &Change) -> Vec<usize> {
        self.new_cells(&change.pieces)
    }

    /// Cells newly swept per tick that people of a change spend in patches of several.
    pub fn price(&self, change: &Change) -> f32 {
        let together = |p: &&Piece| self.library.people_of(p.role) > 1;
        let company: usize = change.pieces.iter().filter(together).map(Piece::ticks_inside).sum();
        self.newly(change).len() as f32 / company.max(1) as f32
    }

    /// Takes note of cells that are swept.
    pub fn take(&mut self, cells: &[usize]) {
        cells.iter().for_each(|&at| self.cells[at] = true);
    }

    fn new_cells<'p>(&self, pieces: impl IntoIterator<Item = &'p Piece>) -> Vec<usize> {
        let mut cells = Vec::new();
        for body in pieces.into_iter().flat_map(|p| p.bodies.iter().step_by(STEP)) {
            let reach = body.reach + ROOM;
            let low = ((body.position - reach - self.origin) / CELL).max(Vec2::ZERO);
            let high = ((body.position + reach - self.origin) / CELL).max(Vec2::ZERO);
            let columns = low.x as usize..(high.x as usize + 1).min(self.columns);
            for row in low.y as usize..(high.y as usize + 1).min(self.rows) {
                let middle = |column: usize| self.origin + CELL * (Vec2::new(column as f32, row as f32) + 0.5);
                let within = |&column: &usize| middle(column).distance_squared(body.position) < reach * reach;
                let own = columns.clone().filter(within).map(|column| row * self.columns + column);
                cells.extend(own.filter(|&at| !self.cells[at]));
            }
        }
        cells.sort_unstable();
        cells.dedup();
        cells
    }
}

#[cfg(test)]
mod tests {
    use super::super::bridge::NO_INSTANCE;
    use super::super::common::plain_set;
    use super::super::domain::Domain;
    use super::super::scene::Scene;
    use super::*;
    use crate::deform::Limits;
    use crate::geom::Ground;

    #[test]
    fn who_walks_sweeps_more_than_who_stands_and_nothing_twice() {
        let set = plain_set();
        let library = Library::new(&set, Limits::default());
        let domain = Domain::new(&Scene::demo()).unwrap();
        let mut swept = Swept::of(&Tracks::new(&library, &domain));
        let change = |name: &str, x: f32| {
            let kind = set.kinds.iter().position(|k| k.name == name).unwrap();
            let at = Ground::new(Vec2::new(x, 5.0), 0.0);
            let piece = Piece::rigid(&library, &domain, library.first_role[kind], NO_INSTANCE, at, 100);
            Change { version: 0, hidden: vec![], pieces: vec![piece], tracks: vec![] }
        };
        let (stands, walks) = (swept.newly(&change("idle-40", 5.0)), swept.newly(&change("cycle-1", 5.0)));
        // At least a disc of 40 cm, and nobody is wider than a metre.
        let area = |cells: &[usize]| cells.len() as f32 * CELL * CELL;
        assert!((0.5..3.2).contains(&area(&stands)) && area(&walks) > area(&stands), "{}", area(&stands));
        swept.take(&stands);
        assert!(swept.newly(&change("idle-40", 5.0)).is_empty());
        assert!(!swept.newly(&change("idle-40", 7.0)).is_empty());
        // In the corner no cell lies outside.
        assert!(swept.newly(&change("idle-40", 0.1)).iter().all(|&cell| cell < swept.cells.len()));
    }
}
