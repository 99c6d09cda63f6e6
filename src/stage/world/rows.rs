//! Pages of control points: where whose are.
//!
//! In a page, a kind's lanes are in such an order that those present in any of its slots are neighbours. So a slot of a kind is a
//! run of lanes, without gaps, masks or indices.

use glam::Vec2;

use super::tables::{Lane, expect};
use super::{Moment, Tables};
use crate::Result;

/// Lanes sampled together.
pub(super) const WIDTH: usize = 8;

/// Patches per kind from which on its control points are weighed once for all of them.
const SHARED: usize = 4;

/// Where the lanes present in a slot of a kind are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Run {
    /// Their first x in the slot's first row: an index into `Tables::rows`.
    at: u32,
    /// Lanes of the kind in the page: how far behind x its z is.
    lanes: u16,
    /// How many are present.
    pub live: u16,
}

/// Four rows of control points, eight lanes at a time.
pub(super) type Knots<'a> = [&'a [[i16; WIDTH]]; 4];

/// What follows from the tables: runs of every slot and kind, and rows.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Index {
    pub runs: Vec<Run>,
    slots: Vec<Slot>,
    pages: Vec<Page>,
    /// Sine and cosine of every patch's turn, times the metres of a unit.
    pub turns: Vec<[f32; 2]>,
    /// People who walk, of every slot.
    pub people: Vec<u32>,
    /// Patches kind by kind, where kinds are shared by so many that it pays to weigh each one's control points once for all of them.
    pub shared: Option<ByKind>,
}

/// Patches kind by kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct ByKind {
    /// End of every kind's patches in `instances`.
    ends: Vec<u32>,
    pub instances: Vec<u32>,
    /// How these are turned, as in [`Index::turns`], and their places in the tables' units: side by side, as they are played.
    frames: Vec<([f32; 2], [i32; 2])>,
}

impl ByKind {
    fn new(tables: &Tables, turns: &[[f32; 2]]) -> Self {
        let (kinds, of) = (tables.kinds(), &tables.instance_kinds);
        let mut instances: Vec<u32> = (0..of.len() as u32).collect();
        instances.sort_by_key(|&instance| of[instance as usize]);
        let end = |kind| instances.partition_point(|&instance| of[instance as usize] <= kind) as u32;
        let places = tables.instance_places.as_chunks().0;
        let frames = instances.iter().map(|&i| (turns[i as usize], places[i as usize])).collect();
        Self { ends: (0..kinds as u32).map(end).collect(), instances, frames }
    }

