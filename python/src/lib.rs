//! The Python face of the core: one file of glue per module of the crate.
//!
//! Glue converts and releases the interpreter lock; it decides nothing. Python users import the modules of the
//! package `crowdquilt`, which are named like the crate's and re-export what stands here.

use pyo3::prelude::*;

mod beyond;
mod check;
mod connectivity;
mod error;
mod export;
mod measures;
mod motion;
mod numbers;
mod patch;
mod progress;
mod refine;
mod samples;
mod signals;
mod site;
mod stage;
mod tiling;
mod wishes;
mod world;

#[pymodule]
mod _core {
    #[pymodule_export]
    use super::beyond::{Day, Spectator, journey};
    #[pymodule_export]
    use super::check::{Report, Row, Summary, check_crowd, summary};
    #[pymodule_export]
    use super::connectivity::{
        Component, Connectivity, GroupLinks, Link, Steering, connectivity, kind_boxes, kind_capsules, kind_positions,
    };
    #[pymodule_export]
    use super::error::CrowdquiltError;
    #[pymodule_export]
    use super::export::{export_bvh, export_glb};
    #[pymodule_export]
    use super::measures::{Measures, kind_measures};
    #[pymodule_export]
    use super::motion::{Clip, check_take, import_presets, load_clip, take_distances};
    #[pymodule_export]
    use super::patch::{Kind, Made, PatchSet, Role, Take, make_patches};
    #[pymodule_export]
    use super::refine::refine_crowd;
    #[pymodule_export]
    use super::samples::write_samples;
    #[pymodule_export]
    use super::signals::{PairSignals, TakeSignals};
    #[pymodule_export]
    use super::site::WorldSite;
    #[pymodule_export]
    use super::stage::{Crowd, Fragment, Obstacle, Prop};
    #[pymodule_export]
    use super::tiling::{Checkpoint, Outcome, Progress, Scene, review, tile};
    #[pymodule_export]
    use super::world::{
        Pattern, World, WorldScene, build_world, check_world, measure_patches, measure_poses, measure_replay,
        measure_street,
    };

    #[pymodule_export]
    #[allow(non_upper_case_globals)]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
