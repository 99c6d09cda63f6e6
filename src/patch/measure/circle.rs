//! The smallest circle around discs.

use std::sync::LazyLock;

use glam::{DVec2, Vec2};

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
        let points: Vec<DVec2> = self.0.iter().filter(|p| p.0.is_finite()).map(|p| p.1).collect();
        smallest(&points).1 as f32
    }
}

/// Middle and radius of the smallest circle around points: whoever lies outside of the circle around those before lies on
/// the edge. O(points cubed) at worst.
fn smallest(points: &[DVec2]) -> (DVec2, f64) {
    let outside = |circle: (DVec2, f64), p: DVec2| circle.0.distance(p) > circle.1 * (1.0 + 1e-9) + 1e-12;
    let mut circle = (points.first().copied().unwrap_or_default(), 0.0);
    for (i, &p) in points.iter().enumerate() {
        if !outside(circle, p) {
            continue;
        }
        circle = (p, 0.0);
        for (j, &q) in points[..i].iter().enumerate() {
            if !outside(circle, q) {
                continue;
            }
            circle = (p.midpoint(q), 0.5 * p.distance(q));
            for &r in &points[..j] {
                if outside(circle, r) {
                    circle = around(p, q, r);
                }
            }
        }
    }
    circle
}

/// The circle through three points; around the two farthest where they lie on a line.
fn around(p: DVec2, q: DVec2, r: DVec2) -> (DVec2, f64) {
    let (a, b) = (q - p, r - p);
    let twice = 2.0 * a.perp_dot(b);
    if twice.abs() < 1e-14 {
        let pairs = [(p, q), (q, r), (p, r)];
        let (s, t) = pairs.into_iter().max_by(|x, y| x.0.distance(x.1).total_cmp(&y.0.distance(y.1))).expect("three");
        return (s.midpoint(t), 0.5 * s.distance(t));
    }
    let to_middle = DVec2::new(
        b.y * a.length_squared() - a.y * b.length_squared(),
        a.x * b.length_squared() - b.x * a.length_squared(),
    ) / twice;
    (p + to_middle, to_middle.length())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The smallest of all circles around two or three of the points that hold all.
    fn tried(points: &[DVec2]) -> f64 {
        let holds = |c: (DVec2, f64)| points.iter().all(|p| c.0.distance(*p) <= c.1 + 1e-7);
        let mut least = f64::INFINITY;
        for (i, &p) in points.iter().enumerate() {
            for (j, &q) in points[..i].iter().enumerate() {
                let pair = (p.midpoint(q), 0.5 * p.distance(q));
                let threes = points[..j].iter().map(|&r| around(p, q, r));
                let radii = threes.chain([pair]).filter(|&c| holds(c)).map(|c| c.1);
                least = radii.fold(least, f64::min);
            }
        }
        least
    }

    proptest! {
        #[test]
        fn it_is_the_smallest_of_all(raw in prop::collection::vec((-3.0f64..3.0, -3.0f64..3.0), 2..12)) {
            let points: Vec<DVec2> = raw.into_iter().map(DVec2::from).collect();
            prop_assert!((smallest(&points).1 - tried(&points)).abs() < 1e-6);
        }

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
    fn nothing_one_point_and_points_on_a_line() {
        assert_eq!(Outline::default().radius(), 0.0);
        let on_line: Vec<DVec2> = [0.0, 1.0, 4.0, 2.0].map(|x| DVec2::new(x, 2.0 * x)).to_vec();
        assert!((smallest(&on_line).1 - 0.5 * 80f64.sqrt()).abs() < 1e-9);
        assert_eq!(smallest(&on_line[..1]).1, 0.0);
    }
}
