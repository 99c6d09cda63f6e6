//! The domain as the inner loops see it: how far each ground point is from walls and obstacles, and the time span.

use glam::Vec2;

use super::prefer::Stay;
use super::{Scene, repeat};
use crate::geom::{Cycle, Ground, Obstacle, Polygon, Torus, Turn};
use crate::motion::FPS;
use crate::{Error, Result};

/// Cell size of the clearance grid in metres.
const CELL: f32 = 0.1;
/// A body needs at least this much room to stand, metres.
const BODY_ROOM: f32 = 0.3;

/// When a part of a body is somewhere, and how high it is above the ground at its lowest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    /// When.
    pub tick: i32,
    /// Metres.
    pub lift: f32,
}

impl Spot {
    /// On the ground.
    pub fn ground(tick: i32) -> Self {
        Self { tick, lift: 0.0 }
    }
}

/// Region, obstacles and time span of a scene.
pub(super) struct Domain {
    /// Lower corner of the bounding box.
    pub min: Vec2,
    /// Upper corner of the bounding box.
    pub max: Vec2,
    /// Bodies are looked at on ticks 0..horizon.
    pub horizon: i32,
    /// What is the same place.
    pub torus: Torus,
    /// What is the same moment.
    pub cycle: Cycle,
    region: Polygon,
    walls: Vec<Polygon>,
    movers: Vec<Mover>,
    clearance: Vec<f32>,
    columns: usize,
    rows: usize,
    crossings: Vec<Crossing>,
}

/// Somebody who crosses the border at certain moments, as only this one may: where they are from a tick on.
pub(super) struct Crossing {
    /// The first tick.
    pub from: i32,
    /// Tick by tick.
    pub places: Vec<Vec2>,
}

/// Final hips are no farther from where the path of a rigid piece has them, metres.
const HIPS_ASTRAY: f32 = 0.3;

impl Domain {
    /// # Errors
    /// The obstacles leave nowhere to stand.
    pub fn new(scene: &Scene) -> Result<Self> {
        let (min, max) = scene.region.bounds();
        let columns = ((max.x - min.x) / CELL).ceil() as usize + 1;
        let rows = ((max.y - min.y) / CELL).ceil() as usize + 1;
        if columns.saturating_mul(rows) > 1 << 28 {
            return Err(Error::invalid(
                "scene",
                "region",
                format!("{} x {} m is too large", max.x - min.x, max.y - min.y),
            ));
        }
        // Where time comes round, the last frame is the first one.
        let loops = scene.periodic.t;
        let mut domain = Self {
            min,
            max,
            horizon: scene.last_frame() + i32::from(!loops),
            torus: Torus::new(min, max, scene.periodic),
            cycle: if loops { Cycle::new(scene.last_frame()) } else { Cycle::default() },
            region: scene.region.clone(),
            walls: scene.obstacles.iter().filter(|o| o.is_wall()).map(|o| o.outline.clone()).collect(),
            movers: scene
                .obstacles
                .iter()
                .filter(|o| !o.is_wall())
                .map(|o| Mover::new(o, scene.last_frame()))
                .collect(),
            clearance: Vec::new(),
            columns,
            rows,
            crossings: vec![],
        };
        let node =
            |i: usize| domain.exact_clearance(min + Vec2::new((i % columns) as f32, (i / columns) as f32) * CELL);
        domain.clearance = (0..columns * rows).map(node).collect();
        if domain.clearance.iter().all(|&c| c < BODY_ROOM) {
            let problem = format!("expected room for a body of {BODY_ROOM} m, found none outside the obstacles");
            return Err(Error::invalid("scene", "region", problem));
        }
        Ok(domain)
    }

    /// The same, crossed by some at certain moments.
    pub fn crossed_by(self, crossings: Vec<Crossing>) -> Self {
        Self { crossings, ..self }
    }

    /// True if this is where somebody is who crosses the border at that moment.
    pub fn is_crossed(&self, tick: i32, hips: Vec2) -> bool {
        let is_here = |place: &Vec2| place.distance(hips) < HIPS_ASTRAY;
        let index = |c: &Crossing| usize::try_from(tick - c.from).ok();
        self.crossings.iter().any(|c| index(c).and_then(|k| c.places.get(k)).is_some_and(is_here))
    }

