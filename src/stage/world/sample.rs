//! Where everybody is at an instant: the kernel that samples control points.
//!
//! Lanes are sampled eight at a time; what is computed beyond a run's end is overwritten by the next. Without `unsafe`: slices of
//! fixed length carry the compiler to vector instructions, `pulp` to the widest the machine has. (Products and sums are never fused,
//! so that all machines give the same bits.)

use std::ops::Range;

use glam::DVec2;

use super::place::Spot;
use super::rows::{ByKind, Knots, WIDTH};
use super::tables::in_metres;
use super::{Moment, World};

type Eight = [f32; WIDTH];

/// Places and velocities, one array for each coordinate. Reused from frame to frame.
#[derive(Clone, Debug, Default)]
pub struct Roots {
    arrays: [Vec<f32>; 4],
    len: usize,
    /// Lanes of a kind, weighed, for worlds whose kinds are shared: places and velocities in units of the kind's frame.
    weighed: Vec<[Eight; 4]>,
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
    let Some(shared) = &world.rows.shared else {
        let all = 0..world.instances() as u32;
        return sample(world, moment, all.map(|instance| Spot { instance, shift: DVec2::ZERO }), origin, out);
    };
    out.grow(world.walkers(moment) + WIDTH);
    out.len = 0;
    pulp::Arch::new().dispatch(SamplingKinds { world, shared, moment, origin, out });
}

/// Weighs what is present of every kind, then turns and moves it for every patch of the kind.
struct SamplingKinds<'a> {
    world: &'a World,
    shared: &'a ByKind,
    moment: &'a Moment,
    origin: DVec2,
    out: &'a mut Roots,
}

impl pulp::NullaryFnOnce for SamplingKinds<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { world, shared, moment, origin, out } = self;
        let (tables, kinds) = (&world.tables, world.kinds());
        let (place, velocity) = (moment.place, moment.velocity);
        let slot = moment.slot as usize;
        let runs = &world.rows.runs[slot * kinds..(slot + 1) * kinds];
        for (kind, run) in runs.iter().enumerate() {
            let live = usize::from(run.live);
            let blocks = live.div_ceil(WIDTH);
            let (x, z) = world.rows.knots(tables, slot, run);
            let weighed = &mut out.weighed;
            weighed.resize(blocks, [[0.0; WIDTH]; 4]);
            weigh_all(x, z, [&place, &velocity], weighed);
            for &([sin, cos], place) in shared.of(kind) {
                let (first, read) = (out.len, blocks * WIDTH);
                out.len += live;
                let place = (in_metres(place) - origin).as_vec2();
                let into = eights(&mut out.arrays, first..first + read);
                turn_all(&out.weighed, (sin, cos, place.x, place.y), into);
            }
        }
    }
}

/// Samples patch by patch.
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
    let out = eights(&mut out.arrays, first..first + read);
    transform(x, z, weights, (sin, cos, place.x, place.y), out);
}

/// A part of all arrays, eight numbers at a time.
#[inline(always)]
fn eights([x, z, vx, vz]: &mut [Vec<f32>; 4], part: Range<usize>) -> [&mut [Eight]; 4] {
    let (x, z) = (x[part.clone()].as_chunks_mut().0, z[part.clone()].as_chunks_mut().0);
    [x, z, vx[part.clone()].as_chunks_mut().0, vz[part].as_chunks_mut().0]
}

// Loops, not closures: these would not always be inlined into what is compiled for wide instructions.

/// Weighs the control points of blocks of eight lanes, turns and moves them: places, then velocities.
#[inline(always)]
fn transform(
    x: Knots,
    z: Knots,
    [place, velocity]: [&[f32; 4]; 2],
    by: (f32, f32, f32, f32),
    [ox, oz, ovx, ovz]: [&mut [Eight]; 4],
) {
    let n = ox.len();
    let ([x0, x1, x2, x3], [z0, z1, z2, z3]) = (x, z);
    let ((x0, x1, x2, x3), (z0, z1, z2, z3)) =
        ((&x0[..n], &x1[..n], &x2[..n], &x3[..n]), (&z0[..n], &z1[..n], &z2[..n], &z3[..n]));
    let (oz, ovx, ovz) = (&mut oz[..n], &mut ovx[..n], &mut ovz[..n]);
    for b in 0..n {
        let x = [lift(&x0[b]), lift(&x1[b]), lift(&x2[b]), lift(&x3[b])];
        let z = [lift(&z0[b]), lift(&z1[b]), lift(&z2[b]), lift(&z3[b])];
        let weighed = [weigh(&x, place), weigh(&z, place), weigh(&x, velocity), weigh(&z, velocity)];
        [ox[b], oz[b], ovx[b], ovz[b]] = turn(&weighed, by);
    }
}

/// Weighs the control points of blocks of eight lanes: places, then velocities.
#[inline(always)]
fn weigh_all(x: Knots, z: Knots, [place, velocity]: [&[f32; 4]; 2], out: &mut [[Eight; 4]]) {
    for (b, out) in out.iter_mut().enumerate() {
        let x = [lift(&x[0][b]), lift(&x[1][b]), lift(&x[2][b]), lift(&x[3][b])];
        let z = [lift(&z[0][b]), lift(&z[1][b]), lift(&z[2][b]), lift(&z[3][b])];
        *out = [weigh(&x, place), weigh(&z, place), weigh(&x, velocity), weigh(&z, velocity)];
    }
}

/// Turns and moves blocks of eight lanes that have been weighed.
#[inline(always)]
fn turn_all(weighed: &[[Eight; 4]], by: (f32, f32, f32, f32), [ox, oz, ovx, ovz]: [&mut [Eight]; 4]) {
    let n = weighed.len();
    let (ox, oz, ovx, ovz) = (&mut ox[..n], &mut oz[..n], &mut ovx[..n], &mut ovz[..n]);
    for b in 0..n {
        [ox[b], oz[b], ovx[b], ovz[b]] = turn(&weighed[b], by);
    }
}

/// Turns eight lanes by a sine and cosine, and moves them to the right and up.
#[inline(always)]
fn turn([px, pz, vx, vz]: &[Eight; 4], (sin, cos, right, up): (f32, f32, f32, f32)) -> [Eight; 4] {
    let mut turned = [[0.0; WIDTH]; 4];
    for i in 0..WIDTH {
        turned[0][i] = cos * px[i] - sin * pz[i] + right;
        turned[1][i] = sin * px[i] + cos * pz[i] + up;
        turned[2][i] = cos * vx[i] - sin * vz[i];
        turned[3][i] = sin * vx[i] + cos * vz[i];
    }
    turned
}

#[inline(always)]
fn lift(numbers: &[i16; WIDTH]) -> Eight {
    let mut lifted = [0.0; WIDTH];
    for i in 0..WIDTH {
        lifted[i] = numbers[i].into();
    }
    lifted
}

#[inline(always)]
fn weigh(rows: &[Eight; 4], w: &[f32; 4]) -> Eight {
    let mut sum = [0.0; WIDTH];
    for i in 0..WIDTH {
        sum[i] = rows[0][i] * w[0] + rows[1][i] * w[1] + rows[2][i] * w[2] + rows[3][i] * w[3];
    }
    sum
}
