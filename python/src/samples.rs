//! Glue of `crowdquilt::samples`.

use std::path::PathBuf;

use pyo3::prelude::*;

use crate::error::run;

/// Write all generated sample takes into `folder` (made if absent): a BVH file per person and a `NAME.take.json`
/// per take. The same seed gives the same files. Returns their paths in the order written.
#[pyfunction]
#[pyo3(signature = (folder, seed=1))]
pub fn write_samples(py: Python<'_>, folder: PathBuf, seed: u64) -> PyResult<Vec<PathBuf>> {
    run(py, || crowdquilt::samples::write(&folder, seed))
}
