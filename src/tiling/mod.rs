//! Tiling: packing motion patches into a domain so that no port dangles and nobody collides.

mod audition;
mod bake;
mod boxes;
mod bridge;
mod builds;
mod checkpoint;
mod clock;
mod crew;
mod demands;
mod domain;
mod draft;
mod encounters;
mod engine;
mod enrich;
mod faults;
mod figure;
mod footprint;
mod gather;
mod grid;
mod hurdle;
mod keyframe;
mod library;
mod mend;
mod occupancy;
mod outcome;
mod pace;
mod paper;
mod passage;
mod piece;
mod places;
mod plan;
mod prefer;
mod rehearsal;
mod repeat;
mod scene;
mod seed;
mod session;
mod sketch;
mod source;
mod study;
mod swept;
mod team;
mod torsos;
mod tracks;
mod tryout;
mod view;
mod visit;
mod wang;
mod wedge;

#[cfg(test)]
#[path = "../../tests/common/mod.rs"]
mod common;
#[cfg(test)]
mod oracle_tests;

pub use checkpoint::{Checkpoint, Keep, Reached, Stage};
pub use engine::{tile, tile_in};
pub use grid::Grid;
pub use outcome::{Method, Options, Outcome, Phase, Progress, Status};
pub use prefer::{Field, Form, Preference, Term};
pub use scene::{KindFilter, Periodic, Placed, Scene, Sink, Source, Team, Wang};
pub use session::{Review, Session, review};
pub use study::study;
pub(crate) use visit::{Crossing, Place, Visit, playable, visits};
