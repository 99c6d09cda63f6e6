//! One person's small doings, from standing to standing.

use glam::{Vec2, Vec3};

use super::solo;
use crate::geom::Ground;
use crate::motion::Foot::{Left, Right};
use crate::samples::acting::Sight;
use crate::samples::actor::Actor;
use crate::samples::gesture::{Grip, Relative};
use crate::samples::posture::Channel::*;
use crate::samples::scene::Scene;

pub(super) fn scenes() -> Vec<Scene> {
    vec![
        action("look-at-watch", 57, watch),
        action("wave", 60, wave),
        action("stretch", 66, stretch),
        action("scratch-head", 60, scratch),
        tie_shoe(),
    ]
}

pub(super) fn grip(relative: Relative, palm: [f32; 3], fingers: [f32; 3], facing: [f32; 3]) -> Grip {
    Grip { relative, palm: palm.into(), fingers: fingers.into(), facing: facing.into() }
}

fn action(name: &str, frames: i32, gesture: fn(&mut Actor)) -> Scene {
    let mut a = Actor::standing();
    a.stand(20);
    let from = a.now;
    gesture(&mut a);
    a.stand(frames);
    let to = a.now;
    a.stand(20);
    solo(name, a, &[(name, &["action", "in_place"], from, to)])
}

fn watch(a: &mut Actor) {
    let look = grip(Relative::Chest, [-0.02, -0.03, 0.31], [-1.0, 0.15, 0.10], [0.0, -0.75, -0.6]);
    a.reach_with(Left, [0.05, 0.65, 1.25, 1.85], vec![(0.0, look)], Vec3::new(0.8, -1.0, -0.1));
    a.look([0.25, 0.7, 1.2, 1.7], Sight::Beside(Vec3::new(0.08, 1.26, 0.52)));
    a.pose([0.2, 0.7, 1.2, 1.8], &[(SpinePitch, 0.05), (HeadPitch, 0.03), (HipsLeft, -0.012)]);
}

fn wave(a: &mut Actor) {
    wave_at(a, 0.0);
    a.look([0.05, 0.4, 1.4, 1.9], Sight::Beside(Vec3::new(0.3, 1.65, 5.0)));
}

/// Waves with the right hand, beginning `t` seconds from the cursor.
pub(super) fn wave_at(a: &mut Actor, t: f32) {
    let at = |x: f32| grip(Relative::Chest, [-0.34 + x, 0.32, 0.20], [3.2 * x, 1.0, 0.05], [0.0, 0.0, 1.0]);
    let times = [(0.0, 0.06), (0.45, -0.08), (0.70, 0.08), (0.95, -0.08), (1.20, 0.07), (1.45, -0.03)];
    let grips = times.iter().map(|&(after, x)| (t + after, at(x))).collect();
    a.reach_with(Right, [0.05, 0.60, 1.35, 1.95].map(|after| t + after), grips, Vec3::new(0.9, -1.0, -0.1));
    a.pose([0.1, 0.6, 1.3, 1.9].map(|after| t + after), &[(HipsLeft, 0.015), (SpineRoll, 0.03), (HeadRoll, -0.04)]);
}

fn stretch(a: &mut Actor) {
    for side in [Left, Right] {
        let s = if side == Left { 1.0 } else { -1.0 };
        let low = grip(Relative::Chest, [s * 0.30, 0.05, 0.30], [s * -0.3, 0.9, 0.3], [s * -0.5, 0.0, 0.8]);
        let high = grip(Relative::Chest, [s * 0.15, 0.68, 0.02], [s * -0.25, 1.0, 0.0], [s * -0.3, 0.0, 1.0]);
        let wide = grip(Relative::Chest, [s * 0.52, 0.32, 0.06], [s * 0.8, 0.7, 0.0], [0.0, -0.4, 1.0]);
        let grips = vec![(0.1, low), (0.65, high), (1.1, high), (1.55, wide)];
        a.reach_with(side, [0.05, 0.5, 1.45, 2.15], grips, Vec3::new(1.0, -0.35, 0.15));
    }
    a.pose(
        [0.3, 0.8, 1.1, 1.9],
        &[
            (SpinePitch, -0.14),
            (HeadPitch, -0.22),
            (HipsForward, 0.025),
            (HeelUpLeft, 0.10),
            (HeelUpRight, 0.10),
            (HipsUp, 0.006),
        ],
    );
}

fn scratch(a: &mut Actor) {
    let at = |dy: f32| grip(Relative::Head, [-0.125, 0.12 + dy, -0.02], [0.35, 0.8, -0.35], [1.0, -0.3, 0.25]);
    let up = grip(Relative::Chest, [-0.26, 0.22, 0.24], [0.2, 1.0, 0.1], [0.8, 0.0, 0.4]);
    let mut grips = vec![(0.25, up), (0.65, at(0.0))];
    grips.extend(
        [0.015, -0.015, 0.015, -0.012, 0.012].iter().enumerate().map(|(i, &d)| (0.78 + 0.11 * i as f32, at(d))),
    );
    grips.push((1.65, up));
    a.reach_with(Right, [0.05, 0.5, 1.4, 1.95], grips, Vec3::new(1.0, -0.55, 0.25));
    a.look([0.1, 0.6, 1.2, 1.8], Sight::Beside(Vec3::new(0.6, 0.9, 2.5)));
    a.pose([0.2, 0.7, 1.3, 1.85], &[(HeadRoll, 0.09), (SpineRoll, 0.03), (SpinePitch, 0.03), (HipsLeft, 0.015)]);
}

/// Steps back with the right foot, kneels, ties the left shoe, gets up.
fn tie_shoe() -> Scene {
    let mut a = Actor::standing();
    a.stand(20);
    let from = a.now;
    a.wait(5);
    let origin = a.now;
    a.shift(Vec2::new(0.0, -0.13), 0.0, 0.6);
    a.step_from(Right, origin, Ground::new(Vec2::new(-0.02, -0.44), 0.0), 15);
    let kneel = [-0.2, 0.72, 1.75, 2.60];
    a.pose(kneel, &[(HipsUp, -0.45), (PelvisPitch, 0.22), (SpinePitch, 0.55), (KneeOutLeft, 0.12), (HeadPitch, 0.05)]);
    a.pulse(HeelUpRight, [0.0, 0.72, 1.55, 2.15], 1.0);
    for (side, s) in [(Left, 1.0), (Right, -1.0)] {
        let at = |x: f32, y: f32| {
            grip(Relative::World, [0.105 + s * x, y, 0.10], [s * -0.5, -0.75, 0.45], [s * -0.9, -0.3, 0.0])
        };
        let grips = [
            (0.0, 0.05, 0.16),
            (0.75, 0.03, 0.15),
            (1.0, 0.08, 0.19),
            (1.25, 0.03, 0.15),
            (1.5, 0.08, 0.18),
            (1.75, 0.04, 0.16),
        ];
        let grips = grips.iter().map(|&(t, x, y)| (t, at(x, y))).collect();
        a.reach(side, [0.05, 0.7, 1.75, 2.35], grips);
    }
    a.look([-0.1, 0.5, 1.8, 2.4], Sight::Beside(Vec3::new(0.1, 0.1, 0.25)));
    a.wait(60);
    a.shift(Vec2::new(0.0, 0.13), 0.0, 0.7);
    a.step_from(Right, origin, Ground::IDENTITY, 16);
    a.wait(9);
    a.mark();
    let to = a.now;
    a.stand(20);
    solo("tie-shoe", a, &[("tie-shoe", &["action", "in_place"], from, to)])
}
