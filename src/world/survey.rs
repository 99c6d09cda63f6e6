//! Which patches of a plan are alike, and so have to be solved once.

use std::collections::BTreeMap;

use glam::Vec2;

use super::{CrowdPatch, FramePatch, Lattice, Plan, Rounds};
use crate::Result;

/// The patch kinds of a plan.
#[derive(Clone, Debug)]
pub(super) struct Survey {
    /// The first cell of every kind.
    first: Vec<usize>,
    /// Kind of every cell.
    cells: Vec<usize>,
    rounds: Rounds,
}

impl Survey {
    /// Looks at every cell of a plan.
    pub fn new(plan: &Plan) -> Result<Self> {
        plan.validate()?;
        let (columns, rows) = plan.size();
        let rounds = plan.rounds()?;
        let (mut index, mut first) = (BTreeMap::new(), Vec::new());
        let mut cells = Vec::with_capacity(columns * rows);
        for cell in 0..columns * rows {
            let key = (plan.cell_key(cell % columns, cell / columns), rounds.connections.get(&cell));
            let kind = *index.entry(key).or_insert_with(|| {
                first.push(cell);
                first.len() - 1
            });
            cells.push(kind);
        }
        Ok(Self { first, cells, rounds })
    }

    /// How many kinds there are.
    pub fn kinds(&self) -> usize {
        self.first.len()
    }

    /// Column and row of a kind's first cell.
    fn place(&self, plan: &Plan, kind: usize) -> (usize, usize) {
        let columns = plan.size().0;
        (self.first[kind] % columns, self.first[kind] / columns)
    }

    /// Outline and patterns of a kind.
    pub fn frame(&self, plan: &Plan, kind: usize) -> Result<FramePatch> {
        let (column, row) = self.place(plan, kind);
        plan.frame(column, row)
    }

    /// The patch of a kind.
    pub fn solve(&self, plan: &Plan, kind: usize) -> Result<CrowdPatch> {
        let (column, row) = self.place(plan, kind);
        plan.connected(column, row, self.rounds.of_cell(self.first[kind]))
    }

    /// What became of the plan's goals, in words, where that is not what it asks for.
    pub fn notes(&self, plan: &Plan, kinds: &[CrowdPatch]) -> Vec<String> {
        self.rounds.notes(&plan.goals, |cell| &kinds[self.cells[cell]])
    }

    /// The patches of all kinds, joined.
    pub fn join(self, plan: &Plan, kinds: Vec<CrowdPatch>) -> Result<Lattice> {
        let (columns, rows) = plan.size();
        Lattice::shared(columns, rows, Vec2::splat(plan.side), kinds, self.cells)
    }
}
