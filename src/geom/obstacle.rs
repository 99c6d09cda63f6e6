//! Obstacles: prisms on the ground that stand or move, of any height or of so much that one can get over them.

use glam::Vec2;

use super::{Ground, Polygon};

/// Where a moving obstacle is at a moment.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Waypoint {
    /// When, seconds.
    pub secs: f32,
    /// Where the origin of the outline is, metres.
    pub position: Vec2,
    /// Turn about the vertical in radians; not wrapped.
    pub heading: f32,
}

/// A prism that people stay out of.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Obstacle {
    /// Its outline: on the ground of the scene if it stands, about its way-points if it moves.
    #[serde(flatten)]
    pub outline: Polygon,
    /// How high it is, metres; none is over all heads.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<f32>,
    /// Way-points in order of time, between which it goes straight and turns evenly, at rest before the first and
    /// after the last; empty if it stands.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub path: Vec<Waypoint>,
}

impl From<Polygon> for Obstacle {
    fn from(outline: Polygon) -> Self {
        Self { outline, height: None, path: vec![] }
    }
}

impl Obstacle {
    /// True if it never moves and nothing gets over it.
    pub fn is_wall(&self) -> bool {
        self.path.is_empty() && self.height.is_none()
    }

    /// `world_from_outline` at a moment.
    pub fn place(&self, secs: f32) -> Ground {
        let next = self.path.partition_point(|w| w.secs <= secs);
        let ground = |w: &Waypoint| Ground::new(w.position, w.heading);
        match (next.checked_sub(1).map(|i| &self.path[i]), self.path.get(next)) {
            (None, None) => Ground::IDENTITY,
            (Some(w), None) | (None, Some(w)) => ground(w),
            (Some(a), Some(b)) => {
                let t = (secs - a.secs) / (b.secs - a.secs);
                Ground::new(a.position.lerp(b.position, t), a.heading + (b.heading - a.heading) * t)
            }
        }
    }

    /// The outline on the ground of the scene at a moment.
    pub fn outline_at(&self, secs: f32) -> Polygon {
        let place = self.place(secs);
        Polygon { points: self.outline.points.iter().map(|&p| place.apply(p)).collect() }
    }

    /// What is wrong with height and way-points, if anything.
    pub fn problem(&self) -> Option<String> {
        if let Some(h) = self.height.filter(|h| !(h.is_finite() && *h > 0.0)) {
            return Some(format!("expected a height of more than 0 m, found {h}"));
        }
        if let Some(w) =
            self.path.iter().find(|w| !(w.position.is_finite() && w.heading.is_finite() && w.secs.is_finite()))
        {
            return Some(format!("expected finite way-points, found {w:?}"));
        }
        let late = self.path.windows(2).find(|w| w[0].secs >= w[1].secs);
        late.map(|w| format!("expected way-points in order of time, found {} s after {} s", w[1].secs, w[0].secs))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::FRAC_PI_2;

    fn waypoint(secs: f32, x: f32, z: f32, heading: f32) -> Waypoint {
        Waypoint { secs, position: Vec2::new(x, z), heading }
    }

    #[test]
    fn a_moving_obstacle_is_on_its_way_and_rests_at_both_ends() {
        let outline = Polygon::rectangle(Vec2::new(-1.0, -0.5), Vec2::new(1.0, 0.5));
        let path = vec![waypoint(2.0, 0.0, 0.0, 0.0), waypoint(4.0, 4.0, 2.0, FRAC_PI_2)];
        let cart = Obstacle { path, height: Some(0.3), ..outline.clone().into() };
        assert_eq!(cart.place(-3.0), Ground::IDENTITY);
        assert_eq!(cart.place(3.0), Ground::new(Vec2::new(2.0, 1.0), FRAC_PI_2 / 2.0));
        assert_eq!(cart.place(9.0).position, Vec2::new(4.0, 2.0));
        // Turned by a quarter, what was left (+x) is behind (-z).
        assert!(cart.outline_at(4.0).points[1].distance(Vec2::new(3.5, 1.0)) < 1e-5, "{:?}", cart.outline_at(4.0));
        assert!((cart.outline_at(3.1).area() - outline.area()).abs() < 1e-4);
        assert!(!cart.is_wall() && Obstacle::from(outline).is_wall());
    }

    #[test]
    fn what_is_wrong_is_told() {
        let fine: Obstacle = Polygon::rectangle(Vec2::ZERO, Vec2::ONE).into();
        assert_eq!(fine.problem(), None);
        let path = vec![waypoint(2.0, 0.0, 0.0, 0.0), waypoint(2.0, 1.0, 0.0, 0.0)];
        assert!(Obstacle { path, ..fine.clone() }.problem().unwrap().contains("order of time"));
        assert!(Obstacle { height: Some(0.0), ..fine.clone() }.problem().unwrap().contains("height"));
        let path = vec![waypoint(2.0, f32::NAN, 0.0, 0.0)];
        assert!(Obstacle { path, ..fine }.problem().unwrap().contains("finite"));
    }

    #[test]
    fn files_of_walls_are_as_they_were() {
        let wall: Obstacle = Polygon::rectangle(Vec2::ZERO, Vec2::ONE).into();
        let json = serde_json::to_string(&wall).unwrap();
        assert_eq!(json, serde_json::to_string(&wall.outline).unwrap());
        assert_eq!(serde_json::from_str::<Obstacle>(&json).unwrap(), wall);
    }
}
