//! People touch where they should and nowhere else.

use glam::Vec3;

use super::{TAKES, frame};
use crate::geom::{Capsule, Cuboid, Upright};
use crate::motion::{BODY_CAPSULES, BodyPart, body_capsules, joint::*};

fn palm(globals: &[(Vec3, glam::Quat)], part: BodyPart) -> Vec3 {
    match part {
        BodyPart::LeftHand => globals[LEFT_HAND].0 + globals[LEFT_HAND].1 * Vec3::new(0.09, 0.0, 0.0),
        BodyPart::RightHand => globals[RIGHT_HAND].0 + globals[RIGHT_HAND].1 * Vec3::new(-0.09, 0.0, 0.0),
        other => unreachable!("{other:?} is not a hand"),
    }
}

fn is_hand(part: BodyPart) -> bool {
    matches!(part, BodyPart::LeftHand | BodyPart::RightHand)
}

#[test]
fn hands_meet() {
    let mut met = 0;
    for (take, people) in TAKES.iter() {
        let globals = |person: usize, f: usize| people[person][f].as_slice();
        for c in take.file.contacts.iter().filter(|c| is_hand(c.b.part)) {
            for f in frame(c.begin)..=frame(c.end) {
                let gap = (palm(globals(c.a.person, f), c.a.part) - palm(globals(c.b.person, f), c.b.part)).length();
                assert!(gap <= 0.01, "{} at {:.2} s: {gap}", take.file.name, f as f32 / 60.0);
                met += 1;
            }
        }
    }
    assert!(met > 60, "{met}");
}

#[test]
fn hands_on_bodies_are_near_them() {
    for (take, people) in TAKES.iter() {
        let globals = |person: usize, f: usize| people[person][f].as_slice();
        for c in take.file.contacts.iter().filter(|c| is_hand(c.a.part) && c.b.part == BodyPart::Torso) {
            for f in frame(c.begin)..=frame(c.end) {
                let mut capsules = Vec::new();
                body_capsules(globals(c.b.person, f), &mut capsules);
                let hand = palm(globals(c.a.person, f), c.a.part);
                let point = Capsule { a: hand, b: hand, radius: 0.0 };
                let gap = capsules[..3].iter().map(|k| -depth(&point, k)).fold(f32::MAX, f32::min);
                assert!((-0.05..0.11).contains(&gap), "{} at {:.2} s: {gap}", take.file.name, f as f32 / 60.0);
            }
        }
    }
}

#[test]
fn boxes_are_between_the_palms() {
    for (take, people) in TAKES.iter() {
        let globals = |person: usize, f: usize| people[person][f].as_slice();
        for prop in &take.file.props {
            for hold in &prop.held {
                for f in (frame(hold.begin)..=frame(hold.end)).filter(|&f| f < people[hold.person].len()) {
                    let g = globals(hold.person, f);
                    let width = (palm(g, BodyPart::LeftHand) - palm(g, BodyPart::RightHand)).length();
                    assert!((width - prop.size[0]).abs() < 0.01, "{} at {f}: {width}", take.file.name);
                }
            }
        }
    }
}

#[test]
fn sitters_are_on_their_crates_and_everybody_else_keeps_clear_of_them() {
    let mut sitters = 0;
    for (take, people) in TAKES.iter() {
        for prop in &take.file.props {
            let Some(seat) = prop.sat.first() else { continue };
            let at = |f: usize| people[seat.person][f][HIPS].0;
            let hips = at(frame(seat.begin));
            let heading = {
                // The path looks where the feet do on average.
                let toes = |j: usize| people[seat.person][frame(seat.begin)][j].1 * Vec3::Z;
                let ahead = toes(LEFT_FOOT) + toes(RIGHT_FOOT);
                ahead.x.atan2(ahead.z)
            };
            let forward = Vec3::new(heading.sin(), 0.0, heading.cos());
            let middle = (hips + forward * prop.seat).with_y(0.5 * prop.size[1]);
            let cuboid = Cuboid::new(Upright { middle, heading }, prop.size);
            for f in frame(seat.begin)..=frame(seat.end) {
                let over = at(f).y - 0.13 - prop.size[1];
                assert!(over.abs() < 0.01, "{} at {f}: {over} m over the crate", take.file.name);
                assert!(at(f).distance(hips) < 0.01, "{} at {f}: the hips slide", take.file.name);
            }
            for (person, frames) in people.iter().enumerate() {
                let mut worst = (0f32, 0, 0);
                for (f, globals) in frames.iter().enumerate() {
                    let mut capsules = Vec::new();
                    body_capsules(globals, &mut capsules);
                    for (k, c) in capsules.iter().enumerate() {
                        let deep = cuboid.penetration(c);
                        worst = if deep > worst.0 { (deep, f, k) } else { worst };
                    }
                }
                assert!(worst.0 < 0.01, "{} person {person}: {worst:?} (m, frame, capsule)", take.file.name);
            }
            sitters += 1;
        }
    }
    assert!(sitters >= 5, "{sitters}");
}

