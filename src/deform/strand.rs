//! Deformation of one motion path between two fixed ends in closed form.
//!
//! The path's edges e_i are complex numbers, and each frame carries a similarity s_i. Minimising
//! sum w_i |s_(i+1) - s_i|^2 (the Laplacian energy of "Tiling Motion Patches" section 3, after Kim et al. 2009) with
//! both ends' headings and the end's position fixed has the solution s_i = turn_i + g_i gap: `g`, one complex profile,
//! is computed once per path; a deformation is then a few sums. Similarities are made rigid (as-rigid edge lengths),
//! and what gap remains is spread over moving edges.
//!
//! Departures from the plain Laplacian: the weights w_i grow where the person stands, so that a standing body neither
//! turns nor glides, and the last correction tapers to zero at the ports, so that speed is continuous over a stitch.

use glam::Vec2;

use super::Limits;
use crate::geom::{Ground, complex, wrap_angle};
use crate::motion::MotionPath;

/// Below this speed a body counts as standing (m per frame at 30 fps).
pub(super) const STANDING_EDGE: f32 = 0.1 / crate::motion::FPS;
/// From this speed on a path bends freely.
const WALKING_EDGE: f32 = 0.5 / crate::motion::FPS;
/// Compliance of a standing frame relative to a walking one.
const STANDING_COMPLIANCE: f32 = 0.01;
/// A gap this small needs no deformation.
const GAP_TOLERANCE: f32 = 2e-4;

/// A motion path made ready to be deformed: edges and headings relative to its first frame, and its profile.
#[derive(Clone, Debug)]
pub struct Strand {
    edges: Vec<Vec2>,
    headings: Vec<f32>,
    /// Share of the heading change that has happened by frame i, 0 to 1.
    turn_share: Vec<f32>,
    /// g_i: how frame i's similarity answers to a gap.
    profile: Vec<Vec2>,
    /// Half the sum of the edges at both sides of frame i.
    lever: Vec<Vec2>,
    /// Share of the last correction that edge i takes; all zero if the person stands throughout.
    stretch_share: Vec<f32>,
}

impl Strand {
    /// Prepares `path`. O(frames).
    pub fn new(path: &MotionPath) -> Self {
        let world_from_entry = path.at(0);
        let entry_from_world = world_from_entry.inverse();
        let points: Vec<Vec2> = path.points.iter().map(|&p| entry_from_world.apply(p)).collect();
        let headings: Vec<f32> = path.headings.iter().map(|h| h - path.headings[0]).collect();
        Self::from_edges(points.windows(2).map(|w| w[1] - w[0]).collect(), headings)
    }

    /// The strand that walks `first` and then `second`.
    pub fn chained(first: &Self, second: &Self) -> Self {
        let turn = *first.headings.last().expect("never empty");
        let rotation = complex::unit(turn);
        let edges = first.edges.iter().copied().chain(second.edges.iter().map(|&e| complex::mul(rotation, e)));
        let headings = first.headings.iter().copied().chain(second.headings[1..].iter().map(|h| h + turn));
        Self::from_edges(edges.collect(), headings.collect())
    }

    fn from_edges(edges: Vec<Vec2>, headings: Vec<f32>) -> Self {
        let compliance: Vec<f32> = edges.iter().map(|e| compliance(e.length())).collect();
        let frames = headings.len();
        let edge = |i: usize| edges.get(i).copied().unwrap_or(Vec2::ZERO);
        let lever: Vec<Vec2> =
            (0..frames).map(|i| (edge(i) + if i > 0 { edge(i - 1) } else { Vec2::ZERO }) * 0.5).collect();
        Self {
            turn_share: cumulative_share(&compliance),
            profile: profile(&lever, &compliance),
            stretch_share: stretch_share(&edges),
            lever,
            edges,
            headings,
        }
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.headings.len()
    }

    /// Where the undeformed path ends, seen from where it begins.
    pub fn exit(&self) -> Ground {
        Ground::new(self.edges.iter().sum(), *self.headings.last().expect("never empty"))
    }

    /// Deforms the path so that it leads from `from` to `to`, into `out` (world frame, one sample per source frame).
    ///
    /// Returns false, with `out` unspecified, if a limit is broken on any frame. O(frames), no allocation once `out`
    /// has grown.
    pub fn deform(&self, from: Ground, to: Ground, limits: &Limits, out: &mut MotionPath) -> bool {
        let last = self.frames() - 1;
        let target = from.inverse().apply(to.position);
        let turn = wrap_angle(to.heading - from.heading - self.headings[last]);
        // Similarities of the frames, kept in `out.points`; angles in `out.headings`.
        let (similarity, angle) = (&mut out.points, &mut out.headings);
        similarity.clear();
        similarity.extend(self.turn_share.iter().map(|share| complex::unit(turn * share)));
        angle.clear();
        for _ in 0..2 {
            let gap = target - self.span(similarity);
            for (s, &g) in similarity.iter_mut().zip(&self.profile) {
                let bent = *s + complex::mul(g, gap);
                let length = bent.length();
                if length < 0.2 {
                    return false;
                }
                *s = bent / length;
            }
        }
        let mut previous = 0.0;
        for (s, share) in similarity.iter().zip(&self.turn_share) {
            let nominal = turn * share;
            let now = nominal + complex::arg(complex::mul(*s, complex::conj(complex::unit(nominal))));
            if !angle.is_empty() && (now - previous).abs() > limits.bend {
                return false;
            }
            previous = now;
            angle.push(now);
        }
        self.lay(from, target, to, limits, out)
    }

