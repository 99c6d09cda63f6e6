//! A baked world of crowd patches: immutable, playable at any time, by random access.
//!
//! "Crowd Patches" (2009): a world is patches of a few kinds, placed side by side; all of it repeats every period. State at
//! time t is a pure function of t: nobody is simulated, nothing is remembered, t = 1 h costs what t = 1 s costs.
//!
//! **Layout.** A walker's way is a uniform cubic B-spline over time slots ([`Moment`]), its control points 16-bit numbers.
//! A *page* is a run of slots; within it, every kind's walkers are *lanes* in an order that makes those present in any
//! slot neighbours: who leaves during the page first (the earliest first), then who stays, then who comes in. Rows of
//! control points follow each other, so that one slot of all kinds is four contiguous rows, and sampling is four loads,
//! a weighted sum and the instance's transform for eight lanes at a time (`sample.rs`). Kinds may be shared by any number of
//! instances, or be used once.
//!
//! | file | what |
//! |---|---|
//! | `moment.rs` | an instant: time slot and spline weights |
//! | `tables.rs` | all numbers of a world, as in the file; what must be true of them |
//! | `rows.rs` | pages, lanes |
//! | `sample.rs` | the sampling kernel |
//! | `kind.rs` | what a patch kind consists of: outline, patterns, objects, people, ways |
//! | `acts.rs` | full bodies of people who do something else than walk: clips |
//! | `fade.rs` | how walk and clip fade into each other, and feet stay meanwhile |
//! | `gait/` | full bodies: poses by speed and phase, steps that go on over borders, feet that stay where they are planted |
//! | `identity.rs` | who is who, at any time |
//! | `place.rs` | where instances are, which are near |
//! | `file.rs` | the world file |

mod acts;
mod fade;
mod file;
mod gait;
mod identity;
mod kind;
mod moment;
mod place;
mod rows;
mod sample;
mod tables;

use glam::{DVec2, Vec2};

pub use acts::{Act, Acts};
pub(crate) use acts::{NO_ACT, feet_with_body};
pub use gait::{Foot, Gait, GaitTable, Swing, Walking};
pub(crate) use gait::{PER_RADIAN, STEPS_PER_CYCLE};
pub(crate) use identity::mix;
pub use identity::{Identities, Link, Person};
pub use kind::{Crossing, Kind, ObjectShape, Pattern, Stayer};
pub use moment::Moment;
pub use place::{Nearby, Spot, UNITS_PER_METRE};
pub(crate) use rows::stay_slots;
pub use sample::Roots;
pub use tables::{Lane, Tables, TemplateInfo, WalkLimits, WorldInfo};

use crate::Result;

/// A finished world: see the [module's documentation](self).
#[derive(Clone, Debug, PartialEq)]
pub struct World {
    tables: Tables,
    rows: rows::Index,
    nearby: Nearby,
    /// Index of the first crossing of every instance, and after the last.
    first_crossing: Vec<u32>,
    /// Number of stayers before every instance, and of all.
    first_stayer: Vec<u32>,
    /// How people with bodies go from stay to stay.
    ways: gait::Ways,
}

impl World {
    /// A world of these numbers.
    ///
    /// # Errors
    /// Names the table and the place in it where something cannot be.
    pub fn new(tables: Tables) -> Result<Self> {
        tables.validate()?;
        let rows = rows::Index::new(&tables)?;
        let nearby = Nearby::new(&tables);
        let ends = |of: &dyn Fn(usize) -> usize| {
            let each = tables.instance_kinds.iter().map(|&kind| of(kind as usize) as u32);
            std::iter::once(0)
                .chain(each.scan(0_u32, |sum, n| {
                    *sum += n;
                    Some(*sum)
                }))
                .collect::<Vec<u32>>()
        };
        let first_crossing = ends(&|kind| tables.kind(kind).walkers());
        let first_stayer = ends(&|kind| tables.kind(kind).stayers().len());
        let ways = gait::Ways::new(&tables, &first_crossing)?;
        Ok(Self { rows, nearby, first_crossing, first_stayer, ways, tables })
    }

    /// All its numbers.
    pub fn tables(&self) -> &Tables {
        &self.tables
    }

    /// What it is, in words and settings.
    pub fn info(&self) -> &WorldInfo {
        &self.tables.info
    }

    /// The instant `time` (seconds, any; also negative).
    pub fn moment(&self, time: f64) -> Moment {
        Moment::new(time, f64::from(self.info().period_secs), self.info().slots)
    }

    /// How many patch kinds there are.
    pub fn kinds(&self) -> usize {
        self.tables.kinds()
    }

