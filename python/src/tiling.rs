//! Glue of `crowdquilt::tiling`.

use std::path::PathBuf;
use std::sync::Arc;

use crowdquilt::tiling as core;
use numpy::PyArray2;
use pyo3::exceptions::{PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;

use crate::error::{CrowdquiltError, run, to_python};
use crate::numbers::points2;
use crate::patch::PatchSet;
use crate::progress::watched;
use crate::stage::{Crowd, Obstacle, obstacles};
use crate::wishes;

/// What to tile: a region with obstacles, a time, and wishes.
#[pyclass(frozen, module = "crowdquilt")]
pub struct Scene(core::Scene);

#[pymethods]
impl Scene {
    /// Read a scene from a TOML file.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        run(py, || core::Scene::load(&path)).map(Self)
    }

    /// Read a scene from TOML text.
    #[staticmethod]
    fn from_toml(py: Python<'_>, text: &str) -> PyResult<Self> {
        run(py, || core::Scene::from_toml(text)).map(Self)
    }

    /// The demo's scene: 12 x 12 m, 20 s.
    #[staticmethod]
    fn demo() -> Self {
        Self(core::Scene::demo())
    }

    /// The same scene with other wishes: number of people, or how many per square metre; share of their time together
    /// (0 to 1); seconds.
    #[pyo3(signature = (*, characters=None, density=None, interaction=None, duration_secs=None))]
    fn replace(
        &self,
        characters: Option<usize>,
        density: Option<f32>,
        interaction: Option<f32>,
        duration_secs: Option<f32>,
    ) -> PyResult<Self> {
        let mut scene = self.0.clone();
        let bad = |place: &str, expected: &str| {
            Err(to_python(crowdquilt::Error::invalid("scene", place, format!("expected {expected}"))))
        };
        if let Some(n) = characters {
            if !(1..=1_000_000).contains(&n) {
                return bad("characters", &format!("1 to 1000000, found {n}"));
            }
            scene.characters = n;
        }
        if let Some(density) = density {
            if !(density > 0.0 && density <= 10.0) || characters.is_some() {
                return bad("density", &format!("more than 0 and at most 10, and no characters, found {density}"));
            }
            scene.characters = scene.people_at(density);
        }
        if let Some(share) = interaction {
            if !(0.0..=1.0).contains(&share) {
                return bad("interaction", &format!("0 to 1, found {share}"));
            }
            scene.interaction = share;
        }
        if let Some(secs) = duration_secs {
            if !(secs > 0.0 && secs <= 3600.0) {
                return bad("duration_secs", &format!("more than 0 and at most 3600, found {secs}"));
            }
            scene.duration_secs = secs;
        }
        Ok(Self(scene))
    }

    /// (corners, 2): where everybody stays inside, as x, z in metres.
    #[getter]
    fn region<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        points2(py, &self.0.region.points)
    }

    /// What everybody stays out of.
    #[getter]
    fn obstacles(&self) -> Vec<Obstacle> {
        obstacles(&self.0.obstacles)
    }

    /// The nodes of a grid over the region, `cell` metres apart: how many columns, and (n, 2) places, row by row.
    fn nodes<'py>(&self, py: Python<'py>, cell: f32) -> PyResult<(usize, Bound<'py, PyArray2<f32>>)> {
        let (columns, nodes) = wishes::nodes(&self.0, cell)?;
        Ok((columns, points2(py, &nodes)?))
    }

    /// The same scene with one more factor exp(-f / sigma) of the preference function; see `crowdquilt.tiling.prefer`.
    ///
    /// f is a table of float32, not negative: (rows, columns) over the ground or (headings, rows, columns) with nodes
    /// `step` metres apart, (n,) over time with values `step` seconds apart, or pairs of a kind's name and its value.
    #[pyo3(signature = (table, *, step=1.0, sigma=1.0))]
    fn with_table(&self, table: wishes::Table, step: f32, sigma: f32) -> PyResult<Self> {
        wishes::with_table(&self.0, table, step, sigma).map(Self)
    }

    /// Length in seconds.
    #[getter]
    fn duration_secs(&self) -> f32 {
        self.0.duration_secs
    }

    /// How many people are wished for.
    #[getter]
    fn characters(&self) -> usize {
        self.0.characters
    }

    /// How many people are wished for, with those of teams and those who come in at sources.
    #[getter]
    fn people(&self) -> usize {
        self.0.people()
    }

    /// Which share of the people's time is wished for in patches of two or more.
    #[getter]
    fn interaction(&self) -> f32 {
        self.0.interaction
    }

    fn __repr__(&self) -> String {
        let Self(s) = self;
        format!("Scene(characters={}, interaction={}, duration_secs={})", s.characters, s.interaction, s.duration_secs)
    }
}

