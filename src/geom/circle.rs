//! The smallest circle around discs.

use glam::DVec2;

/// A middle and a radius.
pub type Disc = (DVec2, f64);

/// Middle and radius of the smallest circle around discs; of radius 0 around none. The circle of a few of them, the basis, is
/// widened by the disc that reaches farthest out of it until none does: as the radius grows each time, that ends. O(discs) for
/// each widening, of which there are a handful.
pub fn smallest_circle(discs: &[Disc]) -> Disc {
    let Some(&first) = discs.iter().max_by(|a, b| a.1.total_cmp(&b.1)) else { return (DVec2::ZERO, 0.0) };
    let (mut basis, mut circle) = (vec![first], first);
    loop {
        let reach = |disc: &Disc| circle.0.distance(disc.0) + disc.1;
        let Some(&farthest) = discs.iter().max_by(|a, b| reach(a).total_cmp(&reach(b))) else { return circle };
        if reach(&farthest) <= circle.1 + slack(circle.1) {
            return circle;
        }
        basis.push(farthest);
        let Some((wider, kept)) = of_few(&basis).filter(|(wider, _)| wider.1 > circle.1) else { return circle };
        (circle, basis) = (wider, kept);
    }
}

/// What rounding is let pass.
fn slack(radius: f64) -> f64 {
    1e-9 * (1.0 + radius)
}

/// The smallest circle around up to four discs, and those of them that it touches from outside.
fn of_few(discs: &[Disc]) -> Option<(Disc, Vec<Disc>)> {
    let chosen = |set: u32| (0..discs.len()).filter(move |i| set & 1 << i != 0).map(|i| discs[i]).collect::<Vec<_>>();
    let holds = |circle: &Disc| discs.iter().all(|d| circle.0.distance(d.0) + d.1 <= circle.1 + slack(circle.1));
    let sets = (1u32..1 << discs.len()).filter(|set| set.count_ones() <= 3).map(chosen);
    let circles = sets.filter_map(|set| Some((touching(&set).filter(holds)?, set)));
    circles.min_by(|a, b| a.0.1.total_cmp(&b.0.1))
}

/// The circle that touches one, two or three discs, which lie inside of it; the smallest if there are several, `None` if none.
fn touching(discs: &[Disc]) -> Option<Disc> {
    match *discs {
        [disc] => Some(disc),
        [(p, a), (q, b)] => {
            let apart = p.distance(q);
            let radius = 0.5 * (apart + a + b);
            (apart > (a - b).abs()).then(|| (p + (q - p) * ((radius - a) / apart), radius))
        }
        [(p, a), (q, b), (r, c)] => {
            // Differences of |middle - p| = radius - a, squared, are linear: middle = p + m + n (radius - a).
            let (u, v, d, e) = (q - p, r - p, b - a, c - a);
            let area = u.perp_dot(v);
            if area.abs() < 1e-12 {
                return None;
            }
            let solved = |x: f64, y: f64| DVec2::new(x * v.y - y * u.y, y * u.x - x * v.x) / area;
            let m = solved(0.5 * (u.length_squared() - d * d), 0.5 * (v.length_squared() - e * e));
            let n = solved(d, e);
            let (x, y, z) = (n.length_squared() - 1.0, m.dot(n), m.length_squared());
            // x t^2 + 2 y t + z = 0 with t = radius - a.
            let roots = if x.abs() < 1e-12 {
                [-z / (2.0 * y), f64::NAN]
            } else {
                let root = (y * y - x * z).sqrt();
                [(-y - root) / x, (-y + root) / x]
            };
            let fits = |t: &f64| t.is_finite() && *t + a >= a.max(b).max(c);
            let least = roots.into_iter().filter(fits).min_by(f64::total_cmp)?;
            Some((p + m + n * least, least + a))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn reach(from: DVec2, discs: &[Disc]) -> f64 {
        discs.iter().map(|d| from.distance(d.0) + d.1).fold(0.0, f64::max)
    }

    proptest! {
        /// How far the discs reach from a place is convex: who finds nothing better near by has the best.
        #[test]
        fn all_lie_inside_and_no_place_near_by_is_better(
            raw in prop::collection::vec((-3.0f64..3.0, -3.0f64..3.0, 0.0f64..0.8), 1..14),
        ) {
            let discs: Vec<Disc> = raw.into_iter().map(|(x, y, r)| (DVec2::new(x, y), r)).collect();
            let (middle, radius) = smallest_circle(&discs);
            prop_assert!((reach(middle, &discs) - radius).abs() < 1e-7);
            for step in [1e-1, 1e-2, 1e-3, 1e-4] {
                for k in 0..24 {
                    let near = middle + step * DVec2::from_angle(std::f64::consts::TAU * f64::from(k) / 24.0);
                    prop_assert!(reach(near, &discs) >= radius - 1e-7, "{}", reach(near, &discs) - radius);
                }
            }
        }
    }

    #[test]
    fn nothing_one_point_points_on_a_line_and_discs_in_discs() {
        assert_eq!(smallest_circle(&[]).1, 0.0);
        let on_line: Vec<Disc> = [0.0, 1.0, 4.0, 2.0].map(|x| (DVec2::new(x, 2.0 * x), 0.0)).to_vec();
        assert!((smallest_circle(&on_line).1 - 0.5 * 80f64.sqrt()).abs() < 1e-9);
        assert_eq!(smallest_circle(&on_line[..1]), (DVec2::ZERO, 0.0));
        let inside = [(DVec2::X, 2.0), (DVec2::new(1.5, 0.2), 0.3), (DVec2::X, 2.0)];
        assert_eq!(smallest_circle(&inside), (DVec2::X, 2.0));
    }
}
