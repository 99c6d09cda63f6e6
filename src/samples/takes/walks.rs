//! One person walking: straight at three speeds, turning, starting, stopping, changing speed.

use super::solo;
use crate::motion::Foot;
use crate::samples::actor::Actor;
use crate::samples::gait::{FAST, Gait, NORMAL, SLOW};
use crate::samples::scene::Scene;

pub(super) fn scenes() -> Vec<Scene> {
    let mut all = vec![straight("walk-slow", SLOW, "0.80"), straight("walk-normal", NORMAL, "1.15")];
    all.push(straight("walk-fast", FAST, "1.45"));
    for foot in [Foot::Left, Foot::Right] {
        all.extend([30.0, 60.0, 90.0].map(|angle| turn(angle, foot)));
    }
    all.push(u_turn());
    all.extend([0.0, 45.0, 90.0].map(start_stop));
    all.push(speeds());
    all
}

fn straight(name: &str, gait: Gait, speed: &str) -> Scene {
    let mut a = Actor::standing();
    a.stand(10);
    a.start(Foot::Left, gait, 0.0);
    a.walk(gait, 1);
    let at = a.now;
    a.walk(gait, 1);
    let half = a.now;
    a.walk(gait, 1);
    let full = a.now;
    // Nobody stops from a fast walk in one step.
    a.walk(if gait == FAST { NORMAL } else { gait }, 2);
    a.stop(0.0);
    let label = ["slow", "normal", "fast"][(gait.speed > 1.0) as usize + (gait.speed > 1.3) as usize];
    solo(
        name,
        a,
        &[
            (&format!("walk-{speed}-half"), &["walk", label], at, half),
            (&format!("walk-{speed}-cycle"), &["walk", label], at, full),
        ],
    )
}

/// A turn to the left, begun in mid-stance on `foot`.
fn turn(angle: f32, foot: Foot) -> Scene {
    let mut a = Actor::standing();
    a.stand(10);
    a.start(foot, NORMAL, 0.0);
    a.walk(NORMAL, 1);
    let from = a.now;
    let halves = if angle > 75.0 { 3 } else { 2 };
    a.walk_turn(NORMAL, halves, angle.to_radians(), 1.0 - 0.28 * angle / 90.0);
    let to = a.now;
    a.walk(NORMAL, 2);
    a.stop(0.0);
    let name = format!("turn-{angle}{}", if foot == Foot::Left { "" } else { "-right-foot" });
    solo(&name.clone(), a, &[(&name, &["walk", "turn"], from, to)])
}

fn u_turn() -> Scene {
    let mut a = Actor::standing();
    a.stand(10);
    a.start(Foot::Right, SLOW, 0.0);
    a.walk(SLOW, 1);
    let from = a.now;
    a.walk_turn(SLOW, 4, std::f32::consts::PI, 0.75);
    let to = a.now;
    a.walk(SLOW, 2);
    a.stop(0.0);
    solo("u-turn", a, &[("u-turn", &["walk", "turn", "slow"], from, to)])
}

/// Starts and stops; a turn to the left is begun by the left foot and ended on it.
fn start_stop(angle: f32) -> Scene {
    let mut a = Actor::standing();
    a.stand(15);
    let from = a.now;
    a.start(Foot::Left, NORMAL, angle.to_radians());
    let started = a.now;
    a.walk(NORMAL, 2);
    let stopping = a.now;
    a.stop(angle.to_radians() * 0.5);
    let stopped = a.now;
    a.stand(15);
    let suffix = if angle > 0.0 { format!("-{angle}") } else { String::new() };
    let stop = if angle > 0.0 { format!("stop-{}", (angle * 0.5) as i32) } else { "stop".to_owned() };
    solo(
        &format!("start-stop{suffix}"),
        a,
        &[(&format!("start{suffix}"), &["start"], from, started), (&stop, &["stop"], stopping, stopped)],
    )
}

fn speeds() -> Scene {
    let mut a = Actor::standing();
    a.stand(10);
    a.start(Foot::Right, SLOW, 0.0);
    let mut patches = Vec::new();
    for (gait, name, label) in [
        (NORMAL, "faster-0.80-1.15", "faster"),
        (FAST, "faster-1.15-1.45", "faster"),
        (NORMAL, "slower-1.45-1.15", "slower"),
        (SLOW, "slower-1.15-0.80", "slower"),
    ] {
        a.walk(gait_before(gait, label), 1);
        let from = a.now;
        a.walk(gait, 2);
        patches.push((name, label, from, a.now));
        a.walk(gait, 1);
    }
    a.walk(SLOW, 1);
    a.stop(0.0);
    let mut scene = Scene::new("speeds", vec![a]);
    for (name, label, from, to) in patches {
        scene.patch(name, &["walk", label], &[(0, from, to)], None);
    }
    scene
}

/// The gait walked before changing to `gait`.
fn gait_before(gait: Gait, label: &str) -> Gait {
    match (gait == NORMAL, label) {
        (true, "faster") | (false, "slower") => {
            if label == "faster" {
                SLOW
            } else {
                NORMAL
            }
        }
        (true, _) => FAST,
        (false, _) => NORMAL,
    }
}
