//! Ways of people over borders: a walk is the stays in one patch after the other, and steps are counted all along.

use std::collections::BTreeMap;

use glam::{DVec2, Vec2, Vec3};

use super::super::{Lane, Tables, UNITS_PER_METRE, World, rows};
use super::feet::Prints;
use super::{Gait, PER_RADIAN, STEPS_PER_CYCLE};
use crate::Result;

/// Borders that a search for a step crosses at most; a step crosses one or two.
const FAR: usize = 64;
/// Knots that a slot needs.
pub(super) const ORDER: usize = 4;

/// What headings are stored in.
pub(super) const RADIANS: f32 = 1.0 / PER_RADIAN;

/// A knot of somebody's stay: x and z of the way's control point; steps and heading when the slot of the same number begins.
/// All that is asked about somebody lies side by side.
pub(super) type Knot = [i16; 4];
const STEPS: usize = 2;
pub(super) const HEADING: usize = 3;

/// Where the knots of a walker of a kind are.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Track {
    /// The first of them.
    first: u32,
    /// The slot it comes in.
    enter: u16,
    /// Slots of its stay.
    slots: u16,
}

impl Track {
    /// All its knots: three more than it stays slots.
    fn knots(&self) -> std::ops::Range<usize> {
        self.first as usize..self.first as usize + usize::from(self.slots) + ORDER - 1
    }
}

/// How people with bodies go from stay to stay. Empty without bodies.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::stage::world) struct Ways {
    /// Number of walkers before every kind.
    first_walker: Vec<u32>,
    tracks: Vec<Track>,
    knots: Vec<Knot>,
    /// Crossings before and after every crossing; none if feet do not need them.
    links: Vec<[Option<Link>; 2]>,
    pub(super) prints: Prints,
    /// Slots per second.
    pub(super) rate: f32,
}

/// A crossing, and whose it is.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Link {
    crossing: u32,
    instance: u32,
}

/// A stay of somebody, seen from a patch: its numbers, and where its patch is.
#[derive(Clone, Copy, Debug)]
pub(in crate::stage::world) struct Stay<'a> {
    link: Link,
    pub(super) knots: &'a [Knot],
    slots: i32,
    /// The slot it comes in.
    pub enter: i32,
    /// How its patch is turned: sine and cosine times the metres of a unit, and the angle.
    pub(super) turns: Vec3,
    /// Origin of its patch, relative to that of the patch it is seen from.
    pub(super) origin: Vec2,
    /// Phase that it begins with.
    phase: f32,
    /// Factor of its steps.
    pace: f32,
}

impl Ways {
    /// # Errors
    /// If the gait does not fit the world.
    pub fn new(tables: &Tables, first_crossing: &[u32]) -> Result<Self> {
        let Some(gait) = &tables.gait else { return Ok(Self::default()) };
        let rate = tables.info.slots as f32 / tables.info.period_secs;
        let mut ways = Self { rate, prints: Prints::new(&gait.table), ..Self::default() };
        let (mut at, mut stays) = (0, 0);
        for kind in 0..tables.kinds() {
            ways.first_walker.push(ways.tracks.len() as u32);
            for (enter, leave) in rows::stays(tables, kind) {
                let slots = (leave - enter).clamp(0, 0xffff) as u16;
                let track = Track { first: at as u32, enter: enter as u16, slots };
                (at, stays) = (track.knots().end, stays + u64::from(slots) + 1);
                ways.tracks.push(track);
            }
        }
        gait.validate(stays, tables.identities.parts().0.len())?;
        ways.knots = vec![Knot::default(); at];
        ways.copy_ways(tables);
        ways.copy_steps(gait);
        if !gait.table.prints.is_empty() {
            ways.link(tables, first_crossing);
        }
        Ok(ways)
    }

    /// Copies control points from the pages.
    fn copy_ways(&mut self, tables: &Tables) {
        let (kinds, slots) = (tables.kinds(), tables.info.slots as usize);
        let (mut begin, mut page_begin) = (0, 0);
        for page in 0..tables.pages() {
            let (first, steps) = (begin, tables.page_slots(page));
            let end = tables.lane_ends[(page + 1) * kinds - 1] as usize;
            let row = 2 * (end - first);
            for kind in 0..kinds {
                let lanes = begin..tables.lane_ends[page * kinds + kind] as usize;
                begin = lanes.end;
                for lane in lanes.clone() {
                    let of = Lane(tables.lanes[lane]);
                    let track = self.tracks[self.first_walker[kind] as usize + of.walker()];
                    let on = page * tables.info.page as usize + of.lap() as usize * slots;
                    let at = page_begin + 2 * (lanes.start - first) + lane - lanes.start;
                    let knots = &mut self.knots[track.knots()];
                    for step in
                        (0..steps).filter(|step| (on + step).wrapping_sub(track.enter.into()) < track.slots.into())
                    {
                        for (i, knot) in knots[on + step - usize::from(track.enter)..][..ORDER].iter_mut().enumerate() {
                            let x = at + (step + i) * row;
                            (knot[0], knot[1]) = (tables.rows[x], tables.rows[x + lanes.len()]);
                        }
                    }
                }
            }
            page_begin += row * (steps + ORDER - 1);
        }
    }

