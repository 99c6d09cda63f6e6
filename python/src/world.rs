//! Glue of `crowdquilt::world` and `crowdquilt::stage::world`.

use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::Arc;

use crowdquilt::check::world as check;
use crowdquilt::motion::{JOINT_COUNT, canonical};
use crowdquilt::stage::world as stage;
use crowdquilt::world as core;
use glam::{DVec2, Quat, Vec2, Vec3};
use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;

use crate::check::Report;
use crate::error::run;
use crate::numbers::{points2, stack, table};
use crate::patch::PatchSet;
use crate::progress::watched;

/// What a world is made from: templates, and a map of where which is.
#[pyclass(frozen, module = "crowdquilt")]
pub struct WorldScene(pub core::WorldScene);

#[pymethods]
impl WorldScene {
    /// Read a scene from a TOML file.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        run(py, || core::WorldScene::load(&path)).map(Self)
    }

    /// Read a scene from TOML text; a map in a picture is looked for in `folder`.
    #[staticmethod]
    #[pyo3(signature = (text, folder=PathBuf::from(".")))]
    fn from_toml(py: Python<'_>, text: &str, folder: PathBuf) -> PyResult<Self> {
        run(py, || core::WorldScene::from_toml(text, &folder)).map(Self)
    }

    /// A scene from the bytes of another.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, data: &[u8]) -> PyResult<Self> {
        run(py, || core::WorldScene::from_bytes(data)).map(Self)
    }

    /// The scene as bytes, with all that its files said: for another process or machine with the same version.
    fn to_bytes(&self) -> Cow<'static, [u8]> {
        Cow::Owned(self.0.to_bytes())
    }

    /// The same scene with another seed.
    #[pyo3(signature = (*, seed=None))]
    fn replace(&self, seed: Option<u64>) -> Self {
        let scene = self.0.clone();
        Self(match seed {
            Some(seed) => scene.with_seed(seed),
            None => scene,
        })
    }

    /// The same scene, in which people who stay do something that the people of `patches` do: groups play patches of several people,
    /// who is alone those of one who stays in place. Kinds with a word of the gathering's name as a label are meant; where there are
    /// none any will do. Returns the scene, and in words for whom nothing was found.
    fn with_acts(&self, py: Python<'_>, patches: &PatchSet) -> PyResult<(Self, Vec<String>)> {
        run(py, || Ok(self.0.clone().with_acts(&patches.0))).map(|(scene, notes)| (Self(scene), notes))
    }

    /// What it is called.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// Same seed, same world.
    #[getter]
    fn seed(&self) -> u64 {
        match &self.0.layout {
            core::Layout::Map(plan) => plan.seed,
            core::Layout::Area(area) => area.seed,
        }
    }

    fn __repr__(&self) -> String {
        let what = match &self.0.layout {
            core::Layout::Map(plan) => format!("cells={} x {}", plan.size().0, plan.size().1),
            core::Layout::Area(area) => format!("polygons={}", area.grounds.len()),
        };
        format!("WorldScene({:?}, {what})", self.0.name)
    }
}

/// What crosses an edge of a patch kind: its length in metres; (n, 4) arrays of who comes in and who goes out: place in metres
/// along the edge, time in seconds, speed across and along it in m/s.
#[pyclass(frozen, get_all, module = "crowdquilt")]
pub struct Pattern {
    length: f32,
    inputs: Py<PyArray2<f32>>,
    outputs: Py<PyArray2<f32>>,
}

/// A baked world of crowd patches, playable at any time. Metres, seconds, y up; `len(world)` is the number of its patches.
#[pyclass(frozen, module = "crowdquilt")]
pub struct World(pub Arc<stage::World>);

type People<'py> = (Bound<'py, PyArray1<u64>>, Bound<'py, PyArray2<f32>>, Bound<'py, PyArray2<f32>>);
type Bodies<'py> = (Bound<'py, PyArray1<u64>>, Bound<'py, PyArray3<f32>>);
type Object<'py> = (String, Bound<'py, PyArray2<f32>>, f32);
type Way<'py> = (f64, Bound<'py, PyArray2<f32>>);