    /// A patch kind.
    pub fn kind(&self, kind: usize) -> Kind<'_> {
        self.tables.kind(kind)
    }

    /// How many patches there are.
    pub fn instances(&self) -> usize {
        self.tables.instance_kinds.len()
    }

    /// Kind of a patch.
    pub fn kind_of(&self, instance: usize) -> usize {
        self.tables.instance_kinds[instance] as usize
    }

    /// Where the origin of a patch is, metres.
    pub fn place(&self, instance: usize) -> DVec2 {
        self.tables.place(instance)
    }

    /// How a patch is turned about the vertical, radians: its x axis points along (cos, sin) of it in (x, z).
    pub fn turn(&self, instance: usize) -> f32 {
        self.tables.instance_turns[instance]
    }

    /// Which patches are where.
    pub fn nearby(&self) -> &Nearby {
        &self.nearby
    }

    /// How many people walk at an instant. O(1).
    pub fn walkers(&self, moment: &Moment) -> usize {
        self.rows.people[moment.slot as usize] as usize
    }

    /// How many people stay inside their patches.
    pub fn stayers(&self) -> usize {
        self.first_stayer[self.instances()] as usize
    }

    /// Patches in the order in which [`Self::roots`] plays them: those of a kind together, where kinds are shared.
    pub fn order(&self) -> impl ExactSizeIterator<Item = usize> {
        let shared = self.rows.shared.as_ref().map(|shared| &shared.instances);
        (0..self.instances()).map(move |i| shared.map_or(i, |instances| instances[i] as usize))
    }

    /// Where everybody who walks is at `moment`, patch by patch in [order](Self::order), metres from `origin`. O(people); allocates
    /// only where `out` has never been as large.
    pub fn roots(&self, moment: &Moment, origin: DVec2, out: &mut Roots) {
        sample::sample_all(self, moment, origin, out);
    }

    /// The same for some patches only.
    pub fn roots_of(&self, moment: &Moment, spots: impl Iterator<Item = Spot>, origin: DVec2, out: &mut Roots) {
        sample::sample(self, moment, spots, origin, out);
    }

    /// First slot of the stay of every walker of a kind, counted from the period it comes in, and the slot after the last: the patch
    /// has it from one to the other.
    pub fn stays(&self, kind: usize) -> Vec<(i64, i64)> {
        rows::stays(&self.tables, kind)
    }

    /// Place and velocity of a walker of a kind, in the kind's frame, `secs` after the begin of the period it came in; `None` while
    /// the patch does not have it. O(lanes of the kind).
    pub fn way(&self, kind: usize, walker: usize, secs: f64) -> Option<(Vec2, Vec2)> {
        let moment = self.moment(secs);
        let mut lanes = self.rows.lanes(&self.tables, kind, moment.slot);
        let lane = lanes.position(|lane| lane.walker() == walker && lane.lap() == moment.lap)?;
        Some(self.rows.lane(&self.tables, kind, lane, &moment))
    }

    /// Crossing of the first walker of a patch; those of the others follow.
    pub fn first_crossing(&self, instance: usize) -> usize {
        self.first_crossing[instance] as usize
    }

    /// Who walks in `instance` at `moment`, in the order of [`Self::roots`]: index of the walker in the kind, and the period it came
    /// in.
    pub fn walkers_of(&self, instance: usize, moment: &Moment) -> impl ExactSizeIterator<Item = (usize, i64)> {
        let own = moment.later(self.tables.instance_phases[instance], self.info().slots);
        self.rows
            .lanes(&self.tables, self.kind_of(instance), own.slot)
            .map(move |lane| (lane.walker(), own.lap - lane.lap()))
    }

    /// Who walks in `instance` (of the world's copy `copy`) at `moment`, in the order of [`Self::roots`]. O(1) for each.
    pub fn people_of(&self, instance: usize, copy: [i64; 2], moment: &Moment) -> impl ExactSizeIterator<Item = Person> {
        let first = self.first_crossing[instance] as usize;
        let identities = &self.tables.identities;
        self.walkers_of(instance, moment).map(move |(walker, lap)| identities.of(first + walker, copy, lap))
    }

    /// The `index`-th of those who stay in `instance` (of the world's copy `copy`).
    pub fn stayer(&self, instance: usize, index: usize, copy: [i64; 2]) -> Person {
        let number = i64::from(self.first_stayer[instance]) + index as i64;
        Person { cycle: self.tables.identities.cycles() as u32, copy, number }
    }

    /// Bytes it takes in memory.
    pub fn bytes(&self) -> usize {
        let firsts = 4 * (self.first_crossing.len() + self.first_stayer.len());
        self.tables.bytes() + self.rows.bytes() + self.nearby.bytes() + firsts + self.ways.bytes()
    }
}
