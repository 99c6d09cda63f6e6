//! Worlds of rectangular patches on a grid that repeats for ever in both directions.
//!
//! Patterns and connections are those of one *macro tile* of columns x rows patches; whoever leaves it on the right comes in
//! to its next copy on the left. There is no limit on coordinates and time: everything is a function of place and time.

use glam::Vec2;

use super::{CrowdPatch, Identities, Link, Person, Port};
use crate::{Error, Result};

/// Somebody at some time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// Who.
    pub person: Person,
    /// Column and row of the patch it is in.
    pub cell: [i64; 2],
    /// Where in the patch, metres from its lower corner: exact however far the patch is away.
    pub place: Vec2,
    /// Velocity, m/s.
    pub velocity: Vec2,
}

/// A macro tile of crowd patches.
#[derive(Clone, Debug)]
pub struct Lattice {
    columns: usize,
    rows: usize,
    cell: Vec2,
    kinds: Vec<CrowdPatch>,
    /// Kind of every cell.
    cells: Vec<usize>,
    /// Index of the first crossing of every patch.
    first: Vec<usize>,
    links: Vec<Option<Link>>,
    identities: Identities,
}

impl Lattice {
    /// Joins `patches` (row by row), rectangles with corners (0, 0) and `cell`, edges in the order below, right, above, left.
    ///
    /// # Errors
    /// If their number is not columns x rows, an outline is not the rectangle, or patterns that meet are not mirrors: names
    /// the patch.
    pub fn new(columns: usize, rows: usize, cell: Vec2, patches: Vec<CrowdPatch>) -> Result<Self> {
        let cells = (0..patches.len()).collect();
        Self::shared(columns, rows, cell, patches, cells)
    }

    /// The same of a few `kinds` of patches: `cells` says which is where.
    ///
    /// # Errors
    /// As [`Self::new`], or if a cell names a kind that is not there.
    pub fn shared(columns: usize, rows: usize, cell: Vec2, kinds: Vec<CrowdPatch>, cells: Vec<usize>) -> Result<Self> {
        if cells.len() != columns * rows || cells.is_empty() {
            let problem = format!("expected {columns} x {rows} of them, at least one, found {}", cells.len());
            return Err(Error::invalid("lattice", "patches", problem));
        }
        if let Some(bad) = cells.iter().position(|&kind| kind >= kinds.len()) {
            let problem = format!("expected a kind below {}, found {}", kinds.len(), cells[bad]);
            return Err(Error::invalid("lattice", format!("patch {bad}"), problem));
        }
        let first = cells
            .iter()
            .scan(0, |next, &kind| {
                let first = *next;
                *next += kinds[kind].walkers.len();
                Some(first)
            })
            .collect();
        let (links, identities) = (Vec::new(), Identities::default());
        let mut lattice = Self { columns, rows, cell, kinds, cells, first, links, identities };
        (0..lattice.cells.len()).try_for_each(|index| lattice.check(index))?;
        lattice.links = (0..lattice.cells.len()).flat_map(|index| lattice.links_of(index)).map(Some).collect();
        lattice.identities = Identities::new(&lattice.links);
        Ok(lattice)
    }

    fn check(&self, index: usize) -> Result<()> {
        let place = format!("patch {index}");
        let outline = rectangle(self.cell);
        let patch = self.at(index);
        if patch.frame.outline.len() != 4
            || !patch.frame.outline.iter().zip(&outline).all(|(a, b)| a.distance(*b) < 1e-3)
        {
            let problem = format!("expected the outline {outline:?}, found {:?}", patch.frame.outline);
            return Err(Error::invalid("lattice", place, problem));
        }
        for edge in [1, 2] {
            let (other, _) = self.neighbour(index, edge);
            let (own, theirs) = (&patch.frame.patterns[edge], &self.at(other).frame.patterns[(edge + 2) % 4]);
            let mirror = own.mirror();
            let same = |a: &[super::Crossing], b: &[super::Crossing]| {
                a.len() == b.len()
                    && a.iter()
                        .zip(b)
                        .all(|(a, b)| a.time == b.time && (a.place - b.place).abs() < 1e-4 && a.across == b.across)
            };
            if own.period != theirs.period
                || !same(&mirror.inputs, &theirs.inputs)
                || !same(&mirror.outputs, &theirs.outputs)
            {
                let problem = format!("expected the mirror of edge {edge} in patch {other}, found another pattern");
                return Err(Error::invalid("lattice", place, problem));
            }
        }
        Ok(())
    }

