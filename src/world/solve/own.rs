//! What a track must keep by itself: speed, acceleration, turning, borders and objects.

use glam::DVec2;

use super::contact::Push;
use super::track::Track;
use crate::world::Limits;
use crate::world::frame::{Border, FramePatch};
use crate::world::shape::Obstacle;

/// Objects are passed with this much room, metres.
const OBJECT_ROOM: f64 = 0.06;
/// Borders, beyond the body's radius.
const BORDER_ROOM: f64 = 0.05;
/// What counts as free of objects and borders.
const SLACK: f64 = 0.002;
/// Share of the limits that is aimed at: the optimum gives way a little.
const AIM: f64 = 0.85;
/// The same of the speed.
const CLOSE: f64 = 0.95;
/// Share of the limits that is accepted.
const KEEP: f64 = 0.99;

/// The surroundings and limits of walkers, in steps of the grid.
#[derive(Clone, Debug)]
pub(super) struct Ground {
    /// What a centre stays out of.
    pub obstacles: Vec<Obstacle>,
    /// Edges of the patch.
    pub borders: Vec<Border>,
    /// Radius of a body.
    pub radius: f64,
    /// Seconds per step.
    pub step: f64,
    /// Metres per step.
    pub speed: f64,
    /// Metres per step squared.
    pub bend: f64,
    /// Radians per step.
    pub turning: f64,
    /// Metres per step below which one stands.
    pub standing: f64,
}

impl Ground {
    /// The surroundings of walkers in a frame-patch, on a grid of so many seconds.
    pub fn new(frame: &FramePatch, limits: &Limits, obstacles: Vec<Obstacle>, step: f64) -> Self {
        Self {
            obstacles,
            borders: (0..frame.outline.len()).map(|edge| frame.border(edge)).collect(),
            radius: f64::from(limits.radius),
            step,
            speed: f64::from(limits.speed) * step,
            bend: f64::from(limits.acceleration) * step * step,
            turning: f64::from(limits.turning) * step,
            standing: f64::from(limits.standing) * step,
        }
    }

    /// Whether `track` keeps its own limits everywhere.
    pub fn keeps(&self, track: &Track) -> bool {
        let knots = track.moving_knots();
        knots.clone().all(|k| track.bend(k).length_squared() <= (KEEP * self.bend).powi(2))
            && knots.clone().all(|k| self.slow_enough(track, k) && self.turns_slowly(track, k))
            && (knots.start - 1..knots.end + 1).all(|k| self.inside(track, k) && self.off_objects(track, k))
    }

    fn slow_enough(&self, track: &Track, k: usize) -> bool {
        (track.points[k + 1] - track.points[k]).length_squared() <= (KEEP * self.speed).powi(2)
    }

    /// Turning within the segment after knot `k`.
    fn turns_slowly(&self, track: &Track, k: usize) -> bool {
        let (v0, v1) = (velocity(track, k), velocity(track, k + 1));
        let (a0, a1) = (track.bend(k), track.bend(k + 1));
        let safe = a0.length_squared().max(a1.length_squared()) / (KEEP * self.turning).powi(2);
        // Between the knots speed may be less by no more than an eighth of the change of acceleration.
        let dip = (a1 - a0).length() / 8.0;
        let chord = least_length(v0, v1) - dip;
        if chord > 0.0 && chord * chord >= safe {
            return true;
        }
        (0..=32).all(|i| {
            let u = f64::from(i) / 32.0;
            let a = a0.lerp(a1, u);
            let v = v0 + (a0 + 0.5 * u * (a1 - a0)) * u;
            let square = v.length_squared();
            square < (0.98 * self.standing).powi(2) || v.perp_dot(a).abs() <= KEEP * self.turning * square
        })
    }

    fn inside(&self, track: &Track, k: usize) -> bool {
        let (place, room) = (track.knots[k], self.radius + SLACK + track.bend(k).length() / 6.0);
        self.borders
            .iter()
            .enumerate()
            .all(|(edge, border)| (place - border.begin).dot(border.inward) >= room || self.at_crossing(track, edge, k))
    }

