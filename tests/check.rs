//! One crowd that keeps the contract, and one fault per test: each must fail its own rows and no others.

mod fixture;

use crowdquilt::check::{Limits, check, check_with, summary};
use crowdquilt::geom::Polygon;
use crowdquilt::motion::{JOINT_COUNT, joint};
use crowdquilt::stage::Crowd;
use fixture::{DEFORMED_WALKER, OTHER_SHAKER, SHAKER, STAND, WALKER, crowd};
use glam::{Quat, Vec2, Vec3};

/// Breaks the valid crowd with `fault` and expects exactly the rows whose names contain `expected` to fail.
fn fails(fault: impl FnOnce(&mut Crowd), expected: &[&str]) {
    let mut broken = crowd();
    fault(&mut broken);
    let report = check(&broken);
    let failed: Vec<&str> = report.failures().map(|r| r.row.as_str()).collect();
    let as_expected = failed.len() == expected.len() && failed.iter().zip(expected).all(|(f, e)| f.contains(e));
    assert!(as_expected, "expected {expected:?} to fail\n{report}");
    assert!(!report.ok());
    assert!(report.failures().all(|r| !r.place.is_empty()), "{report}");
}

fn shift_root(crowd: &mut Crowd, character: usize, by: Vec3) {
    crowd.characters[character].root.iter_mut().for_each(|p| *p += by);
}

fn shift_paths(crowd: &mut Crowd, character: usize, by: Vec2) {
    crowd.characters[character].fragments.iter_mut().flat_map(|f| &mut f.points).for_each(|p| *p += by);
}

#[test]
fn the_valid_crowd_passes_every_row() {
    let report = check(&crowd());
    assert!(report.ok(), "{report}");
    let deformed = report.rows.iter().find(|r| r.row.contains("stretch")).unwrap();
    assert!(deformed.value > 2e-4 && deformed.place.contains(&format!("character {DEFORMED_WALKER}")), "{report}");
    let text = report.to_string();
    assert_eq!(text.lines().count(), report.rows.len() + 1);
    assert!(!text.contains("FAIL"));
}

#[test]
fn the_report_survives_json_and_a_written_crowd_passes_too() {
    let report = check(&crowd());
    let json = serde_json::to_string(&report).unwrap();
    let mut back: crowdquilt::check::Report = serde_json::from_str(&json).unwrap();
    for (b, row) in back.rows.iter_mut().zip(&report.rows) {
        // The JSON parser may miss a number's last bit.
        assert!((b.value - row.value).abs() <= 1e-15 * row.value.abs().max(1e-9));
        b.value = row.value;
    }
    assert_eq!(back, report);
    let read = Crowd::from_bytes(&crowd().to_bytes()).unwrap();
    let again = check(&read);
    assert!(again.ok(), "{again}");
}

#[test]
fn the_report_does_not_depend_on_the_number_of_threads() {
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| check(&crowd()))
    };
    assert_eq!(on(1), on(4));
}

#[test]
fn summary_counts() {
    let s = summary(&crowd());
    assert_eq!((s.characters, s.instances, s.kinds_used, s.danglings), (4, 15, 3, 0));
    // 60 + 55 of 4 x 119 intervals between frames are spent in the handshake.
    assert!((s.multi_person_share - 115.0 / 476.0).abs() < 1e-9, "{s:?}");
}

#[test]
fn an_exit_before_the_end_dangles() {
    let fault = |c: &mut Crowd| {
        let instance = c.characters[WALKER].fragments.pop().unwrap().instance;
        remove_instance(c, instance);
        let walker = &mut c.characters[WALKER];
        walker.root.truncate(111);
        walker.rotations.truncate(111 * JOINT_COUNT);
    };
    fails(fault, &["dangling"]);
}

fn remove_instance(c: &mut Crowd, instance: u32) {
    c.instances.remove(instance as usize);
    for f in c.characters.iter_mut().flat_map(|c| &mut c.fragments).filter(|f| f.instance > instance) {
        f.instance -= 1;
    }
}

#[test]
fn an_entry_after_the_beginning_dangles() {
    let fault = |c: &mut Crowd| {
        let instance = c.characters[WALKER].fragments.remove(0).instance;
        remove_instance(c, instance);
        let walker = &mut c.characters[WALKER];
        walker.begin = 20;
        walker.root.drain(..20);
        walker.rotations.drain(..20 * JOINT_COUNT);
    };
    fails(fault, &["dangling"]);
}

#[test]
fn a_chain_with_a_hole_leaves_a_role_without_player() {
    let fault = |c: &mut Crowd| drop(c.characters[OTHER_SHAKER].fragments.remove(1));
    // Whose hand the other one shakes is then a stranger's.
    fails(fault, &["roles missing", "gap in time", "different patches overlap"]);
}