    /// The patch of a cell of the macro tile.
    fn at(&self, index: usize) -> &CrowdPatch {
        &self.kinds[self.cells[index]]
    }

    /// The different patches.
    pub fn kinds(&self) -> &[CrowdPatch] {
        &self.kinds
    }

    /// Which of them is in every cell of the macro tile, row by row.
    pub fn cells(&self) -> &[usize] {
        &self.cells
    }

    /// Patch on the other side of an edge, and how many copies of the macro tile further it is.
    fn neighbour(&self, index: usize, edge: usize) -> (usize, [i64; 2]) {
        let step = [[0, -1], [1, 0], [0, 1], [-1, 0]][edge];
        let at = [(index % self.columns) as i64 + step[0], (index / self.columns) as i64 + step[1]];
        let (inner, copy) = self.split(at);
        (inner, copy)
    }

    /// Patch of the macro tile at a cell of the plane, and the copy.
    fn split(&self, cell: [i64; 2]) -> (usize, [i64; 2]) {
        let size = [self.columns as i64, self.rows as i64];
        let inner = [cell[0].rem_euclid(size[0]) as usize, cell[1].rem_euclid(size[1]) as usize];
        (inner[1] * self.columns + inner[0], [cell[0].div_euclid(size[0]), cell[1].div_euclid(size[1])])
    }

    fn links_of(&self, index: usize) -> impl Iterator<Item = Link> {
        self.at(index).walkers.iter().map(move |walker| {
            let (other, shift) = self.neighbour(index, walker.output.edge);
            let port = Port { edge: (walker.output.edge + 2) % 4, index: walker.output.index };
            // Walkers are in the order of their inputs.
            let before: usize = self.at(other).frame.patterns[..port.edge].iter().map(|p| p.inputs.len()).sum();
            Link { to: self.first[other] + before + port.index, laps: walker.laps, shift }
        })
    }

    /// Period in seconds.
    pub fn period(&self) -> f32 {
        self.kinds[0].frame.period()
    }

    /// Size of a cell, metres.
    pub fn cell(&self) -> Vec2 {
        self.cell
    }

    /// The patch at a cell of the plane.
    pub fn patch(&self, cell: [i64; 2]) -> &CrowdPatch {
        self.at(self.split(cell).0)
    }

    /// Who came in to the patch at `cell` as walker `walker` in `period`. O(1).
    pub fn person(&self, cell: [i64; 2], walker: usize, period: i64) -> Person {
        let (index, copy) = self.split(cell);
        self.identities.of(self.first[index] + walker, copy, period)
    }

    /// Where `walker` of the patch at `cell` goes next: cell, walker there, and how many periods later it comes in there.
    pub fn next(&self, cell: [i64; 2], walker: usize) -> ([i64; 2], usize, u32) {
        let (index, _) = self.split(cell);
        let leaving = &self.at(index).walkers[walker];
        let step = [[0, -1], [1, 0], [0, 1], [-1, 0]][leaving.output.edge];
        let link = self.links[self.first[index] + walker].unwrap_or(Link { to: 0, laps: 0, shift: [0; 2] });
        let to = [cell[0] + step[0], cell[1] + step[1]];
        (to, link.to - self.first[self.split(to).0], leaving.laps)
    }

    /// Everybody in the patch at `cell` at `time` (seconds, any). O(walkers of the patch), no history.
    pub fn people(&self, cell: [i64; 2], time: f64) -> impl Iterator<Item = Sighting> {
        self.patch(cell).at(time).map(move |(walker, lap, place, velocity)| Sighting {
            person: self.person(cell, walker, lap),
            cell,
            place,
            velocity,
        })
    }

    /// Identities of everybody.
    pub fn identities(&self) -> &Identities {
        &self.identities
    }
}

/// Corners of the rectangle from the origin to `size`, counter-clockwise.
pub(super) fn rectangle(size: Vec2) -> Vec<Vec2> {
    vec![Vec2::ZERO, Vec2::new(size.x, 0.0), size, Vec2::new(0.0, size.y)]
}
