//! Repeating tiles ("Tiling Motion Patches", section 7): patches wrap around a region and a time that repeat.
//!
//! Nobody's places and ticks are wrapped: a person's path goes on as it is, and who compares two people does so through
//! [`Torus`] and [`Cycle`](crate::geom::Cycle), which know when two places or moments are the same. In time that comes
//! round everybody's life is a loop: a lap after its first patch has begun it is where it was, or there but for whole
//! periods, and the same again begins.

use glam::Vec2;

use super::Scene;
use crate::geom::{Obstacle, Polygon, Torus};
use crate::motion::FPS;
use crate::patch::PatchKind;
use crate::{Error, Result};

/// Nobody must meet an image of themselves, nor be met by two images of one other person: shortest period, metres.
const SHORTEST_PERIOD: f32 = 6.0;
/// Shortest lap: a life has to lead back to where it began, seconds.
const SHORTEST_LAP: f32 = 6.0;
/// A moving obstacle is back this nearly, metres and radians.
const BACK: f32 = 1e-3;

/// What keeps a scene from repeating as it wishes, if anything.
///
/// # Errors
/// Names what was expected and what was found.
pub(super) fn possible(scene: &Scene) -> Result<()> {
    let repeats = scene.periodic;
    let bad = |place: &str, problem: String| Err(Error::invalid("scene", place, problem));
    if repeats.in_space() {
        if let Some(found) = not_a_rectangle(&scene.region) {
            let problem = format!("expected a rectangle along x and z, because it repeats, found {found}");
            return bad("region", problem);
        }
        let (low, high) = scene.region.bounds();
        for (axis, wide, does) in [("x", high.x - low.x, repeats.x), ("z", high.y - low.y, repeats.z)] {
            if does && wide < SHORTEST_PERIOD {
                let problem =
                    format!("expected at least {SHORTEST_PERIOD} m along {axis}, because it repeats, found {wide} m");
                return bad("region", problem);
            }
        }
    }
    if repeats.t && scene.duration_secs < SHORTEST_LAP {
        let found = scene.duration_secs;
        return bad(
            "duration_secs",
            format!("expected at least {SHORTEST_LAP} s, because it repeats, found {found} s"),
        );
    }
    if repeats.t && !(scene.sources.is_empty() && scene.sinks.is_empty() && scene.teams.is_empty()) {
        let problem = "expected no sources, sinks and teams where \"t\" repeats: everybody's life is a loop";
        return bad("periodic", problem.into());
    }
    for (i, obstacle) in scene.obstacles.iter().enumerate() {
        if let Some(problem) = wayward(scene, obstacle) {
            return bad(&format!("obstacle {i}"), problem);
        }
    }
    Ok(())
}

/// What a region is, if it is no rectangle along the axes.
pub(super) fn not_a_rectangle(region: &Polygon) -> Option<String> {
    let (low, high) = region.bounds();
    let is_corner = |p: &Vec2| [(p.x, low.x, high.x), (p.y, low.y, high.y)].iter().all(|(v, a, b)| v == a || v == b);
    if region.points.len() != 4 {
        return Some(format!("{} corners", region.points.len()));
    }
    let corner = region.points.iter().find(|p| !is_corner(p))?;
    Some(format!("a corner at [{}, {}]", corner.x, corner.y))
}

/// Why an obstacle does not repeat, if it does not.
fn wayward(scene: &Scene, obstacle: &Obstacle) -> Option<String> {
    let (low, high) = scene.region.bounds();
    let (from, to) = obstacle.outline.bounds();
    let torus = Torus::new(low, high, scene.periodic);
    let too_wide = torus.period().cmpgt(Vec2::ZERO) & (to - from).cmpge(torus.period());
    if too_wide.any() {
        let (size, period) = (to - from, torus.period());
        return Some(format!("expected it smaller than the period of {period} m, found {size} m"));
    }
    let ends = [0.0, scene.last_frame() as f32 / FPS].map(|secs| obstacle.place(secs));
    let away = torus.nearest(ends[1].position - ends[0].position).length();
    let turned = crate::geom::wrap_angle(ends[1].heading - ends[0].heading).abs();
    if scene.periodic.t && (away > BACK || turned > BACK) {
        return Some(format!(
            "expected it back at the end, because time repeats, found it {away} m and {turned} rad off"
        ));
    }
    None
}