/// How far a run is. `phase` is "seed", "enrich", "close" or "mend".
#[pyclass(frozen, get_all, module = "crowdquilt")]
pub struct Progress {
    phase: &'static str,
    patches: usize,
    characters: usize,
    danglings: usize,
    multi_person_share: f32,
    energy: f32,
    secs: f64,
}

fn progress(p: &core::Progress) -> Progress {
    let phase = match p.phase {
        core::Phase::Seed => "seed",
        core::Phase::Enrich => "enrich",
        core::Phase::Close => "close",
        core::Phase::Mend => "mend",
    };
    Progress {
        phase,
        patches: p.patches,
        characters: p.characters,
        danglings: p.danglings,
        multi_person_share: p.multi_person_share,
        energy: p.energy,
        secs: p.secs,
    }
}

/// The best tiling of a run.
///
/// `status` is "perfect" (no dangling, no interpenetration, all wishes met), "short" (a wish is unmet) or "imperfect"
/// (danglings or interpenetrations are left); `reason` says why it is not perfect. `unkept` says why the last checkpoint
/// could not be written, if so.
#[pyclass(frozen, get_all, module = "crowdquilt")]
pub struct Outcome {
    crowd: Py<Crowd>,
    status: &'static str,
    reason: String,
    danglings: usize,
    interpenetrations: usize,
    solve_secs: f64,
    unkept: Option<String>,
}

#[pymethods]
impl Outcome {
    fn __repr__(&self) -> String {
        format!("Outcome({}, danglings={}, solve_secs={:.2})", self.status, self.danglings, self.solve_secs)
    }
}

fn told(status: core::Status) -> (&'static str, String) {
    match status {
        core::Status::Perfect => ("perfect", String::new()),
        core::Status::Short(reason) => ("short", reason),
        core::Status::Imperfect(reason) => ("imperfect", reason),
    }
}

fn outcome(py: Python<'_>, found: core::Outcome) -> PyResult<Outcome> {
    let (status, reason) = told(found.status);
    Ok(Outcome {
        crowd: Py::new(py, Crowd(Arc::new(found.crowd)))?,
        status,
        reason,
        danglings: found.danglings,
        interpenetrations: found.interpenetrations,
        solve_secs: found.solve_secs,
        unkept: found.unkept,
    })
}

/// A tiling as it is kept between runs (`*.tiling`). Its scene may be given other wishes before a run goes on.
#[pyclass(frozen, module = "crowdquilt")]
pub struct Checkpoint(core::Checkpoint);

#[pymethods]
impl Checkpoint {
    /// Read a checkpoint.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        run(py, || core::Checkpoint::load(&path)).map(Self)
    }

    /// What is tiled.
    #[getter]
    fn scene(&self) -> Scene {
        Scene(self.0.scene.clone())
    }

    /// The seed of the run.
    #[getter]
    fn seed(&self) -> u64 {
        self.0.seed
    }

    /// What the patch set is called, if that was told.
    #[getter]
    fn patches(&self) -> Option<&str> {
        self.0.patches.as_deref()
    }

    /// People who are there.
    #[getter]
    fn characters(&self) -> usize {
        self.0.reached.people
    }

    /// Placed patches.
    #[getter]
    fn instances(&self) -> usize {
        self.0.reached.patches
    }

    /// Share of the people's time in patches of two or more.
    #[getter]
    fn multi_person_share(&self) -> f32 {
        self.0.reached.multi_person_share
    }

    /// Seconds of search so far, of all runs.
    #[getter]
    fn solve_secs(&self) -> f64 {
        self.0.reached.secs
    }

    fn __len__(&self) -> usize {
        self.0.reached.people
    }

    fn __repr__(&self) -> String {
        let r = &self.0.reached;
        format!("Checkpoint(characters={}, instances={}, solve_secs={:.1})", r.people, r.patches, r.secs)
    }
}

