//! Pages of control points, and the kernel that samples them.
//!
//! In a page, a kind's lanes are in such an order that those present in any of its slots are neighbours. So a slot of a kind is a
//! run of lanes, without gaps, masks or indices. Lanes are sampled eight at a time; what is computed beyond a run's end
//! is overwritten by the next. Without `unsafe`: slices of fixed length carry the compiler to vector instructions, `pulp` to
//! the widest the machine has. (Products and sums are never fused, so that all machines give the same bits.)

use glam::{DVec2, Vec2};

use super::place::Spot;
use super::tables::{Lane, expect};
use super::{Moment, Tables, World};
use crate::Result;

/// Lanes sampled together.
pub(super) const WIDTH: usize = 8;

/// Patches per kind from which on its control points are weighed once for all of them.
const SHARED: usize = 4;

/// Places and velocities, one array for each coordinate. Reused from frame to frame.
#[derive(Clone, Debug, Default)]
pub struct Roots {
    arrays: [Vec<f32>; 4],
    len: usize,
    /// Lanes of every kind, weighed, for worlds whose kinds are shared: places and velocities in units of the kind's frame.
    weighed: [Vec<f32>; 4],
    /// Where each kind's are, and how many.
    parts: Vec<[u32; 2]>,
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

    #[cold]
    #[inline(never)]
    fn grow(&mut self, people: usize) {
        if self.arrays[0].len() < people {
            self.arrays.iter_mut().for_each(|array| array.resize(people, 0.0));
        }
    }
}

/// Where the lanes present in a slot of a kind are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Run {
    /// Their first x in the slot's first row: an index into `Tables::rows`.
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
    /// From row to row, of every slot.
    strides: Vec<usize>,
    pages: Vec<Page>,
    /// Sine and cosine of every patch's turn, times the metres of a unit.
    turns: Vec<[f32; 2]>,
    /// People who walk, of every slot.
    pub people: Vec<u32>,
    /// Whether it pays to weigh each kind's control points once for all patches of the kind.
    shared: bool,
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
        let turns = tables.instance_turns.iter().map(turn).collect();
        let together = tables.instance_phases.iter().all(|&phase| phase == 0);
        let shared = together && tables.instance_kinds.len() >= SHARED * kinds;
        let mut index = Self { runs, turns, strides: Vec::new(), pages: Vec::new(), people: Vec::new(), shared };
        let stays: Vec<(i64, i64)> = (0..kinds).flat_map(|kind| stays(tables, kind)).collect();
        let mut begin = 0;
        for page in 0..tables.pages() {
            let end = |kind: usize| if kind == 0 { 0 } else { tables.lane_ends[kind - 1] as usize };
            let (first, last) = (end(page * kinds), end((page + 1) * kinds));
            let row = 2 * (last - first);
            index.pages.push(Page { begin, row, lane: first });
            index.strides.extend(std::iter::repeat_n(row, tables.page_slots(page)));
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
    pub fn lane(&self, tables: &Tables, kind: usize, lane: usize, moment: &Moment) -> (Vec2, Vec2) {
        let slot = moment.slot as usize;
        let run = self.runs[slot * tables.kinds() + kind];
        let at = run.at as usize + lane;
        let (rows, n, unit) = (&tables.rows, self.strides[slot], tables.info.metres_per_unit);
        let row = |at: usize| f32::from(rows[at]);
        let weighed = |w: &[f32; 4], at: usize| -> f32 {
            (w[0] * row(at) + w[1] * row(at + n) + w[2] * row(at + 2 * n) + w[3] * row(at + 3 * n)) * unit
        };
        let both = |weights| Vec2::new(weighed(weights, at), weighed(weights, at + usize::from(run.lanes)));
        (both(&moment.place), both(&moment.velocity))
    }

    /// Four rows of what is present in a slot of a kind, eight lanes at a time: their x, and their z.
    #[inline(always)]
    fn knots<'a>(
        &self,
        tables: &'a Tables,
        slot: usize,
        run: &Run,
    ) -> ([&'a [[i16; WIDTH]]; 4], [&'a [[i16; WIDTH]]; 4]) {
        let read = usize::from(run.live).next_multiple_of(WIDTH);
        let (n, at) = (self.strides[slot], run.at as usize);
        let eights = |at: usize| tables.rows[at..at + read].as_chunks::<WIDTH>().0;
        let four = |at: usize| [eights(at), eights(at + n), eights(at + 2 * n), eights(at + 3 * n)];
        (four(at), four(at + usize::from(run.lanes)))
    }

    /// Where the control points of a lane are in a slot that it is present in: its x in the first of four rows, how far behind its z
    /// is, and from row to row.
    pub fn find(&self, tables: &Tables, kind: usize, slot: usize, lane: Lane) -> Option<[usize; 3]> {
        let (page, step) = (slot / tables.info.page as usize, slot % tables.info.page as usize);
        let index = page * tables.kinds() + kind;
        let first = if index == 0 { 0 } else { tables.lane_ends[index - 1] as usize };
        let lanes = &tables.lanes[first..tables.lane_ends[index] as usize];
        let number = lanes.iter().position(|&other| other == lane.0)?;
        let Page { begin, row, lane: base } = self.pages[page];
        Some([begin + step * row + 2 * (first - base) + number, lanes.len(), row])
    }

    pub fn bytes(&self) -> usize {
        8 * (self.runs.len() + self.strides.len() + self.turns.len()) + 24 * self.pages.len() + 4 * self.people.len()
    }
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

