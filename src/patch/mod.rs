//! Motion patches: fragments of one or more people's motion with ports, contacts and labels, and the set of them.

pub mod annotate;
pub mod boundaries;
pub mod compose;
pub mod connectivity;
mod cut;
mod cut_props;
#[cfg(test)]
mod cut_tests;
pub mod episode;
mod file;
mod make;
mod measure;
mod mirror;
mod prop;
mod set;
mod speed;
pub mod study;

pub(crate) use file::{filed_rotation, pack_rotation, unpack_rotation};
pub(crate) use speed::{Turns, fastest_turns, turn_between};

pub use cut::{CutOptions, Source, cut, load_take};
pub use make::{Made, MakeOptions, Step, cut_folder, make, make_with};
pub use measure::Measures;
pub use mirror::mirrored;
pub use prop::{PatchProp, PropHold};
pub use set::{Contact, Fragment, PatchKind, PatchSet, PoseGroup, Touch};
