//! Pages of control points, and the kernel that samples them.
//!
//! In a page, a kind's lanes are in such an order that those present in any of its slots are neighbours. So a slot of a kind is a
//! run of lanes, without gaps, masks or indices. Lanes are sampled eight at a time; what is computed beyond a run's end
//! is overwritten by the next. Without `unsafe`: slices of fixed length carry the compiler to vector instructions, `pulp` to
//! the widest the machine has. (Products and sums are never fused, so that all machines give the same bits.)

use glam::DVec2;

use super::place::Spot;
use super::tables::{Lane, expect};
use super::{Moment, Tables, World};
use crate::Result;

/// Lanes sampled together.
const WIDTH: usize = 8;

/// Places and velocities, one array for each coordinate. Reused from frame to frame.
#[derive(Clone, Debug, Default)]
pub struct Roots {
    arrays: [Vec<f32>; 4],
    len: usize,
}

impl Roots {
    /// How many people.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is nobody.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Everybody's x, metres from the origin asked for.
    pub fn x(&self) -> &[f32] {
        &self.arrays[0][..self.len]
    }

    /// Everybody's z.
    pub fn z(&self) -> &[f32] {
        &self.arrays[1][..self.len]
    }

    /// Everybody's velocity along x, m/s.
    pub fn vx(&self) -> &[f32] {
        &self.arrays[2][..self.len]
    }

    /// Everybody's velocity along z.
    pub fn vz(&self) -> &[f32] {
        &self.arrays[3][..self.len]
    }

    fn reserve(&mut self, people: usize) {
        if self.arrays[0].len() < people {
            self.arrays.iter_mut().for_each(|array| array.resize(people, 0.0));
        }
    }
}

/// Where the lanes present in a slot of a kind are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Run {
    /// Their first x in a row.
    at: u32,
    /// Lanes of the kind in the page: how far behind x its z is.
    lanes: u16,
    /// How many are present.
    live: u16,
}

/// What follows from the tables: runs of every slot and kind, and rows.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Index {
    runs: Vec<Run>,
    /// First number of every page, and of its rows.
    pages: Vec<Page>,
    /// People who walk, of every slot.
    pub people: Vec<u32>,
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
        let mut index = Self { runs: vec![Run::default(); slots * kinds], pages: Vec::new(), people: Vec::new() };
        let stays: Vec<(i64, i64)> = (0..kinds).flat_map(|kind| stays(tables, kind)).collect();
        let mut begin = 0;
        for page in 0..tables.pages() {
            let end = |kind: usize| if kind == 0 { 0 } else { tables.lane_ends[kind - 1] as usize };
            let (first, last) = (end(page * kinds), end((page + 1) * kinds));
            let row = 2 * (last - first);
            index.pages.push(Page { begin, row, lane: first });
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
        let base = self.pages[page].lane;
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
                at: (2 * (lanes.start - base) + low) as u32,
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
        let page = slot as usize / tables.info.page as usize;
        let first = if page + kind == 0 { 0 } else { tables.lane_ends[page * tables.kinds() + kind - 1] as usize };
        let low = run.at as usize - 2 * (first - self.pages[page].lane);
        tables.lanes[first + low..first + low + usize::from(run.live)].iter().map(|&lane| Lane(lane))
    }

    pub fn bytes(&self) -> usize {
        8 * self.runs.len() + 24 * self.pages.len() + 4 * self.people.len()
    }
}

/// First slot of every walker's stay, and the slot after the last. The neighbour rounds the same time, so that at every
/// instant exactly one patch has the walker; both curves are the same straight line then.
fn stays(tables: &Tables, kind: usize) -> Vec<(i64, i64)> {
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

/// Samples the walkers of `spots`.
pub(super) fn sample(
    world: &World,
    moment: &Moment,
    spots: impl Iterator<Item = Spot>,
    origin: DVec2,
    out: &mut Roots,
) {
    out.reserve(world.walkers(moment) + WIDTH);
    out.len = 0;
    pulp::Arch::new().dispatch(Sampling { world, moment, spots, origin, out });
}

struct Sampling<'a, I> {
    world: &'a World,
    moment: &'a Moment,
    spots: I,
    origin: DVec2,
    out: &'a mut Roots,
}

