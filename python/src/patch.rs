//! Glue of `crowdquilt::patch`.

use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::Arc;

use crowdquilt::motion::FPS;
use crowdquilt::patch as core;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::error::{run, to_python};
use crate::numbers::points2;

/// Cut the patches of all take files (`*.take.json`) of `folder` into one set, with mirrored copies.
///
/// Captures are looked up in `captures` if given, else beside the take files.
#[pyfunction]
#[pyo3(signature = (folder, captures=None))]
pub fn cut_patches(py: Python<'_>, folder: PathBuf, captures: Option<PathBuf>) -> PyResult<PatchSet> {
    run(py, || core::cut_folder(&folder, captures.as_deref())).map(|set| PatchSet(Arc::new(set)))
}

/// One person's part in a patch kind: pose groups of `entry` and `exit`, the frame of the patch's clock at which it
/// begins, and its number of frames.
#[pyclass(frozen, get_all, module = "crowdquilt")]
pub struct Role {
    entry: String,
    exit: String,
    begin: u32,
    frames: usize,
}

/// A motion patch that instances are made of: its people's `roles`, its `contacts` (how many), the first and last
/// frame of its interaction (`core`), its length in `frames`.
#[pyclass(frozen, get_all, module = "crowdquilt")]
pub struct Kind {
    name: String,
    labels: Vec<String>,
    roles: Vec<Py<Role>>,
    contacts: usize,
    core: Option<(u32, u32)>,
    mirrored: bool,
    frames: u32,
}

#[pymethods]
impl Kind {
    /// Number of people.
    #[getter]
    fn people(&self) -> usize {
        self.roles.len()
    }

    /// Seconds from the first entry to the last exit.
    #[getter]
    fn seconds(&self) -> f32 {
        self.frames.saturating_sub(1) as f32 / FPS
    }

    fn __repr__(&self) -> String {
        format!("Kind({:?}, people={}, seconds={:.2})", self.name, self.people(), self.seconds())
    }
}

/// The patch kinds to tile with.
#[pyclass(frozen, module = "crowdquilt")]
pub struct PatchSet(pub Arc<core::PatchSet>);

/// The kinds of `set`, for Python.
pub fn kinds(py: Python<'_>, set: &core::PatchSet) -> PyResult<Vec<Kind>> {
    let group = |index: u32| set.groups[index as usize].name.clone();
    let role = |f: &core::Fragment| {
        let (entry, exit) = (group(f.entry_group), group(f.exit_group));
        Py::new(py, Role { entry, exit, begin: f.begin, frames: f.motion.len() })
    };
    let kind = |k: &core::PatchKind| {
        Ok(Kind {
            name: k.name.clone(),
            labels: k.labels.clone(),
            roles: k.fragments.iter().map(role).collect::<PyResult<_>>()?,
            contacts: k.contacts.len(),
            core: k.core,
            mirrored: k.mirrored,
            frames: k.fragments.iter().map(|f| f.begin + f.motion.len() as u32).max().unwrap_or(0),
        })
    };
    set.kinds.iter().map(kind).collect()
}

#[pymethods]
impl PatchSet {
    /// Read a patch-set file (`*.patches`).
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        run(py, || core::PatchSet::load(&path)).map(|set| Self(Arc::new(set)))
    }

    /// A set from the bytes of a patch-set file.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, data: &[u8]) -> PyResult<Self> {
        run(py, || core::PatchSet::from_bytes(data)).map(|set| Self(Arc::new(set)))
    }

    /// Write a patch-set file, whole or not at all.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        run(py, || self.0.save(&path))
    }

    /// The bytes of a patch-set file.
    fn to_bytes(&self) -> Cow<'static, [u8]> {
        Cow::Owned(self.0.to_bytes())
    }

    /// All problems of the set, one message each; empty if it is sound.
    fn validate(&self) -> Vec<String> {
        self.0.validate().iter().map(ToString::to_string).collect()
    }

    /// Names of the pose groups of all ports.
    #[getter]
    fn groups(&self) -> Vec<String> {
        self.0.groups.iter().map(|g| g.name.clone()).collect()
    }

    /// The kinds.
    #[getter]
    fn kinds(&self, py: Python<'_>) -> PyResult<Vec<Kind>> {
        kinds(py, &self.0)
    }

    /// The motion path of one role of one kind: (frames, 2) ground points x, z in metres and (frames,) headings in
    /// radians, in the patch's own frame.
    fn path<'py>(&self, py: Python<'py>, kind: usize, role: usize) -> PyResult<Path<'py>> {
        let missing = || crowdquilt::Error::invalid("patch set", format!("kind {kind}"), format!("no role {role}"));
        let fragment = self.0.kinds.get(kind).and_then(|k| k.fragments.get(role));
        let path = &fragment.ok_or_else(missing).map_err(to_python)?.motion.path;
        Ok((points2(py, &path.points)?, PyArray1::from_slice(py, &path.headings)))
    }

    fn __len__(&self) -> usize {
        self.0.kinds.len()
    }

    fn __repr__(&self) -> String {
        format!("PatchSet(kinds={}, groups={})", self.0.kinds.len(), self.0.groups.len())
    }
}

type Path<'py> = (Bound<'py, PyArray2<f32>>, Bound<'py, PyArray1<f32>>);
