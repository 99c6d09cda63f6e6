//! Things that stand in the way: discs, and convex polygons.

use glam::{DVec2, Vec2};

use crate::geom::Polygon;

/// Outline of a static object on the ground.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// A tree, a lamp post, a fountain, a person.
    Disc {
        /// Its middle, metres.
        centre: Vec2,
        /// Its radius, metres.
        radius: f32,
    },
    /// A bench, a stall: any convex polygon.
    Convex(Polygon),
}

impl Shape {
    /// A disc.
    pub fn disc(centre: Vec2, radius: f32) -> Self {
        Self::Disc { centre, radius }
    }

    /// A box of full extents `size` about `centre`, turned counter-clockwise by `angle` radians seen with x right and
    /// z up.
    pub fn oblong(centre: Vec2, size: Vec2, angle: f32) -> Self {
        let turn = Vec2::from_angle(angle);
        let corner = |x: f32, z: f32| centre + turn.rotate(Vec2::new(x, z) * size * 0.5);
        let points = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, z)| corner(x, z)).to_vec();
        Self::Convex(Polygon { points })
    }

    /// What is wrong with it, if anything.
    pub fn problem(&self) -> Option<String> {
        match self {
            Self::Disc { centre, radius } if !centre.is_finite() || !radius.is_finite() || *radius <= 0.0 => {
                Some(format!("expected a finite centre and a radius above zero, found {centre} and {radius}"))
            }
            Self::Disc { .. } => None,
            Self::Convex(polygon) => convex_problem(&polygon.points),
        }
    }
}

/// Why `points` are not the corners of a convex polygon in counter-clockwise order, if they are not.
pub(super) fn convex_problem(points: &[Vec2]) -> Option<String> {
    if points.len() < 3 {
        return Some(format!("expected at least 3 corners, found {}", points.len()));
    }
    if let Some(bad) = points.iter().position(|p| !p.is_finite()) {
        return Some(format!("corner {bad} is not a finite point: {}", points[bad]));
    }
    let n = points.len();
    let side = |i: usize| (points[(i + 1) % n] - points[i]).as_dvec2();
    let turning: f64 = (0..n).map(|i| side(i).angle_to(side((i + 1) % n))).sum();
    for i in 0..n {
        if side(i).length() < 1e-3 {
            return Some(format!("expected distinct corners, found corner {i} on the next"));
        }
        if side(i).normalize().perp_dot(side((i + 1) % n).normalize()) < -1e-6 {
            return Some(format!(
                "expected a convex polygon, counter-clockwise; it turns right at corner {}",
                (i + 1) % n
            ));
        }
    }
    // A star turns left everywhere, but more than once.
    let area: f64 =
        (1..n - 1).map(|i| (points[i] - points[0]).as_dvec2().perp_dot((points[i + 1] - points[0]).as_dvec2())).sum();
    let round = (turning - std::f64::consts::TAU).abs() < 1e-6;
    (!round || area < 1e-6).then(|| "expected a polygon that goes round once and has an area".to_string())
}

/// A convex polygon grown by a radius: what a body's centre stays out of when the radius includes the body's.
#[derive(Clone, Debug)]
pub(super) struct Obstacle {
    corners: Vec<DVec2>,
    /// Outward unit normals of the edges; empty for a disc.
    outward: Vec<DVec2>,
    radius: f64,
    centre: DVec2,
    /// Radius of the disc about `centre` that holds it all.
    pub reach: f64,
}

impl Obstacle {
    /// `shape` grown by `radius`.
    pub fn new(shape: &Shape, radius: f64) -> Self {
        let (corners, own) = match shape {
            Shape::Disc { centre, radius } => (vec![centre.as_dvec2()], f64::from(*radius)),
            Shape::Convex(polygon) => (polygon.points.iter().map(|p| p.as_dvec2()).collect(), 0.0),
        };
        let centre = corners.iter().sum::<DVec2>() / corners.len() as f64;
        let n = corners.len();
        let normal = |i: usize| -(corners[(i + 1) % n] - corners[i]).perp().normalize();
        let outward = if n > 1 { (0..n).map(normal).collect() } else { Vec::new() };
        let far = corners.iter().map(|c| c.distance(centre)).fold(0.0, f64::max);
        Self { corners, outward, radius: own + radius, centre, reach: far + own + radius }
    }