impl World {
    fn kind(&self, kind: usize) -> PyResult<stage::Kind<'_>> {
        let kinds = self.0.kinds();
        if kind < kinds {
            return Ok(self.0.kind(kind));
        }
        Err(PyIndexError::new_err(format!("kind {kind} does not exist: the world has {kinds} kinds")))
    }
}

#[pymethods]
impl World {
    /// Read a world file (`*.world`).
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        run(py, || stage::World::load(&path)).map(|world| Self(Arc::new(world)))
    }

    /// A world from the bytes of a world file.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, data: &[u8]) -> PyResult<Self> {
        run(py, || stage::World::from_bytes(data)).map(|world| Self(Arc::new(world)))
    }

    /// Write a world file, whole or not at all.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        run(py, || self.0.save(&path))
    }

    /// The bytes of a world file.
    fn to_bytes(&self) -> Cow<'static, [u8]> {
        Cow::Owned(self.0.to_bytes())
    }

    /// What it is called.
    #[getter]
    fn name(&self) -> &str {
        &self.0.info().name
    }

    /// Seed it was made with.
    #[getter]
    fn seed(&self) -> u64 {
        self.0.info().seed
    }

    /// Everything repeats after this time, seconds.
    #[getter]
    fn period_secs(&self) -> f32 {
        self.0.info().period_secs
    }

    /// Size in x and z of what repeats for ever, metres; None if the world ends.
    #[getter]
    fn repeat(&self) -> Option<(f64, f64)> {
        self.0
            .info()
            .repeat
            .map(|[x, z]| (f64::from(x) / stage::UNITS_PER_METRE, f64::from(z) / stage::UNITS_PER_METRE))
    }

    /// Radius of a walker's body, metres.
    #[getter]
    fn radius(&self) -> f32 {
        self.0.info().limits.radius
    }

    /// Names of the templates, and what their ground looks like.
    #[getter]
    fn templates(&self) -> Vec<(String, String)> {
        self.0.info().templates.iter().map(|t| (t.name.clone(), t.ground.clone())).collect()
    }

    /// How many patch kinds its patches share.
    #[getter]
    fn kinds(&self) -> usize {
        self.0.kinds()
    }

    /// How many different patterns there are, counting mirror images once.
    #[getter]
    fn patterns(&self) -> usize {
        self.0.tables().pattern_lengths.len()
    }

    /// How many people stay inside their patches.
    #[getter]
    fn stayers(&self) -> usize {
        self.0.stayers()
    }

    /// How many people walk on average over a period.
    #[getter]
    fn walkers(&self) -> f64 {
        let (slots, period) = (self.0.info().slots, f64::from(self.0.info().period_secs));
        let at = |slot: u32| self.0.moment((f64::from(slot) + 0.5) * period / f64::from(slots));
        (0..slots).map(|slot| self.0.walkers(&at(slot)) as f64).sum::<f64>() / f64::from(slots)
    }

    /// Bytes it takes in memory.
    #[getter]
    fn memory(&self) -> usize {
        self.0.bytes()
    }

    /// (patches,): kind of every patch.
    #[getter]
    fn instances<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        PyArray1::from_slice(py, &self.0.tables().instance_kinds)
    }

    /// (patches, 3): where the origin of every patch is, x and z in metres, and its turn in radians.
    #[getter]
    fn places<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let place = |i: usize| {
            let at = self.0.place(i);
            [at.x as f32, at.y as f32, self.0.turn(i)]
        };
        table(py, (0..self.0.instances()).flat_map(place).collect(), 3)
    }

    /// Everybody who walks at a time: (n,) identities, (n, 2) places x, z in metres from `origin`, (n, 2) velocities in m/s.
    ///
    /// An identity is a number that is the same for the same person at any time; `near` (x, z, radius) asks only for the patches
    /// that reach into a disc, where the world repeats also beyond its first copy.
    #[pyo3(signature = (secs, *, origin=(0.0, 0.0), near=None))]
    fn at<'py>(
        &self,
        py: Python<'py>,
        secs: f64,
        origin: (f64, f64),
        near: Option<(f64, f64, f64)>,
    ) -> PyResult<People<'py>> {
        let finite = secs.is_finite() && secs.abs() < 1e12;
        let time = run(py, || {
            finite.then_some(secs).ok_or_else(|| {
                crowdquilt::Error::invalid("world", "time", format!("expected seconds within 1e12, found {secs}"))
            })
        })?;
        let (ids, places, velocities) = py.detach(|| self.people(time, DVec2::new(origin.0, origin.1), near));
        Ok((PyArray1::from_vec(py, ids), table(py, places, 2)?, table(py, velocities, 2)?))
    }

    /// Everybody who stays in a patch of a kind: (n, 4) x, z, heading, radius in the kind's frame; and what each does.
    fn stays<'py>(&self, py: Python<'py>, kind: usize) -> PyResult<(Bound<'py, PyArray2<f32>>, Vec<String>)> {
        let stayers: Vec<_> = self.kind(kind)?.stayers().collect();
        let numbers = stayers.iter().flat_map(|s| [s.place.x, s.place.y, s.heading, s.radius]).collect();
        let names = stayers.iter().map(|s| self.0.info().names[s.name as usize].clone()).collect();
        Ok((table(py, numbers, 4)?, names))
    }

    /// Template of a kind, an index.
    fn template(&self, kind: usize) -> PyResult<usize> {
        Ok(self.kind(kind)?.template())
    }

    /// (corners, 2): outline of a kind in its own frame, metres.
    fn outline<'py>(&self, py: Python<'py>, kind: usize) -> PyResult<Bound<'py, PyArray2<f32>>> {
        points2(py, &self.kind(kind)?.outline())
    }

    /// Static objects of a kind: name, (corners, 2) outline or (1, 2) middle, radius (0 for polygons).
    fn objects<'py>(&self, py: Python<'py>, kind: usize) -> PyResult<Vec<Object<'py>>> {
        let object = |(name, shape): (u32, stage::ObjectShape)| {
            let (points, radius) = match shape {
                stage::ObjectShape::Disc(middle, radius) => (vec![middle], radius),
                stage::ObjectShape::Polygon(points) => (points, 0.0),
            };
            Ok((self.0.info().names[name as usize].clone(), points2(py, &points)?, radius))
        };
        self.kind(kind)?.objects().map(object).collect()
    }

    /// The pattern of every edge of a kind.
    fn patterns_of(&self, py: Python<'_>, kind: usize) -> PyResult<Vec<Pattern>> {
        let numbers = |crossings: &[stage::Crossing]| {
            let each = crossings.iter().flat_map(|c| [c.place, c.time, c.across, c.along]);
            table(py, each.collect(), 4).map(Bound::unbind)
        };
        let patterns = self.kind(kind)?.patterns();
        let pattern = |p: &stage::Pattern| {
            Ok(Pattern { length: p.length, inputs: numbers(&p.inputs)?, outputs: numbers(&p.outputs)? })
        };
        patterns.iter().map(pattern).collect()
    }

    /// The way of every walker through a kind: seconds at which it begins, and (n, 2) places, `step` seconds apart.
    #[pyo3(signature = (kind, step=0.05))]
    fn ways<'py>(&self, py: Python<'py>, kind: usize, step: f64) -> PyResult<Vec<Way<'py>>> {
        self.kind(kind)?;
        let slot = f64::from(self.0.info().period_secs) / f64::from(self.0.info().slots);
        let way = |(walker, (enter, leave)): (usize, (i64, i64))| {
            let (begin, end) = (enter as f64 * slot, leave as f64 * slot);
            let times = (0..).map(|i| begin + f64::from(i) * step.max(1e-3)).take_while(|&t| t < end);
            let places: Vec<Vec2> = times.filter_map(|t| Some(self.0.way(kind, walker, t)?.0)).collect();
            Ok((begin, points2(py, &places)?))
        };
        self.0.stays(kind).into_iter().enumerate().map(way).collect()
    }

    /// Whether walkers have full bodies.
    #[getter]
    fn has_bodies(&self) -> bool {
        self.0.tables().gait.is_some()
    }

    /// The same world with full bodies, who walk as the people of `patches` do: the steps of each add up over borders and periods.
    fn with_bodies(&self, py: Python<'_>, patches: &PatchSet) -> PyResult<Self> {
        run(py, || core::with_gait(&self.0, core::gait_table(&patches.0)?)).map(|world| Self(Arc::new(world)))
    }

    /// Full bodies of all who walk in the patches that reach into a disc (x, z, radius), at a time: (n,) identities, (n, joints, 3)
    /// joints in metres from the disc's middle. Nobody if the world has no bodies.
    fn joints_near<'py>(&self, py: Python<'py>, secs: f64, near: (f64, f64, f64)) -> PyResult<Bodies<'py>> {
        let (ids, joints) = py.detach(|| self.joints(secs, near));
        Ok((PyArray1::from_vec(py, ids), stack(py, joints, JOINT_COUNT, 3)?))
    }

    /// Whether people who stay do something.
    #[getter]
    fn has_acts(&self) -> bool {
        self.0.tables().acts.is_some()
    }

    /// Full bodies of all who stay and do something in the patches that reach into a disc (x, z, radius), at a time: (n,) identities,
    /// (n, joints, 3) joints in metres from the disc's middle.
    fn acting_near<'py>(&self, py: Python<'py>, secs: f64, near: (f64, f64, f64)) -> PyResult<Bodies<'py>> {
        let (ids, joints) = py.detach(|| self.acting(secs, near));
        Ok((PyArray1::from_vec(py, ids), stack(py, joints, JOINT_COUNT, 3)?))
    }

    fn __len__(&self) -> usize {
        self.0.instances()
    }

    fn __repr__(&self) -> String {
        let (patches, kinds) = (self.0.instances(), self.0.kinds());
        format!("World({:?}, patches={patches}, kinds={kinds}, walkers={:.0})", self.name(), self.walkers())
    }
}

