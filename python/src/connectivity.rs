//! Glue of `crowdquilt::patch::connectivity`, and the bodies of a set's kinds.

use crowdquilt::motion::{BODY_CAPSULES, JOINT_COUNT, body_capsules};
use crowdquilt::patch::{PatchProp, connectivity as core};
use glam::{Quat, Vec3};
use numpy::{PyArray2, PyArray3};
use pyo3::prelude::*;

use crate::error::{run, to_python};
use crate::numbers::{stack, table};
use crate::patch::PatchSet;

/// What one can do alone from a pose group: the least and the most over the kinds of one person that begin there.
///
/// `turn_deg` from entry to exit, left positive; mean `speed`, m/s; `secs`; way to the `left` and `ahead`, metres, seen
/// from the entry.
#[pyclass(frozen, get_all, module = "crowdquilt")]
pub struct Steering {
    turn_deg: (f32, f32),
    speed: (f32, f32),
    secs: (f32, f32),
    left: (f32, f32),
    ahead: (f32, f32),
}

/// A pose group, and how many kinds of one person (`alone`) and of several (`together`) end (`in`) and begin (`out`)
/// there.
#[pyclass(frozen, get_all, module = "crowdquilt")]
pub struct GroupLinks {
    name: String,
    in_alone: u32,
    in_together: u32,
    out_alone: u32,
    out_together: u32,
    steering: Option<Py<Steering>>,
}

/// The kinds in which somebody goes from group `entry` to group `exit`: those of one person (`alone`), and the roles of
/// those of several (`together`).
#[pyclass(frozen, get_all, module = "crowdquilt")]
pub struct Link {
    entry: String,
    exit: String,
    alone: u32,
    together: u32,
}

/// Groups between which one can go to and fro alone. `lasting`: one can go on inside for ever; `entered`, `left`: one
/// can come in from others, leave for others; `main`: others are to be joined to this one.
#[pyclass(frozen, get_all, module = "crowdquilt")]
pub struct Component {
    groups: Vec<String>,
    lasting: bool,
    entered: bool,
    left: bool,
    main: bool,
}

/// Whether a set can go on for ever: its pose groups as nodes, its kinds as edges.
///
/// `not_entered` and `not_left` name the kinds to and from which no endless chain of kinds of one person leads;
/// `missing` are the fewest ways of one person, from group to group, that make it `closed`; `advice` says so in words.
#[pyclass(frozen, get_all, module = "crowdquilt")]
pub struct Connectivity {
    groups: Vec<Py<GroupLinks>>,
    links: Vec<Py<Link>>,
    components: Vec<Py<Component>>,
    not_entered: Vec<String>,
    not_left: Vec<String>,
    closed: bool,
    missing: Vec<(String, String)>,
    advice: Vec<String>,
}

#[pymethods]
impl Connectivity {
    fn __repr__(&self) -> String {
        format!("Connectivity(closed={}, advice={})", if self.closed { "True" } else { "False" }, self.advice.len())
    }
}

/// Look at how the kinds of a set follow each other: where people cannot come from or go on to, and what would help.
#[pyfunction]
pub fn connectivity(py: Python<'_>, patches: &PatchSet) -> PyResult<Connectivity> {
    let set = &patches.0;
    let found = run(py, || Ok(core::connectivity(set)))?;
    let name = |group: u32| set.groups[group as usize].name.clone();
    let names = |kinds: &[u32]| kinds.iter().map(|&k| set.kinds[k as usize].name.clone()).collect();
    let group = |(index, links): (usize, &core::GroupLinks)| {
        let steering = links.steering.map(|s| Py::new(py, Steering::from(s))).transpose()?;
        Py::new(py, GroupLinks::new(name(index as u32), links, steering))
    };
    let link = |l: &core::Link| {
        Py::new(py, Link { entry: name(l.entry), exit: name(l.exit), alone: l.alone, together: l.together })
    };
    let component = |c: &core::Component| {
        let groups = c.groups.iter().map(|&g| name(g)).collect();
        Py::new(py, Component { groups, lasting: c.lasting, entered: c.entered, left: c.left, main: c.main })
    };
    Ok(Connectivity {
        groups: found.groups.iter().enumerate().map(group).collect::<PyResult<_>>()?,
        links: found.links.iter().map(link).collect::<PyResult<_>>()?,
        components: found.components.iter().map(component).collect::<PyResult<_>>()?,
        not_entered: names(&found.not_entered),
        not_left: names(&found.not_left),
        closed: found.closed,
        missing: found.missing.iter().map(|&(a, b)| (name(a), name(b))).collect(),
        advice: found.advice,
    })
}

