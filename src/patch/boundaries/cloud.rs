//! How far two poses are apart when one is to go over into the other: [`crate::motion::pose`]'s distance over a short
//! window, with weights. Arms count little: they can be blended in half a second, whereas feet would slide.

use glam::Vec3;

use crate::motion::joint::{LEFT_ARM, LEFT_HAND, RIGHT_ARM, RIGHT_HAND};
use crate::motion::{JOINT_COUNT, Motion, canonical, mirror, pose};

/// What a point of the elbow, the wrist or the fingertips counts; a shoulder's arm half, everything else one.
const ARM_WEIGHT: f32 = 0.2;
/// Frames by which the neighbours of a pose are before and after it, so that speeds count as well: 0.13 s, in which a
/// walker is 0.17 m ahead of somebody who stands.
const APART: usize = 3;

/// The points of a pose and its neighbours in time, about their middle on the ground, scaled by the roots of their
/// weights; with what all distances share. Flat, so that the inner loop is three running products.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cloud {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    /// Sum of squares of all numbers.
    square: f32,
    /// Sum of the weights.
    total: f32,
}

impl Cloud {
    /// The pose of a frame, and its image in a mirror.
    pub fn pair(motion: &Motion, frame: usize) -> [Self; 2] {
        let points = window(motion, frame);
        let image = mirror::cloud(&points);
        [Self::new(&points), Self::new(&image)]
    }

    /// The pose of a frame.
    pub fn of(motion: &Motion, frame: usize) -> Self {
        Self::new(&window(motion, frame))
    }

    fn new(points: &[Vec3]) -> Self {
        let weights = weights();
        let weighted = || points.iter().zip(weights.iter().cycle());
        let total: f32 = weighted().map(|(_, w)| w).sum();
        let middle = (weighted().map(|(p, w)| *p * *w).sum::<Vec3>() / total).with_y(0.0);
        let scaled: Vec<Vec3> = weighted().map(|(p, w)| (*p - middle) * w.sqrt()).collect();
        let axis = |of: fn(&Vec3) -> f32| scaled.iter().map(of).collect::<Vec<f32>>();
        let square = scaled.iter().map(|p| p.length_squared()).sum();
        Self { x: axis(|p| p.x), y: axis(|p| p.y), z: axis(|p| p.z), square, total }
    }

    /// Root mean square distance of the points after the best move over the ground and turn about the vertical, metres.
    ///
    /// With ground points about their middle as complex numbers, the best turn leaves both sums of squares less twice
    /// the size of the sum of products.
    pub fn distance(&self, other: &Self) -> f32 {
        let (mut along, mut across, mut up) = (0.0, 0.0, 0.0);
        for i in 0..self.x.len() {
            along += self.x[i] * other.x[i] + self.z[i] * other.z[i];
            across += self.x[i] * other.z[i] - self.z[i] * other.x[i];
            up += self.y[i] * other.y[i];
        }
        let left = self.square + other.square - 2.0 * (f32::hypot(along, across) + up);
        (left.max(0.0) / self.total).sqrt()
    }
}

/// The points of a pose and of those around it; beyond an end of the motion the speed there goes on.
fn window(motion: &Motion, frame: usize) -> Vec<Vec3> {
    let last = motion.len() - 1;
    let own = pose::points(motion, frame);
    let side = |other: Option<usize>, opposite: usize| match other {
        Some(other) => pose::points(motion, other),
        None => own.iter().zip(pose::points(motion, opposite.min(last))).map(|(p, q)| 2.0 * *p - q).collect(),
    };
    let before = side(frame.checked_sub(APART), frame + APART);
    let after = side(Some(frame + APART).filter(|&f| f <= last), frame.saturating_sub(APART));
    [before, own.clone(), after].concat()
}

/// Weights of the points of one pose, in the order of [`pose::points`].
fn weights() -> Vec<f32> {
    let weight = |joint: usize| match joint {
        LEFT_ARM | RIGHT_ARM => 0.5,
        j if (LEFT_ARM..=LEFT_HAND).contains(&j) || (RIGHT_ARM..=RIGHT_HAND).contains(&j) => ARM_WEIGHT,
        _ => 1.0,
    };
    let tips = (0..JOINT_COUNT).filter(|&j| canonical().joints[j].tip.is_some());
    (0..JOINT_COUNT).chain(tips).map(weight).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Ground;
    use crate::motion::testing::walking;
    use glam::Vec2;

    /// The same by the definition: align, then measure.
    fn oracle(a: &[Vec3], b: &[Vec3]) -> f32 {
        let weights = weights();
        let cost = |turn: f32| {
            let turned: Vec<Vec3> = b.iter().map(|&p| Ground::new(Vec2::ZERO, turn).apply3(p)).collect();
            let gaps: Vec<Vec3> = a.iter().zip(&turned).map(|(p, q)| *p - *q).collect();
            let weighted = || gaps.iter().zip(weights.iter().cycle());
            let total: f32 = weighted().map(|(_, w)| w).sum();
            let move_by = (weighted().map(|(g, w)| *g * *w).sum::<Vec3>() / total).with_y(0.0);
            weighted().map(|(g, w)| (*g - move_by).length_squared() * w).sum::<f32>() / total
        };
        (0..3600).map(|i| cost(i as f32 / 3600.0 * std::f32::consts::TAU)).fold(f32::INFINITY, f32::min).sqrt()
    }

    #[test]
    fn it_is_the_least_over_all_turns_and_moves() {
        let walk = walking(3.0);
        let points = |f| window(&walk, f);
        for (i, j) in [(10, 10), (10, 20), (33, 71)] {
            let [a, b] = [i, j].map(|f| Cloud::new(&points(f)));
            assert!((a.distance(&b) - oracle(&points(i), &points(j))).abs() < 2e-3, "{i} {j}");
            assert_eq!(a.distance(&b), b.distance(&a));
        }
        let [own, image] = Cloud::pair(&walk, 40);
        assert!(own.distance(&own) < 2e-3 && own.distance(&image) > 0.02);
    }
}
