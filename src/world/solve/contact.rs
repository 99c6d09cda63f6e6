//! Where two tracks come too close.

use glam::DVec2;

use super::track::Track;

/// Centres are kept this much further apart than bodies need, metres: the optimum gives way a little.
pub(super) const ROOM: f64 = 0.05;
/// Distance beyond that of touching that counts as free, metres: more than single precision of stored points loses.
const SLACK: f64 = 0.002;

/// A knot of a walker that should move along `normal` by `gap`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Push {
    /// Which knot of its track.
    pub knot: usize,
    /// Unit vector.
    pub normal: DVec2,
    /// Metres.
    pub gap: f64,
}

/// Calls `with` for every shift (a multiple of `grid`) that makes `b` overlap `a` in time.
pub(super) fn shifts(a: &Track, b: &Track, grid: i32) -> impl Iterator<Item = i32> {
    let low = (a.first - b.end()).div_euclid(grid) + 1;
    let high = (a.end() - b.first - 1).div_euclid(grid);
    (low..=high).map(move |lap| lap * grid)
}

/// Overlap of `a` and `b` shifted in time: the knots of `a`, and what to subtract to get those of `b`.
fn overlap(a: &Track, b: &Track, shift: i32) -> (std::ops::Range<usize>, isize) {
    let begin = a.first.max(b.first + shift);
    let end = a.end().min(b.end() + shift);
    let range = (begin - a.first).max(0) as usize..(end - a.first).max(0) as usize;
    (range, (b.first + shift - a.first) as isize)
}

/// Whether the bodies never touch: chords less how far curves leave them (exact bound of the curvature).
pub(super) fn free(a: &Track, b: &Track, shift: i32, apart: f64) -> bool {
    let (range, offset) = overlap(a, b, shift);
    let near = (apart + 0.1).powi(2) + 0.2;
    let there = |k: usize| (k as isize - offset) as usize;
    let apart_at = |k: usize| a.knots[k] - b.knots[there(k)];
    for k in range.clone() {
        let from = apart_at(k);
        if from.length_squared() > near {
            continue;
        }
        // Both segments at a near knot.
        for s in [k.wrapping_sub(1), k] {
            if s >= range.end || s + 1 >= range.end || s < range.start {
                continue;
            }
            let (p, q) = (apart_at(s), apart_at(s + 1));
            if chord(p, q).0 < apart + SLACK + relative_sag(a, s, b, there(s)) {
                return false;
            }
        }
    }
    true
}

fn relative_sag(a: &Track, ka: usize, b: &Track, kb: usize) -> f64 {
    let bend = |t: &Track, k: usize| if k > 0 && k + 1 < t.points.len() { t.bend(k) } else { DVec2::ZERO };
    let at = |d: usize| (bend(a, ka + d) - bend(b, kb + d)).length_squared();
    at(0).max(at(1)).sqrt() / 8.0
}