/// True if people can play a kind where something repeats: boxes stay out, because one that lies there, or is handed
/// over across the border, would have to be in several places.
pub(super) fn can_repeat(kind: &PatchKind) -> bool {
    kind.props.is_empty()
}

/// Distance from the nearest image of an outline.
pub(super) fn distance(outline: &Polygon, torus: Torus, p: Vec2) -> f32 {
    let period = torus.period();
    if torus.is_plane() {
        return outline.signed_distance(p);
    }
    let (low, high) = outline.bounds();
    let middle = (low + high) * 0.5;
    let seen = middle + torus.nearest(p - middle);
    let images = (0..9).map(|k| Vec2::new((k % 3 - 1) as f32, (k / 3 - 1) as f32) * period);
    images.map(|image| outline.signed_distance(seen + image)).fold(f32::INFINITY, f32::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Periodic, Waypoint};

    fn scene(periodic: Periodic) -> Scene {
        Scene { periodic, ..Scene::demo() }
    }

    fn problem(scene: &Scene) -> String {
        possible(scene).unwrap_err().to_string()
    }

    #[test]
    fn what_cannot_repeat_is_told() {
        let (x, t) = (Periodic { x: true, ..Periodic::default() }, Periodic { t: true, ..Periodic::default() });
        let mut ell = scene(x);
        assert!(possible(&ell).is_ok());
        ell.region.points[0].x += 0.5;
        assert!(problem(&ell).contains("a corner at [0.5, 0]"), "{}", problem(&ell));
        ell.periodic = t;
        assert!(possible(&ell).is_ok());
        ell.duration_secs = 2.0;
        assert!(problem(&ell).contains("at least 6 s"));
        let mut narrow = scene(x);
        narrow.region = Polygon::rectangle(Vec2::ZERO, Vec2::new(3.0, 40.0));
        assert!(problem(&narrow).contains("at least 6 m along x"));
        narrow.periodic = Periodic { z: true, ..Periodic::default() };
        assert!(possible(&narrow).is_ok());
    }

    #[test]
    fn moving_obstacles_come_back_or_go_on_into_the_next_tile() {
        let at = |secs: f32, x: f32| Waypoint { secs, position: Vec2::new(x, 5.0), heading: 0.0 };
        let outline = Polygon::rectangle(Vec2::splat(-0.5), Vec2::splat(0.5));
        let cart =
            |to: f32| Obstacle { outline: outline.clone(), height: None, path: vec![at(0.0, 2.0), at(20.0, to)] };
        let with = |periodic: Periodic, to: f32| Scene { obstacles: vec![cart(to)], ..scene(periodic) };
        let t = Periodic { t: true, ..Periodic::default() };
        assert!(possible(&with(t, 2.0)).is_ok());
        assert!(problem(&with(t, 14.0)).contains("obstacle 0"));
        assert!(possible(&with(Periodic { x: true, ..t }, 14.0)).is_ok());
    }

    #[test]
    fn the_nearest_image_of_an_outline_counts() {
        let outline = Polygon::rectangle(Vec2::new(11.0, 5.0), Vec2::new(12.5, 6.0));
        let torus = Torus::new(Vec2::ZERO, Vec2::splat(12.0), Periodic { x: true, ..Periodic::default() });
        assert!((distance(&outline, torus, Vec2::new(1.0, 5.5)) - 0.5).abs() < 1e-4);
        assert!((distance(&outline, torus, Vec2::new(-14.0, 5.5)) - 1.0).abs() < 1e-4);
        assert!((distance(&outline, Torus::default(), Vec2::new(1.0, 5.5)) - 10.0).abs() < 1e-4);
    }
}
