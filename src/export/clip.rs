//! One person of a crowd as a clip, the form that motion files are written from.

use crate::motion::{self, Clip, FPS};
use crate::stage::Crowd;
use crate::{Error, Result};

/// The final motion of one person.
///
/// # Errors
/// There is no such person, or it has no motion.
pub fn clip(crowd: &Crowd, character: usize) -> Result<Clip> {
    let found = crowd.characters.get(character).ok_or_else(|| {
        let problem = format!("expected one of 0..{}", crowd.characters.len());
        Error::invalid("crowd", format!("character {character}"), problem)
    })?;
    if found.frames() == 0 {
        return Err(Error::invalid("crowd", format!("character {character}"), "expected a motion, found no frame"));
    }
    Ok(Clip {
        name: format!("person_{character}"),
        skeleton: found.skeleton().clone(),
        fps: FPS,
        root: found.root.clone(),
        rotations: found.rotations.clone(),
    })
}

/// The final motion of one person as the text of a BVH file.
///
/// # Errors
/// There is no such person, or it has no motion.
pub fn bvh(crowd: &Crowd, character: usize) -> Result<String> {
    clip(crowd, character).map(|clip| motion::bvh::write(&clip))
}
