//! Who steps where: of a few pushes, everybody takes the one that leads best past the spectator, the others, and things.

use std::collections::BTreeMap;

use glam::DVec2;

use super::ground::{Grounds, way};
use super::{Aside, Stay, TICK};
use crate::stage::World;

/// Greatest push, m/s2.
pub(super) const PUSH: f64 = 1.6;
/// Seconds that a push is thought to last.
const LASTS: f64 = 0.5;
/// Seconds ahead that count.
const AHEAD: [f64; 8] = [TICK, 0.3, 0.5, 0.8, 1.1, 1.5, 2.0, 2.5];
/// Room that people like to leave, metres.
const MARGIN: f64 = 0.15;
/// How much somebody minds touching, against a metre off its way.
const TOUCH: f64 = 60.0;
/// Directions of pushes.
const DIRECTIONS: usize = 12;
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

/// Chooses everybody's push for the tick that begins at `secs`.
pub(super) fn decide(world: &World, grounds: &mut Grounds, secs: f64, body: &Body, people: &mut BTreeMap<Stay, Aside>) {
    let walkers: Vec<Walker> =
        people.iter().map(|(&stay, &aside)| Walker::new(world, grounds, stay, aside, secs)).collect();
    let radius = f64::from(world.info().limits.radius);
    let meant: Vec<DVec2> = (0..walkers.len())
        .map(|me| {
            let cost =
                |grounds: &mut Grounds, push: DVec2| cost(world, grounds, secs, body, &walkers, me, push, radius);
            let pushes = pushes(&walkers[me].aside);
            let costs: Vec<f64> = pushes.iter().map(|&push| cost(grounds, push)).collect();
            let best = (0..pushes.len()).min_by(|&a, &b| costs[a].total_cmp(&costs[b])).unwrap_or(0);
            pushes[best]
        })
        .collect();
    people.values_mut().zip(meant).for_each(|(aside, push)| aside.push = push);
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

/// What a push would come to.
#[allow(clippy::too_many_arguments)]
fn cost(
    world: &World,
    grounds: &mut Grounds,
    secs: f64,
    body: &Body,
    walkers: &[Walker],
    me: usize,
    push: DVec2,
    radius: f64,
) -> f64 {
    let own = &walkers[me];
    let end = Aside { push, ..own.aside }.after(LASTS);
    let far = (end.offset.length() - FARTHEST).max(0.0);
    let mut sum =
        0.6 * end.offset.length_squared() + 0.35 * end.velocity.length_squared() + 0.04 * push.length_squared();
    sum += TOUCH * far * far;
    for (i, &ahead) in AHEAD.iter().enumerate() {
        let place = own.place(world, grounds, secs, i, push);
        // What is far ahead may change.
        let weight = 1.0 / (1.0 + ahead);
        let spectator = place.distance(body.place + body.velocity * ahead) - body.radius - radius;
        sum += weight * mind(spectator, 2.0 * MARGIN);
        for (_, other) in walkers.iter().enumerate().filter(|&(j, _)| j != me) {
            let before = own.ways[i].distance(other.ways[i]);
            if before < 4.0 {
                sum += weight
                    * mind(
                        place.distance(other.places[i]) - 2.0 * radius,
                        MARGIN.min((before - 2.0 * radius).max(0.0)),
                    );
            }
        }
        let free = 2.0 * MARGIN;
        sum += weight * mind(grounds.room(world, own.stay, own.ways[i], place, radius, free), MARGIN / 3.0);
    }
    sum
}

/// How much somebody minds a gap, if it likes a margin.
fn mind(gap: f64, margin: f64) -> f64 {
    let near = (margin - gap).max(0.0) / MARGIN;
    let touch = if gap < 0.02 { 4.0 * (0.02 - gap) / MARGIN + 1.0 } else { 0.0 };
    near * near + TOUCH * touch
}
