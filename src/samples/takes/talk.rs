//! Two people talk, or hand over a box.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::actions::grip;
use super::carry::{ELBOW_CARRY, LADEN, held, laden};
use super::meet::{Coming, Encounter, both, facing, look_at_each_other, meet};
use crate::geom::Ground;
use crate::motion::Foot::{self, Left, Right};
use crate::samples::actor::Actor;
use crate::samples::gait::NORMAL;
use crate::samples::gesture::{Grip, Relative};
use crate::samples::posture::Channel::*;
use crate::samples::scene::{BOX, GRIP, Scene};

pub(super) fn scenes() -> Vec<Scene> {
    let turns = [-70f32.to_radians(), -100f32.to_radians()];
    let places = [Ground::IDENTITY, Ground::new(Vec2::new(0.25, 1.08), PI + 0.22)];
    let mut all =
        both(&Encounter { name: "talk", labels: &["friendly", "talk"], places: &places, turns: &turns, play: chat });
    let turns = [80f32.to_radians(), 60f32.to_radians()];
    let argue =
        Encounter { name: "argue", labels: &["hostile", "talk"], places: &facing(0.95), turns: &turns, play: argue };
    all.extend(both(&argue));
    let long = Encounter {
        name: "talk-long",
        labels: &["friendly", "talk"],
        places: &facing(1.12),
        turns: &turns,
        play: long_chat,
    };
    all.push(meet(&long, Coming::Standing));
    all.push(pass_box(Coming::Walking));
    all.push(pass_box(Coming::Standing));
    all
}

/// One hand speaks: up in front, two or three beats, down.
pub(super) fn gesticulate(a: &mut Actor, side: Foot, t: f32, beats: usize) {
    let s = if side == Left { 1.0 } else { -1.0 };
    let at =
        |x: f32, y: f32, z: f32| grip(Relative::Chest, [s * x, y, z], [s * -0.35, 0.25, 1.0], [s * -0.55, 0.75, 0.0]);
    let mut grips = vec![(t + 0.1, at(0.22, -0.22, 0.28))];
    for i in 0..beats {
        let b = t + 0.45 + 0.36 * i as f32;
        grips.push((b, at(0.17 + 0.03 * (i % 2) as f32, -0.10, 0.33)));
        grips.push((b + 0.17, at(0.21, -0.17, 0.36)));
    }
    let end = t + 0.45 + 0.36 * beats as f32;
    a.reach(side, [t, t + 0.5, end, end + 0.6], grips);
    a.pose([t + 0.1, t + 0.5, end, end + 0.5], &[(SpinePitch, 0.04), (HeadPitch, -0.03), (SpineYaw, -0.05 * s)]);
}

/// Nods twice.
pub(super) fn nod(a: &mut Actor, t: f32) {
    for k in 0..2 {
        let t = t + 0.36 * k as f32;
        a.pose([t, t + 0.16, t + 0.18, t + 0.38], &[(HeadPitch, 0.15)]);
    }
}

/// Weight on one leg.
pub(super) fn lounge(a: &mut Actor, side: f32, times: [f32; 4]) {
    a.pose(times, &[(HipsLeft, 0.035 * side), (PelvisRoll, 0.05 * side), (SpineRoll, -0.05 * side), (HipsUp, -0.006)]);
}

fn chat(scene: &mut Scene, t: f32) -> f32 {
    gesticulate(&mut scene.actors[0], Right, t + 0.1, 2);
    nod(&mut scene.actors[1], t + 0.7);
    gesticulate(&mut scene.actors[1], Left, t + 0.95, 1);
    nod(&mut scene.actors[0], t + 1.6);
    2.45
}

fn long_chat(scene: &mut Scene, t: f32) -> f32 {
    gesticulate(&mut scene.actors[0], Right, t + 0.2, 3);
    nod(&mut scene.actors[1], t + 0.9);
    lounge(&mut scene.actors[1], 1.0, [t + 0.3, t + 1.0, t + 3.2, t + 4.0]);
    gesticulate(&mut scene.actors[1], Right, t + 1.9, 2);
    lounge(&mut scene.actors[0], -1.0, [t + 1.9, t + 2.6, t + 3.4, t + 4.1]);
    nod(&mut scene.actors[0], t + 3.0);
    4.2
}