    /// Where the path ends if frame i's similarity is `similarity[i]`.
    fn span(&self, similarity: &[Vec2]) -> Vec2 {
        similarity.iter().zip(&self.lever).map(|(&s, &e)| complex::mul(s, e)).sum()
    }

    /// Turns similarities into points: rigid edges, plus the tapered rest of the gap.
    fn lay(&self, from: Ground, target: Vec2, to: Ground, limits: &Limits, out: &mut MotionPath) -> bool {
        let last = self.frames() - 1;
        let rigid = |i: usize, s: &[Vec2]| {
            let mean = s[i] + s[i + 1];
            complex::mul(mean / mean.length(), self.edges[i])
        };
        let reached: Vec2 = (0..last).map(|i| rigid(i, &out.points)).sum();
        let rest = target - reached;
        if rest.length() > GAP_TOLERANCE && self.stretch_share.iter().all(|&w| w == 0.0) {
            return false;
        }
        let world = complex::unit(from.heading);
        let (slip_sin, slip_cos) = limits.slip.sin_cos();
        let mut position = from.position;
        for i in 0..last {
            let plain = rigid(i, &out.points);
            let edge = plain + rest * self.stretch_share[i];
            if (edge.length() - plain.length()).abs() > limits.stretch {
                return false;
            }
            let (ahead, aside) = (edge.dot(plain), edge.perp_dot(plain).abs());
            if plain.length() > STANDING_EDGE && aside * slip_cos > ahead * slip_sin {
                return false;
            }
            out.points[i] = position;
            position += complex::mul(world, edge);
        }
        // The very end is set, not summed: a stitch is exact. Rounding and the tolerated gap are far below a millimetre.
        out.points[last] = to.position;
        for (heading, own) in out.headings.iter_mut().zip(&self.headings) {
            *heading += own + from.heading;
        }
        true
    }
}

pub(super) fn compliance(edge: f32) -> f32 {
    let t = ((edge - STANDING_EDGE) / (WALKING_EDGE - STANDING_EDGE)).clamp(0.0, 1.0);
    STANDING_COMPLIANCE + (1.0 - STANDING_COMPLIANCE) * t * t * (3.0 - 2.0 * t)
}

fn cumulative_share(compliance: &[f32]) -> Vec<f32> {
    let total: f32 = compliance.iter().sum();
    let mut sum = 0.0;
    let mut shares = vec![0.0];
    shares.extend(compliance.iter().map(|c| {
        sum += c;
        sum / total
    }));
    shares
}

/// g with L g = conj(lever) scaled so that sum g_i lever_i = 1, zero at both ends; L is the weighted path Laplacian.
fn profile(lever: &[Vec2], compliance: &[f32]) -> Vec<Vec2> {
    let n = lever.len();
    let mut g = vec![Vec2::ZERO; n];
    let stiffness = |i: usize| 1.0 / compliance[i];
    // Thomas algorithm on the interior frames 1..n-1.
    let mut upper = vec![0.0f32; n];
    for i in 1..n.saturating_sub(1) {
        let pivot = stiffness(i - 1) + stiffness(i) - if i > 1 { stiffness(i - 1) * upper[i - 1] } else { 0.0 };
        upper[i] = stiffness(i) / pivot;
        let below = if i > 1 { g[i - 1] * stiffness(i - 1) } else { Vec2::ZERO };
        g[i] = (complex::conj(lever[i]) + below) / pivot;
    }
    for i in (1..n.saturating_sub(2)).rev() {
        g[i] = g[i] + g[i + 1] * upper[i];
    }
    let gain: f32 = g.iter().zip(lever).map(|(&g, &e)| complex::mul(g, e).y).sum();
    // A standing person cannot be bent into another place.
    let scale = if gain > 1e-6 { 1.0 / gain } else { 0.0 };
    g.iter_mut().for_each(|g| *g *= scale);
    g
}