impl From<core::Steering> for Steering {
    fn from(s: core::Steering) -> Self {
        Self {
            turn_deg: s.turn_deg.into(),
            speed: s.speed.into(),
            secs: s.secs.into(),
            left: s.left.into(),
            ahead: s.ahead.into(),
        }
    }
}

impl GroupLinks {
    fn new(name: String, links: &core::GroupLinks, steering: Option<Py<Steering>>) -> Self {
        Self {
            name,
            in_alone: links.in_alone,
            in_together: links.in_together,
            out_alone: links.out_alone,
            out_together: links.out_together,
            steering,
        }
    }
}

type Bodies<'py> = PyResult<Bound<'py, PyArray3<f32>>>;

/// The body of one role of one kind: (frames, joints, 3) positions of the joints in metres, in the patch's own frame,
/// y up. The joints are those of every crowd (`Crowd.joints`).
#[pyfunction]
pub fn kind_positions<'py>(py: Python<'py>, patches: &PatchSet, kind: usize, role: usize) -> Bodies<'py> {
    let add = |globals: &[(Vec3, Quat)], out: &mut Vec<f32>| out.extend(globals.iter().flat_map(|(p, _)| p.to_array()));
    stack(py, every_frame(py, patches, kind, role, add)?, JOINT_COUNT, 3)
}

/// The body of one role of one kind as (frames, capsules, 7) capsules: both ends x, y, z and the radius in metres, in
/// the patch's own frame. They are those of `Crowd.capsules`.
#[pyfunction]
pub fn kind_capsules<'py>(py: Python<'py>, patches: &PatchSet, kind: usize, role: usize) -> Bodies<'py> {
    let mut capsules = Vec::new();
    let add = |globals: &[(Vec3, Quat)], out: &mut Vec<f32>| {
        capsules.clear();
        body_capsules(globals, &mut capsules);
        for c in &capsules {
            out.extend(c.a.to_array().into_iter().chain(c.b.to_array()).chain([c.radius]));
        }
    };
    stack(py, every_frame(py, patches, kind, role, add)?, BODY_CAPSULES.len(), 7)
}

/// The boxes of one kind: of each its size (width, height, depth; metres), the first frame of the kind's clock at which
/// it is there, and (frames, 4) places of its middle x, y, z and its heading, in the patch's own frame.
#[pyfunction]
pub fn kind_boxes<'py>(py: Python<'py>, patches: &PatchSet, kind: usize) -> PyResult<Vec<KindBox<'py>>> {
    let missing = || crowdquilt::Error::invalid("patch set", format!("kind {kind}"), "does not exist");
    let kind = patches.0.kinds.get(kind).ok_or_else(missing).map_err(to_python)?;
    let last = kind.fragments.iter().map(|f| f.begin + f.motion.len() as u32).max().unwrap_or(0);
    let place = |prop: &PatchProp| {
        let mut there = (0..last).filter_map(|frame| Some((frame, prop.place(kind, frame)?))).peekable();
        let begin = there.peek().map_or(0, |(frame, _)| *frame);
        let values = there.flat_map(|(_, at)| [at.middle.x, at.middle.y, at.middle.z, at.heading]).collect();
        Ok((prop.size.into(), begin, table(py, values, 4)?))
    };
    kind.props.iter().map(place).collect()
}

type KindBox<'py> = ((f32, f32, f32), u32, Bound<'py, PyArray2<f32>>);

/// What `add` makes of the joints' global transforms at every frame of a role.
fn every_frame(
    py: Python<'_>,
    patches: &PatchSet,
    kind: usize,
    role: usize,
    mut add: impl FnMut(&[(Vec3, Quat)], &mut Vec<f32>) + Send,
) -> PyResult<Vec<f32>> {
    let missing = || crowdquilt::Error::invalid("patch set", format!("kind {kind}"), format!("no role {role}"));
    let fragment = patches.0.kinds.get(kind).and_then(|k| k.fragments.get(role));
    let motion = &fragment.ok_or_else(missing).map_err(to_python)?.motion;
    run(py, || {
        let (mut globals, mut values) = (Vec::new(), Vec::new());
        for frame in 0..motion.len() {
            motion.globals(frame, &mut globals);
            add(&globals, &mut values);
        }
        Ok(values)
    })
}
