//! How far apart crossings of one border stay.
//!
//! While a body touches the border its centre goes along a straight line which the pattern gives, alike in both
//! patches and out of reach of any solver. So that solved patches never collide there, whichever are put side by side,
//! the lines of one border are kept apart already in the pattern, and away from its corners.

use super::{Crossing, Limits, Pattern};

/// The straight part of a crossing lasts this long on either side of it at most, seconds.
pub(super) const STRAIGHT_SECS: f32 = 0.8;
/// Bodies on the straight parts are at least this far from touching, metres.
pub(super) const GAP: f32 = 0.1;
/// Straight parts stay this far from a right angle, metres.
pub(super) const CORNER: f32 = 1.5;

/// How far straight parts stay from a corner of interior `angle` (radians), metres: two people who come in on either
/// side of it can still let each other pass. Sharp corners need more room.
pub(super) fn corner_room(angle: f32) -> f32 {
    // Both are this deep before they can have stepped aside, and stay on their side of the bisector.
    const DEPTH: f32 = 0.95;
    let half = (0.5 * angle).max(0.1);
    ((0.3 + DEPTH * half.cos()) / half.sin() + 0.126).max(0.8)
}

/// Least distance of the centres of two crossings' walkers while both are on their straight parts, over all periods.
pub(super) fn distance(a: (&Crossing, bool), b: (&Crossing, bool), period: f32) -> f32 {
    let span = 2.0 * STRAIGHT_SECS;
    let near = ((b.0.time - a.0.time) / period).round();
    let laps = (span / period).ceil() as i32;
    (-laps..=laps).map(|lap| distance_once(a, b, b.0.time - (near + lap as f32) * period)).fold(f32::INFINITY, f32::min)
}

/// The same with `b` crossing at `time_b`.
fn distance_once((a, a_in): (&Crossing, bool), (b, b_in): (&Crossing, bool), time_b: f32) -> f32 {
    let lag = time_b - a.time;
    let (begin, end) = ((lag - STRAIGHT_SECS).max(-STRAIGHT_SECS), (lag + STRAIGHT_SECS).min(STRAIGHT_SECS));
    if begin > end {
        return f32::INFINITY;
    }
    let depth = |c: &Crossing, inward: bool| if inward { c.across } else { -c.across };
    let (va, vb) = (glam::Vec2::new(a.along, depth(a, a_in)), glam::Vec2::new(b.along, depth(b, b_in)));
    // Relative place at time s after a's crossing: from + v s.
    let v = vb - va;
    let from = glam::Vec2::new(b.place - a.place, 0.0) - vb * lag;
    let nearest = if v.length_squared() > 0.0 { -from.dot(v) / v.length_squared() } else { begin };
    (from + v * nearest.clamp(begin, end)).length()
}

/// Acceleration with which walkers are expected to step aside, m/s2: half of what they can.
const ASIDE: f32 = 1.2;
/// How far people look ahead when they step aside, seconds.
const AHEAD_SECS: f32 = 2.4;

/// Whether two walkers who go straight on beyond their straight parts could still step aside for each other: a pattern
/// that lets people come in right in front of those who go out has no solution within the limits of acceleration.
pub(super) fn passable(a: (&Crossing, bool), b: (&Crossing, bool), period: f32, apart: f32) -> bool {
    let near = ((b.0.time - a.0.time) / period).round();
    (-1..=1).all(|lap| passable_once(a, b, b.0.time - (near + lap as f32) * period - a.0.time, apart))
}

/// The same with `b` crossing `lag` seconds after `a`.
fn passable_once((a, a_in): (&Crossing, bool), (b, b_in): (&Crossing, bool), lag: f32, apart: f32) -> bool {
    const SAMPLES: i32 = 48;
    let place = |c: &Crossing, inward: bool, s: f32| {
        glam::Vec2::new(c.place + c.along * s, if inward { c.across * s } else { -c.across * s })
    };
    let dodge = |s: f32| 0.5 * ASIDE * (s.abs() - STRAIGHT_SECS).max(0.0).powi(2);
    (0..=SAMPLES).map(|i| AHEAD_SECS * (2.0 * i as f32 / SAMPLES as f32 - 1.0)).all(|s| {
        let other = s - lag;
        let need = apart - dodge(s) - dodge(other);
        need <= 0.0 || other.abs() > AHEAD_SECS || place(a, a_in, s).distance(place(b, b_in, other)) >= need
    })
}

