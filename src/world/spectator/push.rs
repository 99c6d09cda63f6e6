//! Who steps where: of a few pushes, everybody takes the one that leads best past the spectator, the others, and things.

use std::collections::BTreeMap;

use glam::DVec2;

use super::ground::{Grounds, way};
use super::{Aside, SIGHT, Stay, TICK};
use crate::stage::World;

/// Greatest push, m/s2.
pub(super) const PUSH: f64 = 1.6;
/// Seconds that a push is thought to last.
const LASTS: f64 = 0.5;
/// Seconds ahead that count.
const AHEAD: [f64; 11] = [TICK, 0.2, 0.3, 0.4, 0.55, 0.7, 0.9, 1.2, 1.6, 2.0, 2.5];
/// Room that people like to leave, metres.
const MARGIN: f64 = 0.15;
/// Nobody plans to come closer, metres: others step aside as well.
const CLEAR: f64 = 0.09;
/// How much somebody minds touching, against a metre off its way.
const TOUCH: f64 = 60.0;
/// Directions of pushes.
const DIRECTIONS: usize = 12;
/// Nobody further away than this, metres, is met within the time that counts.
const NEAR: f64 = 8.0;
/// Offsets are no larger, metres.
const FARTHEST: f64 = 1.6;

/// The spectator.
pub(super) struct Body {
    pub place: DVec2,
    pub velocity: DVec2,
    pub radius: f64,
}

/// Somebody in sight: where its way leads, and where it will be as things are.
struct Walker {
    stay: Stay,
    aside: Aside,
    ways: [DVec2; AHEAD.len()],
    places: [DVec2; AHEAD.len()],
}

/// All that counts for a choice.
struct Sight<'a> {
    world: &'a World,
    secs: f64,
    body: &'a Body,
    walkers: Vec<Walker>,
    /// Of everybody's body.
    radius: f64,
}

/// Chooses everybody's push for the tick that begins at `secs`.
pub(super) fn decide(world: &World, grounds: &mut Grounds, secs: f64, body: &Body, people: &mut BTreeMap<Stay, Aside>) {
    let walkers = people.iter().map(|(&stay, &aside)| Walker::new(world, grounds, stay, aside, secs)).collect();
    let radius = f64::from(world.info().limits.radius);
    let mut sight = Sight { world, secs, body, walkers, radius };
    // Who is nearest has the least choice and goes first; the others know what it does.
    let mut order: Vec<usize> = (0..sight.walkers.len()).collect();
    let far = |me: usize| sight.walkers[me].ways[0].distance_squared(body.place);
    order.sort_by(|&a, &b| far(a).total_cmp(&far(b)).then(a.cmp(&b)));
    for me in order {
        let push = sight.choose(grounds, me);
        let own = &sight.walkers[me];
        let places = std::array::from_fn(|i| own.place(world, grounds, secs, i, push));
        (sight.walkers[me].places, sight.walkers[me].aside.push) = (places, push);
    }
    people.values_mut().zip(sight.walkers).for_each(|(aside, walker)| aside.push = walker.aside.push);
}

impl Walker {
    fn new(world: &World, grounds: &mut Grounds, stay: Stay, aside: Aside, secs: f64) -> Self {
        let aside = Aside { push: DVec2::ZERO, ..aside };
        let (mut last, mut velocity, mut at) =
            way(world, stay, secs).map_or_else(Default::default, |(p, v)| (p, v, secs));
        let ways = AHEAD.map(|ahead| {
            // Beyond the border it goes straight on.
            let found = way(world, stay, secs + ahead);
            let (p, v) = found.unwrap_or_else(|| (last + velocity * (secs + ahead - at), velocity));
            (last, velocity, at) = (p, v, secs + ahead);
            p
        });
        let mut walker = Self { stay, aside, ways, places: ways };
        walker.places = std::array::from_fn(|i| walker.place(world, grounds, secs, i, DVec2::ZERO));
        walker
    }