    /// Copies steps and headings.
    fn copy_steps(&mut self, gait: &Gait) {
        let mut numbers = gait.steps.iter().zip(&gait.headings);
        for track in &self.tracks {
            let knots = self.knots[track.knots()].iter_mut().take(usize::from(track.slots) + 1);
            knots
                .zip(&mut numbers)
                .for_each(|(knot, (&steps, &heading))| (knot[STEPS], knot[HEADING]) = (steps, heading));
        }
    }

    /// Finds who goes where: stays follow each other without a gap.
    fn link(&mut self, tables: &Tables, first_crossing: &[u32]) {
        let (slots, identities) = (i64::from(tables.info.slots), &tables.identities);
        let mut cycles: BTreeMap<u32, Vec<(i64, Link, i64)>> = BTreeMap::new();
        for (instance, &kind) in tables.instance_kinds.iter().enumerate() {
            let first = first_crossing[instance];
            for crossing in first..first_crossing[instance + 1] {
                let track = self.tracks[(self.first_walker[kind as usize] + crossing - first) as usize];
                let own = identities.laps(crossing as usize) * slots + i64::from(track.enter);
                let when = own - i64::from(tables.instance_phases[instance]);
                let of = cycles.entry(identities.cycle(crossing as usize)).or_default();
                let link = Link { crossing, instance: instance as u32 };
                of.extend((track.slots > 0).then_some((when, link, i64::from(track.slots))));
            }
        }
        self.links = vec![[None; 2]; first_crossing.last().map_or(0, |&n| n as usize)];
        for (cycle, mut stays) in cycles {
            stays.sort_unstable_by_key(|&(when, link, slots)| (when, link.crossing, slots));
            let around = identities.around(cycle).0 * slots;
            let again = stays.first().map(|&(when, link, slots)| (when + around, link, slots));
            stays.extend(again.filter(|_| around > 0));
            for pair in stays.windows(2) {
                if pair[0].0 + pair[0].2 == pair[1].0 {
                    self.links[pair[0].1.crossing as usize][1] = Some(pair[1].1);
                    self.links[pair[1].1.crossing as usize][0] = Some(pair[0].1);
                }
            }
        }
    }

    /// The stay of a walker of an instance, seen from there.
    #[inline(always)]
    pub fn stay<'a>(&'a self, world: &World, gait: &Gait, instance: usize, walker: usize) -> Stay<'a> {
        let track = self.tracks[self.first_walker[world.kind_of(instance)] as usize + walker];
        let crossing = world.first_crossing[instance] + walker as u32;
        let [sin, cos] = world.rows.turns[instance];
        Stay {
            link: Link { crossing, instance: instance as u32 },
            knots: &self.knots[track.knots()],
            slots: track.slots.into(),
            enter: track.enter.into(),
            turns: Vec3::new(sin, cos, world.turn(instance)),
            origin: Vec2::ZERO,
            phase: gait.crossing_phases[crossing as usize],
            pace: gait.crossing_paces[crossing as usize],
        }
    }

    /// The stay before (`side` 0) or after (1) a stay, seen from the same patch.
    #[cold]
    fn neighbour<'a>(&'a self, world: &World, gait: &Gait, stay: &Stay, side: usize) -> Option<Stay<'a>> {
        let to = (*self.links.get(stay.link.crossing as usize)?.get(side)?)?;
        let [here, there] = [stay.link, to].map(|link| link.instance as usize);
        let next = self.stay(world, gait, there, (to.crossing - world.first_crossing[there]) as usize);
        let when = |stay: &Stay| {
            let laps = world.tables.identities.laps(stay.link.crossing as usize);
            let phase = world.tables.instance_phases[stay.link.instance as usize];
            laps * i64::from(world.info().slots) + i64::from(stay.enter) - i64::from(phase)
        };
        // From the last crossing of a cycle it is once around to the first.
        let (now, then) = (when(stay), when(&next));
        let rounds = if side == 1 { i32::from(then <= now) } else { -i32::from(then >= now) };
        let shift = world.copies_on(stay.link.crossing as usize, to.crossing as usize, rounds);
        let way = world.place(there) + shift - world.place(here);
        Some(Stay { origin: stay.origin + way.as_vec2(), ..next })
    }

    pub fn bytes(&self) -> usize {
        let links = size_of::<[Option<Link>; 2]>() * self.links.len();
        4 * self.first_walker.len() + 8 * (self.tracks.len() + self.knots.len()) + links
    }
}

