//! Analytic two-bone inverse kinematics: legs onto planted feet, arms onto hands.

use glam::{Quat, Vec3};

/// How far the pole pulls the knee of a nearly straight limb, metres: bent further than this, the limb's own bend rules.
const POLE_PULL: f32 = 0.04;

/// Bends and swings a two-bone limb so that its end reaches `target`, or points at it where it is out of reach.
///
/// `hip`, `knee`, `end` are the limb's present global positions (m). The limb keeps its bend plane; `pole` (a global
/// direction) says where the knee points, the more so the straighter the limb is, so that the knee of a limb that
/// straightens and bends again does not flip. `stretch` in (0, 1] is the largest part of the limb's length that may be
/// used, so that knees never lock.
///
/// Returns the global rotations to apply, first to the upper bone and all below it, then to the lower bone
/// (`upper_new = swing * upper`, `lower_new = swing * bend * lower`), and the end's new position.
pub fn two_bone(hip: Vec3, knee: Vec3, end: Vec3, target: Vec3, pole: Vec3, stretch: f32) -> (Quat, Quat, Vec3) {
    let (upper, lower) = ((knee - hip).length(), (end - knee).length());
    let reach = (target - hip).length().max((upper - lower).abs() + 1e-4).min((upper + lower) * stretch);
    let along = (end - hip).normalize_or(Vec3::NEG_Y);
    let toward = (target - hip).normalize_or(along);
    let bulge = (knee - hip).reject_from_normalized(along) + pole.reject_from_normalized(along) * POLE_PULL;
    let side = (Quat::from_rotation_arc(along, toward) * bulge).reject_from_normalized(toward);
    let side = side.try_normalize().unwrap_or_else(|| toward.any_orthonormal_vector());
    let foot = (upper * upper - lower * lower + reach * reach) / (2.0 * reach);
    let new_knee = hip + toward * foot + side * (upper * upper - foot * foot).max(0.0).sqrt();
    let new_end = hip + toward * reach;
    let swing = rotation_between(knee - hip, new_knee - hip);
    let bend = swing.inverse() * rotation_between(swing * (end - knee), new_end - new_knee) * swing;
    (swing, bend, new_end)
}

fn rotation_between(from: Vec3, to: Vec3) -> Quat {
    match (from.try_normalize(), to.try_normalize()) {
        (Some(a), Some(b)) => Quat::from_rotation_arc(a, b),
        _ => Quat::IDENTITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reaches_what_is_in_reach_with_the_knee_towards_the_pole() {
        let hip = Vec3::new(0.1, 0.9, 0.0);
        for (knee, end) in [
            (Vec3::new(0.1, 0.48, 0.0), Vec3::new(0.1, 0.07, 0.0)),
            (Vec3::new(0.1, 0.5, 0.12), Vec3::new(0.1, 0.1, 0.0)),
        ] {
            for target in [Vec3::new(0.2, 0.15, 0.3), Vec3::new(0.1, 0.5, -0.2), Vec3::new(-0.1, 0.2, -0.3)] {
                let (swing, bend, reached) = two_bone(hip, knee, end, target, Vec3::Z, 0.999);
                assert!((reached - target).length() < 1e-4, "{reached} {target}");
                let new_knee = hip + swing * (knee - hip);
                let new_end = new_knee + swing * bend * (end - knee);
                assert!((new_end - reached).length() < 1e-4);
                let foot = (target - hip).normalize();
                let side = (new_knee - hip) - foot * (new_knee - hip).dot(foot);
                assert!(side.dot(swing * Vec3::Z) > 0.0, "knee bends backwards: {side}");
            }
        }
    }

    #[test]
    fn out_of_reach_points_at_the_target() {
        let (_, _, reached) =
            two_bone(Vec3::Y, Vec3::new(0.0, 0.5, 0.05), Vec3::ZERO, Vec3::new(3.0, 1.0, 0.0), Vec3::Z, 0.99);
        assert!((reached - Vec3::Y).normalize().dot(Vec3::X) > 0.9999);
        assert!((reached - Vec3::Y).length() < 1.01);
    }
}
