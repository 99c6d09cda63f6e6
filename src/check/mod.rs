//! Verifies a finished crowd from its output alone; shares no code with the solvers that made it.
//!
//! [`check`] measures every clause of the contract of a finished crowd and returns one [`Row`] for each, with the
//! worst value found, the limit it is held against and the place where it was found:
//!
//! | clause | what | file |
//! |---|---|---|
//! | 1 | chains of fragments begin and end at the borders of the domain's time or at a source and a sink, every role is played once | `chain.rs` |
//! | 2 | stitches are closed, no joint turns or moves faster than in the captures, the path is what is seen | `stitch.rs`, `speed.rs` |
//! | 3 | the deformation of every source frame is within its limits | `deformation.rs` |
//! | 4, 7 | bodies stay apart, inside the region and out of obstacles | `bodies.rs`, `depth.rs`, `obstacle.rs` |
//! | 5 | people who touch in the capture still touch | `contact.rs` |
//! | 6 | planted feet stay, joints turn no further than captured | `plant.rs`, `joint.rs` |
//! | 2, 4, 5, 7 | boxes are held or rest, palms are on them, they enter nothing and do not fly | `prop.rs` |
//!
//! A crowd that repeats is checked as it is unrolled, and its seams in rows of their own (`seam.rs`).
//!
//! Clause 8 (same seed, same bytes) is a property of the solver and no crowd can show it.

mod bodies;
mod chain;
mod contact;
mod deformation;
mod depth;
mod joint;
mod limits;
mod obstacle;
mod part;
mod plant;
mod prop;
mod prop_shape;
mod report;
mod seam;
mod speed;
mod stitch;
mod summary;
pub mod world;

pub use limits::Limits;
pub use report::{Report, Row};
pub use summary::{Summary, summary};

use crate::stage::Crowd;

/// Checks `crowd` against the default [`Limits`]. O(people x frames), parallel over frames and people; the report
/// does not depend on the number of threads.
pub fn check(crowd: &Crowd) -> Report {
    check_with(crowd, &Limits::default())
}

/// Checks `crowd` against `limits`.
///
/// A crowd that refers to things that do not exist, or whose arrays disagree in length, fails the one row
/// `references`; nothing else can be measured on it.
pub fn check_with(crowd: &Crowd, limits: &Limits) -> Report {
    let references = chain::references(crowd);
    if !references.ok {
        return Report { rows: vec![references] };
    }
    if crowd.domain.periodic.any() {
        return seam::check(crowd, references, limits);
    }
    let parts = part::parts(crowd);
    let mut rows = vec![references];
    rows.extend(chain::rows(crowd, &parts));
    rows.extend(stitch::rows(crowd, &parts, limits));
    rows.extend(speed::rows(crowd, limits));
    rows.extend(deformation::rows(&parts, limits));
    rows.extend(bodies::rows(crowd, &parts, limits));
    rows.extend(contact::rows(crowd, &parts, limits));
    rows.extend(plant::rows(crowd, &parts, limits));
    rows.extend(joint::rows(crowd, &parts, limits));
    rows.extend(prop::rows(crowd, &parts, limits));
    rows.sort_by_key(|row| row.clause);
    Report { rows }
}
