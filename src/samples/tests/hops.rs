//! Hopping: folded arms and the raised leg stay where they are, and who bumps into somebody touches but does not enter.

use super::{TAKES, frame};
use crate::geom::Capsule;
use crate::motion::{body_capsules, joint::*};

/// Capsules of the torso.
const TRUNK: std::ops::Range<usize> = 0..3;

fn capsules(globals: &[(glam::Vec3, glam::Quat)]) -> Vec<Capsule> {
    let mut out = Vec::new();
    body_capsules(globals, &mut out);
    out
}

#[test]
fn folded_arms_are_before_the_chest_and_the_leg_stays_up() {
    let mut hopped = 0;
    for (take, people) in TAKES.iter() {
        for patch in take.file.patches.iter().filter(|p| {
            ["straight", "turn", "bump"].iter().any(|l| p.labels.iter().any(|m| m == l) && p.labels[0] == "hop")
        }) {
            for role in &patch.roles {
                let seen = people[role.person].iter().enumerate().take(frame(role.end) + 1);
                for (f, g) in seen.skip(frame(role.begin)) {
                    let c = capsules(g);
                    let into_chest = c[12..16].iter().flat_map(|a| c[TRUNK].iter().map(move |b| a.penetration(b)));
                    let deepest = into_chest.fold(0.0, f32::max);
                    assert!(deepest < 0.01, "{} at {f}: an arm is {deepest} m in the chest", patch.name);
                    let low = g[LEFT_FOOT].0.y.max(g[RIGHT_FOOT].0.y);
                    assert!(low > 0.3, "{} at {f}: the raised foot is at {low} m", patch.name);
                    hopped += 1;
                }
            }
        }
    }
    assert!(hopped > 1000, "{hopped}");
}

#[test]
fn who_bumps_touches_and_does_not_enter() {
    let mut bumps = 0;
    for (take, people) in TAKES.iter().filter(|(t, _)| t.file.name.starts_with("bump")) {
        let patch = &take.file.patches[0];
        let (from, to) =
            (frame(patch.roles[0].begin), frame(patch.roles.iter().map(|r| r.end).fold(f32::MAX, f32::min)));
        let depth = |f: usize| {
            let [a, b] = [0, 1].map(|p| capsules(&people[p][f]));
            a.iter().flat_map(|x| b.iter().map(move |y| x.penetration(y))).fold(f32::MIN, f32::max)
        };
        let depths = (from..=to).map(|f| (depth(f), f));
        let deepest = depths.max_by(|a, b| a.0.total_cmp(&b.0)).expect("a bump takes a while");
        let hit = 0.5 * (take.file.contacts[0].begin + take.file.contacts[0].end);
        println!("{}: {deepest:?}, hit at {}", take.file.name, frame(hit));
        assert!((0.0..0.03).contains(&deepest.0), "{}: {} m", take.file.name, deepest.0);
        assert!(deepest.1.abs_diff(frame(hit)) <= 8, "{}: deepest at {}", take.file.name, deepest.1);
        bumps += 1;
    }
    assert!(bumps >= 3, "{bumps}");
}
