//! Generated sample captures: what Crowdquilt works on when it is given nothing else.
//!
//! Each take is planned as a performance (`actor`): a root `path`, `footsteps` on it, and `gesture`s and
//! posture pulses over time (`acting`), `flight`s, `hopping`. `perform` turns a plan into motion with the `gait` curves of gait analysis and
//! inverse kinematics, and `scene` adds the ground truth: foot plants, contacts, ports, patches, props.

mod acting;
mod actor;
mod flight;
mod footsteps;
mod gait;
mod gesture;
mod hopping;
mod path;
mod perform;
mod posture;
mod scene;
mod takes;
mod timeline;

use std::path::{Path, PathBuf};

use crate::container::write_whole;
use crate::motion::take::TakeFile;
use crate::motion::{Clip, bvh};
use crate::{Error, Result};

/// Several people's captures on one clock, with their annotation.
#[derive(Clone, Debug, PartialEq)]
pub struct Take {
    /// The annotation; `file.people[i].file` names the capture of `clips[i]`.
    pub file: TakeFile,
    /// The captures: canonical skeleton, 60 frames per second, all of the same length.
    pub clips: Vec<Clip>,
}

/// All sample takes. The same seed gives the same takes.
pub fn generate(seed: u64) -> Vec<Take> {
    takes::scenes().into_iter().map(|scene| scene.play(seed)).collect()
}

/// Writes all sample takes into `dir` (made if absent): a BVH file per person and a `NAME.take.json` per take.
/// Returns the files in the order written.
///
/// # Errors
/// What the operating system says.
pub fn write(dir: &Path, seed: u64) -> Result<Vec<PathBuf>> {
    std::fs::create_dir_all(dir).map_err(|e| Error::io(dir, e))?;
    let mut written = Vec::new();
    for take in generate(seed) {
        for (person, clip) in take.file.people.iter().zip(&take.clips) {
            let path = dir.join(&person.file);
            write_whole(&path, bvh::write(clip).as_bytes())?;
            written.push(path);
        }
        let path = dir.join(format!("{}.take.json", take.file.name));
        let json = serde_json::to_string_pretty(&take.file).expect("a take file is always valid JSON");
        write_whole(&path, json.as_bytes())?;
        written.push(path);
    }
    Ok(written)
}

#[cfg(test)]
mod tests;
