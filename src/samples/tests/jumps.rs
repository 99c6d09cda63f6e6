//! Jumps: bodies fly as bodies do, and every part of them gets over something low.

use super::TAKES;
use crate::motion::{body_capsules, joint::*};

/// Height over the ground of the lowest point of a body at every frame.
fn clearances(name: &str) -> Vec<f32> {
    let (_, globals) = TAKES.iter().find(|(t, _)| t.file.name == name).unwrap();
    let mut capsules = Vec::new();
    let mut lowest = |g: &Vec<_>| {
        capsules.clear();
        body_capsules(g, &mut capsules);
        capsules.iter().map(|c| c.a.y.min(c.b.y) - c.radius).fold(f32::INFINITY, f32::min)
    };
    globals[0].iter().map(&mut lowest).collect()
}

#[test]
fn both_feet_are_high_over_the_ground_for_a_while() {
    for (name, height, secs) in [("jump", 0.25, 0.25), ("leap", 0.18, 0.2)] {
        let above = clearances(name).iter().filter(|&&c| c > height).count() as f32 / 60.0;
        println!("{name}: {above:.2} s above {height} m, {:?}", clearances(name).iter().copied().fold(0.0, f32::max));
        assert!(above >= secs, "{name}: {above} s");
    }
}

#[test]
fn bodies_in_the_air_fall() {
    for name in ["jump", "leap"] {
        let (take, globals) = TAKES.iter().find(|(t, _)| t.file.name == name).unwrap();
        let clear = clearances(name);
        let root = &take.clips[0].root;
        let mut flown = 0;
        for f in 4..clear.len() - 4 {
            if clear[f - 4..=f + 4].iter().any(|&c| c < 0.06) {
                continue;
            }
            flown += 1;
            let fall = (root[f + 3].y - 2.0 * root[f].y + root[f - 3].y) * 400.0;
            assert!((fall + 9.81).abs() < 1.5, "{name} frame {f}: {fall} m/s2");
        }
        assert!(flown > 8, "{name}: {flown}");
        let thrust = (3..root.len() - 3).map(|f| ((root[f + 3] - 2.0 * root[f] + root[f - 3]) * 400.0).length());
        let thrust = thrust.fold(0.0, f32::max);
        println!("{name}: {thrust} m/s2");
        assert!(thrust < 36.0, "{name}: {thrust} m/s2");
        let hips = globals[0].iter().map(|g| g[HIPS].0.y).fold(f32::INFINITY, f32::min);
        assert!(hips > 0.5, "{name}: {hips}");
    }
}
