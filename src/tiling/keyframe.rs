//! Keyframing: patches that the scene has placed. They come first, as they are, and people are led into, between and out
//! of them; all else is tiled around them. A kind that is placed is used nowhere else, so that nothing takes it out.

use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::bridge::{Goal, Taste};
use super::draft::Draft;
use super::gather::{Life, come, part};
use super::occupancy::PieceId;
use super::passage::{Part, parts};
use super::piece::Company;
use super::scene::Placed;
use crate::motion::FPS;

/// Of those who could come from an earlier patch, so many of the nearest are tried.
const NEAREST: usize = 2;

/// A patch that has been put in: its instance, and its roles in the order in which they are cast.
struct Stage {
    instance: u32,
    roles: Vec<(Part, PieceId)>,
}

/// Puts all placed patches in and leads their people from and to the edges of time.
pub(super) fn keyframes(draft: &mut Draft, placed: &[Placed], taste: Taste, rng: &mut ChaCha8Rng) -> Option<()> {
    let mut in_time: Vec<&Placed> = placed.iter().collect();
    in_time.sort_by(|a, b| a.secs.total_cmp(&b.secs));
    let stages: Option<Vec<Stage>> = in_time.into_iter().map(|placed| put(draft, placed, rng)).collect();
    let mut lives: Vec<Life> = Vec::new();
    for stage in stages? {
        cast(draft, &stage, &mut lives, taste, rng);
    }
    for life in &mut lives {
        come(draft, life, taste, rng)?;
    }
    for life in &mut lives {
        part(draft, life, taste, rng)?;
    }
    lives.into_iter().for_each(|life| draft.push_track(life.pieces));
    Some(())
}

/// Puts a patch in, where and when it was placed.
fn put(draft: &mut Draft, placed: &Placed, rng: &mut ChaCha8Rng) -> Option<Stage> {
    let library = draft.base.library;
    let kind = library.set.kinds.iter().position(|k| k.name == placed.kind)? as u32;
    let parts = parts(library, kind, placed.at, (placed.secs * FPS).round() as i32);
    let ids = draft.add_patch(parts.iter().map(|p| (p.role, p.entry)))?;
    let instance = draft.piece(ids[0]).instance;
    let mut roles: Vec<(Part, PieceId)> = parts.into_iter().zip(ids).collect();
    roles.shuffle(rng);
    Some(Stage { instance, roles })
}

/// Whoever was in an earlier patch and finds a way plays a role; new people play the others.
fn cast(draft: &mut Draft, stage: &Stage, lives: &mut Vec<Life>, taste: Taste, rng: &mut ChaCha8Rng) {
    let mut taken = vec![false; lives.len()];
    for &(part, id) in &stage.roles {
        let away = |&i: &usize| lives[i].end.at.position.distance(part.entry.at.position);
        let mut others: Vec<usize> =
            (0..taken.len()).filter(|&i| !taken[i] && lives[i].end.tick < part.entry.tick).collect();
        others.sort_by(|a, b| away(a).total_cmp(&away(b)));
        let way = others.into_iter().take(NEAREST).find_map(|i| {
            let company = Company { from: lives[i].company.to, to: stage.instance };
            Some((i, draft.search(lives[i].end, Goal::Port(part.entry), company, taste, rng)?))
        });
        match way {
            Some((i, way)) => {
                taken[i] = true;
                let life = &mut lives[i];
                life.pieces.extend(way);
                life.pieces.push(id);
                (life.end, life.company.to) = (part.exit, stage.instance);
            }
            None => lives.push(Life::of(&part, id, stage.instance)),
        }
    }
}
