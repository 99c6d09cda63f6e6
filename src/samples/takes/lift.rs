//! One person taking a box up from the ground, and putting it down.

use glam::Vec3;

use super::actions::grip;
use super::carry::{ELBOW_CARRY, held, laden};
use super::solo;
use crate::motion::Foot::{self, Left, Right};
use crate::samples::acting::Sight;
use crate::samples::actor::{Actor, secs};
use crate::samples::gesture::{Grip, Relative};
use crate::samples::posture::Channel::*;
use crate::samples::scene::{BOX, GRIP, Scene};

/// How far in front of the body the middle of the box lies (m): toes and knees stay clear of it.
const AHEAD: f32 = 0.52;
/// Seconds from standing to the grasp, and from there to standing.
const DOWN: f32 = 1.2;
const UP: f32 = 1.3;
/// Frames of the whole, either way.
const FRAMES: i32 = 84;

pub(super) fn scenes() -> Vec<Scene> {
    vec![take_up(), put_down()]
}

/// The palm of one side on the box that lies on the ground; `wide` times as far apart as the box is wide.
fn low(side: Foot, wide: f32) -> Grip {
    let s = if side == Left { 1.0 } else { -1.0 };
    let palm = [s * 0.5 * wide * BOX[0], 0.5 * BOX[1] - GRIP[0], AHEAD - GRIP[1]];
    grip(Relative::Path, palm, [s * -0.06, -0.45, 0.85], [-s, 0.0, 0.0])
}

/// Squats, deepest at `t` seconds from the cursor.
fn squat(a: &mut Actor, t: f32) {
    let times = [t - DOWN, t - 0.05, t + 0.1, t + UP];
    a.pose(times, &[(HipsUp, -0.48), (HipsForward, -0.16), (KneeOutLeft, 0.3), (KneeOutRight, 0.3)]);
    a.pose(times, &[(PelvisPitch, 0.50), (SpinePitch, 0.67), (HeadPitch, -0.1), (HeelUpLeft, 0.2), (HeelUpRight, 0.2)]);
    a.look([t - DOWN - 0.2, t - 0.5, t + 0.2, t + UP], Sight::Beside(Vec3::new(0.0, 0.15, AHEAD)));
}

fn take_up() -> Scene {
    let mut a = Actor::standing();
    a.stand(20);
    let (from, grasp) = (a.now, 0.05 + DOWN);
    squat(&mut a, grasp);
    let always = [0.15, 0.9, 1e3, 1e3 + 1.0];
    for side in [Left, Right] {
        let way = vec![
            (grasp - 0.3, low(side, 1.35)),
            (grasp - 0.02, low(side, 1.0)),
            (grasp + 0.1, low(side, 1.0)),
            (grasp + UP, held(side)),
        ];
        a.reach_with(side, always, way, ELBOW_CARRY);
    }
    laden(&mut a, [grasp, grasp + UP - 0.1, 1e3, 1e3 + 1.0]);
    let held_from = a.t() + grasp;
    a.carrying = true;
    a.stand(FRAMES);
    let to = a.now;
    a.stand(20);
    let mut scene = solo("take-up", a, &[("take-up", &["action", "in_place", "carry", "symmetric"], from, to)]);
    scene.hold_box(0, Some(held_from), None);
    scene
}

fn put_down() -> Scene {
    let mut a = Actor::standing();
    a.ports.clear();
    a.carrying = true;
    a.mark();
    a.stand(20);
    let (from, release) = (a.now, 0.15 + DOWN);
    squat(&mut a, release);
    let begun = -9.0 - secs(a.now);
    for side in [Left, Right] {
        let way = vec![
            (release - DOWN, held(side)),
            (release - 0.1, low(side, 1.0)),
            (release + 0.02, low(side, 1.0)),
            (release + 0.3, low(side, 1.35)),
        ];
        a.reach_with(side, [begun, begun + 1.0, release + 0.25, release + 0.95], way, ELBOW_CARRY);
    }
    laden(&mut a, [begun, begun + 1.0, release - DOWN + 0.1, release]);
    let held_to = a.t() + release;
    a.carrying = false;
    a.stand(FRAMES);
    let to = a.now;
    a.stand(20);
    let mut scene = solo("put-down", a, &[("put-down", &["action", "in_place", "carry", "symmetric"], from, to)]);
    scene.hold_box(0, None, Some(held_to));
    scene
}
