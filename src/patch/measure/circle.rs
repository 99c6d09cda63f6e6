//! The outline of many discs, as wide as the smallest circle around them.

use std::sync::LazyLock;

use glam::{DVec2, Vec2};

use crate::geom::{Disc, smallest_circle};

/// How many directions an outline is looked at from: the circle is at most a part in 800 too small.
const DIRECTIONS: usize = 64;

static FACING: LazyLock<[DVec2; DIRECTIONS]> =
    LazyLock::new(|| std::array::from_fn(|i| DVec2::from_angle(std::f64::consts::TAU * i as f64 / DIRECTIONS as f64)));

/// The points of a set of discs that are outermost in a number of directions. Constant memory however many there are.
#[derive(Clone, Debug)]
pub(super) struct Outline([(f64, DVec2); DIRECTIONS]);

impl Default for Outline {
    fn default() -> Self {
        Self([(f64::NEG_INFINITY, DVec2::ZERO); DIRECTIONS])
    }
}

impl Outline {
    pub fn add(&mut self, middle: Vec2, radius: f32) {
        let (middle, radius) = (middle.as_dvec2(), f64::from(radius));
        for (outermost, facing) in self.0.iter_mut().zip(FACING.iter()) {
            let reach = middle.dot(*facing) + radius;
            if reach > outermost.0 {
                *outermost = (reach, middle + radius * *facing);
            }
        }
    }

    pub fn unite(&mut self, other: &Self) {
        for (mine, theirs) in self.0.iter_mut().zip(&other.0) {
            if theirs.0 > mine.0 {
                *mine = *theirs;
            }
        }
    }

    /// Radius of the smallest circle around all; 0 around nothing.
    pub fn radius(&self) -> f32 {
        let points: Vec<Disc> = self.0.iter().filter(|p| p.0.is_finite()).map(|p| (p.1, 0.0)).collect();
        smallest_circle(&points).1 as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn discs_lie_inside_to_a_thousandth(raw in prop::collection::vec((-3.0f32..3.0, -3.0f32..3.0, 0.01f32..0.5), 1..12)) {
            let mut outline = Outline::default();
            raw.iter().for_each(|&(x, y, r)| outline.add(Vec2::new(x, y), r));
            let radius = outline.radius();
            // As wide as the farthest two, and no wider than a circle about the middle of all.
            let farthest = raw.iter().flat_map(|a| raw.iter().map(move |b| {
                let apart = Vec2::new(a.0 - b.0, a.1 - b.1).length();
                0.5 * (apart + a.2 + b.2)
            })).fold(0.0, f32::max);
            prop_assert!(radius >= farthest * 0.998 - 1e-4, "{} {}", radius, farthest);
            prop_assert!(radius <= farthest * 2.0 / 3f32.sqrt() + 1e-4, "{} {}", radius, farthest);
        }
    }

    #[test]
    fn around_nothing_it_is_a_point() {
        assert_eq!(Outline::default().radius(), 0.0);
    }
}