    /// Distance to the nearest wall or obstacle that stands and is over all heads; negative beyond.
    pub fn exact_clearance(&self, p: Vec2) -> f32 {
        let from_walls = |o: &Polygon| repeat::distance(o, self.torus, p);
        self.walls.iter().map(from_walls).fold(self.inside(p), f32::min)
    }

    /// Distance to the nearest border that does not repeat; negative beyond.
    fn inside(&self, p: Vec2) -> f32 {
        let period = self.torus.period();
        if self.torus.is_plane() {
            return -self.region.signed_distance(p);
        }
        // A rectangle, of which sides that repeat are none.
        let room = (p - self.min).min(self.max - p);
        Vec2::select(period.cmpeq(Vec2::ZERO), room, Vec2::splat(f32::MAX)).min_element()
    }

    /// True if what happens at a tick is not seen: before the first and after the last.
    #[inline]
    pub fn is_unseen(&self, tick: i32) -> bool {
        !self.cycle.loops() && (tick < 0 || tick > self.horizon)
    }

    /// The ticks of a patch on which its bodies are looked at.
    #[inline]
    pub fn seen(&self, begin: i32, end: i32) -> std::ops::Range<i32> {
        if self.cycle.loops() { begin..end } else { begin.max(0)..end.min(self.horizon) }
    }

    /// The ticks on which final bodies are looked at. Where time comes round they are those of the second lap of three:
    /// blends and planted feet reach into the first and the third.
    pub fn frames(&self) -> std::ops::Range<i32> {
        let first = self.cycle.ticks();
        first..first + self.horizon
    }

    /// The last tick for which final bodies are made.
    pub fn last_frame(&self) -> u32 {
        (if self.cycle.loops() { 3 * self.horizon } else { self.horizon - 1 }) as u32
    }

    /// Somebody at a place and moment, as preferences know them.
    pub fn stay(&self, at: Ground, tick: i32) -> Stay {
        Stay::new(Ground::new(self.torus.wrap(at.position), at.heading), self.cycle.slot(tick))
    }

    /// True if a disc certainly lies inside the region and outside the obstacles, or above them.
    #[inline]
    pub fn holds(&self, at: Spot, center: Vec2, radius: f32) -> bool {
        self.is_within_walls(center, radius) && self.movers.iter().all(|m| m.is_clear(at, center, radius, self))
    }

    /// A place over one of the low obstacles (which one: any number) at a tick, `aside` from its middle: each between -1
    /// and 1 of its extent. `None` if there are none.
    pub fn over_obstacle(&self, tick: i32, aside: Vec2, which: usize) -> Option<Vec2> {
        let low = || self.movers.iter().filter(|m| m.height.is_finite());
        let mover = low().nth(which.checked_rem(low().count())?)?;
        let (low, high) = mover.outline.bounds();
        let (place, turn) = mover.at(self.cycle.slot(tick));
        Some(place + turn.apply(aside * (high - low) * 0.5))
    }

    /// True if there is a low obstacle under a place at a tick.
    pub fn is_over_obstacle(&self, tick: i32, place: Vec2) -> bool {
        let low = self.movers.iter().filter(|m| m.height.is_finite());
        low.into_iter().any(|m| !m.is_clear(Spot::ground(tick), place, 0.0, self))
    }

    #[inline]
    fn is_within_walls(&self, center: Vec2, radius: f32) -> bool {
        let center = self.torus.wrap(center);
        // The nearest node; casts round towards zero.
        let cell = (center - self.min) / CELL + 0.5;
        if cell.x < 0.0 || cell.y < 0.0 || cell.x >= self.columns as f32 || cell.y >= self.rows as f32 {
            return false;
        }
        let node = self.clearance[cell.y as usize * self.columns + cell.x as usize];
        // Clearance changes by at most the distance to the node.
        if node - CELL * std::f32::consts::FRAC_1_SQRT_2 >= radius {
            return true;
        }
        node + CELL * std::f32::consts::FRAC_1_SQRT_2 >= radius && self.exact_clearance(center) >= radius
    }
}

/// An obstacle that moves or that one can get over, and where it is at every tick.
struct Mover {
    outline: Polygon,
    height: f32,
    /// The circle around the outline.
    middle: Vec2,
    radius: f32,
    /// Where the circle's middle is, and how it is turned; one for all ticks if it stands.
    places: Vec<(Vec2, Turn)>,
}

