//! Boxes that stay level: what people carry.

use glam::{Vec2, Vec3};

use super::{Capsule, Ground, Turn, wrap_angle};

/// Place of a thing that stays upright: it moves and turns about the vertical, and neither tips nor rolls.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Upright {
    /// Its middle, metres.
    pub middle: Vec3,
    /// Turn about the vertical in radians; not wrapped.
    pub heading: f32,
}

impl Upright {
    /// Place and heading on the ground.
    pub fn ground(self) -> Ground {
        Ground::new(Vec2::new(self.middle.x, self.middle.z), self.heading)
    }

    /// The place carried by a transform of the ground.
    pub fn carried(self, by: Ground) -> Self {
        Self { middle: by.apply3(self.middle), heading: by.heading + self.heading }
    }

    /// Between this and another place, turning the short way.
    pub fn lerp(self, to: Self, t: f32) -> Self {
        let heading = self.heading + wrap_angle(to.heading - self.heading) * t;
        Self { middle: self.middle.lerp(to.middle, t), heading }
    }

    /// A point of the thing, given from its middle, in the world.
    pub fn apply(self, point: Vec3) -> Vec3 {
        let ground = Turn::from_angle(self.heading).apply(Vec2::new(point.x, point.z));
        self.middle + Vec3::new(ground.x, point.y, ground.y)
    }

    /// A point of the world, seen from the thing.
    pub fn seen_from(self, point: Vec3) -> Vec3 {
        let away = point - self.middle;
        let ground = Turn::from_angle(-self.heading).apply(Vec2::new(away.x, away.z));
        Vec3::new(ground.x, away.y, ground.y)
    }
}

/// A box that stays level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    /// Where it is.
    pub at: Upright,
    /// Half its extents, metres.
    pub half: Vec3,
}

/// Steps of the search for the nearest point of an axis: each leaves two thirds, so that 24 leave 0.1 mm of a metre.
const STEPS: usize = 24;

impl Cuboid {
    /// A box of full extents `size`.
    pub fn new(at: Upright, size: [f32; 3]) -> Self {
        Self { at, half: Vec3::from_array(size) * 0.5 }
    }

    /// Radius of the ball around the middle that holds the box.
    pub fn radius(&self) -> f32 {
        self.half.length()
    }

    /// How deep a capsule is in the box, metres; negative or zero if it is not. Where its axis runs through the box
    /// that is its radius: enough to tell that it is deep.
    pub fn penetration(&self, capsule: &Capsule) -> f32 {
        let reach = self.radius() + capsule.radius + 0.5 * capsule.a.distance(capsule.b);
        if ((capsule.a + capsule.b) * 0.5).distance_squared(self.at.middle) >= reach * reach {
            return 0.0;
        }
        let (a, b) = (self.at.seen_from(capsule.a), self.at.seen_from(capsule.b));
        let apart = |t: f32| {
            let p = a.lerp(b, t);
            (p.abs() - self.half).max(Vec3::ZERO).length_squared()
        };
        // The distance from a convex body along a straight line has one valley.
        let (mut low, mut high) = (0.0f32, 1.0f32);
        for _ in 0..STEPS {
            let third = (high - low) / 3.0;
            if apart(low + third) <= apart(high - third) { high -= third } else { low += third }
        }
        capsule.radius - apart((low + high) * 0.5).sqrt()
    }

    /// How deep two boxes are in each other, metres; negative or zero if they are apart.
    pub fn overlap(&self, other: &Self) -> f32 {
        let across = self.half.y + other.half.y - (self.at.middle.y - other.at.middle.y).abs();
        let between = other.at.ground().position - self.at.ground().position;
        let axes = |c: &Self| [Vec2::X, Vec2::Y].map(|v| c.at.ground().turn().apply(v));
        let shadow = |c: &Self, along: Vec2| {
            let [x, z] = axes(c).map(|a| a.dot(along).abs());
            c.half.x * x + c.half.z * z
        };
        let depth = |along: Vec2| shadow(self, along) + shadow(other, along) - between.dot(along).abs();
        axes(self).into_iter().chain(axes(other)).map(depth).fold(across, f32::min)
    }

    /// The four corners of its ground plan, in order around it.
    pub fn plan(&self) -> [Vec2; 4] {
        let corner = |x: f32, z: f32| self.at.ground().apply(Vec2::new(x * self.half.x, z * self.half.z));
        [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cuboid(v: &[f32]) -> Cuboid {
        let at = Upright { middle: Vec3::new(v[0], v[1], v[2]), heading: v[3] * 3.0 };
        Cuboid::new(at, [v[4].abs() + 0.1, v[5].abs() + 0.1, v[6].abs() + 0.1])
    }

    /// Points all through a box, in the world.
    fn grid(c: &Cuboid, steps: i32) -> Vec<Vec3> {
        let axis = || (0..=steps).map(move |i| 2.0 * i as f32 / steps as f32 - 1.0);
        axis()
            .flat_map(|x| axis().flat_map(move |y| axis().map(move |z| Vec3::new(x, y, z))))
            .map(|p| c.at.apply(p * c.half))
            .collect()
    }

    proptest! {
        #[test]
        fn a_capsule_is_as_deep_as_dense_sampling_says(v in proptest::collection::vec(-1.0f32..1.0, 13)) {
            let c = cuboid(&v);
            let capsule = Capsule { a: Vec3::new(v[7], v[8], v[9]), b: Vec3::new(v[10], v[11], v[12]), radius: 0.3 };
            let axis = (0..=40).map(|i| capsule.a.lerp(capsule.b, i as f32 / 40.0));
            let points = grid(&c, 12);
            let nearest = axis.flat_map(|p| points.iter().map(move |q| p.distance(*q))).fold(f32::INFINITY, f32::min);
            let depth = c.penetration(&capsule);
            // Samples are up to 0.1 m apart.
            prop_assert!(depth >= 0.3 - nearest - 1e-3 || nearest > 0.3, "{depth} {nearest}");
            prop_assert!(depth <= (0.3 - nearest).max(0.0) + 0.1, "{depth} {nearest}");
        }

        #[test]
        fn boxes_overlap_where_a_point_of_one_is_in_the_other(v in proptest::collection::vec(-1.0f32..1.0, 14)) {
            let (a, b) = (cuboid(&v), cuboid(&v[7..]));
            let inside = |c: &Cuboid, p: Vec3| (c.at.seen_from(p).abs() - c.half).max_element() < -1e-4;
            let meet = grid(&a, 8).into_iter().any(|p| inside(&b, p));
            prop_assert!(!meet || a.overlap(&b) > 0.0);
            prop_assert!((a.overlap(&b) - b.overlap(&a)).abs() < 1e-5);
            let apart = a.at.middle.distance(b.at.middle) - a.radius() - b.radius();
            prop_assert!(apart <= 0.0 || a.overlap(&b) <= 0.0);
        }

        #[test]
        fn seen_from_undoes_apply(v in proptest::collection::vec(-1.0f32..1.0, 10)) {
            let p = Vec3::new(v[7], v[8], v[9]);
            let at = cuboid(&v).at;
            prop_assert!(at.seen_from(at.apply(p)).distance(p) < 1e-5);
        }
    }
}
