//! One person on the spot: idling, turning in place, a step aside, a step back.

use glam::{Vec2, Vec3};

use super::solo;
use crate::geom::Ground;
use crate::motion::Foot;
use crate::samples::acting::Sight;
use crate::samples::actor::Actor;
use crate::samples::posture::Channel::*;
use crate::samples::scene::Scene;

pub(super) fn scenes() -> Vec<Scene> {
    let mut all = vec![idle()];
    all.extend([(45.0, 2, 15), (90.0, 3, 15), (180.0, 5, 14)].map(pivot));
    all.push(steps("step-left", Vec2::new(0.36, 0.0), Foot::Left));
    all.push(steps("step-forward", Vec2::new(0.0, 0.34), Foot::Left));
    all.push(steps("step-back", Vec2::new(0.0, -0.32), Foot::Right));
    all
}

/// Standing about, for four lengths of time.
fn idle() -> Scene {
    let mut a = Actor::standing();
    a.stand(20);
    let mut patches = Vec::new();
    for (frames, name) in [(18, "idle-0.6"), (30, "idle-1.0"), (45, "idle-1.5"), (75, "idle-2.5")] {
        let d = frames as f32 / 30.0;
        let side = if frames % 2 == 0 { 1.0 } else { -1.0 };
        a.look([0.05 * d, 0.4 * d, 0.5 * d, 0.95 * d], Sight::Beside(Vec3::new(2.0 * side * d.min(1.5), 1.4, 3.0)));
        let rest = d.min(1.6) / 1.6;
        a.pose(
            [0.04 * d, 0.45 * d, 0.55 * d, 0.98 * d],
            &[
                (HipsLeft, -0.035 * side * rest),
                (PelvisRoll, -0.05 * side * rest),
                (SpineRoll, 0.06 * side * rest),
                (HipsUp, -0.006 * rest),
                (FlexLeft, 0.06 * rest),
                (ElbowRight, 0.10 * rest),
            ],
        );
        if frames == 75 {
            a.look([1.3, 1.7, 1.9, 2.4], Sight::Beside(Vec3::new(2.5, 1.2, 2.0)));
            a.pose([0.3, 0.9, 1.2, 1.8], &[(ShrugLeft, 0.05), (ShrugRight, 0.05), (SpinePitch, -0.03)]);
        }
        let from = a.now;
        a.stand(frames);
        patches.push((name, from, a.now));
        a.stand(10);
    }
    let patches: Vec<(&str, &[&str], i32, i32)> =
        patches.iter().map(|&(name, from, to)| (name, ["idle"].as_slice(), from, to)).collect();
    solo("idle", a, &patches)
}

fn pivot((angle, steps, frames): (f32, usize, i32)) -> Scene {
    let mut a = Actor::standing();
    a.stand(20);
    let from = a.now;
    // The feet unload before they lift.
    a.wait(5);
    a.pivot(angle.to_radians(), steps, frames);
    let to = a.now;
    a.stand(20);
    let name = format!("pivot-{angle}");
    solo(&name.clone(), a, &[(&name, &["turn", "in_place"], from, to)])
}

/// A step of both feet, `first` first.
fn steps(name: &str, by: Vec2, first: Foot) -> Scene {
    let second = if first == Foot::Left { Foot::Right } else { Foot::Left };
    let mut a = Actor::standing();
    a.stand(20);
    let from = a.now;
    a.wait(5);
    let origin = a.now;
    a.shift(by, 0.02, 0.95);
    a.step_from(first, origin, Ground::new(by, 0.0), 15);
    a.step_from(second, origin, Ground::new(by, 0.0), 15);
    a.wait(8);
    a.mark();
    let to = a.now;
    a.stand(20);
    solo(name, a, &[(name, &["step", "in_place"], from, to)])
}