fn argue(scene: &mut Scene, t: f32) -> f32 {
    let point = |z: f32, y: f32| grip(Relative::Chest, [-0.08, y, z], [0.1, 0.15, 1.0], [0.7, -0.6, 0.0]);
    let a = &mut scene.actors[0];
    let mut grips = vec![(t + 0.1, point(0.25, -0.1))];
    for i in 0..3 {
        grips.push((t + 0.5 + 0.36 * i as f32, point(0.38, -0.02)));
        grips.push((t + 0.68 + 0.36 * i as f32, point(0.31, -0.05)));
    }
    a.reach(Right, [t, t + 0.45, t + 1.5, t + 2.05], grips);
    a.pose([t + 0.1, t + 0.5, t + 1.4, t + 2.0], &[(SpinePitch, 0.10), (HipsForward, 0.03), (HeadPitch, 0.03)]);
    let b = &mut scene.actors[1];
    b.pose([t + 0.35, t + 0.65, t + 1.1, t + 1.6], &[(SpinePitch, -0.07), (HipsForward, -0.03), (HeadYaw, 0.16)]);
    let up = |s: f32| grip(Relative::Chest, [s * 0.30, -0.08, 0.27], [s * 0.25, 0.7, 0.7], [s * -0.25, 0.6, 0.6]);
    for (side, s) in [(Left, 1.0), (Right, -1.0)] {
        b.reach(side, [t + 0.85, t + 1.25, t + 1.6, t + 2.15], vec![(t + 1.0, up(s))]);
    }
    b.pose([t + 1.1, t + 1.35, t + 1.5, t + 1.9], &[(ShrugLeft, 0.12), (ShrugRight, 0.12), (HeadYaw, -0.2)]);
    2.3
}

const APART: f32 = 1.02;

/// The first comes with a box, the second leaves with it.
fn pass_box(coming: Coming) -> Scene {
    let name = if coming == Coming::Walking { "pass-box-walk" } else { "pass-box-stand" };
    let (mut actors, entries) = super::meet::arrive(&facing(APART), coming);
    for port in &mut actors[0].ports {
        port.1 = format!("carry_{}", port.1);
    }
    actors[0].carrying = true;
    let mut scene = Scene::new(name, actors);
    let t = if coming == Coming::Walking { -0.35 } else { 0.0 };
    let (give, taken) = (t + 0.85, t + 1.10);
    let now = scene.actors[0].t();
    let begun = -9.0 - now;
    hand_over(&mut scene.actors[0], begun, give, taken);
    take_over(&mut scene.actors[1], t, give, taken);
    look_at_each_other(&mut scene, t, 1.9);
    let mut roles = Vec::new();
    for (i, a) in scene.actors.iter_mut().enumerate() {
        a.wait(((1.95 + 2.0 * t) * 30.0) as i32);
        a.carrying = i == 1;
        if coming == Coming::Walking {
            a.start(Left, if i == 1 { LADEN } else { NORMAL }, [80f32, 95.0][i].to_radians());
        } else {
            a.stand(3);
        }
        roles.push((i, entries[i], a.now));
    }
    scene.hold_box(0, None, Some(now + taken));
    scene.hold_box(1, Some(now + give), None);
    scene.patch(name, &["carry", "friendly"], &roles, Some([now + t, now + t + 1.95]));
    scene
}

/// The palm on the box between the two; giver's and taker's hands just miss each other.
fn between(side: Foot, below: f32) -> Grip {
    let s = if side == Left { 1.0 } else { -1.0 };
    grip(
        Relative::Path,
        [s * 0.5 * BOX[0], 1.06 - below, 0.5 * APART - GRIP[1]],
        [s * -0.06, 0.02, 1.0],
        [-s, 0.0, 0.0],
    )
}

fn hand_over(a: &mut Actor, begun: f32, give: f32, taken: f32) {
    for side in [Left, Right] {
        let open = Grip { palm: between(side, 0.0).palm * Vec3::new(1.35, 1.0, 0.72), ..between(side, 0.0) };
        let grips = vec![
            (give - 0.65, held(side)),
            (give, between(side, -0.01)),
            (taken, between(side, -0.01)),
            (taken + 0.3, open),
        ];
        a.reach_with(side, [begun, begun + 1.0, taken + 0.15, taken + 0.75], grips, ELBOW_CARRY);
    }
    laden(a, [begun, begun + 1.0, give, taken + 0.5]);
    a.pose([give - 0.6, give, taken, taken + 0.5], &[(SpinePitch, 0.10), (HipsForward, 0.02)]);
}

fn take_over(b: &mut Actor, t: f32, give: f32, taken: f32) {
    for side in [Left, Right] {
        let open = Grip { palm: between(side, 0.0).palm * Vec3::new(1.4, 1.0, 0.75), ..between(side, 0.0) };
        let grips = vec![
            (give - 0.45, open),
            (give, between(side, 0.01)),
            (taken, between(side, 0.01)),
            (taken + 0.65, held(side)),
        ];
        b.reach_with(side, [t, t + 0.55, 1e3, 1e3 + 1.0], grips, ELBOW_CARRY);
    }
    laden(b, [give, taken + 0.4, 1e3, 1e3 + 1.0]);
    b.pose([give - 0.6, give, taken, taken + 0.6], &[(SpinePitch, 0.12), (HipsForward, 0.02)]);
}
