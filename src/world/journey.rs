//! Who gets from one place to another soonest, in any baked world.
//!
//! Nobody has to be followed: two crossings on one cycle are passed by the same person as many periods apart as they are along
//! it, so the answer follows from identities alone. It costs crossings here times crossings there.

use glam::{DVec2, Vec2};

use super::Person;
use crate::stage::World;

/// A person's way from a patch to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Journey {
    /// Who.
    pub person: Person,
    /// When it comes into the first patch, seconds.
    pub departure: f64,
    /// When it comes into the other, seconds.
    pub arrival: f64,
}

impl World {
    /// The patch of the first copy of the world that a place is in.
    pub fn patch_at(&self, place: DVec2) -> Option<usize> {
        self.nearby().within(place, 0.0).map(|spot| spot.instance as usize).find(|&instance| {
            let local = (place - self.place(instance)).as_vec2();
            let local = Vec2::from_angle(-self.turn(instance)).rotate(local);
            let outline = self.kind(self.kind_of(instance)).outline();
            let next = |i: usize| outline[(i + 1) % outline.len()];
            !outline.is_empty()
                && (0..outline.len()).all(|i| (next(i) - outline[i]).perp_dot(local - outline[i]) >= 0.0)
        })
    }

    /// Of all who come into patch `from` at `earliest` (seconds) or later, who comes into patch `to` first; where the world repeats,
    /// in the same copy of the world. None if nobody ever does.
    pub fn journey(&self, from: usize, to: usize, earliest: f64) -> Option<Journey> {
        let all = self.entries(from).flat_map(|a| self.entries(to).map(move |b| (a, b)));
        let journeys = all.filter(|(a, b)| a.crossing != b.crossing).filter_map(|(a, b)| self.connect(a, b, earliest));
        journeys.min_by(|a, b| (a.arrival, a.person).partial_cmp(&(b.arrival, b.person)).expect("times are finite"))
    }

    /// The journey over two crossings.
    fn connect(&self, from: Entry, to: Entry, earliest: f64) -> Option<Journey> {
        let (identities, period) = (&self.tables().identities, f64::from(self.info().period_secs));
        if identities.cycle(from.crossing) != identities.cycle(to.crossing) {
            return None;
        }
        let begin = ((earliest - from.secs) / period).ceil() as i64;
        let least = ((from.secs - to.secs) / period).floor() as i64 + 1;
        let later = self.periods_between(from.crossing, to.crossing, least)?;
        let at = |entry: Entry, lap: i64| entry.secs + lap as f64 * period;
        let person = identities.of(from.crossing, [0, 0], begin);
        Some(Journey { person, departure: at(from, begin), arrival: at(to, begin + later) })
    }

    /// Periods, `least` or more, from a crossing until the same person is at another, in the same copy of the world.
    fn periods_between(&self, from: usize, to: usize, least: i64) -> Option<i64> {
        let identities = &self.tables().identities;
        let (people, around) = identities.around(identities.cycle(from));
        let laps = identities.laps(to) - identities.laps(from);
        let (a, b) = (identities.copies(from), identities.copies(to));
        let off = [a[0] - b[0], a[1] - b[1]];
        let rounds = match (0..2).find(|&axis| around[axis] != 0) {
            // Where a round leads to other copies, only so many rounds lead back to this one.
            Some(axis) => off[axis] / around[axis],
            None if people > 0 => (least - laps).div_euclid(people) + i64::from((least - laps).rem_euclid(people) > 0),
            None => 0,
        };
        let same = (0..2).all(|axis| rounds * around[axis] == off[axis]);
        let later = laps + rounds * people;
        (same && later >= least).then_some(later)
    }

    /// Crossings into a patch, and when.
    fn entries(&self, instance: usize) -> impl Iterator<Item = Entry> {
        let info = self.info();
        let ahead =
            f64::from(self.tables().instance_phases[instance]) * f64::from(info.period_secs) / f64::from(info.slots);
        let first = self.first_crossing(instance);
        let presences = self.kind(self.kind_of(instance)).presences(info.period_secs);
        presences.into_iter().enumerate().map(move |(i, (enter, _))| Entry { crossing: first + i, secs: enter - ahead })
    }
}

/// A crossing into a patch.
#[derive(Clone, Copy, Debug)]
struct Entry {
    crossing: usize,
    /// When, after the begin of a period.
    secs: f64,
}
