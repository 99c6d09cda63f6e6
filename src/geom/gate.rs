//! Gates: places where people come in or go out.

use glam::Vec2;

use super::{Ground, wrap_angle};

/// A place where people come in or go out: a stretch of ground, mostly of the border.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Gate {
    /// One end of the stretch, metres.
    pub from: Vec2,
    /// The other; the same for a point.
    pub to: Vec2,
    /// Which way people look, radians; any if none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heading: Option<f32>,
    /// How far from it they may look, radians.
    pub spread: f32,
    /// Pose group they are in, by name; any if none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub group: Option<String>,
}

impl Gate {
    /// Distance of a place from the stretch, metres.
    pub fn distance(&self, place: Vec2) -> f32 {
        let (along, to) = (self.to - self.from, place - self.from);
        let t = (to.dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
        to.distance(along * t)
    }

    /// How far somebody looks away from where people at the gate may look, radians; 0 if within the spread.
    pub fn turned_away(&self, at: Ground) -> f32 {
        self.heading.map_or(0.0, |wanted| (wrap_angle(at.heading - wanted).abs() - self.spread).max(0.0))
    }

    /// What is wrong with it, if anything.
    pub fn problem(&self) -> Option<String> {
        let sound = self.from.is_finite()
            && self.to.is_finite()
            && self.spread.is_finite()
            && self.heading.is_none_or(f32::is_finite);
        (!sound).then(|| format!("expected finite numbers, found {self:?}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::{FRAC_PI_2, PI};

    #[test]
    fn distance_is_to_the_stretch_and_headings_wrap() {
        let gate = Gate { from: Vec2::ZERO, to: Vec2::new(0.0, 4.0), heading: Some(PI), spread: 0.25, group: None };
        assert_eq!(gate.distance(Vec2::new(0.5, 2.0)), 0.5);
        assert_eq!(gate.distance(Vec2::new(0.0, 7.0)), 3.0);
        let point = Gate { to: gate.from, ..gate.clone() };
        assert_eq!(point.distance(Vec2::new(3.0, 4.0)), 5.0);
        let looking = |heading: f32| gate.turned_away(Ground::new(Vec2::ZERO, heading));
        assert_eq!((looking(-PI), looking(PI + 0.2)), (0.0, 0.0));
        assert!((looking(FRAC_PI_2) - (FRAC_PI_2 - 0.25)).abs() < 1e-5);
        assert_eq!(Gate { heading: None, ..gate }.turned_away(Ground::new(Vec2::ZERO, 1.0)), 0.0);
        assert!(point.problem().is_none() && Gate { spread: f32::NAN, ..point }.problem().is_some());
    }
}