/// Least distance from the origin to the segment from `p` to `q`, and where.
fn chord(p: DVec2, q: DVec2) -> (f64, DVec2) {
    let pq = q - p;
    let t = (-p.dot(pq) / pq.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    let nearest = p + pq * t;
    (nearest.length(), nearest)
}

/// What keeps `a` away from `b` shifted in time. For every time they come near one direction is fixed, that of their
/// closest approach: along it the two are held as far apart as passing each other on straight lines needs.
pub(super) fn pushes(a: &Track, b: &Track, shift: i32, apart: f64, found: &mut Vec<Push>) {
    let (range, offset) = overlap(a, b, shift);
    let apart_at = |k: usize| a.knots[k] - b.knots[(k as isize - offset) as usize];
    let near = apart * apart + 0.2;
    let mut k = range.start;
    while k < range.end {
        if apart_at(k).length_squared() > near {
            k += 1;
            continue;
        }
        let begin = k;
        while k < range.end && apart_at(k).length_squared() <= near {
            k += 1;
        }
        meet(begin.max(range.start + 1) - 1..(k + 1).min(range.end), &apart_at, apart, found);
    }
}

/// Rows for the knots of one encounter.
fn meet(knots: std::ops::Range<usize>, apart_at: &impl Fn(usize) -> DVec2, apart: f64, found: &mut Vec<Push>) {
    let mut closest = (f64::INFINITY, DVec2::X, DVec2::X);
    for k in knots.start..knots.end - 1 {
        let (p, q) = (apart_at(k), apart_at(k + 1));
        let (distance, place) = chord(p, q);
        if distance < closest.0 {
            closest = (distance, place, q - p);
        }
    }
    let (distance, place, velocity) = closest;
    if distance >= apart {
        return;
    }
    let normal = if distance > 1e-3 { place / distance } else { velocity.perp().normalize_or(DVec2::X) };
    let half = 0.5 * velocity.dot(normal.perp()).abs();
    for k in knots {
        let r = apart_at(k);
        // A knot stands for half a step on either side.
        let aside = (r.dot(normal.perp()).abs() - half).max(0.0);
        if aside < apart {
            let gap = (apart * apart - aside * aside).sqrt() - r.dot(normal);
            if gap > 0.0 {
                found.push(Push { knot: k, normal, gap });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::frame::Line;
    use proptest::prelude::*;

    fn track(first: i32, points: &[(f64, f64)]) -> Track {
        let line = Line { edge: 0, place: DVec2::ZERO, velocity: DVec2::X, time: 0.0, reach: 0.1 };
        let mut at = DVec2::ZERO;
        let mut points: Vec<DVec2> = points
            .iter()
            .map(|&(x, z)| {
                at += DVec2::new(x, z);
                at
            })
            .collect();
        // The ends are straight, as at crossings.
        let n = points.len();
        points[0] = 2.0 * points[1] - points[2];
        points[n - 1] = 2.0 * points[n - 2] - points[n - 3];
        let mut track = Track { first, free: 2..n - 2, knots: points.clone(), points, ..Track::new(line) };
        track.update_knots();
        track
    }

    proptest! {
        /// What counts as free is free at every moment, by dense sampling of the curves.
        #[test]
        fn free_tracks_never_touch(
            a in prop::collection::vec((-0.3f64..0.3, -0.3f64..0.3), 8..20),
            b in prop::collection::vec((-0.3f64..0.3, -0.3f64..0.3), 8..20),
            lag in -8i32..8,
        ) {
            let (a, b) = (track(0, &a), track(lag, &b));
            let place = |t: &Track, time: f64| {
                let k = (time.floor() as i32 - t.first) as usize;
                let (u, p) = (time.fract(), &t.points[k - 1..k + 3]);
                let v = 1.0 - u;
                (p[0] * v * v * v + p[1] * (3.0 * u * u * u - 6.0 * u * u + 4.0)
                    + p[2] * (-3.0 * u * u * u + 3.0 * u * u + 3.0 * u + 1.0) + p[3] * u * u * u) / 6.0
            };
            let (begin, end) = (a.first.max(b.first) + 1, a.end().min(b.end()) - 2);
            let times = (begin * 64..end * 64).map(|i| f64::from(i) / 64.0 + 1e-9);
            let nearest = times.map(|time| place(&a, time).distance(place(&b, time))).fold(f64::INFINITY, f64::min);
            if free(&a, &b, 0, 0.5) {
                prop_assert!(nearest >= 0.5, "{nearest}");
            }
            if a.knots.iter().all(|p| b.knots.iter().all(|q| p.distance(*q) > 1.5)) {
                prop_assert!(free(&a, &b, 0, 0.5));
            }
        }
    }

    #[test]
    fn shifts_are_all_that_overlap() {
        let (a, b) = (track(3, &[(0.1, 0.0); 30]), track(-7, &[(0.1, 0.0); 12]));
        let overlaps = |lap: i32| b.first + lap * 10 < a.end() && a.first < b.end() + lap * 10;
        assert_eq!(
            shifts(&a, &b, 10).collect::<Vec<_>>(),
            (-9..9).filter(|&l| overlaps(l)).map(|l| l * 10).collect::<Vec<_>>()
        );
    }
}
