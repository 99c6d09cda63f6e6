//! A baked world, from its file alone: what is played, over a whole period.
//!
//! Control points are read from the rows as a player reads them, curves are followed along chords (see the module), everybody
//! against everybody near, whatever the patch; and whoever leaves a slot must come into the next as the same person, at
//! the same place, as fast.

use std::collections::{BTreeMap, HashMap};

use glam::{DVec2, Vec2};
use rayon::prelude::*;

use super::curve::{CHORDS, Curve};
use super::distance::to_shape;
use super::patch::turning;
use super::tiles::{Body, closest};
use crate::check::report::{Report, Row, Worst};
use crate::geom::Polygon;
use crate::stage::World;
use crate::stage::world::{Kind, ObjectShape, Person, UNITS_PER_METRE};
use crate::world::{Limits, Path, Shape};

/// Checks a baked world: bodies never touch each other, objects, or who stays; walkers keep the limits of walking; everybody who
/// leaves a patch comes into the next at the same place, as fast, as the same person; no two are one. Limits are widened by what
/// 16 bits round. Feet of bodies stay where they are planted, above the floor. O(people x chords).
pub fn check_world(world: &World) -> Report {
    let played = Played::new(world);
    let mut rows = Vec::new();
    let meters = played.widened(0.0, 2.0);
    let diameter = 2.0 * f64::from(world.info().limits.radius);
    let (apart, objects) = rayon::join(|| played.closest(), || played.objects());
    let (near, place) = apart;
    rows.push(row(1, "walkers enter each other", diameter - near, meters, "m", place));
    let radius = f64::from(world.info().limits.radius);
    rows.push(row(2, "walkers enter objects and who stays", radius - objects.0, meters, "m", objects.1));
    rows.extend(played.limits());
    rows.extend(played.hand_overs());
    rows.extend(super::feet::rows(world));
    rows.extend(super::acts::rows(world));
    rows.extend(super::acts::meetings(world));
    Report { rows }
}

fn row(clause: u8, name: &str, value: f64, limit: f64, unit: &str, place: String) -> Row {
    let value = if value.is_nan() { f64::MAX } else { value.clamp(0.0, f64::MAX) };
    Row { clause, row: name.into(), value, limit, unit: unit.into(), ok: value <= limit, place }
}

/// A walker of a kind, as it is played.
struct Way {
    path: Path,
    curve: Curve,
    /// First chord of its stay, and the chord after the last.
    stay: (i64, i64),
    /// Whether it does something else than walk.
    acts: bool,
}

/// What a world plays.
struct Played<'a> {
    world: &'a World,
    ways: Vec<Vec<Way>>,
    /// Seconds of a slot.
    step: f64,
}

impl<'a> Played<'a> {
    fn new(world: &'a World) -> Self {
        let step = f64::from(world.info().period_secs) / f64::from(world.info().slots);
        let mut knots = knots(world);
        let ways = (0..world.kinds())
            .map(|kind| {
                let walkers = 0..world.kind(kind).walkers();
                walkers
                    .filter_map(|w| way(knots.remove(&(kind, w))?, step, world.walker_act(kind, w).is_some()))
                    .collect()
            })
            .collect();
        Self { world, ways, step }
    }

    /// `limit`, and what rounding control points by half a unit each can add: `parts` halves.
    fn widened(&self, limit: f64, parts: f64) -> f64 {
        limit * 1.0005 + 1e-6 + parts * 0.5 * f64::from(self.world.info().metres_per_unit) * std::f64::consts::SQRT_2
    }

    fn walking(&self) -> Limits {
        let own = self.world.info().limits;
        let (radius, speed, acceleration) = (own.radius, own.speed, own.acceleration);
        Limits { radius, speed, acceleration, turning: own.turning, standing: own.standing }
    }

    /// Least distance of any two centres, and where.
    fn closest(&self) -> (f64, String) {
        let slots = i64::from(self.world.info().slots);
        let chords = slots * CHORDS;
        let torus = self.world.info().repeat.map(|r| Vec2::new(r[0] as f32, r[1] as f32) / UNITS_PER_METRE as f32);
        let limits = self.walking();
        let found: Vec<(f64, usize)> =
            (0..chords).into_par_iter().map(|chord| closest(&self.bodies(chord, chords), torus, &limits)).collect();
        let least = found.iter().enumerate().min_by(|a, b| a.1.0.total_cmp(&b.1.0));
        match least.filter(|(_, (near, _))| near.is_finite()) {
            Some((chord, &(near, patch))) => {
                let time = chord as f64 * self.step / CHORDS as f64;
                (near, format!("patch {patch} at {time:.2} s"))
            }
            None => (f64::INFINITY, String::new()),
        }
    }

