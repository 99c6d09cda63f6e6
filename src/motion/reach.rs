//! Touch that survives retargeting: bodies of another size, and paths scaled to them, pull hands apart that touched.
//! While two people are in contact their arms are bent so that the palms meet again; before and after, the correction
//! fades in and out.

use glam::{Quat, Vec3};

use super::contacts::palm;
use super::ik::two_bone;
use super::skeleton::joint::*;
use super::take::{TakeContact, Touch};
use super::{BODY_CAPSULES, BodyPart, FPS, JOINT_COUNT, Motion};

/// Palms nearer than this touch, metres between their centres: nothing is changed then.
pub const CLOSE: f32 = 0.05;

/// How long a correction takes to fade in and out, seconds.
const FADE: f32 = 0.3;

/// No palm is moved farther than this, metres: hands that are farther apart do not touch.
const FARTHEST: f32 = 0.25;

/// Part of an arm's length that may be used.
const STRETCH: f32 = 0.995;

/// Bends the arms of people in contact so that who touches still touches. Where both sides are hands each goes half of
/// the way; a hand on a torso or head goes all of it, to the surface. O(contacts x frames).
pub fn keep(motions: &mut [Motion], contacts: &[TakeContact]) {
    for contact in contacts {
        let people = [contact.a.person, contact.b.person];
        if people[0] == people[1] || people.iter().any(|&p| p >= motions.len()) {
            continue;
        }
        let frames = people.iter().map(|&p| motions[p].len()).min().unwrap_or(0);
        let pulls: Vec<[Vec3; 2]> = (0..frames).map(|f| pull(motions, contact, f)).collect();
        let (begin, end) = (contact.begin * FPS, contact.end * FPS);
        for (side, touch) in [contact.a, contact.b].into_iter().enumerate() {
            let Some(hand) = hand_of(touch.part) else { continue };
            for frame in 0..frames {
                // Outside of the contact the pull at its nearer end fades.
                let within = (frame as f32).clamp(begin, end.max(begin));
                let away = (frame as f32 - within).abs() / (FADE * FPS);
                let at = (within.round() as usize).min(frames - 1);
                if away < 1.0 {
                    let fade = 1.0 - away * away * (3.0 - 2.0 * away);
                    move_palm(&mut motions[touch.person], frame, hand, pulls[at][side] * fade);
                }
            }
        }
    }
}

/// How far apart what touches is, beyond [`CLOSE`], at every frame of a contact, metres.
pub fn misses(motions: &[Motion], contact: &TakeContact) -> Vec<f32> {
    let frames = [contact.a.person, contact.b.person].map(|p| motions[p].len());
    let last = frames[0].min(frames[1]).saturating_sub(1);
    let span = (contact.begin * FPS).round() as usize..=((contact.end * FPS).round() as usize).min(last);
    span.map(|f| (gap(motions, contact, f).length() - CLOSE).max(0.0)).collect()
}

fn hand_of(part: BodyPart) -> Option<usize> {
    match part {
        BodyPart::LeftHand => Some(LEFT_HAND),
        BodyPart::RightHand => Some(RIGHT_HAND),
        BodyPart::Torso | BodyPart::Head => None,
    }
}

/// How the palms of both sides have to move to touch; nothing if they are too far apart.
fn pull(motions: &[Motion], contact: &TakeContact, frame: usize) -> [Vec3; 2] {
    let gap = gap(motions, contact, frame);
    let (length, share) = (gap.length(), [contact.a, contact.b].map(|t| hand_of(t.part).is_some() as u8 as f32));
    if length <= CLOSE || length > FARTHEST || share == [0.0; 2] {
        return [Vec3::ZERO; 2];
    }
    let need = gap * (1.0 - CLOSE / length) / (share[0] + share[1]);
    [need * share[0], -need * share[1]]
}

/// From where one side touches to where the other does.
fn gap(motions: &[Motion], contact: &TakeContact, frame: usize) -> Vec3 {
    let mut globals = [Vec::new(), Vec::new()];
    for (out, touch) in globals.iter_mut().zip([contact.a, contact.b]) {
        motions[touch.person].globals(frame, out);
    }
    let place = |touch: Touch, own: &[(Vec3, Quat)]| hand_of(touch.part).map(|hand| palm(own, hand));
    match (place(contact.a, &globals[0]), place(contact.b, &globals[1])) {
        (Some(a), Some(b)) => b - a,
        (Some(a), None) => on_body(a, contact.b.part, &globals[1]) - a,
        (None, Some(b)) => b - on_body(b, contact.a.part, &globals[0]),
        (None, None) => Vec3::ZERO,
    }
}

/// The point of a torso's or head's surface that is nearest to a palm; the palm itself where it is inside.
fn on_body(palm: Vec3, part: BodyPart, globals: &[(Vec3, Quat)]) -> Vec3 {
    let capsules = if part == BodyPart::Head { 3..4 } else { 0..3 };
    let at = |(joint, offset): (usize, Vec3)| globals[joint].0 + globals[joint].1 * offset;
    let nearest = BODY_CAPSULES[capsules].iter().map(|c| {
        let (a, b) = (at(c.a), at(c.b));
        let along = ((palm - a).dot(b - a) / (b - a).length_squared().max(1e-9)).clamp(0.0, 1.0);
        let centre = a.lerp(b, along);
        let away = palm - centre;
        if away.length() <= c.radius { palm } else { centre + away * (c.radius / away.length()) }
    });
    nearest.min_by(|p, q| p.distance(palm).total_cmp(&q.distance(palm))).expect("bodies have capsules")
}