#[test]
fn a_role_played_twice_is_miscast() {
    // One instance is played by two people, the other by nobody.
    let fault = |c: &mut Crowd| c.characters[SHAKER].fragments[0].instance = c.characters[SHAKER].fragments[2].instance;
    fails(fault, &["roles missing"]);
}

#[test]
fn an_exit_into_another_pose_is_seen() {
    let fault = |c: &mut Crowd| c.set.kinds[STAND].fragments[0].exit_group = 0;
    fails(fault, &["unlike poses"]);
}

#[test]
fn motion_that_ends_early_is_seen() {
    let fault = |c: &mut Crowd| {
        c.characters[WALKER].root.pop();
        let n = c.characters[WALKER].rotations.len();
        c.characters[WALKER].rotations.truncate(n - JOINT_COUNT);
    };
    fails(fault, &["does not span"]);
}

#[test]
fn two_millimetres_at_a_stitch() {
    let fault = |c: &mut Crowd| c.characters[WALKER].fragments[2].points.iter_mut().for_each(|p| p.x += 0.002);
    fails(fault, &["gap between the paths"]);
}

#[test]
fn most_of_a_degree_at_a_stitch() {
    let fault = |c: &mut Crowd| {
        c.characters[WALKER].fragments[2].headings.iter_mut().for_each(|h| *h += 0.6f32.to_radians());
    };
    fails(fault, &["gap between the headings"]);
}

#[test]
fn a_whole_turn_at_a_stitch_is_none() {
    let mut turned = crowd();
    turned.characters[WALKER].fragments[2].headings.iter_mut().for_each(|h| *h += std::f32::consts::TAU);
    let report = check(&turned);
    assert!(report.ok(), "{report}");
}

#[test]
fn a_frame_between_exit_and_entry() {
    fails(|c| c.characters[SHAKER].fragments[0].end -= 1, &["gap in time"]);
}

#[test]
fn a_joint_that_spins() {
    let fault = |c: &mut Crowd| {
        c.characters[WALKER].rotations[60 * JOINT_COUNT + joint::HEAD] *= Quat::from_rotation_y(0.5);
    };
    fails(fault, &["joint turns faster"]);
}

#[test]
fn a_body_that_hops_for_one_frame() {
    fails(|c| c.characters[WALKER].root[60].y += 0.09, &["joint moves faster", "accelerates harder"]);
}

#[test]
fn a_body_beside_its_path() {
    fails(|c| shift_root(c, WALKER, Vec3::X * 0.08), &["hips off"]);
}

#[test]
fn a_stretched_edge() {
    fails(|c| c.characters[WALKER].fragments[2].points[10].y += 0.016, &["stretch"]);
}

#[test]
fn a_bent_path() {
    fails(|c| c.characters[WALKER].fragments[2].headings[10] += 4f32.to_radians(), &["bend"]);
}

#[test]
fn a_crab_walk() {
    let fault = |c: &mut Crowd| {
        let walker = &mut c.characters[WALKER];
        walker.fragments.iter_mut().flat_map(|f| &mut f.headings).for_each(|h| *h += 25f32.to_radians());
    };
    fails(fault, &["slip"]);
}

#[test]
fn a_hurried_stand() {
    let fault = |c: &mut Crowd| {
        // From 45 frames to 25; the handshake after it stays where it is.
        c.characters[SHAKER].fragments[0].begin += 20;
        c.characters[SHAKER].fragments[0].begin -= 5;
    };
    fails(fault, &["time shift"]);
}

#[test]
fn strangers_in_each_other() {
    let fault = |c: &mut Crowd| {
        let to = c.characters[SHAKER].root[0] - c.characters[WALKER].root[60];
        shift_root(c, WALKER, Vec3::new(to.x, 0.0, to.z));
        shift_paths(c, WALKER, Vec2::new(to.x, to.z));
    };
    fails(fault, &["different patches overlap"]);
}

#[test]
fn partners_deeper_in_each_other_than_captured() {
    let fault = |c: &mut Crowd| {
        let to = (c.characters[OTHER_SHAKER].root[0] - c.characters[SHAKER].root[0]).normalize();
        shift_root(c, SHAKER, to * 0.05);
    };
    fails(fault, &["one patch overlap more"]);
}

#[test]
fn hands_that_part() {
    let fault = |c: &mut Crowd| {
        let to = (c.characters[OTHER_SHAKER].root[0] - c.characters[SHAKER].root[0]).normalize();
        shift_root(c, SHAKER, to * -0.05);
    };
    fails(fault, &["touching parts"]);
}

#[test]
fn partners_misplaced() {
    fails(|c| shift_paths(c, SHAKER, Vec2::new(0.015, 0.0)), &["relative position"]);
}

