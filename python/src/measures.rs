//! Glue of what is measured of a set's kinds.

use pyo3::prelude::*;

use crate::error::run;
use crate::patch::PatchSet;

/// What is measured of a kind: its number of `people`; `seconds` from the first entry to the last exit; mean `speed` of
/// all over the ground and the `fastest` of anybody (m/s); `radius` of the smallest circle around everything, seen from
/// above (m); `turn_deg`, the turn from entry to exit of who turns most (degrees, left positive); its number of `props`;
/// and `words` for what people do: `stand`, `step`, `walk`, `run`, `start`, `stop`, `turn`, `low`, `jump`, `together`,
/// `contact`, `prop`.
#[pyclass(frozen, get_all, module = "crowdquilt")]
pub struct Measures {
    people: usize,
    seconds: f32,
    speed: f32,
    fastest: f32,
    radius: f32,
    turn_deg: f32,
    props: usize,
    words: Vec<&'static str>,
}

#[pymethods]
impl Measures {
    fn __repr__(&self) -> String {
        format!(
            "Measures({}, {:.2} s, {:.2} m/s, radius {:.2} m)",
            self.words.join(" "),
            self.seconds,
            self.speed,
            self.radius
        )
    }
}

/// Measure every kind of a set.
#[pyfunction]
pub fn kind_measures(py: Python<'_>, patches: &PatchSet) -> PyResult<Vec<Measures>> {
    let set = &patches.0;
    let found = run(py, || Ok(set.kinds.iter().map(crowdquilt::patch::PatchKind::measures).collect::<Vec<_>>()))?;
    let one = |m: crowdquilt::patch::Measures| Measures {
        people: m.people,
        seconds: m.seconds,
        speed: m.speed,
        fastest: m.fastest,
        radius: m.radius,
        turn_deg: m.turn_deg,
        props: m.props,
        words: m.words,
    };
    Ok(found.into_iter().map(one).collect())
}
