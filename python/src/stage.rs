//! Glue of `crowdquilt::stage`.

use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::Arc;

use crowdquilt::geom::Capsule;
use crowdquilt::motion::{BODY_CAPSULES, FPS, JOINT_COUNT, body_capsules, canonical};
use crowdquilt::stage as core;
use glam::{Quat, Vec3};
use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;

use crate::error::run;
use crate::numbers::{points2, points3, rotations, stack, table};
use crate::patch::{Kind, kinds};

/// One fragment of an instance in a person's life.
#[pyclass(frozen, module = "crowdquilt")]
pub struct Fragment(core::FragmentUse);

#[pymethods]
impl Fragment {
    /// Index of the instance.
    #[getter]
    fn instance(&self) -> u32 {
        self.0.instance
    }

    /// Index of the role it plays in the instance's kind.
    #[getter]
    fn role(&self) -> u32 {
        self.0.role
    }

    /// Frame of the entry; negative where the crowd's first frame crops it.
    #[getter]
    fn begin(&self) -> i32 {
        self.0.begin
    }

    /// Frame of the exit; the next fragment begins here.
    #[getter]
    fn end(&self) -> i32 {
        self.0.end
    }

    /// (samples, 2): the deformed path's ground points x, z, one for each source frame, metres.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        points2(py, &self.0.points)
    }

    /// (samples,): the deformed path's headings, radians, not wrapped.
    #[getter]
    fn headings<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_slice(py, &self.0.headings)
    }
}

/// A box that people hold in both hands, pass, take up and put down. It stays level.
#[pyclass(frozen, module = "crowdquilt")]
pub struct Prop(core::Prop);

#[pymethods]
impl Prop {
    /// Name, e.g. `box`.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// (3,): full extents in metres: width between the hands, height, depth.
    #[getter]
    fn size<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_slice(py, &self.0.size)
    }

    /// First and last frame at which it is there.
    #[getter]
    fn span(&self) -> (u32, u32) {
        (self.0.begin, self.0.end())
    }

    /// (frames, 3): its middle at every frame, metres.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        points3(py, &self.0.places.iter().map(|p| p.middle).collect::<Vec<_>>())
    }

    /// (frames,): its turn about the vertical at every frame, radians, not wrapped.
    #[getter]
    fn headings<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_iter(py, self.0.places.iter().map(|p| p.heading))
    }

    /// Who holds it: person, first and last frame, in order; otherwise it rests.
    #[getter]
    fn holds(&self) -> Vec<(u32, u32, u32)> {
        self.0.holds.iter().map(|h| (h.character, h.begin, h.end)).collect()
    }

    fn __repr__(&self) -> String {
        let (begin, end) = self.span();
        format!("Prop({:?}, frames={begin}..={end}, holds={})", self.0.name, self.0.holds.len())
    }
}

/// A finished crowd: baked, playable at any time. Metres, seconds, y up; `len(crowd)` is the number of people.
#[pyclass(frozen, module = "crowdquilt")]
pub struct Crowd(pub Arc<core::Crowd>);

impl Crowd {
    fn person(&self, index: usize) -> PyResult<&core::Character> {
        let people = &self.0.characters;
        people.get(index).ok_or_else(|| {
            PyIndexError::new_err(format!("person {index} does not exist: the crowd has {} people", people.len()))
        })
    }

    /// Calls `each` with every person there at `secs` and the global transforms of the joints.
    fn bodies(&self, secs: f32, mut each: impl FnMut(u32, &[(Vec3, Quat)])) {
        let (mut pose, mut globals) = ([Quat::IDENTITY; JOINT_COUNT], Vec::new());
        for (index, character) in self.0.characters.iter().enumerate() {
            if let Some(root) = character.sample(secs, &mut pose) {
                character.skeleton().globals(root, &pose, &mut globals);
                each(index as u32, &globals);
            }
        }
    }
}

/// What people stay out of: a prism that stands or moves, of any height or so low that one can jump over it.
#[pyclass(frozen, module = "crowdquilt")]
pub struct Obstacle(crowdquilt::geom::Obstacle);

#[pymethods]
impl Obstacle {
    /// Height in metres; None is over all heads.
    #[getter]
    fn height(&self) -> Option<f32> {
        self.0.height
    }

    /// Whether it moves.
    #[getter]
    fn moves(&self) -> bool {
        !self.0.path.is_empty()
    }

