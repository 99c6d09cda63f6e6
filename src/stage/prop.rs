//! Boxes of a finished crowd.

use super::Crowd;
use crate::geom::{Cuboid, Upright};
use crate::motion::FPS;

/// A box that people hold in both hands, pass, take up and put down. It stays level.
#[derive(Clone, Debug, PartialEq)]
pub struct Prop {
    /// Name, e.g. `box`.
    pub name: String,
    /// Full extents in metres: width between the hands, height, depth.
    pub size: [f32; 3],
    /// First frame at which it is there.
    pub begin: u32,
    /// Its place at every frame.
    pub places: Vec<Upright>,
    /// Who holds it when, in order; otherwise it rests.
    pub holds: Vec<Holding>,
}

/// A time over which somebody has a box in the hands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Holding {
    /// Index of the person.
    pub character: u32,
    /// First frame.
    pub begin: u32,
    /// Last frame, inclusive.
    pub end: u32,
}

impl Prop {
    /// Last frame at which it is there, inclusive.
    pub fn end(&self) -> u32 {
        self.begin + self.places.len().saturating_sub(1) as u32
    }

    /// The box at a frame of the crowd; `None` while it is not there.
    pub fn at_frame(&self, frame: u32) -> Option<Cuboid> {
        let place = self.places.get(frame.checked_sub(self.begin)? as usize)?;
        Some(Cuboid::new(*place, self.size))
    }

    /// Its place at `secs`, by interpolation; `None` while it is not there. No allocation, no state.
    pub fn sample(&self, secs: f32) -> Option<Upright> {
        let at = secs * FPS - self.begin as f32;
        let last = self.places.len().checked_sub(1)?;
        if !(at >= 0.0 && at <= last as f32) {
            return None;
        }
        let i = (at as usize).min(last.saturating_sub(1));
        Some(self.places[i].lerp(self.places[(i + 1).min(last)], at - i as f32))
    }

    /// The people who hold it at a frame of the crowd: one, two while it is passed, none while it rests.
    pub fn holders(&self, frame: u32) -> impl Iterator<Item = u32> {
        self.holds.iter().filter(move |h| h.begin <= frame && frame <= h.end).map(|h| h.character)
    }
}

impl Crowd {
    /// Where every box is at `secs`: its index in [`Crowd::props`] and its place.
    pub fn props_at(&self, secs: f32) -> impl Iterator<Item = (usize, Upright)> {
        self.props.iter().enumerate().filter_map(move |(i, prop)| Some((i, prop.sample(secs)?)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_box_is_where_it_is_between_its_frames() {
        let place = |x: f32, heading: f32| Upright { middle: Vec3::new(x, 1.0, 0.0), heading };
        // Turning the short way over half a turn.
        let places = vec![place(0.0, 3.0), place(0.3, -3.0), place(0.6, -3.0)];
        let holds = vec![Holding { character: 4, begin: 30, end: 31 }, Holding { character: 2, begin: 31, end: 32 }];
        let prop = Prop { name: "box".into(), size: [0.4, 0.3, 0.2], begin: 30, places, holds };
        let half = prop.sample(30.5 / FPS).unwrap();
        assert!((half.middle.x - 0.15).abs() < 1e-5 && (half.heading - std::f32::consts::PI).abs() < 1e-4, "{half:?}");
        assert_eq!((prop.sample(29.9 / FPS), prop.sample(32.1 / FPS), prop.at_frame(33)), (None, None, None));
        assert_eq!((prop.sample(f32::NAN), prop.at_frame(29), prop.end()), (None, None, 32));
        assert_eq!(prop.sample(32.0 / FPS), Some(prop.places[2]));
        assert_eq!(prop.holders(31).collect::<Vec<_>>(), [4, 2]);
        assert_eq!(prop.holders(32).collect::<Vec<_>>(), [2]);
    }
}
