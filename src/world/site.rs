//! A build in pieces: cells that can be solved in any order, by any thread, process or machine.
//!
//! A cell's patch is a function of the scene, the cell and the rounds before: where no way is found through a cell of an area, its
//! borders get calmer and their cells are solved once more. So whoever knows the scene and which cells failed in which
//! round can solve any cell, and the world does not depend on who did. [`WorldScene::build`] is the same on the threads of one
//! process.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::area::Works;
use super::survey::Survey;
use super::{Built, CrowdPatch, FramePatch, Layout, Shard, WorldScene};
use crate::{Error, Result};

/// A world that is being built.
#[derive(Clone, Debug)]
pub struct Site {
    scene: WorldScene,
    works: Kinds,
    failures: Vec<Vec<usize>>,
    left: Vec<usize>,
    /// Of every cell, what was found in its last round: perhaps that there is no way.
    found: Vec<Option<Option<CrowdPatch>>>,
}

#[derive(Clone, Debug)]
enum Kinds {
    Map(Survey),
    Area(Box<Works>),
}

impl Site {
    /// The site of a scene: nothing is solved yet.
    ///
    /// # Errors
    /// If the scene makes no sense.
    pub fn new(scene: &WorldScene) -> Result<Self> {
        let (works, cells) = match &scene.layout {
            Layout::Map(plan) => {
                let survey = Survey::new(plan)?;
                let kinds = survey.kinds();
                (Kinds::Map(survey), kinds)
            }
            Layout::Area(area) => {
                let works = Works::new(area)?;
                let cells = works.frames().len();
                (Kinds::Area(Box::new(works)), cells)
            }
        };
        let found = vec![None; cells];
        Ok(Self { scene: scene.clone(), works, failures: Vec::new(), left: (0..cells).collect(), found })
    }

    /// The site after some rounds, by the cells that failed in each: for somebody who solves cells of the round that follows.
    ///
    /// # Errors
    /// As [`Self::new`], or if there is no such round: names the round.
    pub fn after(scene: &WorldScene, failures: &[Vec<usize>]) -> Result<Self> {
        let mut site = Self::new(scene)?;
        for (round, failed) in failures.iter().enumerate() {
            if let Some(cell) = failed.iter().find(|cell| !site.left.contains(cell)) {
                let problem = format!("expected cells of the round, found {cell}");
                return Err(Error::invalid("build", format!("round {round}"), problem));
            }
            site.next(failed.clone())?;
        }
        Ok(site)
    }

    /// What is built.
    pub fn scene(&self) -> &WorldScene {
        &self.scene
    }

    /// The cells that failed in every round that is over.
    pub fn failures(&self) -> &[Vec<usize>] {
        &self.failures
    }

    /// How many rounds are over.
    pub fn round(&self) -> usize {
        self.failures.len()
    }

    /// How many cells there are in all; cells of a map that are alike count once.
    pub fn cells(&self) -> usize {
        self.found.len()
    }

    /// The cells of this round; none if all is solved.
    pub fn left(&self) -> &[usize] {
        &self.left
    }

    /// Those of them that have not been taken yet.
    pub fn open(&self) -> Vec<usize> {
        self.left.iter().copied().filter(|&cell| self.found[cell].is_none()).collect()
    }

    /// Outline and patterns of a cell in this round.
    pub(super) fn frame(&self, cell: usize) -> Result<FramePatch> {
        match (&self.works, &self.scene.layout) {
            (Kinds::Map(survey), Layout::Map(plan)) => survey.frame(plan, cell),
            (Kinds::Area(works), _) => Ok(works.frames()[cell].clone()),
            _ => Err(Error::invalid("build", "scene", "expected a map")),
        }
    }

    /// The patch of a cell; none if no way is found through it in this round. Changes nothing.
    ///
    /// # Errors
    /// If there is no such cell; and where cells of a map, which are never calmed, have no way.
    pub fn solve(&self, cell: usize) -> Result<Option<CrowdPatch>> {
        if cell >= self.cells() {
            let problem = format!("expected a cell below {}, found {cell}", self.cells());
            return Err(Error::invalid("build", "cells", problem));
        }
        match (&self.works, &self.scene.layout) {
            (Kinds::Map(survey), Layout::Map(plan)) => survey.solve(plan, cell).map(Some),
            (Kinds::Area(works), Layout::Area(area)) => Ok(works.solve(area, cell)),
            _ => Err(Error::invalid("build", "scene", "expected the scene of the site")),
        }
    }

    /// Takes what somebody has solved.
    ///
    /// # Errors
    /// If it is of another round or does not fit this site: names the cell.
    pub fn take(&mut self, shard: Shard) -> Result<()> {
        shard.check(self)?;
        for (cell, patch) in shard.cells.into_iter().zip(shard.patches) {
            self.found[cell] = Some(patch);
        }
        Ok(())
    }

    /// Ends the round, all of whose cells have been taken.
    ///
    /// # Errors
    /// If they have not; or after the last round, if cells are left without a way.
    pub fn end_round(&mut self) -> Result<()> {
        if let Some(cell) = self.open().first() {
            let problem = format!("expected a result for every cell, found none for {cell}");
            return Err(Error::invalid("build", format!("round {}", self.round()), problem));
        }
        let failed = self.left.iter().copied().filter(|&cell| matches!(self.found[cell], Some(None))).collect();
        self.next(failed)
    }