/// Samples the walkers of `spots`.
pub(super) fn sample(
    world: &World,
    moment: &Moment,
    spots: impl Iterator<Item = Spot>,
    origin: DVec2,
    out: &mut Roots,
) {
    out.grow(world.walkers(moment) + WIDTH);
    out.len = 0;
    pulp::Arch::new().dispatch(Sampling { world, moment, spots, origin, out });
}

/// Samples the walkers of all patches.
pub(super) fn sample_all(world: &World, moment: &Moment, origin: DVec2, out: &mut Roots) {
    if !world.rows.shared {
        let all = 0..world.instances() as u32;
        return sample(world, moment, all.map(|instance| Spot { instance, shift: DVec2::ZERO }), origin, out);
    }
    out.grow(world.walkers(moment) + WIDTH);
    out.len = 0;
    pulp::Arch::new().dispatch(SamplingKinds { world, moment, origin, out });
}

/// Weighs what is present of every kind, then turns and moves it for every patch.
struct SamplingKinds<'a> {
    world: &'a World,
    moment: &'a Moment,
    origin: DVec2,
    out: &'a mut Roots,
}

impl pulp::NullaryFnOnce for SamplingKinds<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { world, moment, origin, out } = self;
        let (tables, kinds) = (&world.tables, world.kinds());
        let (place, velocity) = (moment.place, moment.velocity);
        let slot = moment.slot as usize;
        let runs = &world.rows.runs[slot * kinds..(slot + 1) * kinds];
        let whole = runs.iter().map(|run| usize::from(run.live).next_multiple_of(WIDTH)).sum();
        out.weighed.iter_mut().for_each(|list| list.resize(whole, 0.0));
        out.parts.clear();
        let mut begin = 0;
        for run in runs {
            let read = usize::from(run.live).next_multiple_of(WIDTH);
            let (x, z) = world.rows.knots(tables, slot, run);
            let [px, pz, vx, vz] = &mut out.weighed;
            let into = [px, pz, vx, vz].map(|list| list[begin..begin + read].as_chunks_mut::<WIDTH>().0);
            weigh_all(x, z, [&place, &velocity], into);
            out.parts.push([begin as u32, u32::from(run.live)]);
            begin += read;
        }
        for (instance, &kind) in tables.instance_kinds.iter().enumerate() {
            let [begin, live] = out.parts[kind as usize].map(|number| number as usize);
            let (first, read) = (out.len, live.next_multiple_of(WIDTH));
            out.len += live;
            let [sin, cos] = world.rows.turns[instance];
            let place = (tables.place(instance) - origin).as_vec2();
            let [px, pz, vx, vz] = &out.weighed;
            let from = [px, pz, vx, vz].map(|list| list[begin..begin + read].as_chunks::<WIDTH>().0);
            let [ox, oz, ovx, ovz] = &mut out.arrays;
            let into = [ox, oz, ovx, ovz].map(|array| array[first..first + read].as_chunks_mut::<WIDTH>().0);
            turn_all(from, (sin, cos, place.x, place.y), into);
        }
    }
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
        // Copies, so that nothing written can be taken for them.
        let (place, velocity) = (moment.place, moment.velocity);
        for spot in spots {
            let slot = moment.slot + world.tables.instance_phases[spot.instance as usize];
            let slot = if slot < slots { slot } else { slot - slots };
            sample_patch(world, slot as usize, [&place, &velocity], spot, origin, out);
        }
    }
}

type Eight = [f32; WIDTH];