impl Mover {
    fn new(obstacle: &Obstacle, last_tick: i32) -> Self {
        let outline = obstacle.outline.clone();
        let (low, high) = outline.bounds();
        let middle = (low + high) * 0.5;
        let place = |tick: i32| {
            let place = obstacle.place(tick as f32 / FPS);
            (place.apply(middle), place.turn())
        };
        let ticks = if obstacle.path.is_empty() { 0..=0 } else { 0..=last_tick };
        Self {
            height: obstacle.height.unwrap_or(f32::INFINITY),
            radius: outline.points.iter().map(|p| p.distance(middle)).fold(0.0, f32::max),
            places: ticks.map(place).collect(),
            middle,
            outline,
        }
    }

    /// Where its middle is at a tick, and how it is turned.
    fn at(&self, tick: i32) -> (Vec2, Turn) {
        self.places[(tick.max(0) as usize).min(self.places.len() - 1)]
    }

    fn is_clear(&self, at: Spot, center: Vec2, radius: f32, domain: &Domain) -> bool {
        if at.lift >= self.height {
            return true;
        }
        let (place, turn) = self.at(domain.cycle.slot(at.tick));
        let (away, reach) = (domain.torus.nearest(center - place), self.radius + radius);
        if away.length_squared() >= reach * reach {
            return true;
        }
        let back = Turn { cos: turn.cos, sin: -turn.sin };
        self.outline.signed_distance(self.middle + back.apply(away)) >= radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Waypoint;

    #[test]
    fn holds_agrees_with_exact_clearance() {
        let mut scene = Scene::demo();
        scene.obstacles.push(Polygon::rectangle(Vec2::splat(4.0), Vec2::splat(6.0)).into());
        let domain = Domain::new(&scene).unwrap();
        for i in 0..4000 {
            let p = Vec2::new((i % 63) as f32 * 0.2, (i / 63) as f32 * 0.2) - 0.3;
            let c = domain.exact_clearance(p);
            // No body has a negative radius.
            assert!(domain.holds(Spot::ground(0), p, c - 1e-3) || c < 1e-3, "{p} {c}");
            assert!(!domain.holds(Spot::ground(0), p, c + 1e-3));
        }
    }

    #[test]
    fn obstacles_that_fill_the_region_are_refused() {
        let mut scene = Scene::demo();
        scene.obstacles.push(Polygon::rectangle(Vec2::splat(-1.0), Vec2::splat(13.0)).into());
        assert!(Domain::new(&scene).err().unwrap().to_string().contains("room"));
    }

    #[test]
    fn a_moving_obstacle_is_where_it_is_and_only_so_high() {
        let mut scene = Scene::demo();
        let at = |secs: f32, x: f32, heading: f32| Waypoint { secs, position: Vec2::new(x, 6.0), heading };
        // Its outline is not about its way-points, so that it swings about when it turns.
        let outline = Polygon::rectangle(Vec2::new(0.2, 0.1), Vec2::new(1.4, 0.7));
        let path = vec![at(2.0, 2.0, 0.0), at(10.0, 10.0, 3.0)];
        scene.obstacles.push(Obstacle { outline, height: Some(0.4), path });
        let (domain, cart) = (Domain::new(&scene).unwrap(), &scene.obstacles[0]);
        let mut met = 0;
        for i in 0..20_000 {
            let tick = i % 600;
            let p = Vec2::new((i * 7 % 113) as f32 * 0.1, 4.0 + (i * 13 % 41) as f32 * 0.1);
            let distance = cart.outline_at(tick as f32 / FPS).signed_distance(p);
            let inside = domain.exact_clearance(p);
            let radius = 0.2;
            let free = distance >= radius && inside >= radius;
            met += (distance < radius) as usize;
            if (distance - radius).abs() > 1e-3 && (inside - radius).abs() > 1e-3 {
                assert_eq!(domain.holds(Spot::ground(tick), p, radius), free, "{p} at {tick}: {distance}");
            }
            assert_eq!(domain.holds(Spot { tick, lift: 0.41 }, p, radius), domain.is_within_walls(p, radius));
        }
        assert!(met > 500, "{met}");
    }
}