    /// Whether knot `k` is where the body may reach over `edge`.
    fn at_crossing(&self, track: &Track, edge: usize, k: usize) -> bool {
        let time = f64::from(track.first + k as i32) * self.step;
        let during =
            |line: &crate::world::frame::Line, sign: f64| line.edge == edge && (time - line.time) * sign < line.reach;
        during(&track.entry, 1.0) || during(&track.exit, -1.0)
    }

    fn off_objects(&self, track: &Track, k: usize) -> bool {
        let (p, q) = (track.knots[k], track.knots[k + 1]);
        self.obstacles.iter().all(|o| o.clear(p, q, SLACK + track.sag(k)))
    }

    /// What keeps `track` inside and off objects.
    pub fn pushes(&self, track: &Track, found: &mut Vec<Push>) {
        for knot in track.moving_knots() {
            let p = track.knots[knot];
            for (edge, border) in self.borders.iter().enumerate() {
                let gap = self.radius + BORDER_ROOM - (p - border.begin).dot(border.inward);
                if gap > 0.0 && !self.at_crossing(track, edge, knot) {
                    found.push(Push { knot, normal: border.inward, gap });
                }
            }
        }
        for obstacle in &self.obstacles {
            self.pass(track, obstacle, found);
        }
    }

    /// What keeps `track` off `obstacle`: every time it comes near, it passes on one side.
    fn pass(&self, track: &Track, obstacle: &Obstacle, found: &mut Vec<Push>) {
        let knots = track.moving_knots();
        let hit = |k: usize| !obstacle.clear(track.knots[k], track.knots[k + 1], OBJECT_ROOM);
        let mut k = knots.start - 1;
        while k < knots.end {
            let begin = k;
            while k < knots.end && hit(k) {
                k += 1;
            }
            if k > begin {
                pass_once(track, begin..k + 1, obstacle, found);
            }
            k += 1;
        }
    }

    /// How much the step from point `k` to the next is over what is aimed at; `None` if it is not.
    pub fn haste(&self, track: &Track, k: usize) -> Option<DVec2> {
        let step = track.points[k + 1] - track.points[k];
        let (length, most) = (step.length(), CLOSE * self.speed);
        (length > most).then(|| step * (1.0 - most / length))
    }

    /// How much the bend at knot `k` is over what is aimed at; `None` if it is not.
    pub fn excess(&self, track: &Track, k: usize) -> Option<DVec2> {
        let bend = track.bend(k);
        let most = AIM * self.bend;
        let slow = AIM * self.turning;
        let velocity = velocity(track, k);
        let speed = velocity.length();
        // Where `slow * speed` is more than `most`, turning is no matter.
        if speed * slow >= most || speed < self.standing {
            let length = bend.length();
            return (length > most).then(|| bend * (1.0 - most / length));
        }
        let along = velocity / speed;
        let (ahead, aside) = (bend.dot(along), bend.perp_dot(along));
        let over = |value: f64, limit: f64| value - value.clamp(-limit, limit);
        let (ahead, aside) = (over(ahead, most), over(aside, slow * speed));
        (ahead != 0.0 || aside != 0.0).then(|| along * ahead - along.perp() * aside)
    }
}

/// Pushes `knots` of `track` off `obstacle`, to the side that is nearer as a whole.
fn pass_once(track: &Track, knots: std::ops::Range<usize>, obstacle: &Obstacle, found: &mut Vec<Push>) {
    let along = (track.knots[knots.end - 1] - track.knots[knots.start]).normalize_or(DVec2::X);
    let way = |knot: usize, normal: DVec2| obstacle.way_out(track.knots[knot], normal, OBJECT_ROOM).unwrap_or(0.0);
    let furthest = |normal: DVec2| knots.clone().map(|k| way(k, normal)).fold(0.0, f64::max);
    let (left, right) = (along.perp(), -along.perp());
    let normal = if furthest(left) <= furthest(right) { left } else { right };
    found.extend(knots.map(|knot| Push { knot, normal, gap: way(knot, normal) }).filter(|push| push.gap > 0.0));
}

/// Velocity at knot `k`, metres per step.
fn velocity(track: &Track, k: usize) -> DVec2 {
    (track.points[k + 1] - track.points[k - 1]) * 0.5
}

/// Least length of what lies between `a` and `b`.
fn least_length(a: DVec2, b: DVec2) -> f64 {
    let ab = b - a;
    let t = (-a.dot(ab) / ab.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    (a + ab * t).length()
}
