//! A spectator who is walked around.
//!
//! Beyond "Crowd Patches" (2009), whose walkers walk through whoever looks at them. People near a spectator step aside: each has an
//! offset from its way, which begins and ends at zero at the borders of its patch, so that patches, periods and identities
//! know nothing of it. Offsets are the integral of bounded pushes on a clock of ticks, chosen with what is known about the future:
//! everybody's way. So they are a function of the world and of the spectator's track since it came, and of nothing else: the same
//! for any rate of frames that tell the same track. Nobody is remembered beyond
//! its stay in a patch.

mod ground;
mod push;

use std::collections::BTreeMap;

use glam::DVec2;

use super::Person;
use crate::stage::World;
use crate::stage::world::Spot;
use crate::{Error, Result};
use ground::Grounds;

/// Seconds of a tick.
const TICK: f64 = 0.1;
/// People step aside who are no further away, metres.
const SIGHT: f64 = 6.0;
/// They mind everybody who is so much further away, metres: who leaves sight needs some steps to get back to its way.
const BEYOND: f64 = 8.0;
/// Seconds in which offsets fade before and after a border.
const FADE: f64 = 1.6;
/// A track with a gap of more seconds begins anew.
const GAP: f64 = 5.0;

/// Somebody's stay in a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Stay {
    instance: u32,
    copy: [i64; 2],
    walker: usize,
    /// The period it came in.
    lap: i64,
}

/// How far somebody is from its way, if no border is near.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Aside {
    offset: DVec2,
    velocity: DVec2,
    /// Acceleration until the next tick.
    push: DVec2,
}

impl Aside {
    /// Some seconds later.
    fn after(self, secs: f64) -> Self {
        let offset = self.offset + self.velocity * secs + self.push * (0.5 * secs * secs);
        Self { offset, velocity: self.velocity + self.push * secs, push: self.push }
    }
}

/// Somebody as the spectator sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Who.
    pub person: Person,
    /// Where it is, metres.
    pub place: DVec2,
    /// Its velocity, m/s.
    pub velocity: DVec2,
    /// How far it has stepped aside, metres.
    pub aside: DVec2,
}

/// A spectator in a baked world.
#[derive(Clone, Debug)]
pub struct Spectator {
    radius: f64,
    /// Last sample of the track.
    last: Option<(f64, DVec2)>,
    /// Ticks done since time 0.
    tick: i64,
    /// Where the spectator was then, and how fast it went.
    place: DVec2,
    velocity: DVec2,
    people: BTreeMap<Stay, Aside>,
    grounds: Grounds,
}

impl Spectator {
    /// A spectator with a body of a radius in metres, who is not there yet.
    pub fn new(radius: f64) -> Self {
        Self {
            radius: if radius.is_finite() { radius.clamp(0.0, 2.0) } else { 0.25 },
            last: None,
            tick: 0,
            place: DVec2::ZERO,
            velocity: DVec2::ZERO,
            people: BTreeMap::new(),
            grounds: Grounds::default(),
        }
    }

    /// The spectator is at `place` at `secs`: later than told before, or the track begins anew.
    ///
    /// # Errors
    /// If time or place are no numbers, or out of range.
    pub fn look(&mut self, world: &World, secs: f64, place: DVec2) -> Result<()> {
        if !(place.is_finite() && secs.abs() < 1e9) {
            let problem = format!("expected a time and a place, found {secs} s and {place}");
            return Err(Error::invalid("spectator", "track", problem));
        }
        let Some((from, before)) = self.last.filter(|&(last, _)| (0.0..GAP).contains(&(secs - last))) else {
            self.begin(secs, place);
            return Ok(());
        };
        while (self.tick + 1) as f64 * TICK <= secs {
            let at = (self.tick + 1) as f64 * TICK;
            let share = if secs > from { (at - from) / (secs - from) } else { 1.0 };
            self.advance(world, before.lerp(place, share));
        }
        self.last = Some((secs, place));
        Ok(())
    }

    fn begin(&mut self, secs: f64, place: DVec2) {
        self.people.clear();
        self.tick = (secs / TICK).floor() as i64;
        (self.place, self.velocity, self.last) = (place, DVec2::ZERO, Some((secs, place)));
    }

    /// One tick: everybody goes on as decided, then all decide anew.
    fn advance(&mut self, world: &World, place: DVec2) {
        self.tick += 1;
        let secs = self.tick as f64 * TICK;
        self.velocity = (place - self.place) / TICK;
        self.place = place;
        let near = self.near(world, secs);
        // Who is out of sight goes back to its way until it leaves its patch.
        let before =
            std::mem::take(&mut self.people).into_iter().filter(|(stay, _)| ground::way(world, *stay, secs).is_some());
        self.people = near.into_iter().map(|stay| (stay, Aside::default())).collect();
        self.people.extend(before.map(|(stay, aside)| (stay, aside.after(TICK))));
        let body = push::Body { place, velocity: self.velocity, radius: self.radius };
        push::decide(world, &mut self.grounds, secs, &body, &mut self.people);
    }

    /// Stays of all in sight, and a little beyond.
    fn near(&self, world: &World, secs: f64) -> Vec<Stay> {
        let moment = world.moment(secs);
        let stays = world.nearby().within(self.place, SIGHT + BEYOND).flat_map(|spot| stays(world, spot, &moment));
        stays
            .filter(|&(stay, _)| {
                ground::way(world, stay, secs).is_some_and(|(p, _)| p.distance(self.place) < SIGHT + BEYOND)
            })
            .map(|(stay, _)| stay)
            .collect()
    }

    /// Everybody in some patches, at the time of the last sample of the track, or a little later.
    pub fn people(&mut self, world: &World, spots: impl Iterator<Item = Spot>, secs: f64) -> Vec<Seen> {
        let since = secs - self.tick as f64 * TICK;
        let moment = world.moment(secs);
        let mut found = Vec::new();
        for (stay, person) in spots.flat_map(|spot| stays(world, spot, &moment)) {
            let Some((place, velocity)) = ground::way(world, stay, secs) else { continue };
            let (aside, drift) = match self.people.get(&stay).filter(|_| (0.0..GAP).contains(&since)) {
                Some(aside) => self.grounds.faded(world, stay, secs, aside.after(since.min(TICK))),
                None => (DVec2::ZERO, DVec2::ZERO),
            };
            found.push(Seen { person, place: place + aside, velocity: velocity + drift, aside });
        }
        found
    }
}

/// Stays of those who walk in a patch, and who they are.
fn stays<'a>(
    world: &'a World,
    spot: Spot,
    moment: &'a crate::stage::world::Moment,
) -> impl Iterator<Item = (Stay, Person)> + 'a {
    let copy = ground::copy(world, spot);
    let walkers = world.walkers_of(spot.instance as usize, moment);
    let people = world.people_of(spot.instance as usize, copy, moment);
    walkers
        .zip(people)
        .map(move |((walker, lap), person)| (Stay { instance: spot.instance, copy, walker, lap }, person))
}

#[cfg(test)]
mod tests;
