//! Glue of what goes beyond playing a world: days, journeys, spectators.

use std::sync::{Arc, Mutex, PoisonError};

use crowdquilt::stage::world as stage;
use crowdquilt::world as core;
use glam::DVec2;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;

use crate::error::{CrowdquiltError, run};
use crate::numbers::table;
use crate::world::World;

/// How many people are there at which time of day: `hours` are 24 shares (0 to 1) from midnight on, `hidden` the templates where
/// nobody looks. Nobody appears or vanishes anywhere else; those who never come there are always there.
#[pyclass(frozen, module = "crowdquilt")]
pub struct Day(pub core::Day, pub Arc<stage::World>);

#[pymethods]
impl Day {
    #[new]
    fn new(py: Python<'_>, world: &World, hours: Vec<f32>, hidden: Vec<String>) -> PyResult<Self> {
        let found = hours.len();
        let hours: [f32; 24] = hours
            .try_into()
            .map_err(|_| CrowdquiltError::new_err(format!("day: hours: expected 24 of them, found {found}")))?;
        let hidden: Vec<&str> = hidden.iter().map(String::as_str).collect();
        run(py, || core::Day::new(&world.0, hours, &hidden)).map(|day| Self(day, world.0.clone()))
    }

    /// Share of people who are there at a time, seconds since midnight, where it is decided at once.
    fn share(&self, secs: f64) -> f32 {
        self.0.share(secs)
    }

    /// Share of those who come in somewhere that may ever be absent.
    #[getter]
    fn movable(&self) -> f64 {
        self.0.movable()
    }

    /// (n,): who of those that `world.at(secs)` tells is there, in the same order.
    #[pyo3(signature = (secs, *, near=None))]
    fn present<'py>(
        &self,
        py: Python<'py>,
        secs: f64,
        near: Option<(f64, f64, f64)>,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let world = &self.1;
        let who = run(py, || {
            let moment = core_time(world, secs)?;
            let spot = |s: stage::Spot| {
                let (instance, copy) = (s.instance as usize, copy(world, s.shift));
                let walkers = world.walkers_of(instance, &moment);
                walkers.map(move |(walker, lap)| self.0.present(world, instance, copy, walker, lap)).collect::<Vec<_>>()
            };
            Ok(spots(world, near).into_iter().flat_map(spot).collect::<Vec<bool>>())
        })?;
        Ok(PyArray1::from_vec(py, who))
    }
}

/// Somebody who stands or walks in a world, and is walked around: others step aside, and are back on their way at every border of a
/// patch. What they do follows from the spectator's track alone.
#[pyclass(frozen, module = "crowdquilt")]
pub struct Spectator(Mutex<core::Spectator>, Arc<stage::World>);

type Seen<'py> =
    (Bound<'py, PyArray1<u64>>, Bound<'py, PyArray2<f32>>, Bound<'py, PyArray2<f32>>, Bound<'py, PyArray2<f32>>);

#[pymethods]
impl Spectator {
    #[new]
    #[pyo3(signature = (world, radius=0.25))]
    fn new(world: &World, radius: f64) -> Self {
        Self(Mutex::new(core::Spectator::new(radius)), world.0.clone())
    }

    /// The spectator is at (x, z) at a time: later than told before, or the track begins anew.
    fn look(&self, py: Python<'_>, secs: f64, place: (f64, f64)) -> PyResult<()> {
        let mut own = self.0.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        let own = &mut *own;
        run(py, || own.look(&self.1, secs, DVec2::new(place.0, place.1)))
    }

    /// Everybody in the patches that reach into a disc (x, z, radius) at the time of the last look: (n,) identities, (n, 2) places
    /// in metres from the disc's middle, (n, 2) velocities, (n, 2) how far each has stepped aside.
    fn people<'py>(&self, py: Python<'py>, secs: f64, near: (f64, f64, f64)) -> PyResult<Seen<'py>> {
        let mut own = self.0.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        let (own, world) = (&mut *own, &self.1);
        let seen = run(py, || {
            core_time(world, secs)?;
            Ok(own.people(world, spots(world, Some(near)).into_iter(), secs))
        })?;
        let middle = DVec2::new(near.0, near.1);
        let pairs = |of: &dyn Fn(&core::spectator::Seen) -> DVec2| {
            table(py, seen.iter().flat_map(|s| of(s).as_vec2().to_array()).collect(), 2)
        };
        let ids = PyArray1::from_vec(py, seen.iter().map(|s| s.person.hash(0)).collect());
        Ok((ids, pairs(&|s| s.place - middle)?, pairs(&|s| s.velocity)?, pairs(&|s| s.aside)?))
    }
}

/// Who comes from the patch at one place (x, z) to the patch at another first, of all who come into the first at `earliest` or later:
/// identity, when it comes into the first, and when into the other, seconds; None if nobody ever does.
#[pyfunction]
pub fn journey(
    py: Python<'_>,
    world: &World,
    start: (f64, f64),
    end: (f64, f64),
    earliest: f64,
) -> PyResult<Option<(u64, f64, f64)>> {
    let world = &world.0;
    let found = run(py, || {
        core_time(world, earliest)?;
        let patch = |(x, z): (f64, f64)| {
            let problem =
                || crowdquilt::Error::invalid("world", "place", format!("expected a patch at ({x}, {z}), found none"));
            world.patch_at(DVec2::new(x, z)).ok_or_else(problem)
        };
        Ok(world.journey(patch(start)?, patch(end)?, earliest))
    })?;
    Ok(found.map(|j| (j.person.hash(0), j.departure, j.arrival)))
}

/// A time that can be.
fn core_time(world: &stage::World, secs: f64) -> crowdquilt::Result<stage::Moment> {
    if secs.is_finite() && secs.abs() < 1e9 {
        return Ok(world.moment(secs));
    }
    Err(crowdquilt::Error::invalid("world", "time", format!("expected seconds within 1e9, found {secs}")))
}

fn spots(world: &stage::World, near: Option<(f64, f64, f64)>) -> Vec<stage::Spot> {
    match near {
        Some((x, z, radius)) => world.nearby().within(DVec2::new(x, z), radius).collect(),
        None => (0..world.instances() as u32).map(|instance| stage::Spot { instance, shift: DVec2::ZERO }).collect(),
    }
}

fn copy(world: &stage::World, shift: DVec2) -> [i64; 2] {
    let count = |shift: f64, size: i32| (shift * stage::UNITS_PER_METRE / f64::from(size)).round() as i64;
    world.info().repeat.map_or([0, 0], |[x, z]| [count(shift.x, x), count(shift.y, z)])
}