    /// (n, 4): its way-points as seconds, x, z, heading in radians; none if it stands.
    #[getter]
    fn path<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let rows = self.0.path.iter().flat_map(|w| [w.secs, w.position.x, w.position.y, w.heading]);
        table(py, rows.collect(), 4)
    }

    /// (corners, 2): its outline on the ground at a time, as x, z in metres.
    fn at<'py>(&self, py: Python<'py>, secs: f32) -> PyResult<Bound<'py, PyArray2<f32>>> {
        points2(py, &self.0.outline_at(secs).points)
    }

    fn __repr__(&self) -> String {
        let height = self.0.height.map_or("None".into(), |h| h.to_string());
        format!("Obstacle(height={height}, moves={})", if self.moves() { "True" } else { "False" })
    }
}

/// The obstacles of a scene or crowd.
pub fn obstacles(all: &[crowdquilt::geom::Obstacle]) -> Vec<Obstacle> {
    all.iter().cloned().map(Obstacle).collect()
}

type Things<'py> = (Bound<'py, PyArray1<u32>>, Bound<'py, PyArray2<f32>>);
type People<'py> = (Bound<'py, PyArray1<u32>>, Bound<'py, PyArray3<f32>>);

#[pymethods]
impl Crowd {
    /// Names of the teams.
    #[getter]
    fn teams(&self) -> Vec<String> {
        self.0.domain.teams.clone()
    }

    /// Everybody's team, an index into `teams`; None of those who are of none.
    #[getter]
    fn team_of(&self) -> Vec<Option<u32>> {
        self.0.characters.iter().map(|c| c.team).collect()
    }

