//! The domain as the inner loops see it: how far each ground point is from walls and obstacles, and the time span.

use glam::Vec2;

use super::Scene;
use crate::geom::Polygon;
use crate::{Error, Result};

/// Cell size of the clearance grid in metres.
const CELL: f32 = 0.1;
/// A body needs at least this much room to stand, metres.
const BODY_ROOM: f32 = 0.3;

/// Region, obstacles and time span of a scene.
pub(super) struct Domain {
    /// Lower corner of the bounding box.
    pub min: Vec2,
    /// Upper corner of the bounding box.
    pub max: Vec2,
    /// Bodies are looked at on ticks 0..horizon.
    pub horizon: i32,
    region: Polygon,
    obstacles: Vec<Polygon>,
    clearance: Vec<f32>,
    columns: usize,
    rows: usize,
}

impl Domain {
    /// # Errors
    /// The obstacles leave nowhere to stand.
    pub fn new(scene: &Scene) -> Result<Self> {
        let (min, max) = scene.region.bounds();
        let columns = ((max.x - min.x) / CELL).ceil() as usize + 1;
        let rows = ((max.y - min.y) / CELL).ceil() as usize + 1;
        if columns.saturating_mul(rows) > 1 << 28 {
            return Err(Error::invalid(
                "scene",
                "region",
                format!("{} x {} m is too large", max.x - min.x, max.y - min.y),
            ));
        }
        let mut domain = Self {
            min,
            max,
            horizon: scene.last_frame() + 1,
            region: scene.region.clone(),
            obstacles: scene.obstacles.clone(),
            clearance: Vec::new(),
            columns,
            rows,
        };
        let node =
            |i: usize| domain.exact_clearance(min + Vec2::new((i % columns) as f32, (i / columns) as f32) * CELL);
        domain.clearance = (0..columns * rows).map(node).collect();
        if domain.clearance.iter().all(|&c| c < BODY_ROOM) {
            let problem = format!("expected room for a body of {BODY_ROOM} m, found none outside the obstacles");
            return Err(Error::invalid("scene", "region", problem));
        }
        Ok(domain)
    }

    /// Distance to the nearest wall or obstacle; negative beyond.
    pub fn exact_clearance(&self, p: Vec2) -> f32 {
        let inside = -self.region.signed_distance(p);
        self.obstacles.iter().map(|o| o.signed_distance(p)).fold(inside, f32::min)
    }

    /// True if a disc certainly lies inside the region and outside the obstacles.
    #[inline]
    pub fn holds(&self, center: Vec2, radius: f32) -> bool {
        // The nearest node; casts round towards zero.
        let cell = (center - self.min) / CELL + 0.5;
        if cell.x < 0.0 || cell.y < 0.0 || cell.x >= self.columns as f32 || cell.y >= self.rows as f32 {
            return false;
        }
        let node = self.clearance[cell.y as usize * self.columns + cell.x as usize];
        // Clearance changes by at most the distance to the node.
        if node - CELL * std::f32::consts::FRAC_1_SQRT_2 >= radius {
            return true;
        }
        node + CELL * std::f32::consts::FRAC_1_SQRT_2 >= radius && self.exact_clearance(center) >= radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holds_agrees_with_exact_clearance() {
        let mut scene = Scene::demo();
        scene.obstacles.push(Polygon::rectangle(Vec2::splat(4.0), Vec2::splat(6.0)));
        let domain = Domain::new(&scene).unwrap();
        for i in 0..4000 {
            let p = Vec2::new((i % 63) as f32 * 0.2, (i / 63) as f32 * 0.2) - 0.3;
            let c = domain.exact_clearance(p);
            // No body has a negative radius.
            assert!(domain.holds(p, c - 1e-3) || c < 1e-3, "{p} {c}");
            assert!(!domain.holds(p, c + 1e-3));
        }
    }

    #[test]
    fn obstacles_that_fill_the_region_are_refused() {
        let mut scene = Scene::demo();
        scene.obstacles.push(Polygon::rectangle(Vec2::splat(-1.0), Vec2::splat(13.0)));
        assert!(Domain::new(&scene).err().unwrap().to_string().contains("room"));
    }
}
