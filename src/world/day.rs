//! Density that follows the time of day: who is there is a function of who it is and of the time.
//!
//! Beyond "Crowd Patches" (2009), whose density never changes. Everybody has a number from 0 to 1 and is there if it is below the
//! density of the hour; so fewer people are always some of those who were there before, and the same for a whole hour. But
//! nobody appears or vanishes in view: it is decided when somebody comes into a patch where nobody looks (buildings), or into the
//! world, and holds until the next such patch. Who never comes to one is always there.

use super::Person;
use crate::stage::World;
use crate::{Error, Result};

/// Seconds of an hour.
const HOUR: f64 = 3600.0;
/// Picks the numbers.
const SALT: u64 = 0x0064_6179;

/// How many people are there at which time of day.
#[derive(Clone, Debug, PartialEq)]
pub struct Day {
    /// Share of people who are there in every hour.
    hours: [f32; 24],
    /// Seconds since it was last decided about who comes in at a crossing; none if it never is.
    ages: Vec<Option<f64>>,
    /// When it is come in at every crossing, seconds after the begin of a period.
    enters: Vec<f64>,
    period: f64,
}

/// A crossing along its cycle.
#[derive(Clone, Copy, Debug)]
struct Passed {
    cycle: u32,
    /// Seconds since the cycle's begin.
    at: f64,
    crossing: usize,
    hidden: bool,
}

impl Day {
    /// A day for a world: the share of people (0 to 1) in every hour from midnight on, and names of the templates where nobody
    /// looks. O(crossings).
    ///
    /// # Errors
    /// If a share is not from 0 to 1, or a template is not in the world.
    pub fn new(world: &World, hours: [f32; 24], hidden: &[&str]) -> Result<Self> {
        if let Some(hour) = hours.iter().position(|share| !(0.0..=1.0).contains(share)) {
            let problem = format!("expected a share from 0 to 1, found {}", hours[hour]);
            return Err(Error::invalid("day", format!("hour {hour}"), problem));
        }
        let templates = &world.info().templates;
        if let Some(name) = hidden.iter().find(|name| !templates.iter().any(|t| t.name == **name)) {
            let known: Vec<&str> = templates.iter().map(|t| t.name.as_str()).collect();
            let problem = format!("expected templates of {known:?}, found {name:?}");
            return Err(Error::invalid("day", "hidden", problem));
        }
        let mut passed = crossings(world, |template| hidden.contains(&templates[template].name.as_str()));
        let period = f64::from(world.info().period_secs);
        let laps = |p: &Passed| world.tables().identities.laps(p.crossing) as f64 * period;
        let enters = passed.iter().map(|p| p.at - laps(p)).collect();
        let mut ages = vec![None; passed.len()];
        passed.sort_by(|a, b| (a.cycle, a.at, a.crossing).partial_cmp(&(b.cycle, b.at, b.crossing)).expect("finite"));
        for cycle in passed.chunk_by(|a, b| a.cycle == b.cycle) {
            fill(world, cycle, period, &mut ages);
        }
        Ok(Self { hours, ages, enters, period })
    }

    /// Whether the walker of a patch (of the world's copy `copy`) who came in in a period is there. O(1).
    pub fn present(&self, world: &World, instance: usize, copy: [i64; 2], walker: usize, period: i64) -> bool {
        let crossing = world.first_crossing(instance) + walker;
        let Some(age) = self.ages[crossing] else { return true };
        let person = world.tables().identities.of(crossing, copy, period);
        let decided = self.enters[crossing] + period as f64 * self.period - age;
        number(person) < self.share(decided)
    }

    /// Share of people who are there at a time, seconds since midnight, where it is decided at once.
    pub fn share(&self, secs: f64) -> f32 {
        self.hours[(secs / HOUR).floor().rem_euclid(24.0) as usize]
    }

    /// Share of those who come in somewhere that may ever be absent.
    pub fn movable(&self) -> f64 {
        self.ages.iter().flatten().count() as f64 / self.ages.len().max(1) as f64
    }
}

/// Somebody's number, from 0 to 1.
fn number(person: Person) -> f32 {
    (person.hash(SALT) >> 40) as f32 / (1_u64 << 24) as f32
}

/// All crossings of the world, in order.
fn crossings(world: &World, hidden: impl Fn(usize) -> bool) -> Vec<Passed> {
    let (info, identities) = (world.info(), &world.tables().identities);
    let period = f64::from(info.period_secs);
    let mut all = Vec::new();
    for instance in 0..world.instances() {
        let kind = world.kind(world.kind_of(instance));
        let ahead = f64::from(world.tables().instance_phases[instance]) * period / f64::from(info.slots);
        let hidden = hidden(kind.template());
        for (walker, (enter, _)) in kind.presences(info.period_secs).into_iter().enumerate() {
            let crossing = world.first_crossing(instance) + walker;
            let at = identities.laps(crossing) as f64 * period + enter - ahead;
            all.push(Passed { cycle: identities.cycle(crossing), at, crossing, hidden });
        }
    }
    all
}

