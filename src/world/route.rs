//! On which side of the objects to pass: shortest of the ways found by going left or right of what is in the way.

use glam::DVec2;

use super::shape::Obstacle;

/// Room left between a via point and what is passed, metres.
const ROOM: f64 = 0.12;
/// How often a way may be split.
const DEPTH: u32 = 4;

/// Via points of a way from `from` to `to` into `via` (emptied first): none if the straight way is free. Via points are
/// `inside`, as far as there is a choice. O(2^DEPTH x obstacles), no allocation beyond `via`.
pub(super) fn route(
    from: DVec2,
    to: DVec2,
    obstacles: &[Obstacle],
    inside: &dyn Fn(DVec2) -> bool,
    via: &mut Vec<DVec2>,
) {
    via.clear();
    split(from, to, obstacles, inside, DEPTH, via);
}

/// Appends the via points strictly between the ends; returns the length of the way, with a fine where it is blocked.
fn split(
    from: DVec2,
    to: DVec2,
    obstacles: &[Obstacle],
    inside: &dyn Fn(DVec2) -> bool,
    depth: u32,
    via: &mut Vec<DVec2>,
) -> f64 {
    let Some(blocking) = nearest_blocking(from, to, obstacles) else { return from.distance(to) };
    if depth == 0 {
        return from.distance(to) + 10.0;
    }
    let across = (to - from).perp().normalize_or(DVec2::X);
    let begin = via.len();
    let way = |side: f64, via: &mut Vec<DVec2>| {
        let point = blocking.support(across * side) + across * side * ROOM;
        let before = split(from, point, obstacles, inside, depth - 1, via);
        via.push(point);
        let after = split(point, to, obstacles, inside, depth - 1, via);
        before + after + if inside(point) { 0.0 } else { 20.0 }
    };
    let left = way(1.0, via);
    let middle = via.len();
    let right = way(-1.0, via);
    if left <= right {
        via.truncate(middle);
        left
    } else {
        via.drain(begin..middle);
        right
    }
}

/// The first obstacle on the way.
fn nearest_blocking(from: DVec2, to: DVec2, obstacles: &[Obstacle]) -> Option<&Obstacle> {
    let along = (to - from).normalize_or(DVec2::X);
    let hit = |o: &&Obstacle| !o.clear(from, to, 0.0);
    obstacles.iter().filter(hit).min_by(|a, b| a.centre().dot(along).total_cmp(&b.centre().dot(along)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::Shape;
    use glam::Vec2;

    #[test]
    fn the_way_round_a_wall_and_a_tree_is_free_and_short() {
        let wall = Shape::oblong(Vec2::new(4.0, 4.5), Vec2::new(0.5, 3.0), 0.0);
        let shapes = [wall, Shape::disc(Vec2::new(4.0, 2.4), 0.3)];
        let obstacles: Vec<Obstacle> = shapes.iter().map(|s| Obstacle::new(s, 0.25)).collect();
        let (from, to) = (DVec2::new(0.5, 4.0), DVec2::new(7.5, 4.0));
        let mut via = Vec::new();
        route(from, to, &obstacles, &|_| true, &mut via);
        let corners: Vec<DVec2> = [from].into_iter().chain(via).chain([to]).collect();
        for pair in corners.windows(2) {
            assert!(obstacles.iter().all(|o| o.segment_distance(pair[0], pair[1]) >= 0.0), "{corners:?}");
        }
        let length: f64 = corners.windows(2).map(|p| p[0].distance(p[1])).sum();
        assert!(length < 9.0, "{length} {corners:?}");
    }

    #[test]
    fn a_free_way_is_straight() {
        let mut via = vec![DVec2::ONE];
        route(DVec2::ZERO, DVec2::X, &[], &|_| true, &mut via);
        assert!(via.is_empty());
    }
}