    /// Everybody during a chord of the period.
    fn bodies(&self, chord: i64, chords: i64) -> Vec<Body> {
        let mut bodies = Vec::new();
        for instance in 0..self.world.instances() {
            let turn = Vec2::from_angle(self.world.turn(instance)).as_dvec2();
            let place = self.world.place(instance);
            let ahead = i64::from(self.world.tables().instance_phases[instance]) * CHORDS;
            for way in &self.ways[self.world.kind_of(instance)] {
                let mut own = way.stay.0 + (chord + ahead - way.stay.0).rem_euclid(chords);
                while own < way.stay.1 {
                    let (from, to, sag) = way.curve.chord(own, self.step / CHORDS as f64);
                    let [from, to] = [from, to].map(|p| turn.rotate(p) + place);
                    bodies.push(Body { from, to, sag, tile: instance, acts: way.acts });
                    own += chords;
                }
            }
        }
        bodies
    }

    /// Least distance of a walker from objects and who stays, and where.
    fn objects(&self) -> (f64, String) {
        let mut least = (f64::INFINITY, String::new());
        for (index, ways) in self.ways.iter().enumerate() {
            let kind = self.world.kind(index);
            for (what, shape) in shapes(self.world, &kind) {
                for (walker, way) in ways.iter().enumerate() {
                    for chord in way.stay.0..way.stay.1 {
                        let (a, b, sag) = way.curve.chord(chord, self.step / CHORDS as f64);
                        let near = to_shape(&shape, a, b) - sag;
                        if near < least.0 {
                            least = (near, format!("kind {index}, walker {walker}, {what}"));
                        }
                    }
                }
            }
        }
        least
    }

    fn limits(&self) -> Vec<Row> {
        let own = self.world.info().limits;
        let [mut speed, mut acceleration, mut turn] = [Worst::default(), Worst::default(), Worst::default()];
        for (kind, ways) in self.ways.iter().enumerate() {
            for (walker, way) in ways.iter().enumerate() {
                let place = || format!("kind {kind}, walker {walker}");
                speed.offer(way.curve.speed, place);
                acceleration.offer(way.curve.accelerations.iter().copied().fold(0.0, f64::max), place);
                turn.offer(turning(&way.path, own.standing.into()).to_degrees(), place);
            }
        }
        let speeds = self.widened(own.speed.into(), 2.0 / self.step);
        let accelerations = self.widened(own.acceleration.into(), 4.0 / self.step.powi(2));
        // At the speed of standing, where a small error turns most.
        let turns = self.widened(own.turning.into(), 4.0 / self.step.powi(2) / f64::from(own.standing)).to_degrees();
        let rows = [
            (speed, "speed", speeds, "m/s"),
            (acceleration, "acceleration", accelerations, "m/s2"),
            (turn, "turning while walking", turns, "deg/s"),
        ];
        rows.into_iter().map(|(worst, name, limit, unit)| worst.row(3, name, limit, unit)).collect()
    }

    /// Whether everybody goes on from slot to slot.
    fn hand_overs(&self) -> Vec<Row> {
        let slots = self.world.info().slots;
        let found: Vec<HandOvers> = (0..slots).into_par_iter().map(|slot| self.hand_over(slot)).collect();
        let mut all = HandOvers::default();
        for (slot, one) in found.into_iter().enumerate() {
            let place = |who: &str| format!("{who} after {:.2} s", (slot + 1) as f64 * self.step);
            all.lost += one.lost;
            all.twice += one.twice;
            if one.gap > all.gap || all.place.is_empty() {
                (all.gap, all.place) = (one.gap, place(&one.place));
            }
            all.jump = all.jump.max(one.jump);
        }
        vec![
            row(4, "place where a patch hands over", all.gap, 1e-3, "m", all.place),
            row(4, "speed where a patch hands over", all.jump, 0.1, "m/s", String::new()),
            row(4, "people lost between patches", all.lost as f64, 0.0, "", String::new()),
            row(5, "people who are two", all.twice as f64, 0.0, "", String::new()),
        ]
    }

    fn hand_over(&self, slot: u32) -> HandOvers {
        let slots = self.world.info().slots;
        let (this, next) = (i64::from(slot), i64::from(slot) + 1);
        let before = self.present(this, next);
        let after = self.present(next, next);
        let mut found = HandOvers::default();
        let mut seen = HashMap::new();
        let repeat = self.world.info().repeat.unwrap_or([0; 2]).map(|r| f64::from(r) / UNITS_PER_METRE);
        for (who, place, velocity) in &after {
            let same = seen.entry((who.cycle, who.number)).or_insert_with(Vec::new);
            found.twice += usize::from(same.iter().any(|(copy, _, _)| *copy == who.copy));
            same.push((who.copy, *place, *velocity));
        }
        for (who, place, velocity) in &before {
            // Who walks out of a copy of the world walks into it on the other side, as somebody of another copy.
            let gap = |(copy, at, speed): &([i64; 2], DVec2, DVec2)| {
                let [x, z] = [0, 1].map(|axis| (who.copy[axis] - copy[axis]) as f64 * repeat[axis]);
                ((*at + DVec2::new(x, z)).distance(*place), speed.distance(*velocity))
            };
            let nearest = seen.get(&(who.cycle, who.number)).into_iter().flatten().map(gap);
            match nearest.min_by(|a, b| a.0.total_cmp(&b.0)) {
                Some((gap, jump)) if gap < 1.0 => {
                    found.jump = found.jump.max(jump);
                    if gap >= found.gap {
                        (found.gap, found.place) = (gap, format!("person {} of cycle {}", who.number, who.cycle));
                    }
                }
                _ if self.world.tables().identities.leads_out(who.cycle) => {}
                _ => found.lost += 1,
            }
        }
        debug_assert!(slot < slots);
        found
    }