/// Test the final bodies and the wishes of a checkpoint without going on: its status and reason (see `Outcome`), and how
/// many faults its final bodies have. `scene` is the checkpoint's, with other wishes if need be.
#[pyfunction]
pub fn review(
    py: Python<'_>,
    checkpoint: &Checkpoint,
    scene: &Scene,
    patches: &PatchSet,
) -> PyResult<(&'static str, String, usize)> {
    let found = run(py, || core::review(&checkpoint.0, &scene.0, &patches.0))?;
    let (status, reason) = told(found.status);
    Ok((status, reason, found.faults))
}

/// Tile `scene` with the kinds of `patches`. The same seed gives the same crowd for any number of threads, unless
/// time runs out.
///
/// `method` is "engine" (the project's) or "paper" (Algorithms 1 and 2 as published); `time` is the longest that search
/// and final bodies may take, in seconds; `threads` are as many as the machine has cores unless given. `progress(p)` is called about twenty times a
/// second and stops the search by returning False. Ctrl-C stops it too: the KeyboardInterrupt that is raised has the
/// best tiling so far as its attribute `outcome`.
///
/// The engine writes a checkpoint to `checkpoint` every `checkpoint_every` seconds and when its search ends, with the
/// name of the patch set if `patches_name` tells it. A run that was killed goes on if its checkpoint is given as
/// `resume`, with the scene of the checkpoint or one of other wishes.
#[pyfunction]
#[pyo3(signature = (
    scene, patches, *, seed=1, method="engine", time=60.0, threads=None, progress=None, resume=None, checkpoint=None,
    checkpoint_every=10.0, patches_name=None,
))]
#[allow(clippy::too_many_arguments)]
pub fn tile(
    py: Python<'_>,
    scene: &Scene,
    patches: &PatchSet,
    seed: u64,
    method: &str,
    time: f64,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
    resume: Option<&Checkpoint>,
    checkpoint: Option<PathBuf>,
    checkpoint_every: f64,
    patches_name: Option<String>,
) -> PyResult<Outcome> {
    let method = match method {
        "engine" => core::Method::Engine,
        "paper" => core::Method::Paper,
        other => {
            return Err(PyValueError::new_err(format!("expected method \"engine\" or \"paper\", found {other:?}")));
        }
    };
    if !(time > 0.0 && time <= 1e6) {
        return Err(PyValueError::new_err(format!("expected a time of more than 0 seconds, found {time}")));
    }
    if checkpoint_every.is_nan() || checkpoint_every < 0.0 {
        return Err(PyValueError::new_err(format!("expected seconds between checkpoints, found {checkpoint_every}")));
    }
    let keep = checkpoint.as_deref().map(|path| core::Keep {
        path,
        every_secs: checkpoint_every,
        patches: patches_name.as_deref(),
    });
    let session = core::Session { from: resume.map(|kept| &kept.0), keep, steps: None };
    let options = core::Options { method, seed, time_secs: time };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
    let pool = pool.map_err(|e| CrowdquiltError::new_err(format!("threads: {e}")))?;
    let show = |py: Python<'_>, p: core::Progress| Ok(Py::new(py, self::progress(&p))?.into_any());
    let solve = |report: &(dyn Fn(core::Progress) -> bool + Sync)| {
        pool.install(|| core::tile_in(session, &scene.0, &patches.0, &options, &mut |p| report(*p)))
    };
    let (found, interrupt) = watched(py, progress, show, solve);
    let found = outcome(py, found?)?;
    match interrupt {
        None => Ok(found),
        Some(error) => {
            if error.is_instance_of::<PyKeyboardInterrupt>(py) {
                error.value(py).setattr("outcome", found)?;
            }
            Err(error)
        }
    }
}
