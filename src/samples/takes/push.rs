//! One pushes, the other stumbles back a step and recovers.

use glam::Vec2;

use super::actions::grip;
use super::meet::{Encounter, both, facing};
use crate::geom::Ground;
use crate::motion::BodyPart::{LeftHand, RightHand, Torso};
use crate::motion::Foot::{Left, Right};
use crate::samples::gesture::{ELBOW, Relative::Path};
use crate::samples::posture::Channel::*;
use crate::samples::scene::Scene;

const APART: f32 = 0.70;

pub(super) fn scenes() -> Vec<Scene> {
    let turns = [75f32.to_radians(), 80f32.to_radians()];
    both(&Encounter { name: "push", labels: &["hostile"], places: &facing(APART), turns: &turns, play: push })
}

fn push(scene: &mut Scene, t: f32) -> f32 {
    let (touch, release) = (t + 0.62, t + 0.84);
    let a = &mut scene.actors[0];
    for (side, s) in [(Left, 1.0), (Right, -1.0)] {
        let at = |z: f32, y: f32| grip(Path, [s * 0.085, y, z], [s * -0.1, 0.9, 0.45], [0.0, -0.15, 1.0]);
        let grips = vec![
            (t + 0.1, at(0.22, 1.22)),
            (t + 0.4, at(0.24, 1.25)),
            (touch, at(APART - 0.12, 1.33)),
            (release, at(APART - 0.07, 1.34)),
            (release + 0.35, at(0.36, 1.2)),
        ];
        a.reach_with(side, [t, t + 0.40, release + 0.05, release + 0.75], grips, ELBOW);
    }
    a.pose([t + 0.0, t + 0.36, t + 0.40, touch + 0.1], &[(SpinePitch, -0.04), (HipsForward, -0.025)]);
    a.pose(
        [t + 0.32, touch + 0.1, release, release + 0.7],
        &[(SpinePitch, 0.17), (PelvisPitch, 0.06), (HipsForward, 0.06), (HeadPitch, -0.08)],
    );
    stumble(scene, t, touch);
    let now = scene.actors[0].t();
    scene.contact((0, LeftHand), (1, Torso), now + touch, now + release);
    scene.contact((0, RightHand), (1, Torso), now + touch, now + release);
    2.25
}

/// The second actor is thrown back, catches the fall with a step, and protests.
fn stumble(scene: &mut Scene, t: f32, touch: f32) {
    let b = &mut scene.actors[1];
    let began = b.now;
    let back = Vec2::new(0.0, -0.36);
    b.shift(back, touch + 0.06, 0.75);
    b.now = began + ((touch + 0.10) * 30.0).round() as i32;
    b.step_from(Right, began, Ground::new(Vec2::new(-0.03, -0.44), -0.1), 11);
    b.step_from(Left, began, Ground::new(back, 0.0), 13);
    b.step_from(Right, began, Ground::new(back, 0.0), 12);
    b.now = began;
    b.pose([touch, touch + 0.16, touch + 0.25, touch + 0.75], &[(SpinePitch, -0.16), (HeadPitch, 0.12)]);
    b.pose([touch + 0.25, touch + 0.6, touch + 0.7, touch + 1.2], &[(SpinePitch, 0.18), (HipsUp, -0.03)]);
    // Arms fly up for balance.
    let fling = [touch + 0.03, touch + 0.3, touch + 0.4, touch + 1.1];
    b.pose(
        fling,
        &[
            (AbductLeft, 0.42),
            (AbductRight, 0.48),
            (FlexLeft, 0.55),
            (FlexRight, 0.45),
            (ElbowLeft, 0.6),
            (ElbowRight, 0.7),
        ],
    );
    let complain = [t + 1.45, t + 1.75, t + 1.85, t + 2.25];
    b.pose(
        complain,
        &[
            (AbductLeft, 0.22),
            (AbductRight, 0.25),
            (ElbowLeft, 0.8),
            (ElbowRight, 0.85),
            (ShrugLeft, 0.08),
            (ShrugRight, 0.08),
            (FlexLeft, 0.12),
        ],
    );
}