    /// Signed distance of `p`, negative inside.
    #[cfg(test)]
    fn distance(&self, p: DVec2) -> f64 {
        self.core(p) - self.radius
    }

    /// Signed distance from what has not been grown.
    fn core(&self, p: DVec2) -> f64 {
        let sides = self.corners.iter().zip(&self.outward).map(|(&corner, &normal)| (p - corner).dot(normal));
        let inside = sides.fold(f64::NEG_INFINITY, f64::max);
        if inside <= 0.0 && !self.outward.is_empty() {
            return inside;
        }
        self.edges().map(|(a, b)| p.distance_squared(nearest(p, a, b))).fold(f64::INFINITY, f64::min).sqrt()
    }

    fn edges(&self) -> impl Iterator<Item = (DVec2, DVec2)> {
        let n = self.corners.len();
        (0..n).map(move |i| (self.corners[i], self.corners[if i + 1 < n { i + 1 } else { 0 }]))
    }

    /// Whether the segment from `a` to `b` stays further away than `distance`.
    #[inline]
    pub fn clear(&self, a: DVec2, b: DVec2, distance: f64) -> bool {
        let far = self.reach + distance;
        // Most are so far away that this is plain from the middle alone.
        if self.centre.distance_squared((a + b) * 0.5) > 2.0 * far * far + 0.5 * a.distance_squared(b) {
            return true;
        }
        let beyond = self.centre.distance_squared(nearest(self.centre, a, b)) > far * far;
        beyond || (!self.outward.is_empty() && (self.beside(a, b, distance) || self.segment_distance(a, b) > distance))
    }

    /// Whether the segment lies on the far side of an edge.
    fn beside(&self, a: DVec2, b: DVec2, distance: f64) -> bool {
        let far = self.radius + distance;
        let sides = self.corners.iter().zip(&self.outward);
        sides.into_iter().any(|(&corner, &normal)| (a - corner).dot(normal).min((b - corner).dot(normal)) > far)
    }

    /// Distance of the segment from `a` to `b`, negative or zero if it touches.
    pub fn segment_distance(&self, a: DVec2, b: DVec2) -> f64 {
        if self.outward.is_empty() {
            return self.centre.distance(nearest(self.centre, a, b)) - self.radius;
        }
        let ends = self.core(a).min(self.core(b));
        let corners = self.corners.iter().map(|&c| c.distance(nearest(c, a, b))).fold(ends, f64::min);
        if ends > 0.0 && self.edges().any(|(c, d)| crosses(a, b, c, d)) {
            return -self.radius;
        }
        corners - self.radius
    }

    /// Mean of its corners.
    pub fn centre(&self) -> DVec2 {
        self.centre
    }

    /// How far `p` must go in direction `n` until it has left the obstacle grown by `margin`; none if it is not in the way.
    pub fn way_out(&self, p: DVec2, n: DVec2, margin: f64) -> Option<f64> {
        let radius = self.radius + margin;
        let discs = self.corners.iter().filter_map(|&corner| {
            let aside = (corner - p).perp_dot(n);
            (aside.abs() < radius).then(|| (corner - p).dot(n) + (radius * radius - aside * aside).sqrt())
        });
        let sides = self.edges().enumerate().filter_map(|(i, (a, b))| {
            let out = self.outward.get(i)? * radius;
            let (sa, sb) = ((a + out - p).perp_dot(n), (b + out - p).perp_dot(n));
            (sa * sb < 0.0).then(|| (a + out - p).lerp(b + out - p, sa / (sa - sb)).dot(n))
        });
        discs.chain(sides).max_by(f64::total_cmp).filter(|&way| way > 0.0)
    }

    /// Distance between this and another obstacle; negative or zero if they touch.
    pub fn gap(&self, other: &Self) -> f64 {
        let sides = self.edges().map(|(a, b)| other.segment_distance(a, b));
        sides.fold(f64::INFINITY, f64::min) - self.radius
    }

