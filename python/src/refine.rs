//! Glue of `crowdquilt::refine`.

use std::sync::Arc;

use crowdquilt::refine as core;
use pyo3::prelude::*;

use crate::error::run;
use crate::stage::Crowd;

/// A crowd's full bodies made anew from its fragments and builds alone: what tiling ends with, as a pass of its own. A
/// crowd as it was tiled comes out as it is.
#[pyfunction]
pub fn refine_crowd(py: Python<'_>, crowd: &Crowd) -> PyResult<Crowd> {
    run(py, || Ok(core::refine_crowd(&crowd.0))).map(|crowd| Crowd(Arc::new(crowd)))
}
