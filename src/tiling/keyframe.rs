//! Keyframing: patches that the scene has placed. They come first, as they are, with new people led to and from them; all
//! else is tiled around them. A kind that is placed is used nowhere else, so that nothing takes it out again.

use rand_chacha::ChaCha8Rng;

use super::bridge::Taste;
use super::draft::Draft;
use super::gather::{Life, come, part, parts};
use super::scene::Placed;
use crate::motion::FPS;

/// Puts a placed patch in and leads its people from and to the edges of time.
pub(super) fn keyframe(draft: &mut Draft, placed: &Placed, taste: Taste, rng: &mut ChaCha8Rng) -> Option<()> {
    let library = draft.base.library;
    let kind = library.set.kinds.iter().position(|k| k.name == placed.kind)? as u32;
    let roles = parts(library, kind, placed.at, (placed.secs * FPS).round() as i32);
    let ids = draft.add_patch(roles.iter().map(|p| (p.role, p.entry)))?;
    let life = |(p, id)| Life::of(p, id);
    let mut lives: Vec<Life> = roles.iter().zip(ids).map(life).collect();
    for life in &mut lives {
        come(draft, life, taste, rng)?;
    }
    for life in &mut lives {
        part(draft, life, taste, rng)?;
    }
    lives.into_iter().for_each(|life| draft.push_track(life.pieces));
    Some(())
}
