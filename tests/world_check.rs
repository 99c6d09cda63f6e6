//! The check of crowd patches finds every fault: one right patch, one fault per test.

use crowdquilt::check::world::{Placed, check_patch, check_tiles};
use crowdquilt::world::{CrowdPatch, FramePatch, Limits, Options, PatternType, Shape, Standing, StaticObject, solve};
use glam::Vec2;

fn right() -> CrowdPatch {
    let frame = FramePatch::random_square(8.0, 10.0, &[PatternType::mixed(2, 2); 4], 3).unwrap();
    let solution = solve(&frame, &Limits::default(), &Options::default()).unwrap();
    assert!(solution.ok());
    solution.patch
}

fn faults(change: impl FnOnce(&mut CrowdPatch)) -> String {
    let mut patch = right();
    assert_eq!(check_patch(&patch, &Limits::default()).violations, Vec::<String>::new());
    change(&mut patch);
    check_patch(&patch, &Limits::default()).violations.join("; ")
}

fn assert_found(found: &str, expected: &str) {
    assert!(found.contains(expected), "expected {expected:?} in {found:?}");
}

#[test]
fn a_missing_walker_is_found() {
    assert_found(&faults(|p| drop(p.walkers.pop())), "every input and output to be used once");
}

#[test]
fn two_walkers_with_one_output_are_found() {
    assert_found(&faults(|p| p.walkers[1].output = p.walkers[0].output), "every input and output to be used once");
}

#[test]
fn walkers_who_go_back_are_found() {
    let back = |p: &mut CrowdPatch| {
        let edge = p.walkers[0].input.edge;
        let other = p.walkers.iter().position(|w| w.output.edge == edge).unwrap();
        let swap = p.walkers[0].output;
        p.walkers[0].output = p.walkers[other].output;
        p.walkers[other].output = swap;
    };
    assert_found(&faults(back), "nobody to go back");
}

#[test]
fn a_walker_who_comes_late_is_found() {
    assert_found(&faults(|p| p.walkers[2].path.first += 1), "walker 2: expected a straight crossing");
}

#[test]
fn a_path_that_ends_at_the_border_is_found() {
    let short = |p: &mut CrowdPatch| {
        let path = &mut p.walkers[2].path;
        path.points.truncate(path.points.len() - 3);
    };
    assert_found(&faults(short), "walker 2: expected a path from");
}

#[test]
fn a_kink_is_found() {
    let kink = |p: &mut CrowdPatch| {
        let path = &mut p.walkers[3].path;
        let middle = path.points.len() / 2;
        path.points[middle] += Vec2::new(0.15, 0.1);
    };
    assert_found(&faults(kink), "walker 3: expected acceleration at most 2.5");
}

#[test]
fn haste_is_found() {
    let haste = |p: &mut CrowdPatch| {
        let path = &mut p.walkers[3].path;
        let middle = path.points.len() / 2;
        path.points[middle..].iter_mut().for_each(|point| point.x += 0.5);
    };
    assert_found(&faults(haste), "walker 3: expected speed at most 2");
}

#[test]
fn walkers_who_touch_are_found() {
    let twin = |p: &mut CrowdPatch| {
        let path = p.walkers[0].path.clone();
        p.walkers[1].path = path;
    };
    assert_found(&faults(twin), "walkers 0 and 1, 0 periods later, come as near as");
}

#[test]
fn a_thin_wall_between_two_samples_is_found() {
    let wall = |p: &mut CrowdPatch| {
        let path = &p.walkers[0].path;
        let middle = f64::from(path.span().0 + path.span().1) * 0.5 + 0.013;
        let shape = Shape::oblong(path.position(middle), Vec2::new(0.002, 0.002), 0.3);
        p.frame.objects.push(StaticObject { name: "needle".into(), shape });
    };
    assert_found(&faults(wall), "walker 0: expected it 0.25 m off objects");
}

#[test]
fn a_standing_person_in_the_way_is_found() {
    let stand = |p: &mut CrowdPatch| {
        let path = &p.walkers[0].path;
        let position = path.position(f64::from(path.span().0 + path.span().1) * 0.5);
        p.frame.people.push(Standing { name: "stand".into(), position, heading: 0.0, radius: 0.3, role: None });
    };
    assert_found(&faults(stand), "walker 0: expected it 0.25 m off objects");
}

#[test]
fn a_walker_who_leaves_the_patch_is_found() {
    let leave = |p: &mut CrowdPatch| {
        let path = &mut p.walkers[0].path;
        let n = path.points.len();
        // A long smooth detour over the border.
        for (i, point) in path.points.iter_mut().enumerate().take(n - 8).skip(8) {
            let share = (i - 8) as f32 / (n - 16) as f32;
            *point += Vec2::new(9.0, 9.0) * (share * std::f32::consts::PI).sin().powi(2);
        }
    };
    assert_found(&faults(leave), "walker 0: expected it 0.25 m inside the border");
}

#[test]
fn broken_paths_are_found() {
    assert_found(&faults(|p| p.walkers[0].path.points[5].x = f32::NAN), "finite paths");
    assert_found(&faults(|p| p.walkers[0].path.points.truncate(3)), "at least four points");
    assert_found(&faults(|p| p.walkers[0].path.step = 0.19), "one step that divides the period");
}

#[test]
fn tiles_that_do_not_fit_are_found() {
    let patch = right();
    let row: Vec<Placed> = (0..2).map(|i| Placed { patch: &patch, origin: Vec2::new(8.0 * i as f32, 0.0) }).collect();
    let report = check_tiles(&row, Some(Vec2::new(16.0, 8.0)), &Limits::default());
    assert!(report.violations.iter().any(|v| v.contains("nobody takes over")), "{:?}", report.violations);
    let same_place = [row[0], row[0]];
    let report = check_tiles(&same_place, None, &Limits::default());
    assert!(report.closest <= 0.0 && report.violations.iter().any(|v| v.contains("come as near as")));
}