    /// Directions in which the crowd repeats: some of `x`, `z`, `t`.
    #[getter]
    fn periodic(&self) -> Vec<&'static str> {
        let repeats = self.0.domain.periodic;
        let all = [("x", repeats.x), ("z", repeats.z), ("t", repeats.t)];
        all.into_iter().filter(|axis| axis.1).map(|axis| axis.0).collect()
    }

    /// The crowd of `x` times `z` tiles and `t` laps, open where it repeated: everybody of the endless crowd who is ever in
    /// the block. A direction that does not repeat is left as it is.
    #[pyo3(signature = (x=3, z=3, t=3))]
    fn unrolled(&self, py: Python, x: u32, z: u32, t: u32) -> PyResult<Self> {
        if [x, z, t].contains(&0) {
            return Err(PyValueError::new_err(format!("expected at least one tile and lap, found {x}, {z}, {t}")));
        }
        Ok(Self(Arc::new(py.detach(|| self.0.unrolled(x, z, t)))))
    }

    /// Read a crowd file (`*.crowd`).
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        run(py, || core::Crowd::load(&path)).map(|crowd| Self(Arc::new(crowd)))
    }

    /// A crowd from the bytes of a crowd file.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, data: &[u8]) -> PyResult<Self> {
        run(py, || core::Crowd::from_bytes(data)).map(|crowd| Self(Arc::new(crowd)))
    }

    /// Write a crowd file, whole or not at all.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        run(py, || self.0.save(&path))
    }

    /// The bytes of a crowd file.
    fn to_bytes(&self) -> Cow<'static, [u8]> {
        Cow::Owned(self.0.to_bytes())
    }

    /// Seed it was made with.
    #[getter]
    fn seed(&self) -> u64 {
        self.0.seed
    }

    /// Frames per second.
    #[getter]
    fn fps(&self) -> f32 {
        FPS
    }

    /// Number of frames the crowd lives.
    #[getter]
    fn frames(&self) -> u32 {
        self.0.domain.last_frame + 1
    }

    /// Seconds the crowd lives.
    #[getter]
    fn seconds(&self) -> f32 {
        self.0.domain.last_frame as f32 / FPS
    }

    /// (corners, 2): where everybody stays inside, as x, z in metres.
    #[getter]
    fn region<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        points2(py, &self.0.domain.region.points)
    }

    /// What everybody stays out of.
    #[getter]
    fn obstacles(&self) -> Vec<Obstacle> {
        obstacles(&self.0.domain.obstacles)
    }

    /// Names of the canonical skeleton's joints.
    #[getter]
    fn joints(&self) -> Vec<String> {
        canonical().joints.iter().map(|j| j.name.clone()).collect()
    }

    /// Index of every joint's parent; -1 for the root.
    #[getter]
    fn parents(&self) -> Vec<i32> {
        canonical().joints.iter().map(|j| j.parent.map_or(-1, |p| p as i32)).collect()
    }

    /// The patch kinds it is tiled with.
    #[getter]
    fn kinds(&self, py: Python<'_>) -> PyResult<Vec<Kind>> {
        kinds(py, &self.0.set)
    }

    /// (instances,): the kind of every placed patch.
    #[getter]
    fn instances<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        PyArray1::from_iter(py, self.0.instances.iter().map(|i| i.kind))
    }

    /// First and last frame of a person.
    fn span(&self, person: usize) -> PyResult<(u32, u32)> {
        self.person(person).map(|c| (c.begin, c.end()))
    }

    /// (frames, 3): a person's hips from their first frame to their last, metres.
    fn roots<'py>(&self, py: Python<'py>, person: usize) -> PyResult<Bound<'py, PyArray2<f32>>> {
        points3(py, &self.person(person)?.root)
    }

    /// (frames, joints, 4): a person's rotations as x, y, z, w; the hips' global, all others local.
    fn rotations<'py>(&self, py: Python<'py>, person: usize) -> PyResult<Bound<'py, PyArray3<f32>>> {
        rotations(py, &self.person(person)?.rotations, JOINT_COUNT)
    }

    /// (joints, 3): a person's joints in the world at a frame of the crowd, metres. IndexError while they are absent.
    fn positions<'py>(&self, py: Python<'py>, person: usize, frame: u32) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let character = self.person(person)?;
        if !character.present(frame) {
            let (begin, end) = (character.begin, character.end());
            let text = format!("person {person} is there from frame {begin} to {end}, not at frame {frame}");
            return Err(PyIndexError::new_err(text));
        }
        let mut globals = Vec::new();
        character.globals((frame - character.begin) as usize, &mut globals);
        points3(py, &globals.iter().map(|(position, _)| *position).collect::<Vec<_>>())
    }

    /// Name of a person's build: their bones' lengths and their girth.
    fn build(&self, person: usize) -> PyResult<String> {
        self.person(person).map(|c| c.build.name.clone())
    }

    /// A person's height from the soles to the crown, metres.
    fn stature(&self, person: usize) -> PyResult<f32> {
        self.person(person).map(|c| c.build.stature())
    }

    /// (joints, 3): a person's joints as offsets from their parents in the rest pose, metres.
    fn offsets<'py>(&self, py: Python<'py>, person: usize) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let offsets: Vec<Vec3> = self.person(person)?.skeleton().joints.iter().map(|j| j.offset).collect();
        points3(py, &offsets)
    }

    /// The patches a person goes through, in order.
    fn fragments(&self, person: usize) -> PyResult<Vec<Fragment>> {
        Ok(self.person(person)?.fragments.iter().cloned().map(Fragment).collect())
    }

    /// The boxes that people carry.
    #[getter]
    fn props(&self) -> Vec<Prop> {
        self.0.props.iter().cloned().map(Prop).collect()
    }

    /// Every box there at a time: (n,) indices and (n, 4) middles and headings as x, y, z in metres, radians.
    fn props_at<'py>(&self, py: Python<'py>, secs: f32) -> PyResult<Things<'py>> {
        let (indices, places): (Vec<u32>, Vec<_>) = self.0.props_at(secs).map(|(i, p)| (i as u32, p)).unzip();
        let numbers = places.iter().flat_map(|p| [p.middle.x, p.middle.y, p.middle.z, p.heading]).collect();
        Ok((PyArray1::from_vec(py, indices), table(py, numbers, 4)?))
    }

    /// Everybody there at a time: (n,) indices and (n, joints, 3) joints in the world, metres.
    fn at<'py>(&self, py: Python<'py>, secs: f32) -> PyResult<People<'py>> {
        let (mut people, mut values) = (Vec::new(), Vec::new());
        self.bodies(secs, |index, globals| {
            people.push(index);
            values.extend(globals.iter().flat_map(|(position, _)| position.to_array()));
        });
        Ok((PyArray1::from_vec(py, people), stack(py, values, JOINT_COUNT, 3)?))
    }

    /// Everybody there at a time: (n,) indices and (n, capsules, 7) body capsules as ax, ay, az, bx, by, bz, radius.
    fn capsules<'py>(&self, py: Python<'py>, secs: f32) -> PyResult<People<'py>> {
        let (mut people, mut values, mut capsules) = (Vec::new(), Vec::new(), Vec::new());
        self.bodies(secs, |index, globals| {
            people.push(index);
            capsules.clear();
            body_capsules(globals, &mut capsules);
            for Capsule { a, b, radius } in &capsules {
                values.extend([a.x, a.y, a.z, b.x, b.y, b.z, *radius]);
            }
        });
        Ok((PyArray1::from_vec(py, people), stack(py, values, BODY_CAPSULES.len(), 7)?))
    }

    fn __len__(&self) -> usize {
        self.0.characters.len()
    }

    fn __repr__(&self) -> String {
        let (people, instances) = (self.0.characters.len(), self.0.instances.len());
        format!("Crowd(people={people}, instances={instances}, seconds={:.2})", self.seconds())
    }
}