fn stretch_share(edges: &[Vec2]) -> Vec<f32> {
    let n = edges.len() as f32;
    let share = |(i, e): (usize, &Vec2)| {
        let x = (i as f32 + 0.5) / n;
        let moving = if e.length() < STANDING_EDGE { 0.0 } else { e.length() };
        moving * (x * (1.0 - x)).min(0.15)
    };
    let raw: Vec<f32> = edges.iter().enumerate().map(share).collect();
    let total: f32 = raw.iter().sum();
    raw.iter().map(|w| if total > 1e-4 { w / total } else { 0.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn walk(frames: usize, speed: f32, turn: f32) -> MotionPath {
        let mut path = MotionPath::default();
        let mut at = Ground::new(Vec2::new(1.0, 2.0), 0.4);
        for _ in 0..frames {
            path.points.push(at.position);
            path.headings.push(at.heading);
            at = at.then(Ground::new(Vec2::new(0.0, speed / 30.0), turn / frames as f32));
        }
        path
    }

    proptest! {
        #[test]
        fn ends_are_met_and_limits_hold(
            frames in 15usize..70, speed in 0.7f32..1.6, own_turn in -0.8f32..0.8,
            dx in -0.3f32..0.3, dz in -0.3f32..0.3, turn in -0.4f32..0.4, x in -5.0f32..5.0, heading in -3.0f32..3.0,
        ) {
            let path = walk(frames, speed, own_turn);
            let strand = Strand::new(&path);
            let from = Ground::new(Vec2::new(x, -x), heading);
            let exit = strand.exit();
            let to = from.then(Ground::new(exit.position + Vec2::new(dx, dz), exit.heading + turn));
            let mut out = MotionPath::default();
            let limits = Limits::TIGHT;
            if strand.deform(from, to, &limits, &mut out) {
                let last = frames - 1;
                prop_assert!((out.points[0] - from.position).length() < 1e-5);
                prop_assert!((out.points[last] - to.position).length() < 1e-5);
                prop_assert!(wrap_angle(out.headings[last] - to.heading).abs() < 1e-4);
                for i in 0..last {
                    let was = (path.points[i + 1] - path.points[i]).length();
                    let is = (out.points[i + 1] - out.points[i]).length();
                    prop_assert!((is - was).abs() <= limits.stretch + 3e-4, "stretch {}", is - was);
                    let turned = (out.headings[i + 1] - out.headings[i]) - (path.headings[i + 1] - path.headings[i]);
                    prop_assert!(turned.abs() <= limits.bend + 1e-4);
                }
            }
        }
    }

    #[test]
    fn undisturbed_ends_leave_the_path_as_it_is() {
        let path = walk(40, 1.2, 0.6);
        let strand = Strand::new(&path);
        let from = Ground::new(Vec2::new(-3.0, 1.0), 2.0);
        let mut out = MotionPath::default();
        assert!(strand.deform(from, from.then(strand.exit()), &Limits::TIGHT, &mut out));
        let world_from_source = from.then(path.at(0).inverse());
        for (p, q) in out.points.iter().zip(&path.points) {
            assert!((*p - world_from_source.apply(*q)).length() < 1e-4);
        }
    }

    #[test]
    fn a_second_of_walking_reaches_some_decimetres_each_way() {
        let strand = Strand::new(&walk(34, 1.2, 0.0));
        let mut out = MotionPath::default();
        for (dx, dz) in [(0.0, 0.25), (0.0, -0.25), (0.25, 0.0), (-0.25, 0.0)] {
            let to = Ground::new(strand.exit().position + Vec2::new(dx, dz), 0.0);
            assert!(strand.deform(Ground::IDENTITY, to, &Limits::TIGHT, &mut out), "{dx} {dz}");
        }
    }

    #[test]
    fn a_standing_person_does_not_glide_or_spin() {
        let strand = Strand::new(&walk(30, 0.0, 0.0));
        let mut out = MotionPath::default();
        assert!(!strand.deform(Ground::IDENTITY, Ground::new(Vec2::new(0.05, 0.0), 0.0), &Limits::TIGHT, &mut out));
        assert!(strand.deform(Ground::IDENTITY, Ground::IDENTITY, &Limits::TIGHT, &mut out));
    }

    #[test]
    fn a_stop_bends_where_it_walks_not_where_it_stands() {
        let mut path = walk(30, 1.2, 0.0);
        let end = path.at(29);
        path.points.extend([end.position; 30]);
        path.headings.extend([end.heading; 30]);
        let strand = Strand::new(&path);
        let to = strand.exit().then(Ground::new(Vec2::new(0.15, 0.1), 0.2));
        let mut out = MotionPath::default();
        assert!(strand.deform(Ground::IDENTITY, to, &Limits::TIGHT, &mut out));
        assert!((out.points[59] - out.points[32]).length() < 1e-3);
        assert!((out.headings[59] - out.headings[32]).abs() < 0.05);
    }

    #[test]
    fn chained_strand_ends_where_the_two_end() {
        let (a, b) = (Strand::new(&walk(20, 1.0, 0.7)), Strand::new(&walk(25, 1.3, -0.3)));
        let both = Strand::chained(&a, &b);
        let expected = a.exit().then(b.exit());
        assert!((both.exit().position - expected.position).length() < 1e-5);
        assert!((both.exit().heading - expected.heading).abs() < 1e-5);
        assert_eq!(both.frames(), 44);
    }
}
