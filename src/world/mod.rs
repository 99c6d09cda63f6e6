//! Crowd patches: endless populated worlds from pieces of periodic animation.
//!
//! A *crowd patch* is a convex polygon with a period. *Patterns* on its edges say where, when and how fast people
//! cross: two patches whose patterns mirror each other join without a seam. Inside, walkers are led from the inputs to
//! the outputs so that nobody ever touches anybody or anything.
//!
//! ```
//! use crowdquilt::world::{FramePatch, Limits, Options, PatternType, solve};
//!
//! // Four people in and four out over each border of a square of 8 m, every 10 s.
//! let types = [const { PatternType::mixed(4, 4) }; 4];
//! let frame = FramePatch::random_square(8.0, 10.0, &types, 1)?;
//! let solution = solve(&frame, &Limits::default(), &Options { seed: 1, ..Options::default() })?;
//! assert!(solution.ok());
//! let place = solution.patch.walkers[0].path.position(2.5);
//! assert!(place.is_finite());
//! # Ok::<(), crowdquilt::Error>(())
//! ```
//!
//! | file | what |
//! |---|---|
//! | `pattern.rs`, `spacing.rs`, `kinds.rs` | crossings on a border, their mirror image, how far apart they stay, types and random patterns |
//! | `shape.rs`, `frame.rs`, `valid.rs`, `path.rs`, `patch.rs` | objects, the unsolved patch and what is wrong with it, a walker's curve, the solved patch |
//! | `assign.rs`, `pairing.rs`, `route.rs` | which input leads to which output and when, on which side of the objects |
//! | `solve/` | curves without collisions, within the limits of walking; the published particle method, to compare |
//! | `lattice.rs` | who is who over all borders and periods (see [`Identities`]); endless worlds |
//! | `bake.rs` | what is solved, as an immutable [`World`](crate::stage::World) |
//! | `template.rs`, `plan.rs`, `furnish.rs` | what patches contain, which is where, the world that follows |
//! | `area/` | worlds from walkable polygons of maps, drawings and floors of meshes: repaired, cut into convex cells |
//! | `scene.rs` | scene files: templates, and a map in characters or a picture |
//! | `survey.rs`, `site.rs`, `shard.rs` | a build in pieces: which patches there are to solve, in any order and by anybody; files of some of them |
//! | `gait.rs` | walking cycles out of captures, and steps for everybody |
//! | `goal.rs`, `goal/`, `goal_solve.rs`, `journey.rs` | walkers who go somewhere; who gets from one place to another soonest |
//! | `periods.rs`, `day.rs` | several periods in one world; density that follows the time of day |
//! | `spectator/` | people step aside for somebody who walks among them |
//! | `rich/` | what people do who do something else than walk, out of a patch set |
//! | `stream.rs` | an endless world around a camera |
//! | `scenes.rs`, `measure.rs` | the street and the city of the paper; how long patches take |

mod area;
mod assign;
mod bake;
mod band;
mod day;
mod footprints;
mod frame;
mod furnish;
mod gait;
mod goal;
mod goal_solve;
mod journey;
mod kinds;
mod lattice;
mod limits;
mod measure;
mod pairing;
mod patch;
mod path;
mod pattern;
mod periods;
mod plan;
mod rich;
mod route;
mod scene;
pub mod scenes;
mod shape;
mod shard;
mod site;
mod solve;
mod spacing;
pub mod spectator;
mod stream;
mod survey;
mod template;
mod valid;

pub use crate::stage::world::{Identities, Link, Person};
pub use area::{Area, Built, Coordinates, FloorOptions, Ground, Grounds, Reading, Sign};
pub use bake::{Placement, bake};
pub use day::Day;
pub use frame::{Border, FramePatch, Standing, StaticObject};
pub use gait::{gait_table, with_gait};
pub use goal::{Goal, Round, Rounds, Spot};
pub use journey::Journey;
pub use kinds::{Flow, PatternType, balance};
pub use lattice::{Lattice, Sighting};
pub use limits::Limits;
pub use measure::{Creation, Replay, Walk, measure_creation, measure_poses, measure_replay, measure_walk};
pub use patch::{CrowdPatch, Port, Walker};
pub use path::Path;
pub use pattern::{Crossing, Pattern, balanced};
pub use plan::Plan;
pub use rich::{Meeting, Member, Role, Tableau};
pub use scene::{Layout, WorldScene};
pub use shape::Shape;
pub use shard::Shard;
pub use site::Site;
use solve::solve_connected;
pub use solve::{Common, Method, Options, Solution, solve, vary};
pub use spectator::Spectator;
pub use stream::Stream;
pub use template::{Amount, Furnishing, Gathering, Prototype, Template};