impl World {
    fn joints(&self, secs: f64, (x, z, radius): (f64, f64, f64)) -> (Vec<u64>, Vec<f32>) {
        let world = &*self.0;
        let (mut ids, mut joints, mut globals) = (Vec::new(), Vec::new(), Vec::new());
        if world.tables().gait.is_none() {
            return (ids, joints);
        }
        let (middle, moment) = (DVec2::new(x, z), world.moment(secs));
        let mut pose = [Quat::IDENTITY; JOINT_COUNT];
        for spot in world.nearby().within(middle, radius) {
            let instance = spot.instance as usize;
            let place = (world.place(instance) + spot.shift - middle).as_vec2();
            ids.extend(world.people_of(instance, self.copy(spot.shift), &moment).map(|person| person.hash(0)));
            for (who, body) in world.walkers_of(instance, &moment).zip(world.bodies(spot, secs)) {
                let root = world.walker_body(spot, who, &body, secs, &mut pose);
                canonical().globals(root + Vec3::new(place.x, 0.0, place.y), &pose, &mut globals);
                joints.extend(globals.iter().flat_map(|(position, _)| position.to_array()));
            }
        }
        (ids, joints)
    }

    fn acting(&self, secs: f64, (x, z, radius): (f64, f64, f64)) -> (Vec<u64>, Vec<f32>) {
        let (world, middle) = (&*self.0, DVec2::new(x, z));
        let (mut ids, mut joints, mut globals) = (Vec::new(), Vec::new(), Vec::new());
        let mut pose = [Quat::IDENTITY; JOINT_COUNT];
        for spot in world.nearby().within(middle, radius) {
            let instance = spot.instance as usize;
            let place = (world.place(instance) + spot.shift - middle).as_vec2();
            for index in 0..world.kind(world.kind_of(instance)).stayers().len() {
                let Some(hips) = world.stayer_body(spot, index, secs, &mut pose) else { continue };
                ids.push(world.stayer(instance, index, self.copy(spot.shift)).hash(0));
                canonical().globals(hips + Vec3::new(place.x, 0.0, place.y), &pose, &mut globals);
                joints.extend(globals.iter().flat_map(|(position, _)| position.to_array()));
            }
        }
        (ids, joints)
    }

