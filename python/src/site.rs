//! Glue of `crowdquilt::world::Site`: a build in pieces.

use std::borrow::Cow;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crowdquilt::world as core;
use pyo3::prelude::*;
use pyo3::sync::MutexExt;

use crate::error::{CrowdquiltError, run};
use crate::progress::watched;
use crate::world::{World, WorldScene};

/// A world that is being built: cells that can be solved in any order, by any thread, process or machine that has the same
/// version. Rounds follow each other: where cells have no way, they and their neighbours are solved once more with fewer people.
#[pyclass(frozen, module = "crowdquilt")]
pub struct WorldSite(Mutex<Option<core::Site>>);

type Site<'a> = MutexGuard<'a, Option<core::Site>>;

impl WorldSite {
    fn lock(&self, py: Python<'_>) -> Site<'_> {
        self.0.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner)
    }
}

/// The site, unless its world has been taken.
fn there<'a>(site: &'a Site) -> PyResult<&'a core::Site> {
    site.as_ref().ok_or_else(|| CrowdquiltError::new_err("build: its world has been baked already"))
}

#[pymethods]
impl WorldSite {
    /// The site of a scene, after some rounds: `failures` are the cells that failed in each.
    #[new]
    #[pyo3(signature = (scene, failures=Vec::new()))]
    fn new(py: Python<'_>, scene: &WorldScene, failures: Vec<Vec<usize>>) -> PyResult<Self> {
        run(py, || core::Site::after(&scene.0, &failures)).map(|site| Self(Mutex::new(Some(site))))
    }

    /// How many cells there are in all; cells of a map that are alike count once.
    #[getter]
    fn cells(&self, py: Python<'_>) -> PyResult<usize> {
        there(&self.lock(py)).map(core::Site::cells)
    }

    /// How many rounds are over.
    #[getter]
    fn round(&self, py: Python<'_>) -> PyResult<usize> {
        there(&self.lock(py)).map(core::Site::round)
    }

    /// The cells that failed in every round that is over.
    #[getter]
    fn failures(&self, py: Python<'_>) -> PyResult<Vec<Vec<usize>>> {
        there(&self.lock(py)).map(|site| site.failures().to_vec())
    }

    /// The cells of this round; none if all is solved.
    #[getter]
    fn left(&self, py: Python<'_>) -> PyResult<Vec<usize>> {
        there(&self.lock(py)).map(|site| site.left().to_vec())
    }

    /// Those of them that have not been taken yet.
    #[getter]
    fn open(&self, py: Python<'_>) -> PyResult<Vec<usize>> {
        there(&self.lock(py)).map(core::Site::open)
    }

    /// Solve some cells of this round: the bytes of a shard. Changes nothing. `threads` at a time, 0 for all cores.
    #[pyo3(signature = (cells, *, threads=0))]
    fn solve(&self, py: Python<'_>, cells: Vec<usize>, threads: usize) -> PyResult<Cow<'static, [u8]>> {
        let site = self.lock(py);
        let site = there(&site)?;
        let show = |py: Python<'_>, done: usize| Ok(done.into_pyobject(py)?.into_any().unbind());
        let (found, interrupt) =
            watched(py, None, show, |report| core::Shard::solve(site, &cells, threads, report).map(|s| s.to_bytes()));
        match interrupt {
            Some(error) => Err(error),
            None => found.map(Cow::Owned),
        }
    }

    /// Take the bytes of a shard of this round.
    fn take(&self, py: Python<'_>, shard: &[u8]) -> PyResult<()> {
        let mut site = self.lock(py);
        there(&site)?;
        let site = &mut *site;
        run(py, || site.iter_mut().try_for_each(|site| site.take(core::Shard::from_bytes(shard)?)))
    }

    /// End this round, all of whose cells have been taken.
    fn end_round(&self, py: Python<'_>) -> PyResult<()> {
        let mut site = self.lock(py);
        there(&site)?;
        let site = &mut *site;
        run(py, || site.iter_mut().try_for_each(core::Site::end_round))
    }

    /// The world, when no cells are left, and what had to be repaired or left out, in words; the site is used up.
    fn bake(&self, py: Python<'_>) -> PyResult<(World, Vec<String>)> {
        let site = self.lock(py).take();
        let site = site.ok_or_else(|| CrowdquiltError::new_err("build: its world has been baked already"))?;
        run(py, || site.bake()).map(|built| (World(Arc::new(built.world)), built.notes))
    }
}