    fn next(&mut self, failed: Vec<usize>) -> Result<()> {
        self.left = match (&mut self.works, &self.scene.layout) {
            (Kinds::Area(works), Layout::Area(area)) => works.next(area, &failed)?,
            _ => Vec::new(),
        };
        self.left.iter().for_each(|&cell| self.found[cell] = None);
        self.failures.push(failed);
        Ok(())
    }

    /// Solves the cells of the round that are open on all cores, and ends it. `progress` is told how many of how many patches are
    /// done, and stops the work by returning false.
    ///
    /// # Errors
    /// As [`Self::solve`] and [`Self::end_round`], and if it was stopped.
    pub fn work(&mut self, progress: &(dyn Fn(usize, usize) -> bool + Sync)) -> Result<()> {
        let (open, all) = (self.open(), self.cells());
        let done = AtomicUsize::new(all - open.len());
        let solve = |&cell: &usize| {
            let patch = self.solve(cell)?;
            let done = done.fetch_add(usize::from(patch.is_some()), Ordering::Relaxed) + 1;
            if progress(done.min(all), all) { Ok(patch) } else { Err(Error::Stopped) }
        };
        let solved: Vec<Option<CrowdPatch>> = open.par_iter().map(solve).collect::<Result<_>>()?;
        for (cell, patch) in open.into_iter().zip(solved) {
            self.found[cell] = Some(patch);
        }
        self.end_round()
    }

    /// The world, when all is solved.
    ///
    /// # Errors
    /// If something is not, or the world is too large for its numbers.
    pub fn bake(self) -> Result<Built> {
        let patches: Option<Vec<CrowdPatch>> = self.found.into_iter().map(Option::flatten).collect();
        let patches = patches.filter(|_| self.left.is_empty());
        let patches = patches.ok_or_else(|| Error::invalid("build", "cells", "expected all of them solved"))?;
        match (self.works, &self.scene.layout) {
            (Kinds::Map(survey), Layout::Map(plan)) => {
                let notes = survey.notes(plan, &patches);
                let world = plan.bake(&self.scene.name, &survey.join(plan, patches)?)?;
                Ok(Built { world, notes })
            }
            (Kinds::Area(works), Layout::Area(area)) => works.bake(area, &self.scene.name, &patches),
            _ => Err(Error::invalid("build", "scene", "expected the scene of the site")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::scenes;

    fn scene() -> WorldScene {
        let plan = scenes::city(8, true, 5).unwrap();
        WorldScene { name: "small".into(), layout: Layout::Map(plan) }
    }

    fn area() -> WorldScene {
        WorldScene::load(std::path::Path::new("examples/worlds/square.toml")).unwrap()
    }

    /// Builds by blocks of a few cells, the last first, each by somebody who knows scene and failures alone, through files.
    fn in_pieces(scene: &WorldScene) -> Built {
        let mut site = Site::new(scene).unwrap();
        while !site.left().is_empty() {
            let left = site.left().to_vec();
            for block in left.chunks(7).rev() {
                let copy = WorldScene::from_bytes(&scene.to_bytes()).unwrap();
                let worker = Site::after(&copy, site.failures()).unwrap();
                assert_eq!(worker.left(), left);
                let bytes = Shard::solve(&worker, block, 1, &|_| true).unwrap().to_bytes();
                site.take(Shard::from_bytes(&bytes).unwrap()).unwrap();
            }
            assert!(site.open().is_empty());
            site.end_round().unwrap();
        }
        site.bake().unwrap()
    }

    #[test]
    fn pieces_make_the_same_world_to_the_byte() {
        for scene in [scene(), area()] {
            let (whole, pieces) = (scene.build(&|_, _| true).unwrap(), in_pieces(&scene));
            assert!(whole.world.to_bytes() == pieces.world.to_bytes(), "{}", scene.name);
            assert_eq!(whole.notes, pieces.notes);
        }
    }

    #[test]
    fn what_is_missing_or_of_another_build_is_refused() {
        let mut site = Site::new(&scene()).unwrap();
        let shard = Shard::solve(&site, &[3, 4], 0, &|_| true).unwrap();
        let message = |e: Error| e.to_string();
        assert!(message(site.end_round().unwrap_err()).contains("found none for 0"));
        let mut other = Site::new(&scene().with_seed(9)).unwrap();
        assert!(message(other.take(shard.clone()).unwrap_err()).contains("cell 3"));
        let late = Shard { round: 1, ..shard.clone() };
        assert!(message(site.take(late).unwrap_err()).contains("round 0"));
        let mut broken = shard.clone();
        broken.patches[1].as_mut().unwrap().walkers[0].output.index = 999;
        assert!(message(site.take(broken).unwrap_err()).contains("cell 4"));
        site.take(shard).unwrap();
        assert!(site.bake().is_err());
    }

    #[test]
    fn damaged_bytes_are_refused() {
        let bytes = Shard::solve(&Site::new(&scene()).unwrap(), &[0, 9], 0, &|_| true).unwrap().to_bytes();
        for cut in (0..bytes.len()).step_by(97) {
            assert!(Shard::from_bytes(&bytes[..cut]).is_err());
        }
        let text = scene().to_bytes();
        assert!(WorldScene::from_bytes(&text[..text.len() / 2]).is_err());
    }
}