/// Crossings of a pattern with whether they lead in.
pub(super) fn directed(pattern: &Pattern) -> impl Iterator<Item = (&Crossing, bool)> {
    pattern.inputs.iter().map(|c| (c, true)).chain(pattern.outputs.iter().map(|c| (c, false)))
}

/// Nobody reads more problems of one pattern than this.
const ENOUGH: usize = 20;

/// What keeps a solver from keeping the limits on this border whatever it does inside; empty if nothing does.
pub(super) fn problems(pattern: &Pattern, limits: &Limits) -> Vec<String> {
    let all: Vec<_> = directed(pattern).collect();
    let apart = 2.0 * limits.radius + GAP;
    let mut found = Vec::new();
    for (i, &a) in all.iter().enumerate() {
        if found.len() >= ENOUGH {
            break;
        }
        if a.0.speed() > limits.speed || a.0.across * STRAIGHT_SECS < least_depth(limits) {
            let (least, most) = (least_depth(limits) / STRAIGHT_SECS, limits.speed);
            found.push(format!(
                "expected at least {least} m/s across and at most {most} m/s, found {} and {}",
                a.0.across,
                a.0.speed()
            ));
        }
        for &b in &all[i + 1..] {
            let found_distance = distance(a, b, pattern.period);
            if found_distance < apart - 1e-4 {
                found.push(format!(
                    "expected walkers {apart} m apart, found {found_distance:.2} m between those who cross at {} m, \
                     {} s and {} m, {} s",
                    a.0.place, a.0.time, b.0.place, b.0.time
                ));
            }
        }
    }
    found
}

/// How deep a straight part must reach so that the body is clear of the border at its end.
pub(super) fn least_depth(limits: &Limits) -> f32 {
    limits.radius + 0.02
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(place: f32, time: f32, along: f32) -> Crossing {
        Crossing { place, time, across: 1.0, along }
    }

    #[test]
    fn people_side_by_side_are_as_far_apart_as_their_places() {
        assert!((distance((&at(2.0, 1.0, 0.0), true), (&at(2.7, 1.0, 0.0), true), 10.0) - 0.7).abs() < 1e-5);
    }

    #[test]
    fn people_meet_head_on_over_the_end_of_the_period() {
        assert!(distance((&at(2.0, 9.9, 0.0), true), (&at(2.0, 0.1, 0.0), false), 10.0) < 1e-4);
        assert_eq!(distance((&at(2.0, 5.0, 0.0), true), (&at(2.0, 0.1, 0.0), false), 10.0), f32::INFINITY);
    }

    #[test]
    fn distance_is_that_of_dense_sampling() {
        let (a, b) = (at(2.0, 0.3, 0.4), at(3.1, 9.8, -0.3));
        let place = |c: &Crossing, inward: bool, t: f32| {
            glam::Vec2::new(c.place + c.along * (t - c.time), if inward { t - c.time } else { c.time - t })
        };
        let b_near = Crossing { time: -0.2, ..b };
        let sampled = (0..=20_000)
            .map(|i| -1.0 + 2.0 * i as f32 / 20_000.0)
            .filter(|t| (t - 0.3).abs() <= STRAIGHT_SECS && (t + 0.2).abs() <= STRAIGHT_SECS)
            .map(|t| place(&a, true, t).distance(place(&b_near, false, t)))
            .fold(f32::INFINITY, f32::min);
        assert!((distance((&a, true), (&b, false), 10.0) - sampled).abs() < 1e-3);
    }
}