#[test]
fn partners_turned_away() {
    let fault = |c: &mut Crowd| {
        let other = &mut c.characters[OTHER_SHAKER];
        other.fragments.iter_mut().flat_map(|f| &mut f.headings).for_each(|h| *h += 1.5f32.to_radians());
    };
    fails(fault, &["relative heading"]);
}

#[test]
fn partners_out_of_step() {
    let fault = |c: &mut Crowd| {
        let other = &mut c.characters[OTHER_SHAKER].fragments;
        other[0].end += 2;
        other[1].begin += 2;
        other[1].end += 2;
        other[2].begin += 2;
    };
    fails(fault, &["relative time"]);
}

#[test]
fn a_sliding_foot() {
    let fault = |c: &mut Crowd| {
        for (i, p) in c.characters[WALKER].root.iter_mut().enumerate() {
            p.x += 0.04 * (i as f32 / 15.0).sin();
        }
    };
    // The walker's plants are many of the few that there are.
    fails(fault, &["foot slides", "foot slides, median"]);
}

#[test]
fn a_foot_in_the_floor() {
    fails(|c| shift_root(c, STAND, Vec3::NEG_Y * 0.05), &["foot below the floor"]);
}

/// Bends a joint by some degrees about an axis, slowly, so that nothing else is wrong with it.
fn bend_slowly(crowd: &mut Crowd, character: usize, joint: usize, axis: Vec3, most: f32) {
    for (i, pose) in crowd.characters[character].rotations.chunks_mut(JOINT_COUNT).enumerate() {
        let bend = (i as f32 / 60.0).min(1.0) * most.to_radians();
        pose[joint] = Quat::from_axis_angle(axis, bend) * pose[joint];
    }
}

#[test]
fn a_knee_bent_backwards() {
    // It takes the foot along.
    let fault = |c: &mut Crowd| bend_slowly(c, SHAKER, joint::LEFT_LEG, Vec3::NEG_X, 80.0);
    fails(fault, &["planted foot slides", "joint further beyond its limits"]);
}

#[test]
fn an_elbow_bent_backwards() {
    let fault = |c: &mut Crowd| bend_slowly(c, WALKER, joint::LEFT_FORE_ARM, Vec3::Y, 50.0);
    fails(fault, &["joint further beyond its limits"]);
}

#[test]
fn a_step_out_of_the_region() {
    let fault = |c: &mut Crowd| {
        c.domain.region = Polygon::rectangle(Vec2::new(-5.0, -0.7), Vec2::new(5.0, 6.0));
    };
    fails(fault, &["outside the region"]);
}

#[test]
fn a_walk_through_a_wall() {
    let fault = |c: &mut Crowd| {
        c.domain.obstacles.push(Polygon::rectangle(Vec2::new(1.25, 0.0), Vec2::new(2.0, 0.3)).into());
    };
    fails(fault, &["inside obstacles"]);
}

#[test]
fn references_to_nothing_are_a_failed_row_and_no_panic() {
    fails(|c| c.instances[3].kind = 9, &["references"]);
    fails(|c| c.characters[0].fragments[1].role = 4, &["references"]);
    fails(|c| c.characters[0].fragments[1].instance = 400, &["references"]);
    fails(|c| c.characters[1].fragments[0].points.truncate(7), &["references"]);
    fails(|c| c.characters[1].rotations.truncate(7), &["references"]);
    fails(|c| c.characters[1].root[5].x = f32::NAN, &["references"]);
    fails(|c| c.domain.last_frame = u32::MAX, &["references"]);
}

#[test]
fn a_character_without_anything_dangles() {
    let fault = |c: &mut Crowd| {
        let walker = &mut c.characters[WALKER];
        walker.fragments.clear();
        walker.root.clear();
        walker.rotations.clear();
        c.instances.drain(..5);
        c.characters.iter_mut().flat_map(|c| &mut c.fragments).for_each(|f| f.instance -= 5);
    };
    fails(fault, &["dangling"]);
}

/// Seventy people for twenty seconds, as in the densest scene of the paper. Prints the time it takes.
#[test]
fn a_crowd_of_seventy_is_checked_fast() {
    let crowd = fixture::lattice(70, 600);
    let begin = std::time::Instant::now();
    let report = check(&crowd);
    println!("{} people, {} frames: {:?}", crowd.characters.len(), crowd.domain.last_frame, begin.elapsed());
    assert!(report.ok(), "{report}");
}

#[test]
fn limits_are_settings() {
    let strict = Limits { stretch: 1e-4, ..Limits::default() };
    let report = check_with(&crowd(), &strict);
    assert!(report.failures().any(|r| r.row.contains("stretch")), "{report}");
}