/// Steps at the begin and at the end of a slot.
#[inline(always)]
fn between(knots: &[Knot], slot: i32) -> (f32, f32) {
    let pair = &knots[slot as usize..][..2];
    (pair[0][STEPS].into(), pair[1][STEPS].into())
}

impl Stay<'_> {
    /// Its phase in a slot of the stay, of which a share is gone: what it is beyond whole cycles.
    #[inline(always)]
    pub fn phase(&self, (slot, share): (i32, f32)) -> f32 {
        let (from, to) = between(self.knots, slot);
        let phase = self.phase + (from + (to - from) * share) / STEPS_PER_CYCLE * self.pace;
        // Not below zero, so this needs no call of the system's mathematics.
        phase - phase as i32 as f32
    }

    /// How far in a slot steps are `target`.
    #[inline(always)]
    fn share(&self, slot: i32, target: f32) -> f32 {
        let (from, to) = between(self.knots, slot);
        (target - from) / (to - from).max(1.0)
    }

    /// The slot in which steps are `target`, sought from one on; or that it is before (-1) or after (1) all of them.
    #[inline(always)]
    fn within(&self, mut slot: i32, target: f32) -> (i32, i32) {
        loop {
            let (from, to) = between(self.knots, slot);
            let side = i32::from(target > to) - i32::from(target < from);
            if side == 0 || !(0..self.slots).contains(&(slot + side)) {
                return (slot, side);
            }
            slot += side;
        }
    }
}

impl World {
    /// How far it is to the copy of the world that the way from crossing `from` to `to` leads to, `rounds` of their cycle on.
    fn copies_on(&self, from: usize, to: usize, rounds: i32) -> DVec2 {
        let Some(repeat) = self.info().repeat else { return DVec2::ZERO };
        let identities = &self.tables.identities;
        let (a, b) = (identities.copies(from), identities.copies(to));
        let (_, around) = identities.around(identities.cycle(from));
        let on = |axis: usize| (b[axis] - a[axis] + i64::from(rounds) * around[axis]) as f64 * f64::from(repeat[axis]);
        DVec2::new(on(0), on(1)) / UNITS_PER_METRE
    }

    /// Gives `to` the stay and the instant in it (as [`Stay::phase`] takes it) at which whoever is in slot number `slot` of a `stay` is
    /// `cycles` of two steps later (earlier if negative).
    #[inline(always)]
    pub(super) fn later<'a>(
        &'a self,
        gait: &Gait,
        stay: &Stay<'a>,
        (slot, share): (i32, f32),
        cycles: f32,
        to: impl FnOnce(&Stay<'a>, (i32, f32)),
    ) {
        let (from, next) = between(stay.knots, slot);
        let now = from + (next - from) * share;
        let target = now + cycles * STEPS_PER_CYCLE / stay.pace;
        // About where it is. Downwards, as slots are.
        let guess = slot + ((target - from) / (next - from).max(1.0) + 64.0) as i32 - 64;
        match stay.within(guess.clamp(0, stay.slots - 1), target) {
            (slot, 0) => to(stay, (slot, stay.share(slot, target))),
            (_, side) => {
                let (stay, at) = self.beyond(gait, stay, side, target);
                to(&stay, at);
            }
        }
    }

    /// The same, when it is before (`side` -1) or after (1) the stay.
    #[inline(never)]
    fn beyond<'a>(&'a self, gait: &Gait, stay: &Stay<'a>, mut side: i32, mut target: f32) -> (Stay<'a>, (i32, f32)) {
        let mut stay = *stay;
        let mut slot = if side < 0 { 0 } else { stay.slots - 1 };
        for _ in 0..FAR {
            let Some(next) = self.ways.neighbour(self, gait, &stay, usize::from(side > 0)) else { break };
            let whole = if side > 0 { &stay } else { &next };
            let taken = f32::from(whole.knots[whole.slots as usize][STEPS]);
            // What is left goes by the pace of the next stay.
            let pace = stay.pace / next.pace;
            target = if side > 0 { (target - taken) * pace } else { taken + target * pace };
            stay = next;
            (slot, side) = stay.within(if side > 0 { 0 } else { stay.slots - 1 }, target);
            if side == 0 {
                break;
            }
        }
        (stay, (slot, stay.share(slot, target)))
    }
}