    /// Which copy of the world is `shift` away.
    fn copy(&self, shift: DVec2) -> [i64; 2] {
        match self.repeat() {
            Some((x, z)) => [(shift.x / x).round() as i64, (shift.y / z).round() as i64],
            None => [0, 0],
        }
    }

    fn people(&self, secs: f64, origin: DVec2, near: Option<(f64, f64, f64)>) -> (Vec<u64>, Vec<f32>, Vec<f32>) {
        let (world, moment) = (&*self.0, self.0.moment(secs));
        let spots: Vec<stage::Spot> = match near {
            Some((x, z, radius)) => world.nearby().within(DVec2::new(x, z), radius).collect(),
            None => {
                (0..world.instances() as u32).map(|instance| stage::Spot { instance, shift: DVec2::ZERO }).collect()
            }
        };
        let mut roots = stage::Roots::default();
        world.roots_of(&moment, spots.iter().copied(), origin, &mut roots);
        let people = spots.iter().flat_map(|s| world.people_of(s.instance as usize, self.copy(s.shift), &moment));
        let pairs = |a: &[f32], b: &[f32]| a.iter().zip(b).flat_map(|(a, b)| [*a, *b]).collect();
        let ids = people.map(|person| person.hash(0)).collect();
        (ids, pairs(roots.x(), roots.z()), pairs(roots.vx(), roots.vz()))
    }
}

