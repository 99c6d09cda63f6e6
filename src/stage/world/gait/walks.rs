//! Ways of people over borders: a walk is the stays in one patch after the other, and steps are counted all along.

use std::collections::BTreeMap;

use glam::{DVec2, Vec2};

use super::super::moment::weights;
use super::super::{Lane, Tables, UNITS_PER_METRE, World, rows};
use super::{Gait, PER_RADIAN, STEPS_PER_CYCLE};
use crate::Result;
use crate::geom::sin_cos;

/// No stay before or after.
const NONE: u32 = u32::MAX;
/// Borders that a search for a step crosses at most; a step crosses one or two.
const FAR: usize = 64;

/// Where the numbers of a walker of a kind are.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Track {
    /// Its first number in the gait's tables.
    first: u32,
    /// Its first number in `Ways::lanes`.
    lanes: u32,
    /// The slot it comes in.
    enter: u16,
    /// Slots of its stay.
    slots: u16,
}

/// How people with bodies go from stay to stay. Empty without bodies.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::stage::world) struct Ways {
    /// Number of walkers before every kind.
    first_walker: Vec<u32>,
    tracks: Vec<Track>,
    /// Which of its kind's lanes a walker is, in every page of its stay.
    lanes: Vec<u16>,
    /// Crossings before and after every crossing; none if feet do not need them.
    links: Vec<[u32; 2]>,
}

/// A stay of somebody, seen from a patch: its numbers, and where its patch is.
#[derive(Clone, Copy, Debug)]
pub(in crate::stage::world) struct Stay {
    kind: u32,
    crossing: u32,
    first: u32,
    lanes: u32,
    slots: i32,
    /// The slot it comes in.
    pub enter: i32,
    /// Origin of its patch, relative to that of the patch it is seen from.
    origin: Vec2,
    turn: f32,
    /// Phase that it begins with.
    phase: f32,
    /// Factor of its steps.
    pace: f32,
}

/// How somebody is at a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instant {
    pub place: Vec2,
    pub speed: f32,
    /// Where it looks: sine and cosine of the heading.
    pub ahead: Vec2,
}

impl Ways {
    /// # Errors
    /// If the gait does not fit the world.
    pub fn new(tables: &Tables, index: &rows::Index, first_crossing: &[u32]) -> Result<Self> {
        let Some(gait) = &tables.gait else { return Ok(Self::default()) };
        let (mut ways, mut at) = (Self::default(), 0_u64);
        for kind in 0..tables.kinds() {
            ways.first_walker.push(ways.tracks.len() as u32);
            for (enter, leave) in rows::stays(tables, kind) {
                let slots = (leave - enter).clamp(0, 0xffff) as u16;
                let (first, lanes, enter) = (at as u32, ways.lanes.len() as u32, enter as u16);
                ways.tracks.push(Track { first, lanes, enter, slots });
                let page = |slot: i32| page_of(index, slot, tables.info.slots).1;
                let pages = page(i32::from(enter) + i32::from(slots)) - page(enter.into()) + 1;
                ways.lanes.resize(ways.lanes.len() + pages, 0);
                at += u64::from(slots) + 1;
            }
        }
        ways.number_lanes(tables, index);
        gait.validate(at, tables.identities.parts().0.len())?;
        if !gait.table.prints.is_empty() {
            ways.link(tables, first_crossing);
        }
        Ok(ways)
    }

    /// Notes who is which lane.
    fn number_lanes(&mut self, tables: &Tables, index: &rows::Index) {
        let kinds = tables.kinds();
        let mut begin = 0;
        for (at, &end) in tables.lane_ends.iter().enumerate() {
            let (page, kind) = (at / kinds, at % kinds);
            for (number, &lane) in tables.lanes[begin..end as usize].iter().enumerate() {
                let walker = self.first_walker[kind] as usize + Lane(lane).walker();
                let Track { lanes, enter, .. } = self.tracks[walker];
                let end = self.tracks.get(walker + 1).map_or(self.lanes.len(), |next| next.lanes as usize);
                let on = page + tables.pages() * Lane(lane).lap() as usize;
                let since = on.checked_sub(page_of(index, enter.into(), tables.info.slots).1);
                // A lane in which nobody ever is has no number.
                let known = since.and_then(|since| self.lanes[lanes as usize..end].get_mut(since));
                known.into_iter().for_each(|known| *known = number as u16);
            }
            begin = end as usize;
        }
    }

