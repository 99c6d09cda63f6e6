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

/// The knots that two tracks have at the same times, and the numbers of the first in either.
struct Overlap<'a> {
    a: &'a [DVec2],
    b: &'a [DVec2],
    begin: [usize; 2],
}

impl<'a> Overlap<'a> {
    /// Of `a`, and `b` shifted in time.
    fn new(a: &'a Track, b: &'a Track, shift: i32) -> Self {
        let begin = a.first.max(b.first + shift);
        let n = (a.end().min(b.end() + shift) - begin).max(0) as usize;
        let [i, j] = [a.first, b.first + shift].map(|first| if n > 0 { (begin - first) as usize } else { 0 });
        Self { a: &a.knots[i..i + n], b: &b.knots[j..j + n], begin: [i, j] }
    }

    fn len(&self) -> usize {
        self.a.len()
    }

    /// From `b` to `a`.
    fn apart(&self, k: usize) -> DVec2 {
        self.a[k] - self.b[k]
    }

    /// The first from `k` on where they are as near as `square` says, or all.
    fn near(&self, mut k: usize, square: f64) -> usize {
        // Four at a time without a branch: hardly any are near.
        while let (Some(a), Some(b)) = (self.a[k..].first_chunk::<4>(), self.b[k..].first_chunk::<4>()) {
            let mut near = false;
            for i in 0..4 {
                near |= (a[i] - b[i]).length_squared() <= square;
            }
            if near {
                break;
            }
            k += 4;
        }
        while k < self.len() && self.apart(k).length_squared() > square {
            k += 1;
        }
        k
    }
}

/// Whether the bodies never touch: chords less how far curves leave them (exact bound of the curvature).
pub(super) fn free(a: &Track, b: &Track, shift: i32, apart: f64) -> bool {
    let both = Overlap::new(a, b, shift);
    let near = (apart + 0.1).powi(2) + 0.2;
    let mut k = both.near(0, near);
    while k < both.len() {
        // Both segments at a near knot.
        for s in k.saturating_sub(1)..(k + 1).min(both.len() - 1) {
            let sag = relative_sag(a, both.begin[0] + s, b, both.begin[1] + s);
            if chord(both.apart(s), both.apart(s + 1)).0 < apart + SLACK + sag {
                return false;
            }
        }
        k = both.near(k + 1, near);
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
    let both = Overlap::new(a, b, shift);
    let near = apart * apart + 0.2;
    let mut begin = both.near(0, near);
    while begin < both.len() {
        let is_near = |&k: &usize| both.apart(k).length_squared() <= near;
        let end = begin + (begin..both.len()).take_while(is_near).count();
        let knots = begin.saturating_sub(1)..(end + 1).min(both.len());
        meet(knots, &|k| both.apart(k), both.begin[0], apart, found);
        begin = both.near(end, near);
    }
}

/// Rows for the knots of one encounter, the first of which has the number `first` in its track.
fn meet(
    knots: std::ops::Range<usize>,
    apart_at: &impl Fn(usize) -> DVec2,
    first: usize,
    apart: f64,
    found: &mut Vec<Push>,
) {
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
                found.push(Push { knot: first + k, normal, gap });
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
