//! Glue of `crowdquilt::motion`.

use std::path::PathBuf;

use crowdquilt::motion::take::{Character, ImportOptions};
use crowdquilt::motion::{self as core, Foot, bvh, canonical, import, presets, quality, retarget, symptoms, together};
use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::run;
use crate::numbers::{points3, rotations, stack};

/// One person's capture on its own skeleton, in metres and seconds, y up.
#[pyclass(frozen, module = "crowdquilt")]
pub struct Clip {
    clip: core::Clip,
    options: ImportOptions,
}

/// Read a capture (BVH, ASF/AMC, glTF, FBX) and repair what the options say.
///
/// `preset` names a set of repairs for well-known files (`presets()` lists them); the other options override it. Without
/// `metres_per_unit` the unit is what the file says, or guessed from the standing height; without `fps` the header is
/// trusted; `drop_first_frames` leading frames (T-poses) go; `restore_thorax` puts back the bone that cgspeed's
/// conversion of CMU's database lost; `rig` is a file that says which joint is which; `character` (a name, or a
/// number from 0) picks one of several people in the file.
#[pyfunction]
#[pyo3(signature = (path, *, preset=None, metres_per_unit=None, fps=None, drop_first_frames=None, restore_thorax=None, rig=None, character=None))]
#[allow(clippy::too_many_arguments)]
pub fn load_clip(
    py: Python<'_>,
    path: PathBuf,
    preset: Option<String>,
    metres_per_unit: Option<f32>,
    fps: Option<f32>,
    drop_first_frames: Option<u32>,
    restore_thorax: Option<bool>,
    rig: Option<String>,
    character: Option<Who>,
) -> PyResult<Clip> {
    let options =
        ImportOptions { preset, metres_per_unit, fps, drop_first_frames, restore_thorax, rig, ..Default::default() };
    let character = character.map(|who| match who {
        Who::Index(index) => Character::Index(index),
        Who::Name(name) => Character::Name(name),
    });
    let clip = run(py, || together::load_one(&path, &options, character.as_ref()))?;
    Ok(Clip { clip, options })
}

/// A character by number or by name.
#[derive(FromPyObject)]
pub enum Who {
    /// By number, from 0.
    Index(usize),
    /// By name.
    Name(String),
}

/// The presets of repairs: name and what they are for.
#[pyfunction]
pub fn import_presets() -> Vec<(&'static str, &'static str)> {
    presets::PRESETS.iter().map(|p| (p.name, p.about)).collect()
}

/// What is odd about captures that are to be one take: (message, whether they cannot be one).
#[pyfunction]
pub fn check_take(clips: Vec<PyRef<'_, Clip>>) -> Vec<(String, bool)> {
    let clips: Vec<core::Clip> = clips.iter().map(|c| c.clip.clone()).collect();
    together::check(&clips).into_iter().map(|f| (f.message, f.hopeless)).collect()
}

/// How near people of a take come to each other: (a, b, nearest, farthest), hips to hips over the ground, metres.
#[pyfunction]
pub fn take_distances(clips: Vec<PyRef<'_, Clip>>) -> Vec<(usize, usize, f32, f32)> {
    let clips: Vec<core::Clip> = clips.iter().map(|c| c.clip.clone()).collect();
    let row = |a: &together::Apart| (a.people[0], a.people[1], a.nearest, a.farthest);
    together::distances(&clips).iter().map(row).collect()
}

#[pymethods]
impl Clip {
    /// The file's stem.
    #[getter]
    fn name(&self) -> &str {
        &self.clip.name
    }

    /// Frames per second.
    #[getter]
    fn fps(&self) -> f32 {
        self.clip.fps
    }

    /// Number of frames.
    #[getter]
    fn frames(&self) -> usize {
        self.clip.frames()
    }

    /// Seconds from the first frame to the last.
    #[getter]
    fn seconds(&self) -> f32 {
        self.clip.seconds()
    }

