//! A walker's path as chords on the common clock.

use glam::DVec2;

use crate::world::Path;

/// Chords per step of the path.
pub(super) const CHORDS: i64 = 4;

/// A path cut into chords; chord `i` begins `(begin + i)` chord times after time 0.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    /// Number of the first chord on the common clock.
    pub begin: i64,
    /// Ends of the chords, one more than chords.
    pub places: Vec<DVec2>,
    /// Velocity at the ends, m/s.
    pub velocities: Vec<DVec2>,
    /// Greatest acceleration during each chord, m/s2.
    pub accelerations: Vec<f64>,
    /// Greatest speed of the whole curve, m/s (from the control polygon: never too low).
    pub speed: f64,
}

impl Curve {
    /// Cuts `path`. `None` if it has fewer than four control points or is not finite.
    pub fn new(path: &Path) -> Option<Self> {
        let p: Vec<DVec2> = path.points.iter().map(|p| p.as_dvec2()).collect();
        let step = f64::from(path.step);
        if p.len() < 4 || !p.iter().all(|p| p.is_finite()) || !(step.is_finite() && step > 0.0) {
            return None;
        }
        let knot_acceleration = |k: usize| ((p[k + 1] - p[k]) - (p[k] - p[k - 1])).length() / (step * step);
        let mut curve = Self {
            begin: (i64::from(path.first) + 1) * CHORDS,
            places: Vec::new(),
            velocities: Vec::new(),
            accelerations: Vec::new(),
            speed: p.windows(2).map(|w| w[0].distance(w[1]) / step).fold(0.0, f64::max),
        };
        for segment in 0..p.len() - 3 {
            let greatest = knot_acceleration(segment + 1).max(knot_acceleration(segment + 2));
            for i in 0..CHORDS {
                curve.push(&p[segment..segment + 4], i as f64 / CHORDS as f64, step);
                curve.accelerations.push(greatest);
            }
        }
        curve.push(&p[p.len() - 4..], 1.0, step);
        Some(curve)
    }

    /// Appends place and velocity at share `u` of a segment, by repeated interpolation (de Boor).
    fn push(&mut self, p: &[DVec2], u: f64, step: f64) {
        let (place, velocity) = evaluate(p, u);
        self.places.push(place);
        self.velocities.push(velocity / step);
    }

    /// Number of the chord after the last.
    pub fn end(&self) -> i64 {
        self.begin + self.accelerations.len() as i64
    }

    /// Ends of chord number `chord`, and how far the curve may leave it.
    pub fn chord(&self, chord: i64, secs: f64) -> (DVec2, DVec2, f64) {
        let i = (chord - self.begin) as usize;
        (self.places[i], self.places[i + 1], self.accelerations[i] * secs * secs / 8.0)
    }
}

/// Place and velocity (per segment) of a uniform cubic B-spline.
fn evaluate(p: &[DVec2], u: f64) -> (DVec2, DVec2) {
    let level = |points: &[DVec2], width: f64| -> Vec<DVec2> {
        let n = points.len() - 1;
        let share = |i: usize| (u + (n - 1 - i) as f64) / width;
        (0..n).map(|i| points[i].lerp(points[i + 1], share(i))).collect()
    };
    let first = level(p, 3.0);
    let second = level(&first, 2.0);
    (second[0].lerp(second[1], u), 3.0 * (second[1] - second[0]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    #[test]
    fn de_boor_agrees_with_the_polynomials() {
        let points = (0..7).map(|i| Vec2::new(i as f32 * 0.25, (i * i % 4) as f32 * 0.1)).collect();
        let path = Path { step: 0.2, first: 3, points };
        let curve = Curve::new(&path).unwrap();
        for (i, (place, velocity)) in curve.places.iter().zip(&curve.velocities).enumerate() {
            let time = (curve.begin + i as i64) as f64 * 0.2 / CHORDS as f64;
            assert!(place.distance(path.position(time).as_dvec2()) < 1e-5);
            assert!(velocity.distance(path.velocity(time).as_dvec2()) < 1e-4);
        }
        assert_eq!(curve.places.len(), curve.accelerations.len() + 1);
    }
}
