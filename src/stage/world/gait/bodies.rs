//! Where the bodies of walkers are, and their feet: eight people at a time.
//!
//! What a body needs of its way are five instants: now, and for either foot the middles of its stances before and after. These
//! are looked up one by one; all that follows from them is computed for eight people side by side.

use glam::Vec2;

use super::eights::{Eight, Eights, WIDTH};
use super::feet::{Foot, Steps, since};
use super::walks::{HEADING, Knot, ORDER, RADIANS, Stay};
use super::{Gait, Walking};
use crate::geom::sin_cos;
use crate::stage::world::moment::weights;
use crate::stage::world::{Spot, World};

impl World {
    /// Bodies of all who walk in a patch at `time` (seconds, any), in the order of [`World::roots`]; none if the world has no gait.
    /// Places are relative to the patch's own origin, turned as the patch is. O(1) for each.
    pub fn bodies(&self, spot: Spot, time: f64) -> Vec<Walking> {
        let mut bodies = Vec::new();
        self.bodies_of(std::iter::once(spot), time, &mut bodies);
        bodies
    }

    /// The same for several patches, one after the other, appended to `bodies`. Allocates only where these have never been as many.
    pub fn bodies_of(&self, spots: impl Iterator<Item = Spot>, time: f64, bodies: &mut Vec<Walking>) {
        if let Some(gait) = &self.tables.gait {
            pulp::Arch::new().dispatch(Walks { world: self, gait, spots, time, bodies });
        }
    }
}

/// Bodies of all who walk in some patches, in the widest instructions there are.
struct Walks<'a, S> {
    world: &'a World,
    gait: &'a Gait,
    spots: S,
    time: f64,
    bodies: &'a mut Vec<Walking>,
}

impl<S: Iterator<Item = Spot>> pulp::NullaryFnOnce for Walks<'_, S> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { world, gait, spots, time, bodies } = self;
        let (info, moment) = (world.info(), world.moment(time));
        let at = time / f64::from(info.period_secs) * f64::from(info.slots);
        let share = (at - at.floor()) as f32;
        let mut block = Block::default();
        for spot in spots {
            let instance = spot.instance as usize;
            let own = moment.later(world.tables.instance_phases[instance], info.slots);
            for lane in world.rows.lanes(&world.tables, world.kind_of(instance), own.slot) {
                let stay = world.ways.stay(world, gait, instance, lane.walker());
                let slot = own.slot as i32 + lane.lap() as i32 * info.slots as i32 - stay.enter;
                block.add(world, gait, &stay, (slot, share));
                if block.people == WIDTH {
                    block.empty_into(world, gait, bodies);
                }
            }
        }
        block.empty_into(world, gait, bodies);
    }
}

/// Up to eight people.
#[derive(Default)]
struct Block {
    people: usize,
    phase: Eight,
    now: Instants,
    states: States,
    /// Of the left and of the right foot.
    steps: [Steps; 2],
}

impl Block {
    /// Adds somebody who is in a slot of a stay.
    #[inline(always)]
    fn add<'a>(&mut self, world: &'a World, gait: &Gait, stay: &Stay<'a>, at: (i32, f32)) {
        let i = self.people % WIDTH;
        self.people = i + 1;
        self.now.put(i, stay, at);
        let phase = stay.phase(at);
        self.phase[i] = phase;
        if gait.table.prints.is_empty() {
            return;
        }
        for foot in 0..2 {
            let (since, Steps { before, after, .. }) = (since(phase, foot), &mut self.steps[foot]);
            world.later(gait, stay, at, -since, |stay, at| before.put(i, stay, at));
            world.later(gait, stay, at, 1.0 - since, |stay, at| after.put(i, stay, at));
        }
    }

    /// Appends the bodies of all who have been added.
    #[inline(always)]
    fn empty_into(&mut self, world: &World, gait: &Gait, bodies: &mut Vec<Walking>) {
        let Self { people, phase, now, states, steps } = self;
        now.find(world.ways.rate, states);
        let led = !gait.table.prints.is_empty();
        for (foot, steps) in steps.iter_mut().enumerate().filter(|_| led) {
            steps.find(world, &gait.table, foot, phase, states);
        }
        for (i, &phase) in phase.iter().enumerate().take(*people) {
            let (place, velocity) = (states.place.at(i), states.velocity.at(i));
            let feet: Option<[Foot; 2]> = if led { Some([steps[0].at(i), steps[1].at(i)]) } else { None };
            bodies.push(Walking { place, velocity, heading: states.heading[i], phase, feet });
        }
        *people = 0;
    }
}

