//! Planted feet that stay: after retargeting to other bones, and in the capture itself, planted feet drift by some
//! centimetres and stand a little above or below the floor. Legs are bent so that every plant's ball stays in one
//! place at its canonical height; in between the correction passes smoothly from one plant to the next.

use glam::{Quat, Vec3};

use super::build::smooth;
use super::floor::{PLANTED, lift_toe};
use crate::motion::ik::two_bone;
use crate::motion::skeleton::joint::*;
use crate::motion::{FPS, Foot, JOINT_COUNT, Motion, Plant, plants};

/// Part of a leg's length that may be used.
const STRETCH: f32 = 0.998;
/// Length of thigh and shin, metres.
const LEG: f32 = super::CANONICAL_LEG;
/// The hips sink by at most this to let both feet reach, metres.
const MAX_DROP: f32 = 0.04;
/// Smoothing of that sinking, seconds.
const DROP_SIGMA: f32 = 0.07;

/// Least height of the ball of a foot that is not planted, metres.
const LEAST: f32 = 0.0;

/// Hip joint, knee, ankle, ball of each leg.
const LEGS: [(Foot, [usize; 4]); 2] = [
    (Foot::Left, [LEFT_UP_LEG, LEFT_LEG, LEFT_FOOT, LEFT_TOE]),
    (Foot::Right, [RIGHT_UP_LEG, RIGHT_LEG, RIGHT_FOOT, RIGHT_TOE]),
];

/// Pins the planted feet of a motion. O(frames).
pub(super) fn pin(motion: &mut Motion) {
    let targets = LEGS.map(|(foot, leg)| {
        let planted: Vec<Plant> = motion.plants.iter().filter(|p| p.foot == foot).copied().collect();
        let ball = plants::trajectory(motion, leg[3]);
        let mut moves = corrections(&ball, &planted);
        keep_above(&ball, &mut moves, &planted);
        let ankle = plants::trajectory(motion, leg[2]);
        ankle.iter().zip(moves).map(|(&p, by)| p + by).collect::<Vec<Vec3>>()
    });
    drop_hips(motion, &targets);
    let mut globals = Vec::with_capacity(JOINT_COUNT);
    for frame in 0..motion.len() {
        motion.globals(frame, &mut globals);
        let facing = motion.path.at(frame).rotation() * Vec3::Z;
        let pose = &mut motion.rotations[frame * JOINT_COUNT..(frame + 1) * JOINT_COUNT];
        for ((_, leg), ankle) in LEGS.iter().zip(&targets) {
            bend_leg(pose, &globals, *leg, ankle[frame], facing);
        }
    }
}

/// How far the foot is to be moved at every frame: at plants, to the plant's mean place at the canonical height;
/// between plants, smoothly from one's last to the next one's first.
fn corrections(ball: &[Vec3], planted: &[Plant]) -> Vec<Vec3> {
    let mut known: Vec<(usize, Vec3)> = Vec::new();
    for p in planted {
        let frames = p.begin as usize..=p.end as usize;
        let mut anchor = ball[frames.clone()].iter().sum::<Vec3>() / (p.end - p.begin + 1) as f32;
        anchor.y = PLANTED;
        known.extend(frames.map(|f| (f, anchor - ball[f])));
    }
    let (Some(&first), Some(&last)) = (known.first(), known.last()) else { return vec![Vec3::ZERO; ball.len()] };
    let mut out = vec![first.1; ball.len()];
    for pair in known.windows(2) {
        let [(a, from), (b, to)] = [pair[0], pair[1]];
        for (f, slot) in out.iter_mut().enumerate().take(b + 1).skip(a) {
            let t = (f - a) as f32 / (b - a).max(1) as f32;
            *slot = from.lerp(to, t * t * (3.0 - 2.0 * t));
        }
    }
    out[last.0..].fill(last.1);
    out
}