    /// Who is present in a slot (counted from time 0), with place and velocity at the begin of slot `at`.
    fn present(&self, slot: i64, at: i64) -> Vec<(Person, DVec2, DVec2)> {
        let slots = i64::from(self.world.info().slots);
        let moment = self.world.moment((slot as f64 + 0.5) * self.step);
        let mut found = Vec::new();
        for instance in 0..self.world.instances() {
            let kind = self.world.kind_of(instance);
            let turn = Vec2::from_angle(self.world.turn(instance)).as_dvec2();
            let ahead = i64::from(self.world.tables().instance_phases[instance]);
            let people = self.world.people_of(instance, [0, 0], &moment);
            for ((walker, lap), who) in self.world.walkers_of(instance, &moment).zip(people) {
                let way = &self.ways[kind][walker];
                let own =
                    ((at + ahead - lap * slots) * CHORDS - way.curve.begin).clamp(0, way.curve.places.len() as i64 - 1);
                let (place, velocity) = (way.curve.places[own as usize], way.curve.velocities[own as usize]);
                found.push((who, turn.rotate(place) + self.world.place(instance), turn.rotate(velocity)));
            }
        }
        found
    }
}

#[derive(Default)]
struct HandOvers {
    gap: f64,
    jump: f64,
    lost: usize,
    twice: usize,
    place: String,
}

/// Control points of every walker by their number on the kind's clock, from all pages.
fn knots(world: &World) -> HashMap<(usize, usize), BTreeMap<i64, DVec2>> {
    let (t, info) = (world.tables(), world.info());
    let unit = f64::from(info.metres_per_unit);
    let mut found: HashMap<(usize, usize), BTreeMap<i64, DVec2>> = HashMap::new();
    let (mut at, mut lane) = (0, 0);
    for page in 0..t.pages() {
        let ends = &t.lane_ends[page * t.kinds()..(page + 1) * t.kinds()];
        let (first, last) = (lane, ends.last().map_or(lane, |&end| end as usize));
        for row in 0..t.page_slots(page) + 3 {
            let mut begin = first;
            for (kind, &end) in ends.iter().enumerate() {
                let n = end as usize - begin;
                for (i, &who) in t.lanes[begin..end as usize].iter().enumerate() {
                    let who = crate::stage::world::Lane(who);
                    let slot = (page * info.page as usize + row) as i64 - 1 + who.lap() * i64::from(info.slots);
                    let place = DVec2::new(f64::from(t.rows[at + i]), f64::from(t.rows[at + n + i])) * unit;
                    found.entry((kind, who.walker())).or_default().insert(slot, place);
                }
                (at, begin) = (at + 2 * n, end as usize);
            }
        }
        lane = last;
    }
    let stays = (0..world.kinds()).map(|kind| world.stays(kind)).collect::<Vec<_>>();
    for ((kind, walker), knots) in &mut found {
        // Rows of pages go on before and after the stay, where nobody looks.
        let (enter, leave) = stays[*kind][*walker];
        knots.retain(|&knot, _| (enter - 1..leave + 2).contains(&knot));
    }
    found
}

fn way(knots: BTreeMap<i64, DVec2>, step: f64, acts: bool) -> Option<Way> {
    let first = *knots.keys().next()?;
    let points: Vec<Vec2> = knots.values().map(|p| p.as_vec2()).collect();
    let path = Path { step: step as f32, first: first as i32, points };
    let curve = Curve::new(&path)?;
    let stay = (curve.begin, curve.end());
    Some(Way { path, curve, stay, acts })
}

/// Objects and people of a kind that nobody walks into, with words for each.
fn shapes(world: &World, kind: &Kind) -> Vec<(String, Shape)> {
    let name = |index: u32| world.info().names[index as usize].clone();
    let objects = kind.objects().map(|(what, shape)| {
        let shape = match shape {
            ObjectShape::Disc(centre, radius) => Shape::disc(centre, radius),
            ObjectShape::Polygon(points) => Shape::Convex(Polygon { points }),
        };
        (name(what), shape)
    });
    objects.chain(kind.stayers().map(|s| (name(s.name), Shape::disc(s.place, s.radius)))).collect()
}
