//! The smallest circle around discs, seen from above.

use glam::Vec2;

/// Rounds of going towards what is farthest: what is left is less than 1 % of the radius.
const ROUNDS: usize = 150;

/// Middle and radius of nearly the smallest circle around discs (middle, radius), after Badoiu and Clarkson. O(discs).
pub(super) fn around(discs: &[(Vec2, f32)]) -> (Vec2, f32) {
    let reach = |from: Vec2, &(at, radius): &(Vec2, f32)| from.distance(at) + radius;
    let farthest = |from: Vec2| {
        let far = discs.iter().map(|d| (reach(from, d), d.0));
        far.fold((0.0, from), |best, next| if next.0 > best.0 { next } else { best })
    };
    let mut middle = discs.first().map_or(Vec2::ZERO, |d| d.0);
    let mut best = (middle, farthest(middle).0);
    for round in 0..ROUNDS {
        let (_, at) = farthest(middle);
        middle += (at - middle) / (round + 2) as f32;
        let radius = farthest(middle).0;
        if radius < best.1 {
            best = (middle, radius);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_discs_are_inside_and_the_circle_is_small() {
        let discs = [(Vec2::new(-1.0, 0.0), 0.5), (Vec2::new(2.0, 0.0), 0.1), (Vec2::new(0.3, 0.4), 0.2)];
        let (middle, radius) = around(&discs);
        assert!(discs.iter().all(|&(at, r)| middle.distance(at) + r <= radius + 1e-5));
        // From -1.5 to 2.1.
        assert!((1.8..1.83).contains(&radius), "{radius} about {middle}");
    }
}