    /// Finds who goes where: stays follow each other without a gap.
    fn link(&mut self, tables: &Tables, first_crossing: &[u32]) {
        let (slots, identities) = (i64::from(tables.info.slots), &tables.identities);
        let mut cycles: BTreeMap<u32, Vec<(i64, u32, i64)>> = BTreeMap::new();
        for (instance, &kind) in tables.instance_kinds.iter().enumerate() {
            let first = first_crossing[instance];
            for crossing in first..first_crossing[instance + 1] {
                let track = self.tracks[(self.first_walker[kind as usize] + crossing - first) as usize];
                let own = identities.laps(crossing as usize) * slots + i64::from(track.enter);
                let when = own - i64::from(tables.instance_phases[instance]);
                let of = cycles.entry(identities.cycle(crossing as usize)).or_default();
                of.extend((track.slots > 0).then_some((when, crossing, i64::from(track.slots))));
            }
        }
        self.links = vec![[NONE; 2]; first_crossing.last().map_or(0, |&n| n as usize)];
        for (cycle, mut stays) in cycles {
            stays.sort_unstable();
            let around = identities.around(cycle).0 * slots;
            let again = stays.first().map(|&(when, crossing, slots)| (when + around, crossing, slots));
            stays.extend(again.filter(|_| around > 0));
            for pair in stays.windows(2) {
                if pair[0].0 + pair[0].2 == pair[1].0 {
                    self.links[pair[0].1 as usize][1] = pair[1].1;
                    self.links[pair[1].1 as usize][0] = pair[0].1;
                }
            }
        }
    }

    /// The stay of a walker of an instance, seen from there.
    #[inline(always)]
    pub fn stay(&self, world: &World, instance: usize, walker: usize) -> Stay {
        let kind = world.kind_of(instance);
        let Track { first, lanes, enter, slots } = self.tracks[self.first_walker[kind] as usize + walker];
        let crossing = world.first_crossing[instance] as usize + walker;
        let of = |gait: &Gait| (gait.crossing_phases[crossing], gait.crossing_paces[crossing]);
        let (phase, pace) = world.tables.gait.as_ref().map_or((0.0, 1.0), of);
        let (kind, crossing) = (kind as u32, crossing as u32);
        let (slots, enter) = (i32::from(slots), i32::from(enter));
        Stay { kind, crossing, first, lanes, slots, enter, origin: Vec2::ZERO, turn: world.turn(instance), phase, pace }
    }

    /// The stay before (`side` 0) or after (1) a stay, seen from the same patch.
    #[cold]
    fn neighbour(&self, world: &World, stay: &Stay, side: usize) -> Option<Stay> {
        let from = stay.crossing as usize;
        let to = *self.links.get(from)?.get(side)?;
        if to == NONE {
            return None;
        }
        let instance_of = |crossing: u32| world.first_crossing.partition_point(|&first| first <= crossing) - 1;
        let [here, there] = [instance_of(stay.crossing), instance_of(to)];
        let next = self.stay(world, there, (to - world.first_crossing[there]) as usize);
        let when = |crossing: u32, instance: usize, stay: &Stay| {
            let own = world.tables.identities.laps(crossing as usize) * i64::from(world.info().slots);
            own + i64::from(stay.enter) - i64::from(world.tables.instance_phases[instance])
        };
        // From the last crossing of a cycle it is once around to the first.
        let (now, then) = (when(stay.crossing, here, stay), when(to, there, &next));
        let rounds = if side == 1 { i32::from(then <= now) } else { -i32::from(then >= now) };
        let shift = world.copies_on(from, to as usize, rounds);
        let way = world.place(there) + shift - world.place(here);
        Some(Stay { origin: stay.origin + way.as_vec2(), ..next })
    }

    pub fn bytes(&self) -> usize {
        4 * self.first_walker.len() + 12 * self.tracks.len() + 2 * self.lanes.len() + 8 * self.links.len()
    }
}

/// Slot of its period, and page counted from the period's begin, of a slot counted from there.
#[inline(always)]
fn page_of(index: &rows::Index, mut slot: i32, slots: u32) -> (usize, usize) {
    let (slots, mut pages) = (slots as i32, 0);
    // Hardly anybody stays for more than two periods.
    while slot >= slots {
        slot -= slots;
        pages += index.page_of(slots as usize - 1) + 1;
    }
    (slot as usize, pages + index.page_of(slot as usize))
}

impl Stay {
    /// Where it looks, radians, in slot number `slot` of the stay.
    #[inline(always)]
    pub fn heading(&self, gait: &Gait, slot: i32, share: f32) -> f32 {
        let at = (self.first as i32 + slot) as usize;
        let (from, to) = (gait.headings[at], gait.headings[at + 1]);
        (f32::from(from) + f32::from(to.wrapping_sub(from)) * share) / PER_RADIAN - self.turn
    }

