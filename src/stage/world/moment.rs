//! An instant of a world: which time slot, and how control points are weighted in it.

/// An instant: a time slot of a period, and the weights of a uniform cubic B-spline in it. The same for everybody, so it is
/// computed once per frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Which period, counted from time 0.
    pub lap: i64,
    /// Which slot of the period.
    pub slot: u32,
    /// Weights of four control points for places.
    pub place: [f32; 4],
    /// Weights of four control points for velocities, per second.
    pub velocity: [f32; 4],
}

impl Moment {
    /// The instant `time` (seconds, finite) in periods of `slots` slots.
    pub fn new(time: f64, period_secs: f64, slots: u32) -> Self {
        let n = i64::from(slots);
        let at = time / period_secs * f64::from(slots);
        let whole = at.floor();
        let count = whole as i64;
        let (u, per_sec) = ((at - whole) as f32, (f64::from(slots) / period_secs) as f32);
        let (place, velocity) = weights(u);
        let velocity = velocity.map(|w| w * per_sec);
        Self { lap: count.div_euclid(n), slot: count.rem_euclid(n) as u32, place, velocity }
    }

    /// The instant `slots` slots later, of periods of `n` slots.
    #[inline(always)]
    pub fn later(self, slots: u32, n: u32) -> Self {
        let slot = self.slot + slots;
        if slot < n { Self { slot, ..self } } else { Self { slot: slot - n, lap: self.lap + 1, ..self } }
    }
}

/// Weights of four control points for the place at a fraction `u` of a slot, and for the velocity per slot.
#[inline(always)]
pub(super) fn weights(u: f32) -> ([f32; 4], [f32; 4]) {
    let v = 1.0 - u;
    let (b, c) = ((3.0 * u - 6.0) * u * u + 4.0, ((-3.0 * u + 3.0) * u + 3.0) * u + 1.0);
    let velocity = [-0.5 * v * v, (1.5 * u - 2.0) * u, (-1.5 * u + 1.0) * u + 0.5, 0.5 * u * u];
    ([v * v * v / 6.0, b / 6.0, c / 6.0, u * u * u / 6.0], velocity)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slots_follow_each_other_before_and_after_time_zero() {
        let at = |time: f64| {
            let m = Moment::new(time, 10.0, 50);
            (m.lap, m.slot)
        };
        assert_eq!([at(0.0), at(9.99), at(10.0), at(-0.1), at(3600.3)], [(0, 0), (0, 49), (1, 0), (-1, 49), (360, 1)]);
        let later = Moment::new(9.9, 10.0, 50).later(3, 50);
        assert_eq!((later.lap, later.slot), (1, 2));
    }

    #[test]
    fn weights_add_up() {
        for i in 0..100 {
            let m = Moment::new(f64::from(i) * 0.0173, 10.0, 50);
            assert!((m.place.iter().sum::<f32>() - 1.0).abs() < 1e-6 && m.velocity.iter().sum::<f32>().abs() < 1e-5);
        }
    }
}