/// Moves a palm by bending the arm; the hand keeps its direction in space.
pub(super) fn move_palm(motion: &mut Motion, frame: usize, hand: usize, by: Vec3) {
    if by.length() < 1e-4 {
        return;
    }
    let (arm, fore_arm) = (hand - 2, hand - 1);
    let mut globals = Vec::with_capacity(JOINT_COUNT);
    motion.globals(frame, &mut globals);
    let at = |j: usize| globals[j].0;
    // The elbow stays on its side, so that the smallest correction is the smallest turn; straight arms bend theirs down.
    let along = (at(hand) - at(arm)).normalize_or(Vec3::NEG_Y);
    let bulge = (at(fore_arm) - at(arm)).reject_from_normalized(along);
    let pole = bulge.try_normalize().unwrap_or(motion.path.at(frame).rotation() * Vec3::new(0.0, -1.0, -0.5));
    let (swing, bend, _) = two_bone(at(arm), at(fore_arm), at(hand), at(hand) + by, pole, STRETCH);
    let (upper, lower) = (swing * globals[arm].1, swing * bend * globals[fore_arm].1);
    let pose = &mut motion.rotations[frame * JOINT_COUNT..(frame + 1) * JOINT_COUNT];
    let shoulder = globals[arm - 1].1;
    pose[arm] = (shoulder.inverse() * upper).normalize();
    pose[fore_arm] = (upper.inverse() * lower).normalize();
    pose[hand] = (lower.inverse() * globals[hand].1).normalize();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::testing::standing;
    use glam::Vec2;

    /// Two people who face each other with a hand held out, the palms `gap` apart.
    fn facing(gap: f32) -> (Vec<Motion>, TakeContact) {
        // How far the other's palm is in front of one's own, wherever the hands are held.
        let person = |z: f32, heading: f32| {
            let mut motion = standing(3.0);
            motion.path.points.iter_mut().for_each(|p| *p = Vec2::new(0.0, z));
            motion.path.headings.iter_mut().for_each(|h| *h = heading);
            for pose in motion.rotations.chunks_exact_mut(JOINT_COUNT) {
                pose[RIGHT_ARM] = Quat::from_rotation_y(0.8) * Quat::from_rotation_z(0.5);
                pose[RIGHT_FORE_ARM] = Quat::from_rotation_y(1.3);
            }
            motion
        };
        let mut motions = vec![person(0.0, 0.0), person(1.0, std::f32::consts::PI)];
        let mut globals = [Vec::new(), Vec::new()];
        motions[0].globals(0, &mut globals[0]);
        motions[1].globals(0, &mut globals[1]);
        let between = palm(&globals[1], RIGHT_HAND) - palm(&globals[0], RIGHT_HAND);
        let shift = Vec2::new(-between.x, gap - between.z);
        assert!(between.y.abs() < 1e-4, "hands at one height: {between}");
        motions[1].path.points.iter_mut().for_each(|p| *p += shift);
        let touch = |person| Touch { person, part: BodyPart::RightHand };
        (motions, TakeContact { a: touch(0), b: touch(1), begin: 1.0, end: 2.0 })
    }

    #[test]
    fn hands_that_were_pulled_apart_touch_again_and_fade() {
        let (mut motions, contact) = facing(0.15);
        let before = motions.clone();
        assert!(misses(&motions, &contact).iter().all(|m| (m - 0.10).abs() < 1e-3));
        keep(&mut motions, std::slice::from_ref(&contact));
        assert!(misses(&motions, &contact).iter().all(|&m| m < 1e-3), "{:?}", misses(&motions, &contact));
        let turned = |frame: usize| motions[0].pose(frame)[RIGHT_ARM].angle_between(before[0].pose(frame)[RIGHT_ARM]);
        assert_eq!((turned(0), turned(80)), (0.0, 0.0), "far from the contact nothing changes");
        let steps: Vec<f32> = (0..89).map(|f| (turned(f + 1) - turned(f)).abs()).collect();
        assert!(steps.iter().all(|&s| s < 0.05), "smooth on and off: {steps:?}");
        assert!(turned(25) > 0.0 && turned(25) < turned(30));
    }

    #[test]
    fn hands_that_touch_or_never_did_are_left_alone() {
        for gap in [0.03, -0.02, 0.4] {
            let (mut motions, contact) = facing(gap);
            let before = motions.clone();
            keep(&mut motions, &[contact]);
            assert_eq!(motions, before);
        }
    }

    #[test]
    fn a_hand_on_a_body_reaches_its_surface() {
        let (mut motions, mut contact) = facing(0.0);
        contact.b.part = BodyPart::Torso;
        // Step nearer until the hand is some way off the other's chest.
        while misses(&motions, &contact)[0] > 0.08 {
            motions[1].path.points.iter_mut().for_each(|p| p.y -= 0.01);
        }
        let before = misses(&motions, &contact)[10];
        assert!(before > 0.05, "{before}");
        keep(&mut motions, std::slice::from_ref(&contact));
        assert!(misses(&motions, &contact)[10] < 1e-3, "{:?}", misses(&motions, &contact));
    }
}
