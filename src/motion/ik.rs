//! Analytic two-bone inverse kinematics: legs onto planted feet, arms onto hands.

use glam::{Quat, Vec3};

/// How far the pole pulls the knee of a nearly straight limb, metres: bent further than this, the limb's own bend rules.
const POLE_PULL: f32 = 0.04;

/// The most a knee or an elbow bends, radians.
const FOLD: f32 = 2.5;

/// Bends and swings a two-bone limb so that its end reaches `target`, or points at it where it is out of reach.
///
/// `hip`, `knee`, `end` are the limb's present global positions (m). The limb keeps its bend plane; `pole` (a global
/// direction) says where the knee points, the more so the straighter the limb is, so that the knee of a limb that
/// straightens and bends again does not flip; where it turns the plane, the upper bone twists with it, since knees and
/// elbows are hinges. `stretch` in (0, 1] is the largest part of the limb's length that may be
/// used, so that knees never lock.
///
/// Returns the global rotations to apply, first to the upper bone and all below it, then to the lower bone
/// (`upper_new = swing * upper`, `lower_new = swing * bend * lower`), and the end's new position.
pub fn two_bone(hip: Vec3, knee: Vec3, end: Vec3, target: Vec3, pole: Vec3, stretch: f32) -> (Quat, Quat, Vec3) {
    let (upper, lower) = ((knee - hip).length(), (end - knee).length());
    let reach = (target - hip).length().max((upper - lower).abs() + 1e-4).min((upper + lower) * stretch);
    let along = (end - hip).normalize_or(Vec3::NEG_Y);
    let toward = (target - hip).normalize_or(along);
    let bulge = (knee - hip).reject_from_normalized(along);
    let pulled = bulge + pole.reject_from_normalized(along) * POLE_PULL;
    let side = (Quat::from_rotation_arc(along, toward) * pulled).reject_from_normalized(toward);
    let side = side.try_normalize().unwrap_or_else(|| toward.any_orthonormal_vector());
    let foot = (upper * upper - lower * lower + reach * reach) / (2.0 * reach);
    let new_knee = hip + toward * foot + side * (upper * upper - foot * foot).max(0.0).sqrt();
    let new_end = hip + toward * reach;
    let swing = rotation_between(knee - hip, new_knee - hip);
    let hinges = [(knee - hip).cross(end - knee), (new_knee - hip).cross(new_end - new_knee)];
    let swing = twist((new_knee - hip) / upper.max(1e-6), swing * hinges[0], hinges[1], bulge.length_squared()) * swing;
    let bend = swing.inverse() * rotation_between(swing * (end - knee), new_end - new_knee) * swing;
    (swing, bend, new_end)
}

/// The middle and end of a two-bone limb from `root` towards `target`, bent towards `pole`.
///
/// At most `stretch` of the limb's length is used; a target further away is pointed at.
pub(crate) fn bend(root: Vec3, target: Vec3, upper: f32, lower: f32, pole: Vec3, stretch: f32) -> (Vec3, Vec3) {
    let line = (target - root).try_normalize().unwrap_or(Vec3::NEG_Y);
    let folded = (upper * upper + lower * lower - 2.0 * upper * lower * (std::f32::consts::PI - FOLD).cos()).sqrt();
    let reach = (target - root).length().clamp(folded, (upper + lower) * stretch);
    let side = (pole - line * pole.dot(line)).try_normalize().unwrap_or_else(|| line.any_orthonormal_vector());
    let along = (upper * upper - lower * lower + reach * reach) / (2.0 * reach);
    let out = (upper * upper - along * along).max(0.0).sqrt();
    (root + line * along + side * out, root + line * reach)
}

/// The turn about the upper bone (its direction) that brings the hinge's axis `from` to `to`, less of it the less the knee was off the
/// line between the ends (`off` is the square of that distance): a straight limb's hinge has no direction to speak of.
fn twist(bone: Vec3, from: Vec3, to: Vec3, off: f32) -> Quat {
    // Of half the angle, without trigonometry: this runs for every limb of every frame.
    let cosine = from.dot(to) + (from.length_squared() * to.length_squared()).sqrt();
    let sine = from.cross(to).dot(bone);
    let length = (sine * sine + cosine * cosine).sqrt();
    if length < 1e-10 {
        return Quat::IDENTITY;
    }
    // A knee that was bent backwards is turned over by the pole and not by a twist.
    let forwards = (2.0 * cosine * cosine / (length * length)).min(1.0);
    let weight = forwards * off / (off + POLE_PULL * POLE_PULL);
    Quat::from_vec4((bone * sine * weight).extend(length + (cosine - length) * weight)).normalize()
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
    fn knees_stay_hinges_where_the_pole_turns_them() {
        let (hip, knee, end) = (Vec3::ZERO, Vec3::new(0.0, -0.3, 0.25), Vec3::new(0.05, -0.35, -0.1));
        for (pole, target) in [
            (Vec3::X, Vec3::new(0.1, -0.4, 0.0)),
            (Vec3::NEG_X, Vec3::new(-0.2, -0.2, -0.1)),
            (Vec3::new(1.0, 0.0, 1.0), Vec3::new(0.02, -0.2, 0.05)),
            (Vec3::Z, Vec3::new(-0.1, -0.3, -0.2)),
        ] {
            let (swing, _, _) = two_bone(hip, knee, end, target, pole, 0.999);
            let moved = swing * (knee - hip);
            let hinge = moved.cross(target - moved);
            let off = (swing * (knee - hip).cross(end - knee)).angle_between(hinge);
            assert!(off < 3f32.to_radians(), "{pole} {target}: the hinge is off by {} deg", off.to_degrees());
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