    /// Its phase, counted on from that which it came in with.
    #[inline(always)]
    pub fn phase(&self, gait: &Gait, slot: i32, share: f32) -> f32 {
        let (from, to) = between(self.steps(gait), slot);
        self.phase + (from + (to - from) * share) / STEPS_PER_CYCLE * self.pace
    }

    /// Its steps at the begin of every slot, and at its end.
    #[inline(always)]
    fn steps<'a>(&self, gait: &'a Gait) -> &'a [i16] {
        &gait.steps[self.first as usize..][..=self.slots as usize]
    }
}

/// Steps at the begin and at the end of a slot.
#[inline(always)]
fn between(steps: &[i16], slot: i32) -> (f32, f32) {
    (f32::from(steps[slot as usize]), f32::from(steps[slot as usize + 1]))
}

/// The slot in which steps are `target`, sought from one on; or that it is before (-1) or after (1) all of them.
#[inline(always)]
fn within(steps: &[i16], mut slot: i32, target: f32) -> (i32, i32) {
    let last = steps.len() as i32 - 2;
    loop {
        let (from, to) = between(steps, slot);
        let side = i32::from(target > to) - i32::from(target < from);
        if side == 0 || !(0..=last).contains(&(slot + side)) {
            return (slot, side);
        }
        slot += side;
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

    /// How whoever is in slot number `slot` of a `stay` is `cycles` of two steps later (earlier if negative).
    #[inline(always)]
    pub(super) fn later(&self, gait: &Gait, stay: &Stay, (slot, share): (i32, f32), cycles: f32) -> Instant {
        let steps = stay.steps(gait);
        let (from, to) = between(steps, slot);
        let now = from + (to - from) * share;
        let target = now + cycles * STEPS_PER_CYCLE / stay.pace;
        // About where it is. Downwards, as slots are.
        let guess = slot + ((target - from) / (to - from).max(1.0) + 64.0) as i32 - 64;
        match within(steps, guess.clamp(0, stay.slots - 1), target) {
            (slot, 0) => self.instant(gait, stay, slot, target),
            (_, side) => self.beyond(gait, *stay, side, target),
        }
    }

    /// The same, when it is before (`side` -1) or after (1) the stay.
    #[inline(never)]
    fn beyond(&self, gait: &Gait, mut stay: Stay, mut side: i32, mut target: f32) -> Instant {
        let mut slot = if side < 0 { 0 } else { stay.slots - 1 };
        for _ in 0..FAR {
            let Some(next) = self.ways.neighbour(self, &stay, usize::from(side > 0)) else { break };
            let whole = if side > 0 { stay } else { next };
            let taken = f32::from(gait.steps[(whole.first as i32 + whole.slots) as usize]);
            // What is left goes by the pace of the next stay.
            let pace = stay.pace / next.pace;
            target = if side > 0 { (target - taken) * pace } else { taken + target * pace };
            stay = next;
            (slot, side) = within(stay.steps(gait), if side > 0 { 0 } else { stay.slots - 1 }, target);
            if side == 0 {
                break;
            }
        }
        self.instant(gait, &stay, slot, target)
    }

    /// How somebody is in a slot of its stay when its steps are `target`; straight on, before and after what is known of it.
    #[inline(always)]
    fn instant(&self, gait: &Gait, stay: &Stay, slot: i32, target: f32) -> Instant {
        let (from, to) = between(stay.steps(gait), slot);
        let share = (target - from) / (to - from).max(1.0);
        let (inside, slots) = (share.clamp(0.0, 1.0), self.info().slots);
        let (sin, cos) = sin_cos(stay.heading(gait, slot, inside));
        let ahead = Vec2::new(sin, cos);
        let (own, page) = page_of(&self.rows, stay.enter + slot, slots);
        let since = page - page_of(&self.rows, stay.enter, slots).1;
        let number = self.ways.lanes[stay.lanes as usize + since];
        let at = self.rows.find(&self.tables, stay.kind as usize, own, number.into());
        let (knots, unit) = (rows::four_knots(&self.tables, at), self.info().metres_per_unit);
        let (place, velocity) = weights(inside);
        let velocity = rows::weigh(&knots, &velocity) * unit;
        let place = rows::weigh(&knots, &place) * unit + velocity * (share - inside);
        let speed = velocity.length() * (slots as f32 / self.info().period_secs);
        let place = if stay.turn == 0.0 { place } else { turned(place, stay.turn) };
        Instant { place: place + stay.origin, speed, ahead }
    }
}

/// Turned so that the x axis points along the angle's (cos, sin).
#[inline(always)]
fn turned(place: Vec2, angle: f32) -> Vec2 {
    let (sin, cos) = sin_cos(angle);
    Vec2::new(cos, sin).rotate(place)
}
