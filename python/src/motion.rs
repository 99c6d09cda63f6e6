//! Glue of `crowdquilt::motion`.

use std::path::PathBuf;

use crowdquilt::motion::take::ImportOptions;
use crowdquilt::motion::{self as core, Foot, bvh, import, retarget};
use numpy::{PyArray2, PyArray3};
use pyo3::prelude::*;

use crate::error::run;
use crate::numbers::{points3, rotations, stack};

/// One person's capture on its own skeleton, in metres and seconds, y up.
#[pyclass(frozen, module = "crowdquilt")]
pub struct Clip(core::Clip);

/// Read a capture (BVH) and repair what the options say.
///
/// Without `metres_per_unit` the unit is guessed from the standing height; without `fps` the header is trusted;
/// `drop_first_frames` leading frames (T-poses) go; `restore_thorax` puts back the bone that cgspeed's conversion
/// of CMU's database lost.
#[pyfunction]
#[pyo3(signature = (path, *, metres_per_unit=None, fps=None, drop_first_frames=0, restore_thorax=false))]
pub fn load_clip(
    py: Python<'_>,
    path: PathBuf,
    metres_per_unit: Option<f32>,
    fps: Option<f32>,
    drop_first_frames: u32,
    restore_thorax: bool,
) -> PyResult<Clip> {
    let options = ImportOptions { metres_per_unit, fps, drop_first_frames, restore_thorax, ..Default::default() };
    run(py, || import::load(&path, &options)).map(Clip)
}

#[pymethods]
impl Clip {
    /// The file's stem.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// Frames per second.
    #[getter]
    fn fps(&self) -> f32 {
        self.0.fps
    }

    /// Number of frames.
    #[getter]
    fn frames(&self) -> usize {
        self.0.frames()
    }

    /// Seconds from the first frame to the last.
    #[getter]
    fn seconds(&self) -> f32 {
        self.0.seconds()
    }

    /// Names of the joints; parents come before their children.
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.0.skeleton.joints.iter().map(|j| j.name.clone()).collect()
    }

    /// Index of every joint's parent; -1 for the root.
    #[getter]
    fn parents(&self) -> Vec<i32> {
        self.0.skeleton.joints.iter().map(|j| j.parent.map_or(-1, |p| p as i32)).collect()
    }

    /// (joints, 3): every joint's rest offset from its parent, metres.
    #[getter]
    fn offsets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        points3(py, &self.0.skeleton.joints.iter().map(|j| j.offset).collect::<Vec<_>>())
    }

    /// (frames, 3): the root's position, metres.
    #[getter]
    fn root<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        points3(py, &self.0.root)
    }

    /// (frames, joints, 4): local rotations as x, y, z, w.
    #[getter]
    fn rotations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        rotations(py, &self.0.rotations, self.0.skeleton.joints.len())
    }

    /// Height of the person, metres: from the lowest to the highest joint or bone tip when standing.
    #[getter]
    fn height_m(&self) -> f32 {
        import::standing_height(&self.0)
    }

    /// (frames, joints, 3): positions of all joints in the world, metres.
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let (mut globals, mut values) = (Vec::new(), Vec::new());
        for frame in 0..self.0.frames() {
            self.0.globals(frame, &mut globals);
            values.extend(globals.iter().flat_map(|(position, _)| position.to_array()));
        }
        stack(py, values, self.0.skeleton.joints.len(), 3)
    }

    /// The foot plants found once the clip is on the canonical skeleton: (foot, first second, last second). Raises
    /// `CrowdquiltError` for a rig of no known family.
    fn plants(&self, py: Python<'_>) -> PyResult<Vec<(&'static str, f32, f32)>> {
        let motion = run(py, || retarget::to_canonical(&self.0))?;
        let row = |plant: &core::Plant| {
            let foot = if plant.foot == Foot::Left { "left" } else { "right" };
            (foot, plant.begin as f32 / core::FPS, plant.end as f32 / core::FPS)
        };
        Ok(motion.plants.iter().map(row).collect())
    }

    /// The clip as the text of a BVH file.
    fn to_bvh(&self) -> String {
        bvh::write(&self.0)
    }

    fn __repr__(&self) -> String {
        let Self(clip) = self;
        format!("Clip({:?}, joints={}, frames={})", clip.name, clip.skeleton.joints.len(), clip.frames())
    }
}