    /// The point furthest in direction `d`.
    pub fn support(&self, d: DVec2) -> DVec2 {
        let far = |p: &&DVec2, q: &&DVec2| p.dot(d).total_cmp(&q.dot(d));
        self.corners.iter().max_by(far).copied().unwrap_or(self.centre) + d * self.radius
    }
}

/// The point of the segment from `a` to `b` nearest to `p`.
fn nearest(p: DVec2, a: DVec2, b: DVec2) -> DVec2 {
    let ab = b - a;
    let t = ((p - a).dot(ab) / ab.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    a + ab * t
}

fn crosses(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    let side = |p: DVec2, q: DVec2, x: DVec2| (q - p).perp_dot(x - p) > 0.0;
    side(a, b, c) != side(a, b, d) && side(c, d, a) != side(c, d, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bench() -> Obstacle {
        Obstacle::new(&Shape::oblong(Vec2::new(1.0, 2.0), Vec2::new(2.0, 0.5), 0.0), 0.25)
    }

    #[test]
    fn distances_of_a_box() {
        assert!((bench().distance(DVec2::new(1.0, 3.0)) - 0.5).abs() < 1e-6);
        assert!((bench().distance(DVec2::new(1.9, 2.0)) + 0.35).abs() < 1e-6);
        assert!((bench().distance(DVec2::new(3.0, 3.25)) - 2.0_f64.sqrt() + 0.25).abs() < 1e-6);
        assert!((bench().segment_distance(DVec2::new(-2.0, 3.0), DVec2::new(5.0, 3.0)) - 0.5).abs() < 1e-6);
        assert!(bench().segment_distance(DVec2::new(1.0, 0.0), DVec2::new(1.0, 4.0)) < 0.0);
        assert!((bench().support(DVec2::X).x - 2.25).abs() < 1e-6);
    }

    #[test]
    fn what_is_clear_is_as_far_away_as_that() {
        for i in 0..400 {
            let a = DVec2::new(1.0, 2.0) + DVec2::from_angle(f64::from(i)) * 0.005 * f64::from(i);
            let b = a + DVec2::from_angle(1.7 * f64::from(i)) * 0.3;
            let distance = bench().segment_distance(a, b);
            assert!(bench().clear(a, b, distance - 1e-6) || distance <= 0.0);
            assert!(!bench().clear(a, b, distance + 1e-6));
        }
    }

    #[test]
    fn the_way_out_ends_on_the_grown_outline() {
        for shape in
            [Shape::disc(Vec2::new(1.0, 2.0), 0.4), Shape::oblong(Vec2::new(1.0, 2.0), Vec2::new(2.0, 0.5), 0.4)]
        {
            let obstacle = Obstacle::new(&shape, 0.25);
            for i in 0..40 {
                let p = DVec2::new(1.0, 2.0) + DVec2::from_angle(f64::from(i)) * 0.02 * f64::from(i);
                let n = DVec2::from_angle(1.7 * f64::from(i));
                match obstacle.way_out(p, n, 0.06) {
                    Some(way) => assert!((obstacle.distance(p + n * way) - 0.06).abs() < 1e-6, "{i}"),
                    None => assert!(obstacle.distance(p) >= 0.06, "{i}"),
                }
            }
        }
    }

    #[test]
    fn polygons_that_are_not_convex_are_named() {
        let dent = [(0.0, 0.0), (4.0, 0.0), (1.0, 1.0), (0.0, 4.0)].map(|(x, z)| Vec2::new(x, z));
        assert!(convex_problem(&dent).unwrap().contains("corner 2"));
        let star: Vec<Vec2> = (0..5).map(|i| Vec2::from_angle(i as f32 * 2.0 * std::f32::consts::TAU / 5.0)).collect();
        assert!(convex_problem(&star).unwrap().contains("once"));
        let square = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)].map(|(x, z)| Vec2::new(x, z));
        assert_eq!(convex_problem(&square), None);
        let clockwise: Vec<Vec2> = square.iter().rev().copied().collect();
        assert!(convex_problem(&clockwise).is_some());
        assert!(Shape::disc(Vec2::ZERO, 0.0).problem().is_some());
    }
}
