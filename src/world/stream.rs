//! An endless world around a camera: patches are made in front of it and forgotten behind it.
//!
//! "Crowd Patches" (2009), section 6.1, bottom-up: here everything is a function of seed and place, so that what was
//! forgotten is the same when the camera comes back, however far it went. Connections and identities are those of the
//! plan's lattice; every copy of it gets objects and ways of its own.

use std::collections::BTreeMap;

use super::{CrowdPatch, Lattice, Plan, Sighting};
use crate::Result;

/// The part of an endless world that is near a camera.
#[derive(Clone, Debug)]
pub struct Stream {
    plan: Plan,
    lattice: Lattice,
    resident: BTreeMap<[i64; 2], CrowdPatch>,
    /// Cells to keep, from the lower corner on.
    window: [[i64; 2]; 2],
}

impl Stream {
    /// Builds the lattice of `plan`, which repeats from then on.
    ///
    /// # Errors
    /// As [`Plan::build`].
    pub fn new(plan: Plan) -> Result<Self> {
        let plan = Plan { endless: true, ..plan };
        let lattice = plan.build()?;
        Ok(Self { plan, lattice, resident: BTreeMap::new(), window: [[0; 2]; 2] })
    }

    /// Moves the camera to a cell: forgets all cells further than `reach` from it in either direction, and makes at most
    /// `budget` of those that are missing, the nearest first. Returns how many are still missing.
    pub fn look(&mut self, camera: [i64; 2], reach: i64, budget: usize) -> usize {
        let reach = reach.max(0);
        self.window = [camera.map(|c| c - reach), camera.map(|c| c + reach)];
        let [low, high] = self.window;
        let inside = |cell: &[i64; 2]| (0..2).all(|axis| (low[axis]..=high[axis]).contains(&cell[axis]));
        self.resident.retain(|cell, _| inside(cell));
        let cells = (low[0]..=high[0]).flat_map(|x| (low[1]..=high[1]).map(move |z| [x, z]));
        let mut missing: Vec<[i64; 2]> = cells.filter(|cell| !self.resident.contains_key(cell)).collect();
        missing.sort_by_key(|cell| ((cell[0] - camera[0]).abs().max((cell[1] - camera[1]).abs()), *cell));
        for &cell in missing.iter().take(budget) {
            let patch = self.make(cell);
            self.resident.insert(cell, patch);
        }
        missing.len().saturating_sub(budget)
    }

    /// The patch at a cell of the plane: the same whenever it is made.
    pub fn make(&self, cell: [i64; 2]) -> CrowdPatch {
        let (columns, rows) = self.plan.size();
        let size = [columns as i64, rows as i64];
        let inner = [cell[0].rem_euclid(size[0]) as usize, cell[1].rem_euclid(size[1]) as usize];
        let copy = [cell[0].div_euclid(size[0]), cell[1].div_euclid(size[1])];
        self.plan.version(self.lattice.patch(cell), inner[0], inner[1], copy)
    }

    /// The cells that are there, in the order of their coordinates.
    pub fn cells(&self) -> impl Iterator<Item = (&[i64; 2], &CrowdPatch)> {
        self.resident.iter()
    }

    /// Everybody in the cells that are there, at `time` (seconds, any).
    pub fn people(&self, time: f64) -> impl Iterator<Item = Sighting> {
        self.resident.iter().flat_map(move |(&cell, patch)| {
            patch.at(time).map(move |(walker, lap, place, velocity)| Sighting {
                person: self.lattice.person(cell, walker, lap),
                cell,
                place,
                velocity,
            })
        })
    }

    /// The lattice that gives connections and identities.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }
}