/// Instants of stays of eight people.
#[derive(Default)]
pub(super) struct Instants {
    /// The slots' knots, and how far in its slot each is.
    knots: [[Knot; WIDTH]; ORDER],
    share: Eight,
    /// How their patches are turned (sine and cosine times the metres of a unit, and the angle), and the patches' origins.
    turns: Eights<3>,
    origin: Eights<2>,
}

/// How eight people are at an instant.
#[derive(Default)]
pub(super) struct States {
    /// Metres.
    pub place: Eights<2>,
    /// m/s.
    pub velocity: Eights<2>,
    pub speed: Eight,
    /// Radians.
    pub heading: Eight,
    /// Where they look, as x and z.
    pub ahead: Eights<2>,
}

impl Instants {
    /// Puts somebody in at place `i`: a slot of a stay, and the share of it that is gone.
    #[inline(always)]
    pub fn put(&mut self, i: usize, stay: &Stay, (slot, share): (i32, f32)) {
        let knots = &stay.knots[slot as usize..][..ORDER];
        (self.knots[0][i], self.knots[1][i]) = (knots[0], knots[1]);
        (self.knots[2][i], self.knots[3][i]) = (knots[2], knots[3]);
        self.share[i] = share;
        self.turns.put(i, stay.turns);
        self.origin.put(i, stay.origin);
    }

    /// How all of them are; straight on, before and after their slots. `rate` is slots per second.
    #[inline(always)]
    pub fn find(&self, rate: f32, states: &mut States) {
        for i in 0..WIDTH {
            let share = self.share[i];
            let inside = share.clamp(0.0, 1.0);
            let (place, velocity) = weights(inside);
            let velocity = self.weigh(i, &velocity);
            let place = self.weigh(i, &place) + velocity * (share - inside) + self.origin.at(i);
            let (from, to) = (self.knots[0][i][HEADING], self.knots[1][i][HEADING]);
            let heading = f32::from(from) + f32::from(to.wrapping_sub(from)) * inside;
            let heading = heading * RADIANS - self.turns.0[2][i];
            let (sin, cos) = sin_cos(heading);
            let velocity = velocity * rate;
            states.place.put(i, place);
            states.velocity.put(i, velocity);
            states.speed[i] = (velocity.x * velocity.x + velocity.y * velocity.y).sqrt();
            states.heading[i] = heading;
            states.ahead.put(i, Vec2::new(sin, cos));
        }
    }

    /// A weighted sum of somebody's control points, as the patch is turned, metres.
    #[inline(always)]
    fn weigh(&self, i: usize, w: &[f32; ORDER]) -> Vec2 {
        let (a, b, c, d) = (self.knots[0][i], self.knots[1][i], self.knots[2][i], self.knots[3][i]);
        let x = f32::from(a[0]) * w[0] + f32::from(b[0]) * w[1] + f32::from(c[0]) * w[2] + f32::from(d[0]) * w[3];
        let z = f32::from(a[1]) * w[0] + f32::from(b[1]) * w[1] + f32::from(c[1]) * w[2] + f32::from(d[1]) * w[3];
        let (sin, cos) = (self.turns.0[0][i], self.turns.0[1][i]);
        Vec2::new(cos * x - sin * z, sin * x + cos * z)
    }
}