/// Finds for all crossings of a cycle, in order, when it was last decided.
fn fill(world: &World, cycle: &[Passed], period: f64, ages: &mut [Option<f64>]) {
    let people = world.tables().identities.around(cycle[0].cycle).0;
    // Before the first of a round comes the last of the round before; a way through the world begins where nobody looks.
    let last = cycle.iter().rev().find(|p| p.hidden).map(|p| p.at - people as f64 * period);
    let mut decided = if people > 0 { last } else { Some(cycle[0].at) };
    for passed in cycle {
        decided = if passed.hidden { Some(passed.at) } else { decided };
        ages[passed.crossing] = decided.map(|at| passed.at - at);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::scenes;
    use std::collections::BTreeMap;

    fn street(endless: bool) -> World {
        let plan = crate::world::Plan { endless, ..scenes::street(5).unwrap() };
        plan.bake("street", &plan.build().unwrap()).unwrap()
    }

    /// From quiet at night to all at noon.
    fn hours() -> [f32; 24] {
        std::array::from_fn(|hour| 0.1 + 0.9 * (1.0 - (hour as f32 - 12.0).abs() / 12.0))
    }

    /// Everybody at a time, and in which template; with whether it is there.
    fn people(world: &World, day: &Day, secs: f64) -> BTreeMap<Person, (bool, usize)> {
        let moment = world.moment(secs);
        let patch = |i: usize| {
            let template = world.kind(world.kind_of(i)).template();
            let walkers = world.walkers_of(i, &moment).zip(world.people_of(i, [0, 0], &moment));
            walkers.map(move |((walker, lap), person)| (person, (day.present(world, i, [0, 0], walker, lap), template)))
        };
        (0..world.instances()).flat_map(patch).collect()
    }

    #[test]
    fn nobody_appears_or_vanishes_in_view() {
        let world = street(true);
        let day = Day::new(&world, hours(), &["building"]).unwrap();
        let building = world.info().templates.iter().position(|t| t.name == "building").unwrap();
        let (mut changes, mut before) = (0, people(&world, &day, 8.0 * HOUR - 60.0));
        for step in 1..600 {
            let now = people(&world, &day, 8.0 * HOUR - 60.0 + f64::from(step) * 0.2);
            for (who, (there, template)) in &now {
                if before.get(who).is_some_and(|(earlier, _)| earlier != there) {
                    changes += 1;
                    assert_eq!(*template, building, "{who:?}");
                }
            }
            before = now;
        }
        println!("{changes} changes in two minutes about 8 o'clock; {:.2} may be absent", day.movable());
        assert!(changes > 10 && day.movable() > 0.5);
    }

    #[test]
    fn as_many_as_the_hour_says_and_more_are_the_same_and_others() {
        let world = street(true);
        let day = Day::new(&world, hours(), &["building"]).unwrap();
        // Long enough after the hour began for everybody to have come by a building.
        let at = |hour: f64| people(&world, &day, hour * HOUR + 3500.0);
        let share = |all: &BTreeMap<Person, (bool, usize)>| {
            all.values().filter(|(there, _)| *there).count() as f64 / all.len() as f64
        };
        let always = 1.0 - day.movable();
        let found = [0.0, 6.0, 12.0].map(|hour| share(&at(hour)));
        println!("shares {found:?}, {always:.2} always there");
        assert!(found[0] < found[1] && found[1] < found[2] && found[2] == 1.0);
        let expected = [0.1, 0.55].map(|share| always + (1.0 - always) * share);
        assert!(
            (found[0] - expected[0]).abs() < 0.12 && (found[1] - expected[1]).abs() < 0.12,
            "{found:?} {expected:?}"
        );
        // The same hour of another day: the same people; a fuller hour: all of them.
        let (quiet, again, full) = (at(6.0), at(30.0), at(9.0));
        let same = quiet.iter().filter_map(|(who, a)| Some((a.0, again.get(who)?.0)));
        assert!(same.clone().count() > 10 && same.clone().all(|(a, b)| a == b));
        let more = quiet.iter().filter_map(|(who, a)| Some((a.0, full.get(who)?.0)));
        assert!(more.clone().all(|(a, b)| b || !a) && more.clone().any(|(a, b)| b && !a));
    }

    #[test]
    fn a_day_that_makes_no_sense_is_refused() {
        let world = street(false);
        let mut hours = hours();
        assert!(Day::new(&world, hours, &["moon"]).unwrap_err().to_string().contains("\"moon\""));
        hours[7] = 1.5;
        assert!(Day::new(&world, hours, &[]).unwrap_err().to_string().contains("hour 7"));
    }
}
