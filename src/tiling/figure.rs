//! A final body at one moment, as it is tested: its capsules, and the disc on the ground that covers them.

use glam::{Quat, Vec2, Vec3};

use super::domain::{Domain, Spot};
use crate::geom::{Capsule, Torus};
use crate::motion::{BODY_CAPSULES, JOINT_COUNT, Skeleton, shape};
use crate::refine::Body;

/// No body reaches further from its hips than this, metres.
pub(super) const REACH: f32 = 1.1;
/// Interpenetration that is let pass, metres.
pub(super) const TOLERANCE: f32 = 0.005;

/// A body's shape.
#[derive(Clone)]
pub(super) struct Figure {
    /// What it is made of.
    pub capsules: [Capsule; PARTS],
    /// Where the hips are.
    pub center: Vec2,
    /// Distance from there of the farthest point.
    pub radius: f32,
    balls: Balls,
}

/// Number of capsules.
const PARTS: usize = BODY_CAPSULES.len();

/// A ball around each capsule, coordinate by coordinate, so that many are compared at once.
#[derive(Clone, Copy)]
struct Balls {
    x: [f32; PARTS],
    y: [f32; PARTS],
    z: [f32; PARTS],
    radius: [f32; PARTS],
}

impl Balls {
    fn around(capsules: &[Capsule; PARTS]) -> Self {
        let mut balls = Self { x: [0.0; PARTS], y: [0.0; PARTS], z: [0.0; PARTS], radius: [0.0; PARTS] };
        for (i, c) in capsules.iter().enumerate() {
            let middle = (c.a + c.b) * 0.5;
            (balls.x[i], balls.y[i], balls.z[i]) = middle.into();
            balls.radius[i] = c.a.distance(c.b) * 0.5 + c.radius;
        }
        balls
    }

    fn middle(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    /// One bit for each ball that another one enters.
    fn near(&self, to: Vec3, radius: f32) -> u32 {
        let mut bits = 0;
        let mut is_near = [0u32; PARTS];
        for (i, is_near) in is_near.iter_mut().enumerate() {
            let (x, y, z) = (self.x[i] - to.x, self.y[i] - to.y, self.z[i] - to.z);
            let reach = self.radius[i] + radius;
            *is_near = u32::from(x * x + y * y + z * z < reach * reach);
        }
        for (i, near) in is_near.into_iter().enumerate() {
            bits |= near << i;
        }
        bits
    }
}

impl Figure {
    /// The body whose joints' global transforms are given.
    pub fn new(globals: &[(Vec3, Quat)]) -> Self {
        let capsules = shape(globals);
        let ground = |v: Vec3| Vec2::new(v.x, v.z);
        let center = ground(globals[0].0);
        let mut radius = 0.0f32;
        for c in &capsules {
            let far = ground(c.a).distance_squared(center).max(ground(c.b).distance_squared(center));
            radius = radius.max(far.sqrt() + c.radius);
        }
        Self { balls: Balls::around(&capsules), capsules, center, radius }
    }

    /// A body of the given bones at a frame of its motion.
    pub fn at(body: &Body, bones: &Skeleton, frame: usize) -> Self {
        let mut globals = [(Vec3::ZERO, Quat::IDENTITY); JOINT_COUNT];
        bones.place(body.root[frame], body.pose(frame), &mut globals);
        Self::new(&globals)
    }

    /// The same at a tick, if it is there.
    pub fn of(body: &Body, bones: &Skeleton, tick: i32) -> Option<Self> {
        Some(Self::at(body, bones, frame_at(body, tick)?))
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
        self.balls = Balls::around(&self.capsules);
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
        let mut deepest = 0.0f32;
        let reach = self.radius + other.radius;
        if self.center.distance_squared(other.center) >= reach * reach {
            return deepest;
        }
        for (i, a) in self.capsules.iter().enumerate() {
            let mut near = other.balls.near(self.balls.middle(i), self.balls.radius[i]);
            while near != 0 {
                let b = &other.capsules[near.trailing_zeros() as usize];
                near &= near - 1;
                deepest = deepest.max(a.penetration(b));
            }
        }
        deepest
    }
}

/// Figures of one body at some of its frames, each made when it is first asked for.
#[derive(Default)]
pub(super) struct Figures {
    /// One more than where a frame's figure is; 0 for none yet.
    slots: Vec<u32>,
    made: Vec<Figure>,
}

impl Figures {
    /// Forgets all, for another body.
    pub fn begin(&mut self, frames: usize) {
        self.made.clear();
        self.slots.clear();
        self.slots.resize(frames, 0);
    }

    /// The figure at a frame.
    pub fn at(&mut self, body: &Body, bones: &Skeleton, frame: usize) -> &Figure {
        if self.slots[frame] == 0 {
            self.made.push(Figure::at(body, bones, frame));
            self.slots[frame] = self.made.len() as u32;
        }
        &self.made[self.slots[frame] as usize - 1]
    }
}

/// The frame of a body's motion at a tick, if it is there.
pub(super) fn frame_at(body: &Body, tick: i32) -> Option<usize> {
    usize::try_from(tick - body.begin as i32).ok().filter(|&f| f < body.root.len())
}
