//! Feet of who walks in a baked world, as seen: bodies are played and their joints looked at, nothing else.
//!
//! A foot is planted while its ball is low and slow. It may not slide then; whoever walks has a foot planted nearly always (so feet that
//! slide faster than planted ones may are found as well); no foot is below the floor, and none leaps where patches hand over.

use std::collections::BTreeMap;

use glam::{DVec2, Quat, Vec2, Vec3};
use rayon::prelude::*;

use super::super::report::{Row, Worst};
use crate::motion::{JOINT_COUNT, canonical, joint};
use crate::stage::World;
use crate::stage::world::{GaitTable, Person, Spot};

/// Frames per second that are looked at.
const RATE: f64 = 60.0;
/// Patches that are looked at; the first of the world.
const PATCHES: usize = 128;
/// A planted foot's ball is slower than this, m/s, and lower than this, metres.
const PLANTED: (f32, f32) = (0.06, 0.05);
/// Who is slower than this, m/s, takes steps too small to tell from sliding.
const WALKS: f32 = 0.4;
/// Of those who walk, at most so many may have no foot planted (who runs has none for a moment).
const ALOFT: f64 = 0.15;

/// A walker in a frame.
#[derive(Clone, Copy)]
struct Seen {
    place: Vec2,
    speed: f32,
    balls: [Vec3; 2],
    /// Lowest of ankles, balls and tips of the toes.
    lowest: f32,
}

/// Everybody in a frame.
type People = BTreeMap<Person, Seen>;

/// What is known of a foot that is planted: where it was first, and how far it slid since.
type Stance = Option<(Vec2, f32)>;

#[derive(Default)]
struct Found {
    slides: Vec<f32>,
    worst: Worst,
    sinking: Worst,
    /// Frames of somebody who walks, and those without a planted foot.
    walking: usize,
    aloft: usize,
}

/// The rows of feet; none without bodies whose feet are led to footprints.
pub(super) fn rows(world: &World) -> Vec<Row> {
    let Some(table) = world.tables().gait.as_ref().map(|gait| &gait.table).filter(|t| !t.prints.is_empty()) else {
        return Vec::new();
    };
    let mut found = Found::default();
    let (mut last, mut stances) = (People::new(), BTreeMap::new());
    let frames = (f64::from(world.info().period_secs) * RATE).ceil() as usize;
    // Some at a time, so that no large world is in memory as often as there are frames.
    for first in (0..frames).step_by(32) {
        let some = first..frames.min(first + 32);
        let seen: Vec<People> =
            some.into_par_iter().map(|frame| everybody(world, table, frame as f64 / RATE)).collect();
        for (i, now) in seen.into_iter().enumerate() {
            found.frame((first + i) as f64 / RATE, &last, &now, &mut stances);
            last = now;
        }
    }
    found.rows(leap(world, table))
}

/// Who walks in the patches looked at.
fn everybody(world: &World, table: &GaitTable, time: f64) -> People {
    let moment = world.moment(time);
    let (mut pose, mut globals, mut seen) = ([Quat::IDENTITY; JOINT_COUNT], Vec::new(), People::new());
    for instance in 0..world.instances().min(PATCHES) {
        let origin = world.place(instance).as_vec2();
        let spot = Spot { instance: instance as u32, shift: DVec2::ZERO };
        for (who, body) in world.people_of(instance, [0, 0], &moment).zip(world.bodies(spot, time)) {
            let root = body.pose(table, &mut pose);
            canonical().globals(root, &pose, &mut globals);
            let at = Vec3::new(origin.x, 0.0, origin.y);
            let toes = [joint::LEFT_TOE, joint::RIGHT_TOE];
            let tips = toes.map(|toe| {
                let tip = canonical().joints[toe].tip.unwrap_or(Vec3::ZERO);
                (globals[toe].0 + globals[toe].1 * tip).y.min(globals[toe].0.y).min(globals[toe - 1].0.y)
            });
            let balls = toes.map(|toe| globals[toe].0 + at);
            let (place, speed) = (body.place + origin, body.velocity.length());
            seen.insert(who, Seen { place, speed, balls, lowest: tips[0].min(tips[1]) });
        }
    }
    seen
}

impl Found {
    fn frame(&mut self, time: f64, last: &People, now: &People, stances: &mut BTreeMap<Person, [Stance; 2]>) {
        for (who, seen) in now {
            let place = || format!("person {} of cycle {} at {time:.2} s", who.number, who.cycle);
            self.sinking.offer(f64::from(-seen.lowest), place);
            // Who walks out of one side of a world that repeats comes in on the other.
            let before = last.get(who).filter(|before| before.place.distance(seen.place) < 0.5);
            let Some(before) = before else {
                stances.remove(who);
                continue;
            };
            let walks = seen.speed > WALKS;
            let own = stances.entry(*who).or_default();
            let mut planted = 0;
            for (foot, stance) in own.iter_mut().enumerate() {
                let ball = |seen: &Seen| Vec2::new(seen.balls[foot].x, seen.balls[foot].z);
                let (from, to) = (ball(before), ball(seen));
                let stays = from.distance(to) * (RATE as f32) < PLANTED.0 && seen.balls[foot].y < PLANTED.1;
                planted += usize::from(stays);
                *stance = match *stance {
                    Some((begin, slide)) if stays && walks => Some((begin, slide.max(begin.distance(to)))),
                    None if stays && walks => Some((from, from.distance(to))),
                    Some((_, slide)) => {
                        self.slides.push(slide);
                        self.worst.offer(slide.into(), place);
                        None
                    }
                    None => None,
                };
            }
            self.walking += usize::from(walks);
            self.aloft += usize::from(walks && planted == 0);
        }
    }

    fn rows(mut self, leap: Worst) -> Vec<Row> {
        self.slides.sort_by(f32::total_cmp);
        let mut median = Worst::default();
        if let Some(&slide) = self.slides.get(self.slides.len() / 2) {
            median.offer(slide.into(), || format!("{} stances", self.slides.len()));
        }
        let mut aloft = Worst::default();
        aloft.offer(self.aloft as f64 / self.walking.max(1) as f64, || format!("{} bodies", self.walking));
        vec![
            self.worst.row(6, "planted foot slides", 0.01, "m"),
            median.row(6, "planted foot slides, median", 0.003, "m"),
            aloft.row(6, "walking without a planted foot", ALOFT, ""),
            self.sinking.row(6, "foot below the floor", 0.01, "m"),
            leap.row(6, "feet where a patch hands over", 1e-3, "m"),
        ]
    }
}

/// How far feet go while no time passes: right before and after slots end.
fn leap(world: &World, table: &GaitTable) -> Worst {
    let slots = world.info().slots;
    let step = f64::from(world.info().period_secs) / f64::from(slots);
    let of = |slot: u32| {
        let (mut worst, time) = (Worst::default(), f64::from(slot) * step);
        // Feet are as fast as 10 m/s.
        let (before, after) = (everybody(world, table, time - 1e-5), everybody(world, table, time + 1e-5));
        for (who, a) in &before {
            let Some(b) = after.get(who).filter(|b| b.place.distance(a.place) < 0.5) else { continue };
            let gap = (0..2).map(|foot| a.balls[foot].distance(b.balls[foot])).fold(0.0, f32::max);
            worst.offer(gap.into(), || format!("person {} of cycle {} at {time:.2} s", who.number, who.cycle));
        }
        worst
    };
    let all: Vec<Worst> = (0..slots).into_par_iter().map(of).collect();
    all.into_iter().fold(Worst::default(), Worst::merge)
}