    /// Where it will be if it is pushed.
    fn place(&self, world: &World, grounds: &mut Grounds, secs: f64, index: usize, push: DVec2) -> DVec2 {
        let ahead = AHEAD[index];
        let pushed = Aside { push, ..self.aside }.after(ahead.min(LASTS));
        let then = Aside { push: DVec2::ZERO, ..pushed }.after((ahead - LASTS).max(0.0));
        self.ways[index] + grounds.faded(world, self.stay, secs + ahead, then).0
    }
}

/// What somebody may do: nothing, go back to its way, or step to any side.
fn pushes(aside: &Aside) -> Vec<DVec2> {
    let back = |stiff: f64| (-stiff * stiff * aside.offset - 2.0 * stiff * aside.velocity).clamp_length_max(PUSH);
    let mut all = vec![DVec2::ZERO, back(1.0), back(2.0), (-aside.velocity / LASTS).clamp_length_max(PUSH)];
    for i in 0..DIRECTIONS {
        let direction = DVec2::from_angle(i as f64 / DIRECTIONS as f64 * std::f64::consts::TAU);
        all.extend([0.4, 1.0].map(|share| direction * (share * PUSH)));
    }
    all
}

impl Sight<'_> {
    /// Somebody's best push.
    fn choose(&self, grounds: &mut Grounds, me: usize) -> DVec2 {
        let own = &self.walkers[me];
        if own.aside == Aside::default() && own.ways[0].distance(self.body.place) > SIGHT {
            return DVec2::ZERO;
        }
        let near = |other: &&Walker| own.ways[0].distance(other.ways[0]) < NEAR && own.stay != other.stay;
        let others: Vec<&Walker> = self.walkers.iter().filter(near).collect();
        let costs = pushes(&own.aside).into_iter().map(|push| (self.cost(grounds, own, &others, push), push));
        costs.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(DVec2::ZERO, |(_, push)| push)
    }

    /// What a push would come to.
    fn cost(&self, grounds: &mut Grounds, own: &Walker, others: &[&Walker], push: DVec2) -> f64 {
        let end = Aside { push, ..own.aside }.after(LASTS);
        let far = (end.offset.length() - FARTHEST).max(0.0);
        let effort = 0.6 * end.offset.length_squared()
            + 0.35 * end.velocity.length_squared()
            + 0.04 * push.length_squared()
            + TOUCH * far * far;
        // What is far ahead may change.
        let weighed =
            AHEAD.iter().enumerate().map(|(i, ahead)| self.closeness(grounds, own, others, (i, push)) / (1.0 + ahead));
        effort + weighed.sum::<f64>()
    }

    /// How much is too close some seconds ahead.
    fn closeness(&self, grounds: &mut Grounds, own: &Walker, others: &[&Walker], (index, push): (usize, DVec2)) -> f64 {
        let ahead = AHEAD[index];
        let place = own.place(self.world, grounds, self.secs, index, push);
        let spectator = place.distance(self.body.place + self.body.velocity * ahead) - self.body.radius - self.radius;
        let others = others.iter().map(|other| {
            let before = own.ways[index].distance(other.ways[index]);
            // Ways may lead closer than people like, but never into each other.
            let room = (before - 2.0 * self.radius).max(0.0);
            let gap = place.distance(other.places[index]) - 2.0 * self.radius;
            if before < 4.0 { mind(gap, MARGIN.min(room), CLEAR.min(room)) } else { 0.0 }
        });
        let free = grounds.room(self.world, own.stay, own.ways[index], place, self.radius, 2.0 * MARGIN);
        mind(spectator, 2.0 * MARGIN, CLEAR) + others.sum::<f64>() + mind(free, MARGIN / 3.0, 0.02)
    }
}

/// How much somebody minds a gap, if it likes a margin and needs to keep clear.
fn mind(gap: f64, margin: f64, clear: f64) -> f64 {
    let near = (margin - gap).max(0.0) / MARGIN;
    let touch = if gap < clear { 4.0 * (clear - gap) / MARGIN + 1.0 } else { 0.0 };
    near * near + TOUCH * touch
}