    /// How the patches of a kind lie.
    #[inline(always)]
    pub fn of(&self, kind: usize) -> &[([f32; 2], [i32; 2])] {
        let begin = if kind == 0 { 0 } else { self.ends[kind - 1] };
        &self.frames[begin as usize..self.ends[kind] as usize]
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Slot {
    /// The first number of its first row in `Tables::rows`.
    begin: usize,
    /// Numbers of a row.
    row: u32,
    page: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Page {
    /// Its first number in `Tables::rows`.
    begin: usize,
    /// Numbers of a row.
    row: usize,
    /// Its first lane in `Tables::lanes`.
    lane: usize,
}

impl Index {
    /// # Errors
    /// If lanes name walkers that do not exist, or those present in a slot are not neighbours.
    pub fn new(tables: &Tables) -> Result<Self> {
        let (kinds, slots) = (tables.kinds(), tables.info.slots as usize);
        expect(u32::try_from(tables.rows.len()).is_ok(), "rows", || "more than 4 billion numbers".into())?;
        let runs = vec![Run::default(); slots * kinds];
        let turn = |t: &f32| [t.sin(), t.cos()].map(|part| part * tables.info.metres_per_unit);
        let turns: Vec<[f32; 2]> = tables.instance_turns.iter().map(turn).collect();
        let together = tables.instance_phases.iter().all(|&phase| phase == 0);
        let shared = (together && tables.instance_kinds.len() >= SHARED * kinds).then(|| ByKind::new(tables, &turns));
        let mut index = Self { runs, turns, slots: Vec::new(), pages: Vec::new(), people: Vec::new(), shared };
        let stays: Vec<(i64, i64)> = (0..kinds).flat_map(|kind| stays(tables, kind)).collect();
        let mut begin = 0;
        for page in 0..tables.pages() {
            let end = |kind: usize| if kind == 0 { 0 } else { tables.lane_ends[kind - 1] as usize };
            let (first, last) = (end(page * kinds), end((page + 1) * kinds));
            let row = 2 * (last - first);
            index.pages.push(Page { begin, row, lane: first });
            let slot = |step: usize| Slot { begin: begin + step * row, row: row as u32, page: page as u32 };
            index.slots.extend((0..tables.page_slots(page)).map(slot));
            begin += row * (tables.page_slots(page) + 3);
            let mut walkers = 0;
            for kind in 0..kinds {
                let lanes = end(page * kinds + kind)..end(page * kinds + kind + 1);
                expect(lanes.len() <= usize::from(u16::MAX), format!("kind {kind}"), || {
                    format!("{} lanes", lanes.len())
                })?;
                let of = tables.kind(kind).walkers();
                let own = &stays[walkers..walkers + of];
                index.page_runs(tables, page, kind, lanes, own)?;
                walkers += of;
            }
        }
        let phases = tables.instance_kinds.iter().zip(&tables.instance_phases);
        let mut people = vec![0_u32; slots];
        for (&kind, &phase) in phases {
            for (slot, sum) in people.iter_mut().enumerate() {
                let own = (slot + phase as usize) % slots;
                *sum = sum.saturating_add(u32::from(index.runs[own * kinds + kind as usize].live));
            }
        }
        index.people = people;
        Ok(index)
    }

    /// The runs of a kind in a page.
    fn page_runs(
        &mut self,
        tables: &Tables,
        page: usize,
        kind: usize,
        lanes: std::ops::Range<usize>,
        stays: &[(i64, i64)],
    ) -> Result<()> {
        let place = || format!("page {page}, kind {kind}");
        let slots = i64::from(tables.info.slots);
        let Page { begin, row, lane: base } = self.pages[page];
        for step in 0..tables.page_slots(page) {
            let slot = page * tables.info.page as usize + step;
            let mut present = Vec::new();
            for (number, &lane) in tables.lanes[lanes.clone()].iter().enumerate() {
                let lane = Lane(lane);
                let stay = stays.get(lane.walker());
                let stay = stay.filter(|_| lane.lap() < 0x7fff);
                expect(stay.is_some(), place(), || format!("a lane of walker {}", lane.walker()))?;
                let own = slot as i64 + slots * lane.lap();
                present.extend(stay.filter(|s| (s.0..s.1).contains(&own)).map(|_| number));
            }
            let due = stays.iter().map(|&(enter, leave)| laps(enter, leave, slot as i64, slots)).sum::<i64>();
            let low = present.first().copied().unwrap_or(0);
            let together = present.iter().enumerate().all(|(i, &number)| number == low + i);
            expect(together && due == present.len() as i64, place(), || {
                format!("lanes {present:?} for {due} people in slot {slot}")
            })?;
            self.runs[slot * tables.kinds() + kind] = Run {
                at: (begin + step * row + 2 * (lanes.start - base) + low) as u32,
                lanes: lanes.len() as u16,
                live: present.len() as u16,
            };
        }
        Ok(())
    }

    /// Who is present in a slot of a kind.
    pub fn lanes<'a>(
        &self,
        tables: &'a Tables,
        kind: usize,
        slot: u32,
    ) -> impl ExactSizeIterator<Item = Lane> + use<'a> {
        let run = self.runs[slot as usize * tables.kinds() + kind];
        let page_slots = tables.info.page as usize;
        let (page, step) = (slot as usize / page_slots, slot as usize % page_slots);
        let first = if page + kind == 0 { 0 } else { tables.lane_ends[page * tables.kinds() + kind - 1] as usize };
        let Page { begin, row, lane } = self.pages[page];
        let low = run.at as usize - begin - step * row - 2 * (first - lane);
        tables.lanes[first + low..first + low + usize::from(run.live)].iter().map(|&lane| Lane(lane))
    }

    /// Place and velocity of the `lane`-th of those present in a slot of a kind.
    #[inline(always)]
    pub fn lane(&self, tables: &Tables, kind: usize, lane: usize, moment: &Moment) -> (Vec2, Vec2) {
        let slot = moment.slot as usize;
        let run = self.runs[slot * tables.kinds() + kind];
        let at = [run.at as usize + lane, usize::from(run.lanes), self.slots[slot].row as usize];
        let knots = four_knots(tables, at);
        let weighed = |weights| weigh(&knots, weights) * tables.info.metres_per_unit;
        (weighed(&moment.place), weighed(&moment.velocity))
    }

    /// Four rows of what is present in a slot of a kind, eight lanes at a time: their x, and their z.
    #[inline(always)]
    pub fn knots<'a>(&self, tables: &'a Tables, slot: usize, run: &Run) -> (Knots<'a>, Knots<'a>) {
        let read = usize::from(run.live).next_multiple_of(WIDTH);
        let (n, at) = (self.slots[slot].row as usize, run.at as usize);
        let lanes = usize::from(run.lanes);
        (four_rows(&tables.rows, at, n, read), four_rows(&tables.rows, at + lanes, n, read))
    }

