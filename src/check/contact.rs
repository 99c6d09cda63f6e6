//! Clause 5: people who touch in the capture still touch.

use glam::{Quat, Vec3};

use super::depth::axis_distance;
use super::limits::Limits;
use super::part::Part;
use super::report::{Row, Worst};
use crate::geom::{Capsule, wrap_angle};
use crate::motion::{BodyPart, FPS, joint};
use crate::patch::Touch;
use crate::stage::Crowd;

#[derive(Default)]
struct Contacts {
    position: Worst,
    heading: Worst,
    time: Worst,
    distance: Worst,
}

/// The rows of clause 5. Placement and clocks are held over every contact and over the patch's core; the touching
/// parts over the frames of the crowd that show a contact.
pub(super) fn rows(crowd: &Crowd, parts: &[Part], limits: &Limits) -> Vec<Row> {
    let mut all = Contacts::default();
    for players in by_instance(crowd, parts) {
        for (i, a) in players.iter().enumerate() {
            for b in &players[i + 1..] {
                for (first, last) in held_clocks(a, b) {
                    placement(a, b, first, last, &mut all);
                }
            }
        }
        for contact in players.first().map_or(&[][..], |p| &p.kind.contacts) {
            let player = |t: &Touch| players.iter().find(|p| p.used.role == t.role);
            if let (Some(a), Some(b)) = (player(&contact.a), player(&contact.b)) {
                let sides = [(*a, contact.a.part), (*b, contact.b.part)];
                distances(crowd, sides, contact.begin, contact.end, &mut all.distance);
            }
        }
    }
    vec![
        all.position.row(5, "contact: relative position", limits.contact_position, "m"),
        all.heading.row(5, "contact: relative heading", limits.contact_heading_deg, "deg"),
        all.time.row(5, "contact: relative time", limits.contact_time, "s"),
        all.distance.row(5, "contact: touching parts farther apart", limits.contact_distance, "m"),
    ]
}

fn by_instance<'a, 'b>(crowd: &Crowd, parts: &'b [Part<'a>]) -> Vec<Vec<&'b Part<'a>>> {
    let mut players = vec![Vec::new(); crowd.instances.len()];
    for part in parts {
        players[part.used.instance as usize].push(part);
    }
    players
}

/// The clock ranges over which two people's relative placement must not change.
fn held_clocks(a: &Part, b: &Part) -> Vec<(u32, u32)> {
    let roles = [a.used.role, b.used.role];
    let touching = a.kind.contacts.iter().filter(|c| [c.a.role, c.b.role] == roles || [c.b.role, c.a.role] == roles);
    let mut ranges: Vec<(u32, u32)> = touching.map(|c| (c.begin, c.end)).collect();
    ranges.extend(a.kind.core);
    ranges
}

fn placement(a: &Part, b: &Part, first: u32, last: u32, worst: &mut Contacts) {
    let ((a0, a1), (b0, b1)) = (a.clock_range(), b.clock_range());
    for clock in first.max(a0).max(b0)..=last.min(a1).min(b1) {
        let captured = a.captured_at(clock).inverse().then(b.captured_at(clock));
        let deformed = a.deformed_at(clock).inverse().then(b.deformed_at(clock));
        let place = || format!("clock {clock} of {} with character {}", a.name(), b.character);
        worst.position.offer(captured.position.distance(deformed.position) as f64, place);
        worst.heading.offer((wrap_angle(deformed.heading - captured.heading).abs() as f64).to_degrees(), place);
        let gap = a.frame_at_clock(clock as f64) - b.frame_at_clock(clock as f64);
        worst.time.offer(gap.abs() / FPS as f64, place);
    }
}

fn distances(crowd: &Crowd, sides: [(&Part, BodyPart); 2], first: u32, last: u32, worst: &mut Worst) {
    let [(a, _), (b, _)] = sides;
    let begin = a.frame_at_clock(first as f64).max(b.frame_at_clock(first as f64)).ceil().max(0.0);
    let end = a.frame_at_clock(last as f64).min(b.frame_at_clock(last as f64)).floor();
    let frames = begin as i64..=end.min(crowd.domain.last_frame as f64) as i64;
    let seen = |frame: u32| sides.iter().all(|(p, _)| crowd.characters[p.character].present(frame));
    for frame in frames.map(|f| f as u32).filter(|&f| seen(f)) {
        let [p, q] = sides.map(|(part, touching)| final_place(crowd, part, touching, frame));
        let excess = axis_distance(&p, &q) - captured_distance(sides, frame);
        worst.offer(excess as f64, || format!("frame {frame}, {} with character {}", a.name(), b.character));
    }
}

fn final_place(crowd: &Crowd, part: &Part, touching: BodyPart, frame: u32) -> Capsule {
    let character = &crowd.characters[part.character];
    let mut globals = Vec::new();
    character.globals((frame - character.begin) as usize, &mut globals);
    place_of(touching, &globals)
}

/// Distance in the capture at the moment `frame` shows, between captured frames by interpolation.
fn captured_distance(sides: [(&Part, BodyPart); 2], frame: u32) -> f32 {
    let (begin, end) = sides[0].0.clock_range();
    let clock = sides[0].0.clock_at_frame(frame as f64).clamp(begin as f64, end as f64);
    let at = |clock: u32| {
        let [p, q] = sides.map(|(part, touching)| {
            let (begin, end) = part.clock_range();
            let mut globals = Vec::new();
            part.source.motion.globals((clock.clamp(begin, end) - begin) as usize, &mut globals);
            place_of(touching, &globals)
        });
        axis_distance(&p, &q)
    };
    let t = clock.fract() as f32;
    at(clock.floor() as u32) * (1.0 - t) + at(clock.ceil() as u32) * t
}

/// Where a part of the body touches: the palm is 9 cm along the hand, the head's middle 11 cm above its joint; a torso
/// is touched anywhere along the back, since people of different heights do not reach the same place.
fn place_of(part: BodyPart, globals: &[(Vec3, Quat)]) -> Capsule {
    let at = |joint: usize, offset: Vec3| globals[joint].0 + globals[joint].1 * offset;
    let (a, b) = match part {
        BodyPart::Torso => (at(joint::SPINE, Vec3::ZERO), at(joint::NECK, Vec3::ZERO)),
        BodyPart::LeftHand => [at(joint::LEFT_HAND, Vec3::new(0.09, 0.0, 0.0)); 2].into(),
        BodyPart::RightHand => [at(joint::RIGHT_HAND, Vec3::new(-0.09, 0.0, 0.0)); 2].into(),
        BodyPart::Head => [at(joint::HEAD, Vec3::new(0.0, 0.11, 0.01)); 2].into(),
    };
    Capsule { a, b, radius: 0.0 }
}
