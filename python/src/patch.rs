//! Glue of `crowdquilt::patch`.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use crowdquilt::motion::FPS;
use crowdquilt::motion::collection::Collected;
use crowdquilt::patch as core;
use crowdquilt::patch::episode::{Detection, Event};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::error::{run, to_python};
use crate::numbers::points2;
use crate::progress::watched;
use crate::signals::{TakeSignals, kind_name};

/// Where captures come from: one path, or several.
#[derive(FromPyObject)]
pub enum Sources {
    One(PathBuf),
    Several(Vec<PathBuf>),
}

/// Make a patch set of captures: a folder, an index (`.csv`), a take file (`.take.json`) or one capture; or several of
/// them together.
///
/// Takes without patches annotate themselves: events between people are found, and a few recurring poses at which
/// patches begin and end. `captures` is a folder that captures are looked up in first. `threshold` is how near two poses
/// of a group are (m), `groups` how many groups there are at most, `alone` how many patches of one person are kept,
/// `touch_gap` how near surfaces touch (m), `near` how near people react to each other (m). `compose` are files
/// (`*.compose.toml`) that compose patches by hand, or folders of them, besides those in the source folders. Unless `study` is
/// False, how people come to patches, go on and part is found out too (see `PatchSet.study`). `progress` is called with what is being done and how much of it (0 to 1); it stops the work by returning False.
#[pyfunction]
#[pyo3(signature = (source, captures=None, *, threshold=None, groups=None, alone=None, touch_gap=None, near=None, compose=None, study=true, progress=None))]
#[allow(clippy::too_many_arguments)]
pub fn make_patches(
    py: Python<'_>,
    source: Sources,
    captures: Option<PathBuf>,
    threshold: Option<f32>,
    groups: Option<usize>,
    alone: Option<usize>,
    touch_gap: Option<f32>,
    near: Option<f32>,
    compose: Option<Vec<PathBuf>>,
    study: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Made> {
    let sources = match source {
        Sources::One(path) => vec![path],
        Sources::Several(paths) => paths,
    };
    let mut options = core::MakeOptions { compose: compose.unwrap_or_default(), ..Default::default() };
    options.cut.captures = captures;
    let annotate = &mut options.annotate;
    set(&mut annotate.boundaries.threshold, threshold, "threshold", 0.01..1.0)?;
    set(&mut annotate.boundaries.most, groups, "groups", 1..21)?;
    annotate.boundaries.groups = annotate.boundaries.groups.max(annotate.boundaries.most);
    set(&mut annotate.alone.most, alone, "alone", 0..100_001)?;
    set(&mut annotate.episodes.touch_gap, touch_gap, "touch_gap", 0.0..1.0)?;
    set(&mut annotate.episodes.near, near, "near", 0.0..100.0)?;
    let show = |py: Python<'_>, step: (&str, f32)| Ok(step.into_pyobject(py)?.into_any().unbind());
    let (made, interrupt) = watched(py, progress, show, |report| {
        let mut made = core::make_with(&sources, &options, &|step| report(named(step)))?;
        // What cannot be tiled with is told when somebody tries.
        if study && matches!(studied(&mut made.set, report), Err(crowdquilt::Error::Stopped)) {
            return Err(crowdquilt::Error::Stopped);
        }
        Ok(made)
    });
    match interrupt {
        None => Ok(Made(made?)),
        Some(error) => Err(error),
    }
}

/// A step of the making, and how much of it is done.
fn named(step: core::Step) -> (&'static str, f32) {
    match step {
        core::Step::Read(done, all) => ("reading captures", done as f32 / all.max(1) as f32),
        core::Step::Find => ("finding events", 0.0),
        core::Step::Cut => ("cutting", 0.0),
    }
}

fn studied(set: &mut core::PatchSet, report: &dyn Fn((&'static str, f32)) -> bool) -> crowdquilt::Result<()> {
    let report = |share| report(("studying who can go on with what", share));
    crowdquilt::tiling::study(set, crowdquilt::deform::Limits::default(), &report)
}

/// Sets an option that was given, if it is in its range.
fn set<T: PartialOrd + std::fmt::Debug>(
    option: &mut T,
    given: Option<T>,
    name: &str,
    range: std::ops::Range<T>,
) -> PyResult<()> {
    let Some(value) = given else { return Ok(()) };
    if !range.contains(&value) {
        let expected = format!("{name}: expected {:?} or more, below {:?}, found {value:?}", range.start, range.end);
        return Err(PyValueError::new_err(expected));
    }
    *option = value;
    Ok(())
}

/// A patch set, and how it came about.
#[pyclass(frozen, module = "crowdquilt")]
pub struct Made(core::Made);

#[pymethods]
impl Made {
    /// The set.
    #[getter]
    fn set(&self) -> PatchSet {
        PatchSet(Arc::new(self.0.set.clone()))
    }

    /// The takes: what was found in each.
    #[getter]
    fn takes(&self, py: Python<'_>) -> PyResult<Vec<Py<Take>>> {
        (0..self.0.takes.len()).map(|i| Py::new(py, self.take(i))).collect()
    }

    /// What events were told by, of every take in which they were looked for.
    fn signals(&self, py: Python<'_>) -> PyResult<Vec<Py<TakeSignals>>> {
        let found = self.0.annotation.as_ref().map_or(&[][..], |a| &a.found);
        let take = |(&take, found): (&usize, &Detection)| {
            Py::new(py, TakeSignals::of(py, self.0.takes[take].take.name.clone(), found)?)
        };
        self.0.found_in.iter().zip(found).map(take).collect()
    }

    /// What counted as an event: `touch_gap` and `near` in metres; the variations (eq. 4, m²) above which somebody acts
    /// who stays `in_place`, and who is `travelling`. Empty if no take was looked at.
    #[getter]
    fn thresholds(&self) -> BTreeMap<&'static str, f32> {
        let Some(found) = self.0.annotation.as_ref().and_then(|a| a.found.first()) else { return BTreeMap::new() };
        let of = &found.thresholds;
        BTreeMap::from([
            ("touch_gap", of.touch_gap),
            ("near", of.near),
            ("in_place", of.in_place),
            ("travelling", of.travelling),
        ])
    }

    /// The take files that say what was cut, as (name, JSON text): to be edited, and cut again. Takes of which nothing
    /// was cut are left out.
    fn take_files(&self) -> Vec<(String, String)> {
        let file = |c: &Collected| (format!("{}.take.json", c.take.name), c.take.to_json());
        self.0.takes.iter().filter(|c| !c.take.patches.is_empty()).map(file).collect()
    }
}

impl Made {
    fn take(&self, index: usize) -> Take {
        let take = &self.0.takes[index].take;
        let found = self.0.found_in.iter().position(|&i| i == index);
        let events = found.zip(self.0.annotation.as_ref()).map_or(&[][..], |(k, a)| &a.found[k].events);
        let event = |e: &Event| (kind_name(e.kind), e.people.clone(), e.begin as f32 / FPS, e.end as f32 / FPS);
        Take {
            name: take.name.clone(),
            people: take.people.len(),
            annotated: found.is_none(),
            events: events.iter().map(event).collect(),
            patches: take.patches.iter().map(|p| p.name.clone()).collect(),
            together: self.0.together(index),
            notes: self.0.notes(index),
        }
    }
}

/// What was found in a take: how many `people`; whether somebody had `annotated` it; its `events` as (kind, people,
/// begin, end) in seconds; names of the `patches` cut from it; the share of its time within those of several people
/// (`together`); `notes` on why nothing, or less than everything, came of it.
#[pyclass(frozen, get_all, module = "crowdquilt")]
pub struct Take {
    name: String,
    people: usize,
    annotated: bool,
    events: Vec<(&'static str, Vec<usize>, f32, f32)>,
    patches: Vec<String>,
    together: f32,
    notes: Vec<String>,
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

    /// The set with what can be found out about its kinds beforehand: how people come to them, go on from one to another
    /// together, and part. Tiling is faster with it, and finds more. Kept in the set's file.
    fn study(&self, py: Python<'_>) -> PyResult<Self> {
        let mut set = core::PatchSet::clone(&self.0);
        run(py, || crowdquilt::tiling::study(&mut set, crowdquilt::deform::Limits::default(), &|_| true))?;
        Ok(Self(Arc::new(set)))
    }

    /// True if it comes with a study.
    #[getter]
    fn studied(&self) -> bool {
        self.0.study.is_some()
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
