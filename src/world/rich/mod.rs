//! What people do in patches besides walking: real motion out of a patch set, for those who stay and for those who meet.
//!
//! | file | what |
//! |---|---|
//! | `tableau.rs` | a few people who do something in one place: where each is, how far it reaches, its clip |
//! | `play.rs` | tableaux by tiling a small place whose time comes round |
//! | `seat.rs` | those who sit: the part of a capture that comes nearest to where it began |
//! | `meet.rs` | interaction-rich patches: people come in, meet, and go out on time |
//! | `steps.rs` | when feet stand in the clips of those who meet |
//! | `cast.rs` | tableaux for everybody who gathers in a scene |

mod cast;
mod meet;
mod play;
mod seat;
mod steps;
mod tableau;

pub use meet::Meeting;
pub(super) use meet::moved;
pub(super) use steps::Steps;
pub use tableau::{Member, Role, Tableau};
