//! One person carrying a box before the belly.

use glam::Vec3;

use super::actions::grip;
use super::solo;
use crate::motion::Foot::{self, Left, Right};
use crate::samples::acting::Sight;
use crate::samples::actor::Actor;
use crate::samples::gait::Gait;
use crate::samples::gesture::{Grip, Relative};
use crate::samples::posture::Channel::*;
use crate::samples::scene::{BOX, Scene};

pub(super) const LADEN: Gait = Gait { half: 17, speed: 1.05 };
/// The elbows when carrying: close, down, back.
pub(super) const ELBOW_CARRY: Vec3 = Vec3::new(0.35, -1.0, -0.7);

pub(super) fn scenes() -> Vec<Scene> {
    let mut all = vec![walk(), start_stop()];
    all.extend([(90.0, 3, 16), (180.0, 5, 15)].map(pivot));
    for foot in [Left, Right] {
        all.extend([45.0, 90.0].map(|angle| turn(angle, foot)));
    }
    all
}

/// The palm of one side on the box held before the belly.
pub(super) fn held(side: Foot) -> Grip {
    let s = if side == Left { 1.0 } else { -1.0 };
    grip(Relative::Chest, [s * 0.5 * BOX[0], -0.26, 0.30], [s * -0.06, 0.02, 1.0], [-s, 0.0, 0.0])
}

/// Holds the box from `from` to `to` seconds of the actor's clock, faded at the ends.
pub(super) fn laden(a: &mut Actor, times: [f32; 4]) {
    a.pose(times, &[(StillArms, 1.0), (SpinePitch, -0.035), (ShrugLeft, -0.02), (ShrugRight, -0.02)]);
}

fn carrier() -> Actor {
    let mut a = Actor::standing();
    a.ports.clear();
    a.carrying = true;
    a.mark();
    let always = [-9.0, -8.0, 1e3, 1e3 + 1.0];
    for side in [Left, Right] {
        a.reach_with(side, always, vec![(0.0, held(side))], ELBOW_CARRY);
    }
    laden(&mut a, always);
    a
}

fn scene(name: &str, a: Actor, patches: &[(&str, &[&str], i32, i32)]) -> Scene {
    let mut scene = solo(name, a, patches);
    scene.hold_box(0, None, None);
    scene
}

fn walk() -> Scene {
    let mut a = carrier();
    a.stand(10);
    a.start(Left, LADEN, 0.0);
    a.walk(LADEN, 1);
    let at = a.now;
    a.walk(LADEN, 1);
    let half = a.now;
    a.walk(LADEN, 1);
    let full = a.now;
    a.walk(LADEN, 1);
    a.stop(0.0);
    let labels: &[&str] = &["walk", "carry"];
    scene("carry-walk", a, &[("carry-walk-half", labels, at, half), ("carry-walk-cycle", labels, at, full)])
}

fn start_stop() -> Scene {
    let mut a = carrier();
    a.stand(10);
    let idle = a.now;
    a.look([0.1, 0.5, 0.7, 1.1], Sight::Beside(Vec3::new(1.5, 1.3, 2.0)));
    a.pose([0.05, 0.5, 0.7, 1.15], &[(HipsLeft, 0.025), (PelvisRoll, 0.04), (SpineRoll, -0.04)]);
    a.stand(36);
    let from = a.now;
    a.start(Left, LADEN, 0.0);
    let started = a.now;
    a.walk(LADEN, 2);
    let stopping = a.now;
    a.stop(0.0);
    let stopped = a.now;
    a.stand(10);
    scene(
        "carry-start-stop",
        a,
        &[
            ("carry-idle", &["idle", "carry"], idle, from),
            ("carry-start", &["start", "carry"], from, started),
            ("carry-stop", &["stop", "carry"], stopping, stopped),
        ],
    )
}

/// Turning in place.
fn pivot((angle, steps, frames): (f32, usize, i32)) -> Scene {
    let mut a = carrier();
    a.stand(20);
    let from = a.now;
    a.wait(5);
    a.pivot(angle.to_radians(), steps, frames);
    let to = a.now;
    a.stand(20);
    let name = format!("carry-pivot-{angle}");
    scene(&name.clone(), a, &[(&name, &["turn", "in_place", "carry"], from, to)])
}

fn turn(angle: f32, foot: Foot) -> Scene {
    let mut a = carrier();
    a.stand(10);
    a.start(foot, LADEN, 0.0);
    a.walk(LADEN, 1);
    let from = a.now;
    let halves = if angle > 75.0 { 3 } else { 2 };
    a.walk_turn(LADEN, halves, angle.to_radians(), 1.0 - 0.25 * angle / 90.0);
    let to = a.now;
    a.walk(LADEN, 1);
    a.stop(0.0);
    let name = format!("carry-turn-{angle}{}", if foot == Left { "" } else { "-right-foot" });
    scene(&name.clone(), a, &[(&name, &["walk", "turn", "carry"], from, to)])
}
