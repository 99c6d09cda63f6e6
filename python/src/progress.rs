//! Long work that Python watches: it is told about progress, and may stop it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use std::panic::{AssertUnwindSafe, catch_unwind};

use pyo3::prelude::*;

use crate::error::{internal, to_python};

/// Runs `work` on a thread of its own, so that this one can call Python back and hear Ctrl-C, which Python tells to
/// its main thread only. `show` makes a report into what the callback gets. Returns what came of the work, and the
/// exception that stopped it if one did.
pub fn watched<P: Send, T: Send>(
    py: Python<'_>,
    callback: Option<Py<PyAny>>,
    show: impl Fn(Python<'_>, P) -> PyResult<Py<PyAny>>,
    work: impl FnOnce(&(dyn Fn(P) -> bool + Sync)) -> crowdquilt::Result<T> + Send,
) -> (PyResult<T>, Option<PyErr>) {
    let stop = AtomicBool::new(false);
    let (sender, mut receiver) = mpsc::sync_channel::<P>(1);
    std::thread::scope(|scope| {
        let stop = &stop;
        let worker = scope.spawn(move || {
            let report = |p| {
                // A report that finds the one before not yet fetched is dropped: the next comes soon.
                let _ = sender.try_send(p);
                !stop.load(Ordering::Relaxed)
            };
            catch_unwind(AssertUnwindSafe(|| work(&report)))
        });
        let mut interrupt = None;
        loop {
            let heard = match py.detach(|| receiver_wait(&mut receiver)) {
                Err(RecvTimeoutError::Disconnected) => break,
                Err(RecvTimeoutError::Timeout) => Ok(true),
                // Who has raised is not asked again.
                Ok(report) if interrupt.is_none() => ask(py, callback.as_ref(), &show, report),
                Ok(_) => Ok(true),
            };
            match heard.and_then(|go_on| py.check_signals().map(|()| go_on)) {
                Ok(true) => {}
                Ok(false) => stop.store(true, Ordering::Relaxed),
                Err(error) => {
                    stop.store(true, Ordering::Relaxed);
                    interrupt.get_or_insert(error);
                }
            }
        }
        let found = match py.detach(|| worker.join()) {
            Ok(Ok(result)) => result.map_err(to_python),
            Ok(Err(panic)) | Err(panic) => Err(internal(&*panic)),
        };
        (found, interrupt)
    })
}

fn receiver_wait<P>(receiver: &mut mpsc::Receiver<P>) -> Result<P, RecvTimeoutError> {
    receiver.recv_timeout(Duration::from_millis(50))
}

/// Tells Python about the progress; anything but False means: go on.
fn ask<P>(
    py: Python<'_>,
    callback: Option<&Py<PyAny>>,
    show: &impl Fn(Python<'_>, P) -> PyResult<Py<PyAny>>,
    report: P,
) -> PyResult<bool> {
    let Some(callback) = callback else { return Ok(true) };
    let answer = callback.call1(py, (show(py, report)?,))?;
    Ok(!answer.bind(py).is(pyo3::types::PyBool::new(py, false)))
}
