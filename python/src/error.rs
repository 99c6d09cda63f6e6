//! Errors of the core as Python exceptions; panics stop here.

use std::panic::{AssertUnwindSafe, catch_unwind};

use crowdquilt::Error;
use pyo3::exceptions::{PyException, PyOSError};
use pyo3::prelude::*;

pyo3::create_exception!(
    crowdquilt,
    CrowdquiltError,
    PyException,
    "Bad input. The message names the file, the place in it, what was expected and what was found."
);

/// The exception for `error`: `OSError` and its kin (`FileNotFoundError`, ...) for files, else [`CrowdquiltError`].
pub fn to_python(error: Error) -> PyErr {
    match error {
        // OSError(errno, text, path) picks the subclass that belongs to the number.
        Error::Io { path, source } => match source.raw_os_error() {
            Some(code) => {
                let text = source.to_string();
                let text = text.split(" (os error").next().unwrap_or_default().to_owned();
                PyOSError::new_err((code, text, path.display().to_string()))
            }
            None => PyOSError::new_err(format!("{}: {source}", path.display())),
        },
        other => CrowdquiltError::new_err(other.to_string()),
    }
}

/// Runs `work` without the interpreter lock; its errors and panics come back as exceptions.
pub fn run<T: Send>(py: Python<'_>, work: impl FnOnce() -> crowdquilt::Result<T> + Send) -> PyResult<T> {
    match py.detach(|| catch_unwind(AssertUnwindSafe(work))) {
        Ok(result) => result.map_err(to_python),
        Err(panic) => Err(internal(&*panic)),
    }
}

/// The exception for a panic: a defect of ours.
pub fn internal(panic: &(dyn std::any::Any + Send)) -> PyErr {
    let text = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
    CrowdquiltError::new_err(format!("internal error, please report it: {}", text.unwrap_or("no message")))
}
