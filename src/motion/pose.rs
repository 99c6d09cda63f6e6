//! How far two full-body poses are apart: the operator of eq. 4 of "Tiling Motion Patches" (2013), which ignores
//! horizontal translation and rotation about the vertical axis. As there, it is the point-cloud distance of motion
//! graphs (Kovar, Gleicher, Pighin 2002), whose best alignment has a closed form; here in metres (root mean square
//! over the points), all points weighing the same.

use glam::{Vec2, Vec3};

use super::Motion;
use super::skeleton::canonical;
use crate::geom::{Ground, Turn};

/// The points that stand for a body: all joints and the tips of hands, feet and head.
pub fn points(motion: &Motion, frame: usize) -> Vec<Vec3> {
    let mut globals = Vec::new();
    motion.globals(frame, &mut globals);
    let tips = canonical().joints.iter().zip(&globals).filter_map(|(j, g)| Some(g.0 + g.1 * j.tip?));
    let tips: Vec<Vec3> = tips.collect();
    globals.iter().map(|g| g.0).chain(tips).collect()
}

/// Distance in metres of frame `i` of `a` to frame `j` of `b`: root mean square over the body's points after the
/// best horizontal translation and turn about the vertical.
pub fn distance(a: &Motion, i: usize, b: &Motion, j: usize) -> f32 {
    cloud_distance(&points(a, i), &points(b, j))
}

/// As [`distance`], over a window of `2 * half + 1` frames around each (clamped to the motions), aligned as one, so
/// that speeds count as well as poses.
pub fn window_distance(a: &Motion, i: usize, b: &Motion, j: usize, half: usize) -> f32 {
    cloud_distance(&window(a, i, half), &window(b, j, half))
}

/// The points of all frames of the window around `frame`; frames beyond an end repeat the end.
pub fn window(motion: &Motion, frame: usize, half: usize) -> Vec<Vec3> {
    let last = motion.len() - 1;
    (0..=2 * half).flat_map(|k| points(motion, (frame + k).saturating_sub(half).min(last))).collect()
}

/// Root mean square distance in metres of two point clouds of one length, best aligned on the ground.
pub fn cloud_distance(a: &[Vec3], b: &[Vec3]) -> f32 {
    let a_from_b = alignment(a, b);
    let sum: f32 = a.iter().zip(b).map(|(&p, &q)| (p - a_from_b.apply3(q)).length_squared()).sum();
    (sum / a.len().max(1) as f32).sqrt()
}

/// The turn and move on the ground that brings `b` nearest to `a` in the least-squares sense.
pub fn alignment(a: &[Vec3], b: &[Vec3]) -> Ground {
    let ground = |p: &Vec3| Vec2::new(p.x, p.z);
    let n = a.len().max(1) as f32;
    let mean = |cloud: &[Vec3]| cloud.iter().map(ground).sum::<Vec2>() / n;
    let (mean_a, mean_b) = (mean(a), mean(b));
    // With ground points as complex numbers, the best turn is the direction of sum conj(q) p.
    let (mut along, mut across) = (0.0, 0.0);
    for (p, q) in a.iter().zip(b) {
        let (p, q) = (ground(p) - mean_a, ground(q) - mean_b);
        along += q.dot(p);
        across += q.y * p.x - q.x * p.y;
    }
    let heading = f32::atan2(across, along);
    Ground::new(mean_a - Turn::from_angle(heading).apply(mean_b), heading)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud() -> Vec<Vec3> {
        (0..20).map(|i| Vec3::new((i as f32 * 1.7).sin(), i as f32 * 0.09, (i as f32 * 0.9).cos())).collect()
    }

    #[test]
    fn a_turned_and_moved_copy_is_at_distance_zero() {
        let a = cloud();
        for heading in [-3.0, -0.4, 0.0, 1.0, 2.5] {
            let ground = Ground::new(Vec2::new(3.0, -7.0), heading);
            let b: Vec<Vec3> = a.iter().map(|&p| ground.apply3(p)).collect();
            assert!(cloud_distance(&a, &b) < 1e-5, "{heading}");
        }
    }

    #[test]
    fn heights_count_and_no_other_alignment_is_better() {
        let a = cloud();
        let raised: Vec<Vec3> = a.iter().map(|&p| p + Vec3::Y * 0.25).collect();
        assert!((cloud_distance(&a, &raised) - 0.25).abs() < 1e-5);
        let b: Vec<Vec3> = a.iter().rev().map(|&p| p * 1.1).collect();
        let best = alignment(&a, &b);
        let cost = |g: Ground| a.iter().zip(&b).map(|(&p, &q)| (p - g.apply3(q)).length_squared()).sum::<f32>();
        for (dx, dz, dh) in [(0.01, 0.0, 0.0), (0.0, -0.01, 0.0), (0.0, 0.0, 0.01), (0.0, 0.0, -0.01)] {
            let near = Ground::new(best.position + Vec2::new(dx, dz), best.heading + dh);
            assert!(cost(near) > cost(best));
        }
    }
}
