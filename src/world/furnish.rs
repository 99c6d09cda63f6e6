//! Puts objects and people at random places of a frame-patch, where walkers can pass them.

use glam::Vec2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::shape::Obstacle;
use super::{FramePatch, Limits, PatternType, Shape, Standing, StaticObject};
use crate::Result;

/// Objects stay this far from borders, metres: nobody is cut off from where they cross.
const FROM_BORDER: f32 = 1.2;
/// Tries before a thing is left out.
const TRIES: usize = 60;

impl FramePatch {
    /// Adds an object `make(place, angle)` at a random place at least 1.2 m from the border, off the crossings, with room to
    /// pass other things. Returns whether there was room.
    pub fn scatter_object(
        &mut self,
        name: &str,
        make: impl Fn(Vec2, f32) -> Shape,
        limits: &Limits,
        rng: &mut ChaCha8Rng,
    ) -> bool {
        let Some(shape) = self.find_room(make, limits, rng) else { return false };
        self.objects.push(StaticObject { name: name.into(), shape });
        true
    }

    /// Adds a person who stays within `radius` of a random place. Returns whether there was room.
    pub fn scatter_person(&mut self, name: &str, radius: f32, limits: &Limits, rng: &mut ChaCha8Rng) -> bool {
        let heading = std::cell::Cell::new(0.0);
        let make = |at: Vec2, angle: f32| {
            heading.set(angle);
            Shape::disc(at, radius)
        };
        let Some(Shape::Disc { centre, .. }) = self.find_room(make, limits, rng) else { return false };
        self.people.push(Standing { name: name.into(), position: centre, heading: heading.get(), radius, role: None });
        true
    }

    pub(super) fn find_room(
        &self,
        make: impl Fn(Vec2, f32) -> Shape,
        limits: &Limits,
        rng: &mut ChaCha8Rng,
    ) -> Option<Shape> {
        let least = self.outline.iter().copied().fold(Vec2::INFINITY, Vec2::min);
        let most = self.outline.iter().copied().fold(Vec2::NEG_INFINITY, Vec2::max);
        let others = self.obstacles(limits);
        (0..TRIES).find_map(|_| {
            let at = least + (most - least) * Vec2::new(rng.random(), rng.random());
            let shape = make(at, rng.random::<f32>() * std::f32::consts::TAU);
            (self.room_at_borders(&shape)
                && self.misplaced(&shape, limits).is_none()
                && passable(&shape, &others, limits))
            .then_some(shape)
        })
    }

    fn room_at_borders(&self, shape: &Shape) -> bool {
        let own = Obstacle::new(shape, 0.0);
        (0..self.outline.len())
            .map(|edge| self.border(edge))
            .all(|border| (own.support(-border.inward) - border.begin).dot(border.inward) >= f64::from(FROM_BORDER))
    }

    /// A test patch: a square of 8 m with a period of 10 s and `n` people in and out, split evenly over its borders,
    /// up to four objects and up to three standing people, by `seed`.
    ///
    /// # Errors
    /// If there is no room for so many.
    pub fn sample(n: usize, seed: u64) -> Result<Self> {
        use rand::SeedableRng;
        let share = |edge: usize| n / 4 + usize::from(edge < n % 4);
        // What is left over comes in on the first edges and goes out on the last.
        let types = std::array::from_fn(|edge| PatternType::mixed(share(edge), share(3 - edge)));
        let mut frame = Self::random_square(8.0, 10.0, &types, seed)?;
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x5ca7);
        let limits = Limits::default();
        for _ in 0..rng.random_range(0..=4) {
            if rng.random::<bool>() {
                let radius = rng.random_range(0.15..0.6);
                frame.scatter_object("tree", |at, _| Shape::disc(at, radius), &limits, &mut rng);
            } else {
                let size = Vec2::new(rng.random_range(0.6..1.8), rng.random_range(0.3..0.7));
                frame.scatter_object("bench", |at, angle| Shape::oblong(at, size, angle), &limits, &mut rng);
            }
        }
        for _ in 0..rng.random_range(0..=3) {
            frame.scatter_person("stand", 0.3, &limits, &mut rng);
        }
        Ok(frame)
    }
}

/// Whether two people can pass between `shape` and all `others`.
fn passable(shape: &Shape, others: &[Obstacle], limits: &Limits) -> bool {
    let own = Obstacle::new(shape, f64::from(limits.radius));
    others.iter().all(|other| own.gap(other) >= 0.2)
}
