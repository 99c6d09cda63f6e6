//! Three people: a talk, a greeting all round.

use std::f32::consts::{PI, TAU};

use glam::Vec2;

use super::meet::{Encounter, both};
use super::talk::{gesticulate, lounge, nod};
use crate::geom::{Ground, Turn};
use crate::motion::Foot::{Left, Right};
use crate::samples::posture::Channel::*;
use crate::samples::scene::Scene;

/// Three places on a circle, facing its middle.
fn ring(radius: f32) -> [Ground; 3] {
    [0.0, 1.0, 2.0].map(|i| {
        let angle = PI + i * TAU / 3.0;
        Ground::new(Turn::from_angle(angle).apply(Vec2::new(0.0, radius)), angle - PI)
    })
}

pub(super) fn scenes() -> Vec<Scene> {
    let turns = [100f32, 85.0, 95.0].map(f32::to_radians);
    let places = ring(0.74);
    let mut all = both(&Encounter {
        name: "trio-talk",
        labels: &["friendly", "talk", "three"],
        places: &places,
        turns: &turns,
        play: talk,
    });
    let turns = [-90f32, -100.0, -85.0].map(f32::to_radians);
    let places = ring(0.95);
    all.extend(both(&Encounter {
        name: "trio-greet",
        labels: &["friendly", "three"],
        places: &places,
        turns: &turns,
        play: greet,
    }));
    all
}

fn talk(scene: &mut Scene, t: f32) -> f32 {
    gesticulate(&mut scene.actors[0], Right, t + 0.1, 2);
    nod(&mut scene.actors[1], t + 0.6);
    gesticulate(&mut scene.actors[2], Left, t + 1.0, 1);
    nod(&mut scene.actors[0], t + 1.5);
    lounge(&mut scene.actors[1], -1.0, [t + 0.5, t + 1.1, t + 1.7, t + 2.3]);
    2.5
}

/// One raises a hand, the others bow their heads, one after the other.
fn greet(scene: &mut Scene, t: f32) -> f32 {
    for (i, a) in scene.actors.iter_mut().enumerate() {
        let t = t + 0.22 * i as f32;
        if i == 0 {
            super::actions::wave_at(a, t);
        } else {
            let bow = [t + 0.35, t + 0.8, t + 1.0, t + 1.55];
            a.pose(bow, &[(PelvisPitch, 0.15), (SpinePitch, 0.16), (HipsForward, -0.035), (HeadPitch, 0.14)]);
        }
    }
    2.15
}
