//! A final body at one moment, as it is tested: its capsules, and the disc on the ground that covers them.

use std::cell::OnceCell;

use glam::{Quat, Vec2, Vec3};

use super::domain::{Domain, Spot};
use crate::geom::{Capsule, Torus};
use crate::motion::{Skeleton, body_capsules};
use crate::refine::Body;

/// No body reaches further from its hips than this, metres.
pub(super) const REACH: f32 = 1.1;
/// Bodies whose hips are further apart than this never touch, metres.
const TOUCHING_HIPS: f32 = 2.0 * REACH;
/// Interpenetration that is let pass, metres.
pub(super) const TOLERANCE: f32 = 0.005;

/// A body's shape.
pub(super) struct Figure {
    /// What it is made of.
    pub capsules: Vec<Capsule>,
    /// Where the hips are.
    pub center: Vec2,
    /// Distance from there of the farthest point.
    pub radius: f32,
}

impl Figure {
    /// The body whose joints' global transforms are given.
    pub fn new(globals: &[(Vec3, Quat)]) -> Self {
        let mut capsules = Vec::new();
        body_capsules(globals, &mut capsules);
        let ground = |v: Vec3| Vec2::new(v.x, v.z);
        let center = ground(globals[0].0);
        let reach = |c: &Capsule| ground(c.a).distance(center).max(ground(c.b).distance(center)) + c.radius;
        let radius = capsules.iter().map(reach).fold(0.0, f32::max);
        Self { capsules, center, radius }
    }

    /// A body of the given bones at a tick, if it is there.
    pub fn of(body: &Body, bones: &Skeleton, tick: i32) -> Option<Self> {
        let frame = frame_at(body, tick)?;
        let mut globals = Vec::new();
        bones.globals(body.root[frame], body.pose(frame), &mut globals);
        Some(Self::new(&globals))
    }

    /// True if a limb is in a wall or an obstacle at a tick.
    pub fn is_in_wall(&self, domain: &Domain, tick: i32) -> bool {
        let inside = |p: Vec3, radius: f32| {
            let lift = p.y - radius + TOLERANCE;
            domain.holds(Spot { tick, lift }, Vec2::new(p.x, p.z), radius - TOLERANCE)
        };
        // Bones are so short that three discs each are as good as the whole.
        let free = |c: &Capsule| [0.0, 0.5, 1.0].into_iter().all(|t| inside(c.a.lerp(c.b, t), c.radius));
        !domain.holds(Spot::ground(tick), self.center, self.radius)
            && !domain.is_crossed(tick, self.center)
            && !self.capsules.iter().all(free)
    }

    /// The same body somewhere else.
    pub fn moved(mut self, by: Vec2) -> Self {
        let by3 = Vec3::new(by.x, 0.0, by.y);
        for c in &mut self.capsules {
            (c.a, c.b) = (c.a + by3, c.b + by3);
        }
        self.center += by;
        self
    }

    /// The image of the body that is nearest to another one.
    pub fn beside(self, other: &Self, torus: Torus) -> Self {
        let by = torus.whole(other.center - self.center);
        if by == Vec2::ZERO { self } else { self.moved(by) }
    }

    /// Depth of the deepest pair of capsules, metres; 0 if none touch.
    pub fn depth_into(&self, other: &Self) -> f32 {
        if self.center.distance(other.center) >= self.radius + other.radius {
            return 0.0;
        }
        let mut deepest = 0.0f32;
        for a in &self.capsules {
            let (middle, half) = ((a.a + a.b) * 0.5, a.a.distance(a.b) * 0.5 + a.radius);
            for b in &other.capsules {
                let reach = half + b.a.distance(b.b) * 0.5 + b.radius - deepest;
                if middle.distance_squared((b.a + b.b) * 0.5) < reach * reach {
                    deepest = deepest.max(a.penetration(b));
                }
            }
        }
        deepest
    }
}

/// Where everybody's hips are at a tick, sorted along x, so that near ones are neighbours. Where the ground repeats, all
/// are in the region, and images of those who are near its border beyond it.
pub(super) struct Places(Vec<(Vec2, usize)>);

impl Places {
    /// Those who are there. O(people log people).
    pub fn at<'b>(tick: i32, bodies: impl Iterator<Item = &'b Body>, torus: Torus) -> Self {
        let place = |(person, body): (usize, &Body)| {
            let root = body.root[frame_at(body, tick)?];
            Some((torus.wrap(Vec2::new(root.x, root.z)), person))
        };
        let mut all: Vec<(Vec2, usize)> = bodies.enumerate().filter_map(place).collect();
        if !torus.is_plane() {
            let images = all.iter().flat_map(|&(p, person)| torus.images(p, TOUCHING_HIPS).map(move |q| (q, person)));
            all = images.collect();
        }
        all.sort_unstable_by(|a, b| a.0.x.total_cmp(&b.0.x).then(a.1.cmp(&b.1)));
        Self(all)
    }

    /// People within a distance.
    pub fn near(&self, position: Vec2, distance: f32) -> impl Iterator<Item = usize> {
        let first = self.0.partition_point(|(p, _)| p.x < position.x - distance);
        let row = self.0[first..].iter().take_while(move |(p, _)| p.x <= position.x + distance);
        row.filter(move |(p, _)| p.distance_squared(position) <= distance * distance).map(|&(_, person)| person)
    }

    /// Calls `meet` with the figures of all pairs of people whose hips are near enough for them to touch, somebody new in
    /// each pair. `figure` is asked only for those, once.
    pub fn pairs(
        &self,
        is_new: &[bool],
        figure: impl Fn(usize) -> Option<Figure>,
        mut meet: impl FnMut((usize, &Figure), (usize, &Figure)),
    ) {
        let figures: Vec<OnceCell<Option<Figure>>> = self.0.iter().map(|_| OnceCell::new()).collect();
        let image = |(place, person): (Vec2, usize)| {
            let figure = figure(person)?;
            let by = place - figure.center;
            Some(if by == Vec2::ZERO { figure } else { figure.moved(by) })
        };
        let figure = |i: usize| figures[i].get_or_init(|| image(self.0[i])).as_ref();
        for (i, &(here, a)) in self.0.iter().enumerate() {
            let reached = self.0[i + 1..].iter().take_while(|(there, _)| there.x - here.x <= TOUCHING_HIPS);
            for (k, &(there, b)) in reached.enumerate() {
                if !(is_new[a] || is_new[b]) || a == b || here.distance_squared(there) > TOUCHING_HIPS * TOUCHING_HIPS {
                    continue;
                }
                if let (Some(first), Some(second)) = (figure(i), figure(i + 1 + k)) {
                    meet((a, first), (b, second));
                }
            }
        }
    }
}

/// The frame of a body's motion at a tick, if it is there.
pub(super) fn frame_at(body: &Body, tick: i32) -> Option<usize> {
    usize::try_from(tick - body.begin as i32).ok().filter(|&f| f < body.root.len())
}
