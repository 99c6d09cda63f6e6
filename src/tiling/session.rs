//! What a run goes on from and what is kept of it; and what a checkpoint holds, without going on.

use super::Scene;
use super::checkpoint::{Agenda, Checkpoint, Keep, Stage, thaw};
use super::demands::admitted;
use super::domain::Domain;
use super::engine::status;
use super::library::Library;
use super::outcome::{Method, Status};
use super::rehearsal::Rehearsal;
use super::source::arrivals;
use crate::Result;
use crate::patch::PatchSet;

/// What a run goes on from, and what is kept of it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Session<'a> {
    /// The tiling to begin with; none is an empty one.
    pub from: Option<&'a Checkpoint>,
    /// Where checkpoints are written; none are if there is none.
    pub keep: Option<Keep<'a>>,
    /// How many rounds of changes (each is some that are worked out side by side) are tried at most, whatever time they take: for what
    /// must not depend on the machine. The paper's algorithms have no such bound.
    pub steps: Option<u64>,
}

/// What a checkpoint holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Review {
    /// How it would end if nothing more were done.
    pub status: Status,
    /// Faults of the final bodies: people who interpenetrate or move as nobody can.
    pub faults: usize,
}

/// Looks at a checkpoint: tests its final bodies and its wishes, changes nothing.
///
/// # Errors
/// It is not a tiling of `scene` with `set`.
pub fn review(kept: &Checkpoint, scene: &Scene, set: &PatchSet) -> Result<Review> {
    kept.expect_set(set)?;
    let set = &*admitted(scene, set, Method::Engine)?;
    let domain = Domain::new(scene)?;
    let library = Library::new(set, scene.limits).preferring(&scene.preference).parting(scene);
    let tracks = thaw(kept, scene, &library, &domain)?;
    let faults = Rehearsal::new(&tracks).faults.len();
    let placed = scene.placed.is_empty() || kept.agenda().placed;
    Ok(Review { status: status(tracks.chains(), scene, faults, placed), faults })
}

/// What is to be done in a scene from the beginning.
pub(super) fn first_agenda(scene: &Scene) -> Agenda {
    let team = |(i, team): (usize, &super::Team)| std::iter::repeat_n(i, team.characters);
    Agenda {
        lining_up: scene.teams.iter().enumerate().flat_map(team).collect(),
        coming: arrivals(scene),
        placed: scene.placed.is_empty(),
        ..Agenda::default()
    }
}

/// What is to be done on from a checkpoint: where the run before had been, or, if it was through or the wishes are
/// others, all that is still missing.
pub(super) fn further_agenda(kept: &Checkpoint, scene: &Scene) -> Agenda {
    let agenda = kept.agenda().clone();
    if agenda.stage < Stage::Mend && *scene == kept.scene {
        return agenda;
    }
    let missing = [
        (!agenda.placed && !scene.placed.is_empty(), Stage::Place),
        (!agenda.lining_up.is_empty(), Stage::LineUp),
        (!agenda.coming.is_empty(), Stage::LetIn),
    ];
    let first = missing.into_iter().find(|m| m.0).map_or(Stage::Gather, |m| m.1);
    Agenda { stage: first.min(agenda.stage), ..agenda }
}
