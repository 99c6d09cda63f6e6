//! Kinds, ports, plants.

use std::collections::{BTreeMap, BTreeSet};

use glam::Vec3;

use super::{TAKES, frame};
use crate::motion::{Foot, JOINT_COUNT, joint::*};

#[test]
fn there_are_enough_kinds_and_each_has_a_name_of_its_own() {
    let patches: Vec<_> = TAKES.iter().flat_map(|(t, _)| &t.file.patches).collect();
    let names: BTreeSet<_> = patches.iter().map(|p| &p.name).collect();
    assert_eq!(names.len(), patches.len());
    let single = patches.iter().filter(|p| p.roles.len() == 1).count();
    assert!(single >= 27 && patches.len() - single >= 16, "{single} single, {} shared", patches.len() - single);
    for p in &patches {
        for r in &p.roles {
            let seconds = r.end - r.begin;
            // To sit down and to get up takes longer than anything else.
            let most = if p.labels.iter().any(|l| l == "sit") { 6.1 } else { 5.1 };
            let least = if p.roles.len() == 1 { 0.49 } else { 1.4 };
            assert!((least..most).contains(&seconds), "{}: {seconds} s", p.name);
        }
        if let Some([from, to]) = p.core {
            assert!(from < to && p.roles.iter().all(|r| r.begin <= from && to <= r.end), "{}: core", p.name);
        }
    }
}

#[test]
fn patches_begin_and_end_at_ports_on_whole_frames() {
    for (take, _) in TAKES.iter() {
        for role in take.file.patches.iter().flat_map(|p| &p.roles) {
            for time in [role.begin, role.end] {
                let here = take.file.ports.iter().any(|p| p.person == role.person && (p.time - time).abs() < 1e-4);
                assert!(here, "{}: no port of person {} at {time}", take.file.name, role.person);
                assert!((time * 30.0 - (time * 30.0).round()).abs() < 1e-3);
            }
        }
    }
}

/// Where it is, local rotations, feet relative to the hips.
type PortPose = (String, Vec<glam::Quat>, [Vec3; 2]);

/// Local rotations (the hips' without heading) and feet relative to the hips, at a port.
fn port_pose(take: usize, person: usize, f: usize) -> (Vec<glam::Quat>, [Vec3; 2]) {
    let clip = &TAKES[take].0.clips[person];
    let mut pose = clip.pose(f).to_vec();
    let ahead = pose[0] * Vec3::Z;
    let level = glam::Quat::from_rotation_y(-ahead.x.atan2(ahead.z));
    pose[0] = level * pose[0];
    let globals = &TAKES[take].1[person][f];
    (pose, [LEFT_FOOT, RIGHT_FOOT].map(|j| level * (globals[j].0 - globals[HIPS].0)))
}

#[test]
fn poses_at_ports_of_a_group_are_alike() {
    let mut groups: BTreeMap<String, Vec<PortPose>> = BTreeMap::new();
    for (i, (take, _)) in TAKES.iter().enumerate() {
        for port in &take.file.ports {
            let (pose, feet) = port_pose(i, port.person, frame(port.time));
            let place = format!("{} person {} at {:.2}", take.file.name, port.person, port.time);
            groups.entry(port.pose.clone()).or_default().push((place, pose, feet));
        }
    }
    let names: Vec<_> = groups.keys().map(String::as_str).collect();
    assert_eq!(
        names,
        [
            "carry_stand",
            "carry_walk_left",
            "carry_walk_right",
            "hop_left",
            "hop_right",
            "stand",
            "walk_left",
            "walk_right"
        ]
    );
    for (name, ports) in &groups {
        let (angles, gap) = if name.ends_with("stand") { (5.0, 0.02) } else { (12.0, 0.035) };
        for joint in 0..JOINT_COUNT {
            let mean = ports.iter().fold(glam::Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), |sum, p| {
                sum + if p.1[joint].dot(ports[0].1[joint]) < 0.0 { -p.1[joint] } else { p.1[joint] }
            });
            let far = ports.iter().map(|p| (mean.normalize().angle_between(p.1[joint]).to_degrees(), &p.0));
            let worst = far.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
            assert!(worst.0 < angles, "{name}: joint {joint} is {:.1} deg off at {}", worst.0, worst.1);
        }
        for foot in 0..2 {
            let mean: Vec3 = ports.iter().map(|p| p.2[foot]).sum::<Vec3>() / ports.len() as f32;
            for (place, _, feet) in ports {
                // The swinging foot passes at different speeds.
                let swinging =
                    name.ends_with(["right", "left"][foot]) != name.ends_with("stand") && !name.ends_with("stand");
                let limit = if swinging { 2.5 * gap } else { gap };
                assert!((feet[foot] - mean).length() < limit, "{name}: foot {foot} at {place}: {}", feet[foot] - mean);
            }
        }
    }
}

#[test]
fn planted_feet_stay_on_the_ground() {
    let (mut slide, mut low, mut high) = (0f32, f32::MAX, f32::MIN);
    for (take, globals) in TAKES.iter() {
        for p in &take.file.plants {
            let (ankle, toe) = if p.foot == Foot::Left { (LEFT_FOOT, LEFT_TOE) } else { (RIGHT_FOOT, RIGHT_TOE) };
            let at = |f: usize| &globals[p.person][f];
            let (from, to) = ((p.begin * 60.0).ceil() as usize, (p.end * 60.0).floor() as usize);
            let to = to.min(globals[p.person].len() - 1);
            for f in from..=to {
                let moved = (at(f)[toe].0 - at(from)[toe].0).length();
                slide = slide.max(moved);
                assert!(moved <= 0.003, "{}: {:?} foot slides {moved} at {f}", take.file.name, p.foot);
                let points = [
                    at(f)[ankle].0 + at(f)[ankle].1 * Vec3::new(0.0, -0.075, -0.05),
                    at(f)[toe].0 + at(f)[toe].1 * Vec3::new(0.0, -0.02, 0.0),
                    at(f)[toe].0 + at(f)[toe].1 * Vec3::new(0.0, -0.02, 0.07),
                ];
                let lowest = points.iter().map(|p| p.y).fold(f32::MAX, f32::min);
                (low, high) = (low.min(lowest), high.max(lowest));
            }
        }
    }
    assert!(low > -0.012 && high < 0.03, "{low} {high}");
}
