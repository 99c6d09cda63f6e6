//! Glue of `crowdquilt::export`.

use std::borrow::Cow;
use std::path::PathBuf;

use crowdquilt::export as core;
use crowdquilt::motion::bvh;
use pyo3::prelude::*;

use crate::error::run;
use crate::stage::Crowd;

/// The bytes of a binary glTF file: everybody one skinned mesh on one skin, one animation at 30 keys per second.
///
/// `characters` are GLB files of skinned humanoids, dealt out to the people in place of the mannequin.
#[pyfunction]
#[pyo3(signature = (crowd, characters = Vec::new()))]
pub fn export_glb(py: Python<'_>, crowd: &Crowd, characters: Vec<PathBuf>) -> PyResult<Cow<'static, [u8]>> {
    run(py, || {
        let avatars = characters.iter().map(|path| core::Avatar::load(path)).collect::<Result<Vec<_>, _>>()?;
        Ok(core::glb_with(&crowd.0, &avatars))
    })
    .map(Cow::Owned)
}

/// The text of a BVH file of one person's motion, metres, 30 frames per second.
#[pyfunction]
pub fn export_bvh(py: Python<'_>, crowd: &Crowd, person: usize) -> PyResult<String> {
    run(py, || core::clip(&crowd.0, person).map(|clip| bvh::write(&clip)))
}
