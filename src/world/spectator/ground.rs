//! What somebody who steps aside has to mind: borders in space and time, and things that stand there.

use std::collections::BTreeMap;

use glam::{DVec2, Vec2};

use super::{Aside, FADE, Stay};
use crate::stage::World;
use crate::stage::world::{ObjectShape, Spot};

/// What is known about patch kinds that have been seen.
#[derive(Clone, Debug, Default)]
pub(super) struct Grounds {
    kinds: BTreeMap<usize, Ground>,
}

#[derive(Clone, Debug)]
struct Ground {
    /// When every walker comes and goes, seconds since the begin of the period it came in.
    stays: Vec<(f64, f64)>,
    outline: Vec<Vec2>,
    /// Convex corners and radius of what stands there, people who stay included.
    things: Vec<(Vec<Vec2>, f32)>,
}

impl Grounds {
    fn of(&mut self, world: &World, kind: usize) -> &Ground {
        self.kinds.entry(kind).or_insert_with(|| Ground::new(world, kind))
    }

    /// The offset that is seen, and its velocity: zero at both ends of the stay, with its first two derivatives.
    pub fn faded(&mut self, world: &World, stay: Stay, secs: f64, aside: Aside) -> (DVec2, DVec2) {
        let own = own_secs(world, stay, secs);
        let (enter, leave) = self.of(world, world.kind_of(stay.instance as usize)).stays[stay.walker];
        let ((a, da), (b, db)) = (smooth((own - enter) / FADE), smooth((leave - own) / FADE));
        let change = (da * b - a * db) / FADE;
        (aside.offset * (a * b), aside.velocity * (a * b) + aside.offset * change)
    }

    /// How far the middle of a body with a radius is from touching anything at a place of a patch, metres, at most `far`; negative
    /// within. The border of the patch counts only if it is nearer than it would be at `way`.
    pub fn room(&mut self, world: &World, stay: Stay, way: DVec2, place: DVec2, radius: f64, far: f64) -> f64 {
        let (way, place) = (local(world, stay, way), local(world, stay, place));
        let ground = self.of(world, world.kind_of(stay.instance as usize));
        let things = ground.things.iter().map(|(corners, own)| f64::from(outside(corners, place) - own) - radius);
        let inside = |p: Vec2| -f64::from(outside(&ground.outline, p));
        let border = inside(place) - radius.min(inside(way));
        things.chain([if border < 0.0 { border } else { far }]).fold(far, f64::min)
    }
}

impl Ground {
    fn new(world: &World, kind: usize) -> Self {
        let slot = f64::from(world.info().period_secs) / f64::from(world.info().slots);
        let stays = world.stays(kind).into_iter().map(|(a, b)| (a as f64 * slot, b as f64 * slot)).collect();
        let view = world.kind(kind);
        let objects = view.objects().map(|(_, shape)| match shape {
            ObjectShape::Disc(middle, radius) => (vec![middle], radius),
            ObjectShape::Polygon(corners) => (corners, 0.0),
        });
        let people = view.stayers().map(|s| (vec![s.place], s.radius));
        Self { stays, outline: view.outline(), things: objects.chain(people).collect() }
    }
}

/// Distance from a convex polygon or a point, negative inside; beside a corner perhaps less than it is.
fn outside(corners: &[Vec2], place: Vec2) -> f32 {
    if let [middle] = corners {
        return middle.distance(place);
    }
    let edge = |i: usize| {
        let along = (corners[(i + 1) % corners.len()] - corners[i]).normalize_or_zero();
        -along.perp_dot(place - corners[i])
    };
    (0..corners.len()).map(edge).fold(f32::NEG_INFINITY, f32::max)
}

/// A step from 0 to 1 without a jump of velocity or acceleration, and its slope.
fn smooth(x: f64) -> (f64, f64) {
    let x = x.clamp(0.0, 1.0);
    (x * x * x * (x * (6.0 * x - 15.0) + 10.0), 30.0 * x * x * (x - 1.0) * (x - 1.0))
}

/// Seconds since the begin of the period that somebody came in.
fn own_secs(world: &World, stay: Stay, secs: f64) -> f64 {
    let period = f64::from(world.info().period_secs);
    let ahead = f64::from(world.tables().instance_phases[stay.instance as usize]) / f64::from(world.info().slots);
    secs + (ahead - stay.lap as f64) * period
}

/// Where a patch's copy begins, metres.
fn origin(world: &World, stay: Stay) -> DVec2 {
    let units = crate::stage::world::UNITS_PER_METRE;
    let size = world.info().repeat.map_or(DVec2::ZERO, |[x, z]| DVec2::new(f64::from(x), f64::from(z)) / units);
    world.place(stay.instance as usize) + size * DVec2::new(stay.copy[0] as f64, stay.copy[1] as f64)
}

fn local(world: &World, stay: Stay, place: DVec2) -> Vec2 {
    Vec2::from_angle(-world.turn(stay.instance as usize)).rotate((place - origin(world, stay)).as_vec2())
}

/// Which copy of the world a patch is in.
pub(super) fn copy(world: &World, spot: Spot) -> [i64; 2] {
    let units = crate::stage::world::UNITS_PER_METRE;
    let count = |shift: f64, size: i32| (shift * units / f64::from(size)).round() as i64;
    world.info().repeat.map_or([0, 0], |[x, z]| [count(spot.shift.x, x), count(spot.shift.y, z)])
}

/// Place and velocity on somebody's way; none while the patch does not have it.
pub(super) fn way(world: &World, stay: Stay, secs: f64) -> Option<(DVec2, DVec2)> {
    let kind = world.kind_of(stay.instance as usize);
    let (place, velocity) = world.way(kind, stay.walker, own_secs(world, stay, secs))?;
    let turn = Vec2::from_angle(world.turn(stay.instance as usize));
    Some((origin(world, stay) + turn.rotate(place).as_dvec2(), turn.rotate(velocity).as_dvec2()))
}