/// Build the world of `scene`. The same scene gives the same world for any number of threads. `progress((done, all))` is told
/// how many patches are solved and stops the work by returning False. Returns the world, and what had to be repaired or left out
/// on the way, in words.
#[pyfunction]
#[pyo3(signature = (scene, *, progress=None))]
pub fn build_world(py: Python<'_>, scene: &WorldScene, progress: Option<Py<PyAny>>) -> PyResult<(World, Vec<String>)> {
    let show = |py: Python<'_>, step: (usize, usize)| Ok(step.into_pyobject(py)?.into_any().unbind());
    let work = |report: &(dyn Fn((usize, usize)) -> bool + Sync)| scene.0.build(&|done, all| report((done, all)));
    let (found, interrupt) = watched(py, progress, show, work);
    match interrupt {
        Some(error) => Err(error),
        None => found.map(|built| (World(Arc::new(built.world)), built.notes)),
    }
}

/// Verify a baked world from its numbers alone: nobody touches anybody or anything, limits of walking hold, everybody who
/// leaves a patch comes into the next.
#[pyfunction]
pub fn check_world(py: Python<'_>, world: &World) -> PyResult<Report> {
    run(py, || Ok(check::check_world(&world.0))).map(Report)
}

/// Milliseconds to solve random patches of `walkers` people in and out in 8 x 8 m and 10 s on one core: median, 95 %, most; and
/// the share (0 to 1) without any fault.
#[pyfunction]
pub fn measure_patches(
    py: Python<'_>,
    walkers: usize,
    patches: u64,
    particles: bool,
) -> PyResult<(f64, f64, f64, f64)> {
    let method = if particles { core::Method::Particles } else { core::Method::Curves };
    let found = run(py, || core::measure_creation(method, walkers, patches))?;
    let share = found.solved as f64 / found.patches.len().max(1) as f64;
    Ok((found.quantile(0.5), found.quantile(0.95), found.quantile(1.0), share))
}

/// Play a large world on one core: people, kinds, bytes, root samples per second around 1 s and around 1 h, microseconds for
/// one patch at a random time.
#[pyfunction]
pub fn measure_replay(
    py: Python<'_>,
    people: usize,
    kinds: u64,
    unique: bool,
) -> PyResult<(usize, usize, usize, f64, f64, f64)> {
    let r = run(py, || core::measure_replay(people, kinds, unique))?;
    Ok((r.people, r.kinds, r.bytes, r.early, r.late, r.single_micros))
}

/// Walk through the endless street: patches made, most patches at a time, milliseconds of a frame in which a patch is
/// made: median, 99 %, most.
#[pyfunction]
pub fn measure_street(py: Python<'_>, metres: f32) -> PyResult<(usize, usize, f64, f64, f64)> {
    let walk = run(py, || core::measure_walk(&core::scenes::street(1)?, metres, 4, 1))?;
    let at = |share: f64| walk.frames[((walk.frames.len() - 1) as f64 * share) as usize];
    Ok((walk.made, walk.resident, at(0.5), at(0.99), at(1.0)))
}

/// Full bodies of `patches` in a dense world on one core: people, and nanoseconds for each.
#[pyfunction]
pub fn measure_poses(py: Python<'_>, patches: &PatchSet) -> PyResult<(usize, f64)> {
    run(py, || core::measure_poses(&patches.0))
}