impl<I: Iterator<Item = Spot>> pulp::NullaryFnOnce for Sampling<'_, I> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { world, moment, spots, origin, out } = self;
        let slots = world.info().slots;
        for spot in spots {
            let own = moment.later(world.tables.instance_phases[spot.instance as usize], slots);
            sample_patch(world, &own, spot, origin, out);
        }
    }
}

type Eight = [f32; WIDTH];

#[inline(always)]
fn sample_patch(world: &World, moment: &Moment, spot: Spot, origin: DVec2, out: &mut Roots) {
    let (tables, instance) = (&world.tables, spot.instance as usize);
    let slot = moment.slot as usize;
    let run = world.rows.runs[slot * tables.kinds() + tables.instance_kinds[instance] as usize];
    let live = usize::from(run.live);
    if out.arrays[0].len() < out.len + live + WIDTH {
        // The same patch more than once, where a world repeats.
        out.reserve((out.len + live + WIDTH) * 2);
    }
    let page = world.rows.pages[slot / tables.info.page as usize];
    let first = page.begin + (slot % tables.info.page as usize) * page.row + run.at as usize;
    let unit = tables.info.metres_per_unit;
    let turn = tables.instance_turns[instance];
    let (sin, cos) = if turn == 0.0 { (0.0, 1.0) } else { turn.sin_cos() };
    let (sin, cos) = (sin * unit, cos * unit);
    let place = (tables.place(instance) + spot.shift - origin).as_vec2();
    let rows: [usize; 4] = std::array::from_fn(|r| first + r * page.row);
    for k in (0..live).step_by(WIDTH) {
        let x = rows.map(|at| load(&tables.rows, at + k));
        let z = rows.map(|at| load(&tables.rows, at + k + usize::from(run.lanes)));
        let (px, pz) = (weigh(&x, &moment.place), weigh(&z, &moment.place));
        let (vx, vz) = (weigh(&x, &moment.velocity), weigh(&z, &moment.velocity));
        let at = out.len + k;
        let [ox, oz, ovx, ovz] = &mut out.arrays;
        store(ox, at, std::array::from_fn(|i| cos * px[i] - sin * pz[i] + place.x));
        store(oz, at, std::array::from_fn(|i| sin * px[i] + cos * pz[i] + place.y));
        store(ovx, at, std::array::from_fn(|i| cos * vx[i] - sin * vz[i]));
        store(ovz, at, std::array::from_fn(|i| sin * vx[i] + cos * vz[i]));
    }
    out.len += live;
}

/// Eight numbers; at the very end of the table fewer, and zeros.
#[inline(always)]
fn load(rows: &[i16], at: usize) -> Eight {
    match rows.get(at..).and_then(|rest| rest.first_chunk::<WIDTH>()) {
        Some(numbers) => numbers.map(f32::from),
        None => last(rows, at),
    }
}

#[cold]
fn last(rows: &[i16], at: usize) -> Eight {
    std::array::from_fn(|i| rows.get(at + i).map_or(0.0, |&n| f32::from(n)))
}

#[inline(always)]
fn weigh(rows: &[Eight; 4], w: &[f32; 4]) -> Eight {
    std::array::from_fn(|i| rows[0][i] * w[0] + rows[1][i] * w[1] + rows[2][i] * w[2] + rows[3][i] * w[3])
}

#[inline(always)]
fn store(out: &mut [f32], at: usize, numbers: Eight) {
    if let Some(place) = out.get_mut(at..).and_then(|rest| rest.first_chunk_mut()) {
        *place = numbers;
    }
}
