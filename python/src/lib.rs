//! The Python face of the core: one file of glue per module of the crate.
//!
//! Glue converts and releases the interpreter lock; it decides nothing. Python users import the modules of the
//! package `crowdquilt`, which are named like the crate's and re-export what stands here.

use pyo3::prelude::*;

mod error;
mod numbers;
mod patch;
mod stage;

#[pymodule]
mod _core {
    #[pymodule_export]
    use super::error::CrowdquiltError;
    #[pymodule_export]
    use super::patch::{Kind, PatchSet, Role};
    #[pymodule_export]
    use super::stage::{Crowd, Fragment};
}
