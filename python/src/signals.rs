//! Glue of what events were told by, frame by frame.

use crowdquilt::patch::episode::{self as core, EventKind};
use numpy::PyArray1;
use pyo3::prelude::*;

/// What was measured of two `people`, at every frame that both have: the `gap` between their surfaces (m, at most 0.3),
/// how far `apart` their hips are on the ground (m), how many times above its threshold the stronger variation is
/// (`reaction`, eq. 4), and so for `synchronicity` (eq. 5).
#[pyclass(frozen, get_all, module = "crowdquilt")]
pub struct PairSignals {
    people: (usize, usize),
    gap: Py<PyArray1<f32>>,
    apart: Py<PyArray1<f32>>,
    reaction: Py<PyArray1<f32>>,
    synchronicity: Py<PyArray1<f32>>,
}

/// What was measured in a take whose events were looked for: its `name`; of everybody the `variation` (eq. 4, m²) and
/// whether they count as travelling (`travels`), by frame; all `pairs`; and the `signs` that were found as (kind, people,
/// first frame, last frame), which make its events.
#[pyclass(frozen, get_all, module = "crowdquilt")]
pub struct TakeSignals {
    name: String,
    variation: Vec<Py<PyArray1<f32>>>,
    travels: Vec<Py<PyArray1<bool>>>,
    pairs: Vec<Py<PairSignals>>,
    signs: Vec<(&'static str, (usize, usize), usize, usize)>,
}

/// What is called what in Python.
pub fn kind_name(kind: EventKind) -> &'static str {
    match kind {
        EventKind::Contact => "contact",
        EventKind::Proximity => "proximity",
        EventKind::Synchronicity => "synchronicity",
    }
}

impl TakeSignals {
    pub fn of(py: Python<'_>, name: String, found: &core::Detection) -> PyResult<Self> {
        let numbers = |values: &[f32]| PyArray1::from_slice(py, values).unbind();
        let pair = |p: &core::PairSignals| {
            let (gap, apart) = (numbers(&p.gap), numbers(&p.apart));
            let (reaction, synchronicity) = (numbers(&p.reaction), numbers(&p.synchronicity));
            Py::new(py, PairSignals { people: p.people.into(), gap, apart, reaction, synchronicity })
        };
        let signs = found.events.iter().flat_map(|e| &e.signs);
        Ok(Self {
            name,
            variation: found.signals.people.iter().map(|p| numbers(&p.variation)).collect(),
            travels: found.signals.people.iter().map(|p| PyArray1::from_slice(py, &p.travels).unbind()).collect(),
            pairs: found.signals.pairs.iter().map(pair).collect::<PyResult<_>>()?,
            signs: signs.map(|s| (kind_name(s.kind), s.people.into(), s.begin, s.end)).collect(),
        })
    }
}