    pub fn bytes(&self) -> usize {
        let shared = self.shared.as_ref().map_or(0, |shared| shared.ends.len() + 5 * shared.instances.len());
        let four = self.people.len() + shared;
        8 * (self.runs.len() + self.turns.len()) + 16 * self.slots.len() + 24 * self.pages.len() + 4 * four
    }
}

/// Parts of four rows, eight numbers at a time.
#[inline(always)]
fn four_rows(rows: &[i16], at: usize, row: usize, read: usize) -> Knots<'_> {
    let (a, b) = (&rows[at..at + read], &rows[at + row..at + row + read]);
    let (c, d) = (&rows[at + 2 * row..at + 2 * row + read], &rows[at + 3 * row..at + 3 * row + read]);
    [a.as_chunks().0, b.as_chunks().0, c.as_chunks().0, d.as_chunks().0]
}

/// The four control points of a lane: where its x is in the first of four rows, how far behind its z is, and from row to row.
#[inline(always)]
pub(super) fn four_knots(tables: &Tables, [at, behind, stride]: [usize; 3]) -> [Vec2; 4] {
    let knot = |at: usize| Vec2::new(f32::from(tables.rows[at]), f32::from(tables.rows[at + behind]));
    [knot(at), knot(at + stride), knot(at + 2 * stride), knot(at + 3 * stride)]
}

/// Their weighted sum.
#[inline(always)]
pub(super) fn weigh(knots: &[Vec2; 4], w: &[f32; 4]) -> Vec2 {
    knots[0] * w[0] + knots[1] * w[1] + knots[2] * w[2] + knots[3] * w[3]
}

/// First slot of every walker's stay, and the slot after the last. The neighbour rounds the same time, so that at every
/// instant exactly one patch has the walker; both curves are the same straight line then.
pub(super) fn stays(tables: &Tables, kind: usize) -> Vec<(i64, i64)> {
    let per_sec = f64::from(tables.info.slots) / f64::from(tables.info.period_secs);
    let presences = tables.kind(kind).presences(tables.info.period_secs);
    presences.into_iter().map(|stay| stay_slots(stay, per_sec)).collect()
}

/// A stay in whole slots.
pub(crate) fn stay_slots((enter, leave): (f64, f64), slots_per_sec: f64) -> (i64, i64) {
    ((enter * slots_per_sec).round() as i64, (leave * slots_per_sec).round() as i64)
}

/// How many people are present in `slot` of whom one comes in every period.
fn laps(enter: i64, leave: i64, slot: i64, slots: i64) -> i64 {
    (leave - 1 - slot).div_euclid(slots) - (enter - 1 - slot).div_euclid(slots)
}
