//! Who touched in the capture still touches: hips that came down for a planted foot take the hands with them, so at the
//! end arms reach for each other again. Each of two hands goes half the way, by inverse kinematics, with a smooth
//! beginning and end.

use std::collections::BTreeMap;

use glam::{Quat, Vec3};

use super::arm::{fade, move_hand};
use super::carry::ground_at;
use super::{Body, Segment};
use crate::geom::Torus;
use crate::motion::BodyPart;
use crate::motion::contacts::palm;
use crate::motion::joint::{HEAD, LEFT_HAND, RIGHT_HAND, SPINE2};
use crate::patch::{Contact, Touch};

/// Frames over which a hand begins and ceases to be led.
const FADE_FRAMES: i32 = 8;
/// Most that a hand is led aside, metres.
const MAX_SHIFT: f32 = 0.15;

/// Somebody's part in an instance.
#[derive(Clone, Copy)]
struct Player<'a> {
    person: usize,
    segment: &'a Segment<'a>,
}

/// Leads touching hands together in all instances, in order of time. Errors below a tenth of a millimetre are left alone.
pub(super) fn restore(people: &[Vec<Segment>], bodies: &mut [Body], torus: Torus) {
    let mut instances: BTreeMap<u32, Vec<Player>> = BTreeMap::new();
    for (person, segments) in people.iter().enumerate() {
        for segment in segments.iter().filter(|s| !s.kind.contacts.is_empty()) {
            instances.entry(segment.placed.instance).or_default().push(Player { person, segment });
        }
    }
    let mut instances: Vec<Vec<Player>> = instances.into_values().collect();
    // By number they would come in another order once instances are numbered anew.
    instances.sort_by_key(|players| (players[0].segment.placed.begin, players[0].person));
    for players in &instances {
        for contact in &players[0].segment.kind.contacts {
            let player = |t: &Touch| players.iter().find(|p| p.segment.placed.role == t.role);
            if let (Some(a), Some(b)) = (player(&contact.a), player(&contact.b)) {
                join(*a, *b, contact, bodies, torus);
            }
        }
    }
}

fn join(a: Player, b: Player, contact: &Contact, bodies: &mut [Body], torus: Torus) {
    let parts = [contact.a.part, contact.b.part];
    let leads = match parts.map(hand_of) {
        [Some(_), Some(_)] => [0.5, -0.5],
        [Some(_), None] => [1.0, 0.0],
        [None, Some(_)] => [0.0, -1.0],
        [None, None] => return,
    };
    let players = [a, b];
    let (first, last) = span(players, contact, bodies);
    let gaps: Vec<Vec3> = (first..=last).map(|f| torus.nearest3(gap(players, parts, f, bodies))).collect();
    if gaps.iter().all(|g| g.length() < 1e-4) {
        return;
    }
    for (k, player) in players.into_iter().enumerate() {
        let (Some(hand), body) = (hand_of(parts[k]), &mut bodies[player.person]) else { continue };
        let (from, to) = presence(body);
        for frame in (first - FADE_FRAMES).max(from)..=(last + FADE_FRAMES).min(to) {
            let gap = gaps[(frame.clamp(first, last) - first) as usize];
            let weight = fade((first - frame).max(frame - last), FADE_FRAMES);
            move_hand(body, (frame - from) as usize, hand, (gap * weight * leads[k]).clamp_length_max(MAX_SHIFT));
        }
    }
}

fn presence(body: &Body) -> (i32, i32) {
    (body.begin as i32, body.begin as i32 + body.root.len() as i32 - 1)
}

/// The frames on which both are seen in contact; the last comes before the first if there are none.
fn span(players: [Player; 2], contact: &Contact, bodies: &[Body]) -> (i32, i32) {
    let (mut first, mut last) = (i32::MIN, i32::MAX);
    for Player { person, segment } in players {
        let begin = segment.kind.fragments[segment.placed.role as usize].begin;
        let frame = |clock: u32| segment.frame_of(clock.saturating_sub(begin) as f32);
        let (from, to) = presence(&bodies[person]);
        first = first.max(frame(contact.begin).ceil() as i32).max(from);
        last = last.min(frame(contact.end).floor() as i32).min(to);
    }
    (first, last)
}

/// From b's touching place to where the capture says it should be, seen from a's.
fn gap(players: [Player; 2], parts: [BodyPart; 2], frame: i32, bodies: &[Body]) -> Vec3 {
    let mut globals = Vec::new();
    let mut now = [Vec3::ZERO; 2];
    let mut then = [Vec3::ZERO; 2];
    for (k, Player { person, segment }) in players.into_iter().enumerate() {
        let body = &bodies[person];
        body.globals((frame - body.begin as i32) as usize, &mut globals);
        now[k] = place_of(parts[k], &globals);
        then[k] = captured(segment, parts[k], frame);
    }
    let turn = Quat::from_rotation_y(turned(players[0].segment, frame));
    (now[1] - now[0]) - turn * (then[1] - then[0])
}

