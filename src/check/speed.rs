//! Clause 2, on bodies: nothing turns or moves faster than in the captures, so that nothing pops.

use glam::{Quat, Vec3};
use rayon::prelude::*;

use super::limits::Limits;
use super::report::{Row, Worst};
use crate::motion::{FPS, JOINT_COUNT, Motion, canonical};
use crate::stage::{Character, Crowd};

/// A joint that the captures never turn is allowed this speed (rad/s), since a ratio to nothing means nothing.
const SLOWEST_TURN: f32 = 0.5;

/// Fastest turn (rad/s) and fastest move (m/s) of every joint; turns are local, the hips' global.
#[derive(Clone, Copy)]
struct Fastest {
    turn: [f32; JOINT_COUNT],
    speed: [f32; JOINT_COUNT],
}

/// The rows of clause 2 on bodies.
///
/// A path may stretch by a set amount in every frame, which moves all joints, so that much is allowed on top of
/// the captures' speed.
pub(super) fn rows(crowd: &Crowd, limits: &Limits) -> Vec<Row> {
    let sources = fastest_of_captures(crowd);
    let check = |(c, character): (usize, &Character)| character_speeds(c, character, &sources, limits);
    let all: Vec<(Worst, Worst)> = crowd.characters.par_iter().enumerate().map(check).collect();
    let (turn, speed) =
        all.into_iter().fold((Worst::default(), Worst::default()), |(a, b), (c, d)| (a.merge(c), b.merge(d)));
    vec![
        turn.row(2, "joint turns faster than in the captures", limits.joint_speed_ratio, "x"),
        speed.row(2, "joint moves faster than in the captures", limits.stretch * FPS as f64, "m/s"),
    ]
}

fn character_speeds(c: usize, character: &Character, sources: &Fastest, limits: &Limits) -> (Worst, Worst) {
    let (mut turn, mut speed) = (Worst::default(), Worst::default());
    let mut states = (0..character.frames()).map(|i| {
        let mut globals = Vec::with_capacity(JOINT_COUNT);
        character.globals(i, &mut globals);
        globals
    });
    let Some(mut before) = states.next() else { return (turn, speed) };
    for (i, now) in states.enumerate() {
        let (a, b) = (character.pose(i), character.pose(i + 1));
        for j in 0..JOINT_COUNT {
            let place = || {
                let frame = character.begin as usize + i + 1;
                format!("character {c}, frame {frame}, {}", canonical().joints[j].name)
            };
            turn.offer((turn_speed(a[j], b[j]) / sources.turn[j].max(SLOWEST_TURN)) as f64, place);
            let excess = move_speed(before[j].0, now[j].0) as f64 - limits.joint_speed_ratio * sources.speed[j] as f64;
            speed.offer(excess, place);
        }
        before = now;
    }
    (turn, speed)
}

fn fastest_of_captures(crowd: &Crowd) -> Fastest {
    let motions: Vec<&Motion> = crowd.set.kinds.iter().flat_map(|k| &k.fragments).map(|f| &f.motion).collect();
    let all: Vec<Fastest> = motions.par_iter().map(|m| fastest_of(m)).collect();
    all.iter().fold(Fastest { turn: [0.0; JOINT_COUNT], speed: [0.0; JOINT_COUNT] }, |mut a, b| {
        for j in 0..JOINT_COUNT {
            a.turn[j] = a.turn[j].max(b.turn[j]);
            a.speed[j] = a.speed[j].max(b.speed[j]);
        }
        a
    })
}

fn fastest_of(motion: &Motion) -> Fastest {
    let mut fastest = Fastest { turn: [0.0; JOINT_COUNT], speed: [0.0; JOINT_COUNT] };
    let (mut before, mut now) = (Vec::new(), Vec::new());
    motion.globals(0, &mut before);
    for frame in 1..motion.len() {
        motion.globals(frame, &mut now);
        let (a, b) = (motion.pose(frame - 1), motion.pose(frame));
        for j in 0..JOINT_COUNT {
            let turn = if j == 0 { turn_speed(before[0].1, now[0].1) } else { turn_speed(a[j], b[j]) };
            fastest.turn[j] = fastest.turn[j].max(turn);
            fastest.speed[j] = fastest.speed[j].max(move_speed(before[j].0, now[j].0));
        }
        std::mem::swap(&mut before, &mut now);
    }
    fastest
}

/// Radians per second between two frames; from the chord, which stays exact for small angles.
fn turn_speed(a: Quat, b: Quat) -> f32 {
    let b = if a.dot(b) < 0.0 { -b } else { b };
    4.0 * ((a - b).length() * 0.5).min(1.0).asin() * FPS
}

fn move_speed(a: Vec3, b: Vec3) -> f32 {
    a.distance(b) * FPS
}
