//! Glue of `crowdquilt::check`.

use crowdquilt::check as core;
use pyo3::prelude::*;

use crate::error::run;
use crate::stage::Crowd;

/// What one clause of the contract came to: the worst `value` found, its `limit` in the same `unit`, and the `place`
/// where it was found.
#[pyclass(frozen, get_all, module = "crowdquilt")]
#[derive(Clone)]
pub struct Row {
    clause: u8,
    row: String,
    value: f64,
    limit: f64,
    unit: String,
    ok: bool,
    place: String,
}

#[pymethods]
impl Row {
    fn __repr__(&self) -> String {
        format!("Row({:?}, value={}, limit={}, ok={})", self.row, self.value, self.limit, self.ok)
    }
}

/// The contract of a finished crowd, row by row; `str(report)` is a table.
#[pyclass(frozen, module = "crowdquilt")]
pub struct Report(pub core::Report);

#[pymethods]
impl Report {
    /// True if every row is within its limit.
    #[getter]
    fn ok(&self) -> bool {
        self.0.ok()
    }

    /// The rows, sorted by clause.
    #[getter]
    fn rows(&self) -> Vec<Row> {
        self.0.rows.iter().map(row).collect()
    }

    /// The rows beyond their limit.
    #[getter]
    fn failures(&self) -> Vec<Row> {
        self.0.failures().map(row).collect()
    }

    fn __str__(&self) -> String {
        self.0.to_string()
    }

    fn __repr__(&self) -> String {
        format!("Report(rows={}, failures={})", self.0.rows.len(), self.0.failures().count())
    }
}

fn row(r: &core::Row) -> Row {
    Row {
        clause: r.clause,
        row: r.row.clone(),
        value: r.value,
        limit: r.limit,
        unit: r.unit.clone(),
        ok: r.ok,
        place: r.place.clone(),
    }
}

/// The figures one quotes of a tiling: people, placed patches, kinds in use, share (0 to 1) of the people's time
/// inside patches of two or more, boxes, ports without a partner.
#[pyclass(frozen, get_all, module = "crowdquilt")]
pub struct Summary {
    characters: usize,
    instances: usize,
    kinds: usize,
    multi_person_share: f64,
    props: usize,
    danglings: usize,
}

/// Verify `crowd` from its output alone against the contract of a finished crowd.
#[pyfunction]
pub fn check_crowd(py: Python<'_>, crowd: &Crowd) -> PyResult<Report> {
    run(py, || Ok(core::check(&crowd.0))).map(Report)
}

/// Count what `crowd` consists of.
#[pyfunction]
pub fn summary(py: Python<'_>, crowd: &Crowd) -> PyResult<Summary> {
    let s = run(py, || Ok(core::summary(&crowd.0)))?;
    Ok(Summary {
        characters: s.characters,
        instances: s.instances,
        kinds: s.kinds_used,
        multi_person_share: s.multi_person_share,
        props: s.props,
        danglings: s.danglings,
    })
}
