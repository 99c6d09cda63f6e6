//! Joints: speeds, knees and elbows, the root's acceleration, feet over the floor.

use glam::Vec3;

use super::{TAKES, Take};
use crate::motion::limits::excess;
use crate::motion::{JOINT_COUNT, canonical, joint::*};

fn jumps(take: &Take) -> bool {
    take.file.patches.iter().any(|p| p.labels.iter().any(|l| l == "jump" || l == "hop"))
}

#[test]
fn joints_turn_at_human_speeds() {
    let mut worst = (0f32, String::new());
    for (take, _) in TAKES.iter() {
        // Knees of jumpers turn by 1000 degrees per second and more.
        let faster = if jumps(take) { 200.0 } else { 0.0 };
        for clip in &take.clips {
            for f in 1..clip.frames() {
                for j in 0..JOINT_COUNT {
                    let speed = clip.pose(f)[j].angle_between(clip.pose(f - 1)[j]).to_degrees() * 60.0 - faster;
                    if speed > worst.0 {
                        worst = (
                            speed,
                            format!("{} {} at {:.2} s", clip.name, canonical().joints[j].name, f as f32 / 60.0),
                        );
                    }
                }
            }
        }
    }
    assert!(worst.0 < 900.0, "{worst:?}");
}

#[test]
fn roots_accelerate_like_people() {
    let mut worst = (0f32, String::new());
    // Who jumps is looked at in `jumps`.
    for (take, _) in TAKES.iter().filter(|(t, _)| !jumps(t)) {
        for clip in &take.clips {
            for f in 3..clip.frames() - 3 {
                // Over 1/20 s.
                let a = (clip.root[f + 3] - 2.0 * clip.root[f] + clip.root[f - 3]).length() * 400.0;
                if a > worst.0 {
                    worst = (a, format!("{} at {:.2} s", clip.name, f as f32 / 60.0));
                }
            }
        }
    }
    assert!(worst.0 < 9.0, "{worst:?}");
}

#[test]
fn joints_stay_within_their_limits() {
    let mut worst: Vec<(f32, String)> = Vec::new();
    for (take, _) in TAKES.iter() {
        for clip in &take.clips {
            for j in 0..JOINT_COUNT {
                let over = |f: usize| (excess(j, clip.pose(f)[j]).to_degrees(), f);
                let (most, f) = (0..clip.frames()).map(over).max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
                let place = format!("{} {} at {:.2} s", clip.name, canonical().joints[j].name, f as f32 / 60.0);
                worst.push((most, place));
            }
        }
    }
    worst.retain(|w| w.0 > 6.0);
    assert!(worst.is_empty(), "{worst:#?}");
}

/// Flexion of a hinge in degrees, negative if it bends the wrong way.
fn flexion(globals: &[(Vec3, glam::Quat)], joints: [usize; 3], backwards: Vec3) -> f32 {
    let [a, b, c] = joints.map(|j| globals[j].0);
    let angle = (b - a).angle_between(c - b).to_degrees();
    let bend = (c - b).dot(globals[joints[0]].1 * backwards);
    if bend >= -1e-4 { angle } else { -angle }
}

#[test]
fn knees_and_elbows_bend_the_right_way() {
    let (mut knee, mut elbow) = ((f32::MAX, 0f32), (f32::MAX, 0f32));
    for (take, globals) in TAKES.iter() {
        for (person, frames) in globals.iter().enumerate() {
            for (f, g) in frames.iter().enumerate() {
                let place = || format!("{} person {person} at {:.2} s", take.file.name, f as f32 / 60.0);
                for joints in [[LEFT_UP_LEG, LEFT_LEG, LEFT_FOOT], [RIGHT_UP_LEG, RIGHT_LEG, RIGHT_FOOT]] {
                    let k = flexion(g, joints, Vec3::NEG_Z);
                    knee = (knee.0.min(k), knee.1.max(k));
                    assert!((3.0..150.0).contains(&k), "knee {k} in {}", place());
                }
                for joints in [[LEFT_ARM, LEFT_FORE_ARM, LEFT_HAND], [RIGHT_ARM, RIGHT_FORE_ARM, RIGHT_HAND]] {
                    let e = flexion(g, joints, Vec3::Z);
                    elbow = (elbow.0.min(e), elbow.1.max(e));
                    assert!((2.0..150.0).contains(&e), "elbow {e} in {}", place());
                }
            }
        }
    }
}

#[test]
fn no_foot_sinks_into_the_floor_and_swings_bend_the_knee() {
    for (take, globals) in TAKES.iter() {
        for frames in globals {
            for (f, g) in frames.iter().enumerate() {
                for toe in [LEFT_TOE, RIGHT_TOE] {
                    let tip = g[toe].0 + g[toe].1 * Vec3::new(0.0, -0.015, 0.07);
                    assert!(tip.y > -0.012, "{} at {f}: {}", take.file.name, tip.y);
                }
            }
        }
    }
    let (_, globals) = TAKES.iter().find(|(t, _)| t.file.name == "walk-normal").unwrap();
    let peak =
        globals[0].iter().map(|g| flexion(g, [LEFT_UP_LEG, LEFT_LEG, LEFT_FOOT], Vec3::NEG_Z)).fold(0.0, f32::max);
    assert!((52.0..72.0).contains(&peak), "{peak}");
}