#[inline(always)]
fn sample_patch(world: &World, slot: usize, weights: [&[f32; 4]; 2], spot: Spot, origin: DVec2, out: &mut Roots) {
    let (tables, instance) = (&world.tables, spot.instance as usize);
    let run = world.rows.runs[slot * tables.kinds() + tables.instance_kinds[instance] as usize];
    let (live, first) = (usize::from(run.live), out.len);
    let read = live.next_multiple_of(WIDTH);
    if out.arrays[0].len() < first + read {
        // The same patch more than once, where a world repeats.
        out.grow((first + read) * 2);
    }
    out.len += live;
    let [sin, cos] = world.rows.turns[instance];
    let place = (tables.place(instance) + spot.shift - origin).as_vec2();
    let (x, z) = world.rows.knots(tables, slot, &run);
    let [ox, oz, ovx, ovz] = &mut out.arrays;
    let out = [ox, oz, ovx, ovz].map(|array| array[first..first + read].as_chunks_mut::<WIDTH>().0);
    transform(x, z, weights, (sin, cos, place.x, place.y), out);
}

/// Weighs the control points of blocks of eight lanes, turns and moves them: places, then velocities.
#[inline(always)]
fn transform(
    x: [&[[i16; WIDTH]]; 4],
    z: [&[[i16; WIDTH]]; 4],
    [place, velocity]: [&[f32; 4]; 2],
    (sin, cos, right, up): (f32, f32, f32, f32),
    [ox, oz, ovx, ovz]: [&mut [Eight]; 4],
) {
    let n = ox.len();
    let ([x0, x1, x2, x3], [z0, z1, z2, z3]) = (x.map(|s| &s[..n]), z.map(|s| &s[..n]));
    let (oz, ovx, ovz) = (&mut oz[..n], &mut ovx[..n], &mut ovz[..n]);
    for b in 0..n {
        let x = [lift(x0[b]), lift(x1[b]), lift(x2[b]), lift(x3[b])];
        let z = [lift(z0[b]), lift(z1[b]), lift(z2[b]), lift(z3[b])];
        let (px, pz) = (weigh(&x, place), weigh(&z, place));
        let (vx, vz) = (weigh(&x, velocity), weigh(&z, velocity));
        ox[b] = std::array::from_fn(|i| cos * px[i] - sin * pz[i] + right);
        oz[b] = std::array::from_fn(|i| sin * px[i] + cos * pz[i] + up);
        ovx[b] = std::array::from_fn(|i| cos * vx[i] - sin * vz[i]);
        ovz[b] = std::array::from_fn(|i| sin * vx[i] + cos * vz[i]);
    }
}

/// Weighs the control points of blocks of eight lanes: places, then velocities.
#[inline(always)]
fn weigh_all(
    x: [&[[i16; WIDTH]]; 4],
    z: [&[[i16; WIDTH]]; 4],
    [place, velocity]: [&[f32; 4]; 2],
    [ox, oz, ovx, ovz]: [&mut [Eight]; 4],
) {
    for b in 0..ox.len() {
        let x = [lift(x[0][b]), lift(x[1][b]), lift(x[2][b]), lift(x[3][b])];
        let z = [lift(z[0][b]), lift(z[1][b]), lift(z[2][b]), lift(z[3][b])];
        (ox[b], oz[b]) = (weigh(&x, place), weigh(&z, place));
        (ovx[b], ovz[b]) = (weigh(&x, velocity), weigh(&z, velocity));
    }
}

/// Turns and moves blocks of eight lanes that have been weighed. The same sums as in [`transform`].
#[inline(always)]
fn turn_all(
    [px, pz, vx, vz]: [&[Eight]; 4],
    (sin, cos, right, up): (f32, f32, f32, f32),
    [ox, oz, ovx, ovz]: [&mut [Eight]; 4],
) {
    let n = ox.len();
    let (px, pz, vx, vz) = (&px[..n], &pz[..n], &vx[..n], &vz[..n]);
    let (oz, ovx, ovz) = (&mut oz[..n], &mut ovx[..n], &mut ovz[..n]);
    for b in 0..n {
        let (px, pz, vx, vz) = (px[b], pz[b], vx[b], vz[b]);
        ox[b] = std::array::from_fn(|i| cos * px[i] - sin * pz[i] + right);
        oz[b] = std::array::from_fn(|i| sin * px[i] + cos * pz[i] + up);
        ovx[b] = std::array::from_fn(|i| cos * vx[i] - sin * vz[i]);
        ovz[b] = std::array::from_fn(|i| sin * vx[i] + cos * vz[i]);
    }
}

#[inline(always)]
fn lift(numbers: [i16; WIDTH]) -> Eight {
    numbers.map(f32::from)
}

#[inline(always)]
fn weigh(rows: &[Eight; 4], w: &[f32; 4]) -> Eight {
    std::array::from_fn(|i| rows[0][i] * w[0] + rows[1][i] * w[1] + rows[2][i] * w[2] + rows[3][i] * w[3])
}
