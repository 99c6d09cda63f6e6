//! Clause 2, on bodies: nothing turns or moves faster than in the captures, nor starts more suddenly, so that nothing
//! pops.

use glam::{Quat, Vec3};
use rayon::prelude::*;

use super::limits::Limits;
use super::report::{Row, Worst};
use crate::motion::{FPS, JOINT_COUNT, Motion, canonical};
use crate::stage::{Character, Crowd};

/// A joint that the captures never turn is allowed this speed (rad/s), since a ratio to nothing means nothing.
const SLOWEST_TURN: f32 = 0.5;

/// A joint that the captures hardly accelerate is allowed this much, m/s^2: the floor that noise has in any capture.
const LOWEST_ACCELERATION: f32 = 20.0;

/// Fastest turn (rad/s), fastest move (m/s) and largest acceleration (m/s^2) of every joint; turns are local, the hips'
/// global.
#[derive(Clone, Copy)]
struct Fastest {
    turn: [f32; JOINT_COUNT],
    speed: [f32; JOINT_COUNT],
    acceleration: [f32; JOINT_COUNT],
}

impl Fastest {
    const NOTHING: Self =
        Self { turn: [0.0; JOINT_COUNT], speed: [0.0; JOINT_COUNT], acceleration: [0.0; JOINT_COUNT] };

    fn merge(mut self, other: &Self) -> Self {
        for j in 0..JOINT_COUNT {
            self.turn[j] = self.turn[j].max(other.turn[j]);
            self.speed[j] = self.speed[j].max(other.speed[j]);
            self.acceleration[j] = self.acceleration[j].max(other.acceleration[j]);
        }
        self
    }
}

/// The worst of a character, or of all.
#[derive(Default)]
struct Speeds {
    turn: Worst,
    speed: Worst,
    acceleration: Worst,
}

impl Speeds {
    fn merge(self, other: Self) -> Self {
        Self {
            turn: self.turn.merge(other.turn),
            speed: self.speed.merge(other.speed),
            acceleration: self.acceleration.merge(other.acceleration),
        }
    }
}

/// The rows of clause 2 on bodies.
///
/// A path may stretch by a set amount in every frame, which moves all joints, so that much is allowed on top of
/// the captures' speed.
pub(super) fn rows(crowd: &Crowd, limits: &Limits) -> Vec<Row> {
    let sources = fastest_of_captures(crowd);
    let check = |(c, character): (usize, &Character)| character_speeds(c, character, &sources, limits);
    let all: Vec<Speeds> = crowd.characters.par_iter().enumerate().map(check).collect();
    let all = all.into_iter().fold(Speeds::default(), Speeds::merge);
    vec![
        all.turn.row(2, "joint turns faster than in the captures", limits.joint_speed_ratio, "x"),
        all.speed.row(2, "joint moves faster than in the captures", limits.stretch * FPS as f64, "m/s"),
        all.acceleration.row(2, "joint accelerates harder than in the captures", limits.acceleration_ratio, "x"),
    ]
}

fn character_speeds(c: usize, character: &Character, sources: &Fastest, limits: &Limits) -> Speeds {
    let mut worst = Speeds::default();
    let places: Vec<Vec<Vec3>> = (0..character.frames()).map(|i| positions(|out| character.globals(i, out))).collect();
    for i in 1..places.len() {
        let (a, b) = (character.pose(i - 1), character.pose(i));
        for j in 0..JOINT_COUNT {
            let place = |i: usize| {
                let frame = character.begin as usize + i;
                format!("character {c}, frame {frame}, {}", canonical().joints[j].name)
            };
            let turn = turn_speed(a[j], b[j]) / sources.turn[j].max(SLOWEST_TURN);
            worst.turn.offer(turn as f64, || place(i));
            let speed = move_speed(places[i - 1][j], places[i][j]) as f64;
            worst.speed.offer(speed - limits.joint_speed_ratio * sources.speed[j] as f64, || place(i));
            if i > 1 {
                let hard = acceleration(places[i - 2][j], places[i - 1][j], places[i][j]);
                let ratio = hard / sources.acceleration[j].max(LOWEST_ACCELERATION);
                worst.acceleration.offer(ratio as f64, || place(i - 1));
            }
        }
    }
    worst
}

fn positions(globals: impl FnOnce(&mut Vec<(Vec3, Quat)>)) -> Vec<Vec3> {
    let mut all = Vec::with_capacity(JOINT_COUNT);
    globals(&mut all);
    all.into_iter().map(|g| g.0).collect()
}

fn fastest_of_captures(crowd: &Crowd) -> Fastest {
    let motions: Vec<&Motion> = crowd.set.kinds.iter().flat_map(|k| &k.fragments).map(|f| &f.motion).collect();
    let all: Vec<Fastest> = motions.par_iter().map(|m| fastest_of(m)).collect();
    all.iter().fold(Fastest::NOTHING, Fastest::merge)
}

fn fastest_of(motion: &Motion) -> Fastest {
    let mut fastest = Fastest::NOTHING;
    let mut globals: Vec<Vec<(Vec3, Quat)>> = vec![Vec::new(); motion.len()];
    globals.iter_mut().enumerate().for_each(|(f, out)| motion.globals(f, out));
    for frame in 1..motion.len() {
        let (before, now) = (&globals[frame - 1], &globals[frame]);
        let (a, b) = (motion.pose(frame - 1), motion.pose(frame));
        for j in 0..JOINT_COUNT {
            let turn = if j == 0 { turn_speed(before[0].1, now[0].1) } else { turn_speed(a[j], b[j]) };
            fastest.turn[j] = fastest.turn[j].max(turn);
            fastest.speed[j] = fastest.speed[j].max(move_speed(before[j].0, now[j].0));
            if frame > 1 {
                let hard = acceleration(globals[frame - 2][j].0, before[j].0, now[j].0);
                fastest.acceleration[j] = fastest.acceleration[j].max(hard);
            }
        }
    }
    fastest
}

fn acceleration(a: Vec3, b: Vec3, c: Vec3) -> f32 {
    (c - 2.0 * b + a).length() * FPS * FPS
}

/// Radians per second between two frames; from the chord, which stays exact for small angles.
fn turn_speed(a: Quat, b: Quat) -> f32 {
    let b = if a.dot(b) < 0.0 { -b } else { b };
    4.0 * ((a - b).length() * 0.5).min(1.0).asin() * FPS
}

fn move_speed(a: Vec3, b: Vec3) -> f32 {
    a.distance(b) * FPS
}