/// How deep two capsules are in each other (m); negative is the gap.
fn depth(p: &Capsule, q: &Capsule) -> f32 {
    let (d1, d2, r) = (p.b - p.a, q.b - q.a, p.a - q.a);
    let (a, e, b) = (d1.length_squared().max(1e-12), d2.length_squared().max(1e-12), d1.dot(d2));
    let (c, f) = (d1.dot(r), d2.dot(r));
    let det = a * e - b * b;
    let mut s = if det > 1e-12 { ((b * f - c * e) / det).clamp(0.0, 1.0) } else { 0.0 };
    let t = ((b * s + f) / e).clamp(0.0, 1.0);
    s = ((b * t - c) / a).clamp(0.0, 1.0);
    p.radius + q.radius - (p.a + d1 * s - (q.a + d2 * t)).length()
}

/// Capsules of the arms from the elbow down, which may press against what they touch.
fn is_arm(capsule: usize) -> bool {
    let (a, _) = BODY_CAPSULES[capsule].a;
    (LEFT_ARM..=LEFT_HAND).contains(&a) && capsule > 2 || (RIGHT_ARM..=RIGHT_HAND).contains(&a)
}

/// How deep two people are allowed to be in each other: hands that touch as they are, arms that hug 4 cm.
fn allowed(take: &crate::samples::Take, people: [usize; 2], capsules: [usize; 2], t: f32) -> f32 {
    let touching = take.file.contacts.iter().any(|c| {
        let pair = [c.a.person, c.b.person];
        let hands = capsules.iter().all(|&k| is_arm(k));
        (pair == people || pair == [people[1], people[0]])
            && c.begin - 0.35 <= t
            && t <= c.end + 0.35
            && (if is_hand(c.b.part) { hands } else { capsules.iter().any(|&k| is_arm(k)) })
    });
    let handing_over = take.file.props.iter().flat_map(|p| p.held.iter().skip(1)).any(|h| (h.begin - t).abs() < 0.5);
    let hands = |k: usize| k >= 12;
    if handing_over && capsules.iter().all(|&k| hands(k)) {
        return 1.0;
    }
    let hug = touching && take.file.name.starts_with("hug");
    match touching {
        true if hug => 0.04,
        true => 1.0,
        false => 0.0,
    }
}

#[test]
fn bodies_do_not_interpenetrate() {
    let mut problems = Vec::new();
    for (take, people) in TAKES.iter() {
        let globals = |person: usize, f: usize| people[person][f].as_slice();
        for patch in take.file.patches.iter().filter(|p| p.roles.len() > 1) {
            for (i, a) in patch.roles.iter().enumerate() {
                for b in &patch.roles[i + 1..] {
                    let (from, to) = (a.begin.max(b.begin), a.end.min(b.end));
                    let mut worst = (0f32, String::new());
                    for f in frame(from)..=frame(to) {
                        let [mut p, mut q] = [Vec::new(), Vec::new()];
                        body_capsules(globals(a.person, f), &mut p);
                        body_capsules(globals(b.person, f), &mut q);
                        let t = f as f32 / 60.0;
                        for (j, x) in p.iter().enumerate() {
                            for (k, y) in q.iter().enumerate() {
                                let over = depth(x, y) - allowed(take, [a.person, b.person], [j, k], t) - 0.002;
                                if over > worst.0 {
                                    worst = (over, format!("capsules {j} {k} at {t:.2} s"));
                                }
                            }
                        }
                    }
                    if worst.0 > 0.0 {
                        problems
                            .push(format!("{} {}-{}: {:.3} m, {}", patch.name, a.person, b.person, worst.0, worst.1));
                    }
                }
            }
        }
    }
    assert!(problems.is_empty(), "{problems:#?}");
}