    /// Names of the joints; parents come before their children.
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.clip.skeleton.joints.iter().map(|j| j.name.clone()).collect()
    }

    /// Index of every joint's parent; -1 for the root.
    #[getter]
    fn parents(&self) -> Vec<i32> {
        self.clip.skeleton.joints.iter().map(|j| j.parent.map_or(-1, |p| p as i32)).collect()
    }

    /// (joints, 3): every joint's rest offset from its parent, metres.
    #[getter]
    fn offsets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        points3(py, &self.clip.skeleton.joints.iter().map(|j| j.offset).collect::<Vec<_>>())
    }

    /// (frames, 3): the root's position, metres.
    #[getter]
    fn root<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        points3(py, &self.clip.root)
    }

    /// (frames, joints, 4): local rotations as x, y, z, w.
    #[getter]
    fn rotations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        rotations(py, &self.clip.rotations, self.clip.skeleton.joints.len())
    }

    /// Height of the person, metres: by the bones from sole to crown, whatever the posture; where the rig is not told,
    /// from the lowest to the highest joint or bone tip when standing.
    #[getter]
    fn height_m(&self) -> f32 {
        retarget::body_height(&self.clip).unwrap_or_else(|_| import::standing_height(&self.clip))
    }

    /// (frames, joints, 3): positions of all joints in the world, metres.
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let (mut globals, mut values) = (Vec::new(), Vec::new());
        for frame in 0..self.clip.frames() {
            self.clip.globals(frame, &mut globals);
            values.extend(globals.iter().flat_map(|(position, _)| position.to_array()));
        }
        stack(py, values, self.clip.skeleton.joints.len(), 3)
    }

    /// Which joints play the canonical ones: the family of rigs, and canonical name to the clip's. Raises
    /// `CrowdquiltError` for a rig that cannot be told.
    fn rig(&self, py: Python<'_>) -> PyResult<(&'static str, Vec<(String, String)>)> {
        let found = run(py, || retarget::match_rig(&retarget::RestRig::of(&self.clip.skeleton)))?;
        let named =
            canonical().joints.iter().zip(found.joints).filter_map(|(joint, source)| {
                Some((joint.name.clone(), self.clip.skeleton.joints[source?].name.clone()))
            });
        Ok((found.family, named.collect()))
    }

    /// The foot plants found once the clip is on the canonical skeleton: (foot, first second, last second). Raises
    /// `CrowdquiltError` for a rig that cannot be told.
    fn plants(&self, py: Python<'_>) -> PyResult<Vec<(&'static str, f32, f32)>> {
        let motion = run(py, || retarget::to_canonical(&self.clip))?;
        let row =
            |plant: &core::Plant| (foot(plant.foot), plant.begin as f32 / core::FPS, plant.end as f32 / core::FPS);
        Ok(motion.plants.iter().map(row).collect())
    }

    /// What looks wrong with the capture: (complaint, message with the option that may mend it, confidence 0..1).
    fn symptoms(&self, py: Python<'_>) -> Vec<(String, String, f32)> {
        let found = py.detach(|| symptoms::examine(&self.clip, &self.options));
        found.into_iter().map(|s| (format!("{:?}", s.complaint), s.message, s.confidence)).collect()
    }

    /// How good the motion is, in figures. Raises `CrowdquiltError` for a rig that cannot be told.
    fn quality<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let q = run(py, || quality::measure(&self.clip))?;
        let out = PyDict::new(py);
        out.set_item("foot_plants", q.plants.len())?;
        out.set_item("foot_slide_median", q.slide_median)?;
        out.set_item("foot_slide", q.slide_worst)?;
        out.set_item("fastest_joint_m_s", (q.speed.value, q.speed.joint, q.speed.time))?;
        out.set_item("hardest_joint_m_s2", (q.acceleration.value, q.acceleration.joint, q.acceleration.time))?;
        out.set_item("acceleration_p99_m_s2", q.acceleration_p99)?;
        out.set_item("below_floor_m", q.penetration_worst)?;
        out.set_item("below_floor_p99_m", q.penetration_p99)?;
        out.set_item("pops_secs", q.pops)?;
        let (joint, time) = (&canonical().joints[q.excess.joint].name, q.excess.frame as f32 / core::FPS);
        out.set_item("joint_excess_deg", (q.excess.worst.to_degrees(), joint, time))?;
        out.set_item("joint_excess_share", q.excess.share)?;
        Ok(out)
    }

    /// (frames at 30 per second,): how much the pose differs from `gap` seconds before, metres.
    #[pyo3(signature = (gap=0.5))]
    fn variation<'py>(&self, py: Python<'py>, gap: f32) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let curve = run(py, || quality::variation(&self.clip, gap))?;
        Ok(PyArray1::from_vec(py, curve))
    }

    /// (frames at 30 per second, 2): the motion path on the canonical body's ground, x and z, metres.
    fn path<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let motion = run(py, || retarget::to_canonical(&self.clip))?;
        crate::numbers::points2(py, &motion.path.points)
    }

    /// The clip as the text of a BVH file.
    fn to_bvh(&self) -> String {
        bvh::write(&self.clip)
    }

    fn __repr__(&self) -> String {
        let clip = &self.clip;
        format!("Clip({:?}, joints={}, frames={})", clip.name, clip.skeleton.joints.len(), clip.frames())
    }
}

fn foot(foot: Foot) -> &'static str {
    if foot == Foot::Left { "left" } else { "right" }
}