/// Where the part was in the capture at the moment that `frame` shows, in the patch's frame.
fn captured(segment: &Segment, part: BodyPart, frame: i32) -> Vec3 {
    let motion = segment.motion();
    let at = segment.source_frame(frame);
    let (i, t) = (at as usize, at.fract());
    let mut globals = Vec::new();
    let mut place = |f: usize| {
        motion.globals(f.min(motion.len() - 1), &mut globals);
        place_of(part, &globals)
    };
    place(i).lerp(place(i + 1), t)
}

/// How much the placed path is turned against the captured one.
fn turned(segment: &Segment, frame: i32) -> f32 {
    let motion = segment.motion();
    let at = segment.source_frame(frame);
    let i = (at as usize).min(motion.len() - 2);
    let t = at - i as f32;
    let captured = motion.path.headings[i] * (1.0 - t) + motion.path.headings[i + 1] * t;
    ground_at(segment, i, t).heading - captured
}

fn hand_of(part: BodyPart) -> Option<usize> {
    match part {
        BodyPart::LeftHand => Some(LEFT_HAND),
        BodyPart::RightHand => Some(RIGHT_HAND),
        BodyPart::Torso | BodyPart::Head => None,
    }
}

/// The middle of a part that touches.
fn place_of(part: BodyPart, globals: &[(Vec3, Quat)]) -> Vec3 {
    match part {
        BodyPart::LeftHand => palm(globals, LEFT_HAND),
        BodyPart::RightHand => palm(globals, RIGHT_HAND),
        BodyPart::Torso => globals[SPINE2].0,
        BodyPart::Head => globals[HEAD].0 + globals[HEAD].1 * Vec3::new(0.0, 0.11, 0.01),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::JOINT_COUNT;
    use crate::motion::joint::{LEFT_ARM, RIGHT_ARM, RIGHT_FORE_ARM};
    use crate::motion::{Motion, MotionPath, canonical};
    use crate::patch::{Fragment, PatchKind};
    use crate::stage::FragmentUse;

    const FRAMES: usize = 60;

    /// Somebody who stands at `z` m, faces `heading` and holds the right hand out in front.
    fn stander(z: f32, heading: f32) -> Motion {
        let mut pose = [Quat::IDENTITY; JOINT_COUNT];
        pose[LEFT_ARM] = Quat::from_rotation_z(-1.4);
        pose[RIGHT_ARM] = Quat::from_rotation_z(0.9) * Quat::from_rotation_y(0.9);
        pose[RIGHT_FORE_ARM] = Quat::from_rotation_y(0.5);
        Motion {
            path: MotionPath { points: vec![glam::Vec2::new(0.0, z); FRAMES], headings: vec![heading; FRAMES] },
            heights: vec![canonical().joints[0].offset.y; FRAMES],
            rotations: pose.repeat(FRAMES),
            plants: Vec::new(),
        }
    }

    #[test]
    fn hands_meet_again_after_hips_came_down() {
        let hand = |role| Touch { role, part: BodyPart::RightHand };
        let fragment = |motion| Fragment { motion, begin: 0, entry_group: 0, exit_group: 0 };
        let kind = PatchKind {
            name: "shake".into(),
            labels: vec![],
            fragments: vec![fragment(stander(0.0, 0.0)), fragment(stander(0.9, std::f32::consts::PI))],
            contacts: vec![Contact { a: hand(0), b: hand(1), begin: 20, end: 40 }],
            ..PatchKind::default()
        };
        let placed = [0, 1].map(|role| FragmentUse {
            instance: 3,
            role,
            begin: 5,
            end: 5 + FRAMES as i32 - 1,
            points: kind.fragments[role as usize].motion.path.points.clone(),
            headings: kind.fragments[role as usize].motion.path.headings.clone(),
        });
        let people: Vec<Vec<Segment>> = placed.iter().map(|placed| vec![Segment { kind: &kind, placed }]).collect();
        let mut bodies: Vec<Body> = people.iter().map(|s| super::super::refine(s, 100)).collect();
        bodies[0].root.iter_mut().for_each(|p| p.y -= 0.04);
        let before = bodies.clone();
        let players = [0, 1].map(|person| Player { person, segment: &people[person][0] });
        let apart = |bodies: &[Body], frame| gap(players, [BodyPart::RightHand; 2], frame, bodies).length();
        assert!(apart(&bodies, 30) > 0.039);
        restore(&people, &mut bodies, Torus::default());
        for frame in 25..=45 {
            assert!(apart(&bodies, frame) < 1e-3, "frame {frame}: {}", apart(&bodies, frame));
        }
        // Far from the contact nothing changes, and on the way there nothing jumps.
        assert_eq!(bodies[0].pose(0), before[0].pose(0));
        let jumps = (6..64).map(|f| (apart(&bodies, f) - apart(&bodies, f - 1)).abs());
        assert!(jumps.fold(0.0, f32::max) < 0.012);
    }
}