/// Raises a foot that is not planted where its ball would sink below [`LEAST`].
fn keep_above(ball: &[Vec3], moves: &mut [Vec3], planted: &[Plant]) {
    let stands = |f: usize| planted.iter().any(|p| (p.begin as usize..=p.end as usize).contains(&f));
    for (f, by) in moves.iter_mut().enumerate().filter(|&(f, _)| !stands(f)) {
        by.y += (LEAST - ball[f].y - by.y).max(0.0);
    }
}

/// Lowers the hips, smoothly, where a leg would be too short for its ankle's new place.
fn drop_hips(motion: &mut Motion, targets: &[Vec<Vec3>; 2]) {
    let mut globals = Vec::with_capacity(JOINT_COUNT);
    let mut drops = vec![0.0f32; motion.len()];
    for (frame, drop) in drops.iter_mut().enumerate() {
        motion.globals(frame, &mut globals);
        for ((foot, [hip, ..]), ankle) in LEGS.iter().zip(targets) {
            let (hip, target) = (globals[*hip].0, ankle[frame]);
            let across = (hip - target).with_y(0.0).length();
            let reach = ((STRETCH * LEG).powi(2) - across * across).max(0.0).sqrt();
            if plants::is_planted(motion, *foot, frame) {
                *drop = drop.max(hip.y - target.y - reach).min(MAX_DROP);
            }
        }
    }
    // The largest drop near a frame, smoothed: enough at the frame itself, gradual around it.
    let near = (2.0 * DROP_SIGMA * FPS).round() as usize;
    let widest =
        |f: usize| drops[f.saturating_sub(near)..(f + near + 1).min(drops.len())].iter().copied().fold(0.0, f32::max);
    let widened: Vec<f32> = (0..drops.len()).map(widest).collect();
    for (height, drop) in motion.heights.iter_mut().zip(smooth(&widened, DROP_SIGMA * FPS)) {
        *height -= drop.max(0.0);
    }
}

/// Moves one ankle to `target`, keeping the foot's direction in space.
fn bend_leg(pose: &mut [Quat], globals: &[(Vec3, Quat)], leg: [usize; 4], target: Vec3, facing: Vec3) {
    let [hip, knee, ankle, ball] = leg;
    let at = |j: usize| globals[j].0;
    if at(ankle).distance(target) < 1e-4 {
        pose[ball] = (pose[ball] * lift_toe(at(ball), globals[ball].1)).normalize();
        return;
    }
    let (swing, bend, reached) = two_bone(at(hip), at(knee), at(ankle), target, facing, STRETCH);
    let (upper, lower) = (swing * globals[hip].1, swing * bend * globals[knee].1);
    let pelvis = globals[HIPS].1;
    pose[hip] = (pelvis.inverse() * upper).normalize();
    pose[knee] = (upper.inverse() * lower).normalize();
    pose[ankle] = (lower.inverse() * globals[ankle].1).normalize();
    pose[ball] = (pose[ball] * lift_toe(at(ball) + reached - at(ankle), globals[ball].1)).normalize();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corrections_hold_at_plants_and_pass_smoothly_between() {
        let ball: Vec<Vec3> = (0..40).map(|f| Vec3::new(0.1, 0.05, 0.002 * f as f32)).collect();
        let plants = [(5, 10), (25, 35)].map(|(begin, end)| Plant { foot: Foot::Left, begin, end });
        let moves = corrections(&ball, &plants);
        for p in plants {
            let places: Vec<Vec3> = (p.begin..=p.end).map(|f| ball[f as usize] + moves[f as usize]).collect();
            assert!(places.iter().all(|q| q.distance(places[0]) < 1e-6 && (q.y - PLANTED).abs() < 1e-6));
        }
        assert!(moves.windows(2).all(|m| m[0].distance(m[1]) < 0.01));
        assert_eq!(corrections(&ball, &[]), vec![Vec3::ZERO; 40]);
    }
}
