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
