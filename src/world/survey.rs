//! Which patches of a plan are alike, and so have to be solved once.

use std::collections::BTreeMap;

use glam::Vec2;

use super::goal_solve::{Connections, holds};
use super::{CrowdPatch, FramePatch, Goal, Lattice, Plan, Rounds};
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
        plan.connected(column, row, self.connections(self.first[kind]))
    }

    /// The connections that a cell must have.
    fn connections(&self, cell: usize) -> &Connections {
        self.rounds.connections.get(&cell).map_or(&[], Vec::as_slice)
    }

    /// What became of the plan's goals, in words, where that is not what it asks for.
    pub fn notes(&self, plan: &Plan, kinds: &[CrowdPatch]) -> Vec<String> {
        let kept = |step: &(usize, usize)| holds(&kinds[self.cells[step.0]], self.connections(step.0));
        let note = |(goal, wish): (usize, &Goal)| {
            let found = self.rounds.found.iter().filter(|round| round.goal == goal);
            let kept = found.filter(|round| round.steps.iter().all(kept)).count();
            let text = format!("goal {}: {kept} of {} rounds have a way there and back", goal + 1, wish.rounds);
            (kept < wish.rounds).then_some(text)
        };
        plan.goals.iter().enumerate().filter_map(note).collect()
    }

    /// The patches of all kinds, joined.
    pub fn join(self, plan: &Plan, kinds: Vec<CrowdPatch>) -> Result<Lattice> {
        let (columns, rows) = plan.size();
        Lattice::shared(columns, rows, Vec2::splat(plan.side), kinds, self.cells)
    }
}
