//! Domains that repeat: what leaves on one side comes in on the other. Along the directions that repeat, places are only
//! told apart up to a whole number of periods, and ticks up to a whole number of laps.

use glam::{Vec2, Vec3};

/// Directions in which a domain repeats.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Periodic {
    /// Along x.
    pub x: bool,
    /// Along z.
    pub z: bool,
    /// In time.
    pub t: bool,
}

impl Periodic {
    /// True if it repeats in any.
    pub fn any(self) -> bool {
        self.x || self.z || self.t
    }

    /// True if it repeats in none.
    pub fn none(&self) -> bool {
        !self.any()
    }

    /// True if it repeats along x or z.
    pub fn in_space(self) -> bool {
        self.x || self.z
    }
}

/// The ground plane rolled up along the directions that repeat. With none it is the plane: every operation then gives
/// the very number that comes without it, at the cost of a few multiplications.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Torus {
    middle: Vec2,
    /// Zero along directions that do not repeat.
    period: Vec2,
    inverse: Vec2,
}

/// Added and taken away again, it rounds a number below 2^22 to the nearest whole one: `round` would be a call.
const ROUNDER: Vec2 = Vec2::splat(12_582_912.0);

impl Torus {
    /// The rectangle from `min` to `max` rolled up.
    pub fn new(min: Vec2, max: Vec2, periodic: Periodic) -> Self {
        let repeats = Vec2::new(f32::from(u8::from(periodic.x)), f32::from(u8::from(periodic.z)));
        Self { middle: (min + max) * 0.5, period: (max - min) * repeats, inverse: repeats / (max - min) }
    }

    /// The periods in metres; 0 along a direction that does not repeat.
    pub fn period(self) -> Vec2 {
        self.period
    }

    /// True if nothing repeats.
    pub fn is_plane(self) -> bool {
        self.period == Vec2::ZERO
    }

    /// How many periods a difference spans, to the nearest whole number.
    #[inline]
    pub fn laps(self, difference: Vec2) -> Vec2 {
        (difference * self.inverse + ROUNDER) - ROUNDER
    }

    /// The whole periods that are nearest to a difference, metres.
    #[inline]
    pub fn whole(self, difference: Vec2) -> Vec2 {
        self.period * self.laps(difference)
    }

    /// The shortest of all differences that are the same but for whole periods.
    #[inline]
    pub fn nearest(self, difference: Vec2) -> Vec2 {
        difference - self.whole(difference)
    }

    /// All images of a place of the rectangle that are in it or not farther than `margin` beyond its sides.
    pub fn images(self, place: Vec2, margin: f32) -> impl Iterator<Item = Vec2> {
        let lap = |k: i32| Vec2::new((k % 3 - 1) as f32, (k / 3 - 1) as f32);
        let repeats = self.period.cmpgt(Vec2::ZERO);
        let half = Vec2::select(repeats, self.period * 0.5 + margin, Vec2::splat(f32::MAX));
        let possible = (0..9).map(lap).filter(move |lap| (Vec2::select(repeats, Vec2::ZERO, *lap)) == Vec2::ZERO);
        let images = possible.map(move |lap| place + lap * self.period);
        images.filter(move |p| (*p - self.middle).abs().cmple(half).all())
    }

    /// The same of a difference in space.
    pub fn nearest3(self, difference: Vec3) -> Vec3 {
        let whole = self.whole(Vec2::new(difference.x, difference.z));
        difference - Vec3::new(whole.x, 0.0, whole.y)
    }

    /// Where in the rectangle a place is.
    #[inline]
    pub fn wrap(self, place: Vec2) -> Vec2 {
        place - self.whole(place - self.middle)
    }
}

/// Ticks that come round again after some time, or never.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cycle {
    ticks: i32,
}

impl Cycle {
    /// Time that never comes round.
    pub const NEVER: Self = Self { ticks: 0 };

    /// Time that comes round after so many ticks.
    ///
    /// # Panics
    /// There must be some.
    pub fn new(ticks: i32) -> Self {
        assert!(ticks > 0, "expected a lap of at least a tick, found {ticks}");
        Self { ticks }
    }

    /// True if time comes round.
    #[inline]
    pub fn loops(self) -> bool {
        self.ticks > 0
    }

    /// Ticks of a lap; 0 if time never comes round.
    pub fn ticks(self) -> i32 {
        self.ticks
    }

    /// The same moment in the lap that begins at `from`.
    #[inline]
    pub fn fold(self, tick: i32, from: i32) -> i32 {
        if self.loops() { from + (tick - from).rem_euclid(self.ticks) } else { tick }
    }

    /// The same moment in the lap that begins at tick 0.
    #[inline]
    pub fn slot(self, tick: i32) -> i32 {
        self.fold(tick, 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn place() -> impl Strategy<Value = Vec2> {
        (-200.0f32..200.0, -200.0f32..200.0).prop_map(|(x, z)| Vec2::new(x, z))
    }

    fn tile(periodic: Periodic) -> Torus {
        Torus::new(Vec2::new(-3.0, 1.0), Vec2::new(7.0, 9.0), periodic)
    }

    fn periodic() -> impl Strategy<Value = Periodic> {
        (any::<bool>(), any::<bool>()).prop_map(|(x, z)| Periodic { x, z, t: false })
    }

    proptest! {
        #[test]
        fn distances_are_symmetric_and_blind_to_whole_periods(
            p in place(), q in place(), periodic in periodic(), laps in (-9i32..9, -9i32..9),
        ) {
            let torus = tile(periodic);
            let shift = torus.period() * Vec2::new(laps.0 as f32, laps.1 as f32);
            let apart = torus.nearest(p - q).length();
            prop_assert!((apart - torus.nearest(q - p).length()).abs() < 1e-3);
            prop_assert!((apart - torus.nearest(p + shift - q).length()).abs() < 1e-3);
            prop_assert!((torus.nearest(torus.wrap(p) - torus.wrap(q)).length() - apart).abs() < 1e-3);
            prop_assert!(apart <= p.distance(q) + 1e-3);
        }

        #[test]
        fn no_image_is_nearer_than_the_nearest(p in place(), q in place(), periodic in periodic()) {
            let torus = tile(periodic);
            let nearest = torus.nearest(p - q).length();
            for image in 0..25 {
                let laps = Vec2::new((image % 5 - 2) as f32, (image / 5 - 2) as f32);
                prop_assert!(nearest <= (torus.wrap(p) - torus.wrap(q) + laps * torus.period()).length() + 1e-3);
            }
        }

        #[test]
        fn wrapped_places_lie_in_the_rectangle_and_plain_ones_stay(p in place()) {
            let inside = tile(Periodic { x: true, z: true, t: false }).wrap(p);
            prop_assert!(inside.cmpge(Vec2::new(-3.001, 0.999)).all() && inside.cmple(Vec2::new(7.001, 9.001)).all());
            let plain = tile(Periodic::default());
            prop_assert_eq!((plain.wrap(p), plain.nearest(p)), (p, p));
        }

        #[test]
        fn ticks_come_round(tick in -5000i32..5000, from in -900i32..900, lap in 1i32..700) {
            let cycle = Cycle::new(lap);
            let folded = cycle.fold(tick, from);
            prop_assert!((from..from + lap).contains(&folded) && (folded - tick) % lap == 0);
            prop_assert_eq!(Cycle::default().fold(tick, from), tick);
        }
    }
}
