//! Real captures (CMU's database; not part of the project): imported, retargeted, cut by `examples/cmu`.
//!
//! The folder is `../shared/mocap`, or what `CROWDQUILT_MOCAP` says. Without it these tests say so and pass.

mod mocap;

use std::path::Path;

use crowdquilt::geom::Capsule;
use crowdquilt::motion::retarget::{RestRig, match_rig, rest_turns};
use crowdquilt::motion::take::ImportOptions;
use crowdquilt::motion::{
    Clip, Foot, Motion, canonical, contacts, gait, import, joint, limits, plants, pose, reach, retarget,
};
use crowdquilt::patch::{PatchSet, cut_folder};
use glam::{Quat, Vec3};

fn load(folder: &Path, take: &str) -> Clip {
    let row = mocap::rows(folder).into_iter().find(|r| r.take == take).unwrap();
    import::load(&row.file, &row.import).unwrap()
}

fn percentile(mut values: Vec<f32>, percent: usize) -> f32 {
    values.sort_by(f32::total_cmp);
    values[(values.len() - 1) * percent / 100]
}

/// Heights of the balls of the feet while planted.
fn planted_heights(motion: &Motion) -> Vec<f32> {
    let ball = |foot| if foot == Foot::Left { joint::LEFT_TOE } else { joint::RIGHT_TOE };
    let heights = |p: &crowdquilt::motion::Plant| {
        let points = plants::trajectory(motion, ball(p.foot));
        points[p.begin as usize..=p.end as usize].iter().map(|p| p.y).collect::<Vec<_>>()
    };
    motion.plants.iter().flat_map(heights).collect()
}

#[test]
fn every_capture_of_the_index_imports_by_its_row() {
    let Some(folder) = mocap::folder() else { return };
    for row in mocap::rows(&folder) {
        let clip = import::load(&row.file, &row.import).unwrap();
        assert_eq!(clip.frames(), row.frames - row.import.drop_first_frames.unwrap() as usize, "{}", row.take);
        let (stands, height) = (import::standing_height(&clip), retarget::body_height(&clip).unwrap());
        println!("{}: {height:.2} m tall by the bones, {stands:.2} m in the tallest posture", row.take);
        assert!((1.5..2.0).contains(&height), "{}: {height} m", row.take);
        let motion = retarget::to_canonical(&clip).unwrap();
        assert!(motion.rotations.iter().all(|q| q.is_normalized()), "{}", row.take);
    }
}

#[test]
fn the_unit_is_guessed_right_for_files_in_common_units() {
    let Some(folder) = mocap::folder() else { return };
    for row in mocap::rows(&folder).into_iter().filter(|r| r.import.metres_per_unit.unwrap() < 1.0) {
        let guessed = import::load(&row.file, &ImportOptions { metres_per_unit: None, ..row.import.clone() }).unwrap();
        let known = import::load(&row.file, &row.import).unwrap();
        let ratio = guessed.skeleton.joints[2].offset.length() / known.skeleton.joints[2].offset.length();
        assert!((ratio - 1.0).abs() < 1e-3, "{}: off by {ratio}", row.take);
    }
}

/// Feet on the floor: nineteen in twenty frames of planted balls are within 2 cm of where a planted ball belongs, and
/// only one in a hundred of all frames has a toe (ball or tip) lower than 2 cm below the floor.
#[test]
fn planted_feet_stand_on_the_floor() {
    let Some(folder) = mocap::folder() else { return };
    let mut wrong = Vec::new();
    for row in mocap::rows(&folder) {
        let motion = retarget::to_canonical(&import::load(&row.file, &row.import).unwrap()).unwrap();
        let off: Vec<f32> = planted_heights(&motion).iter().map(|y| (y - 0.02).abs()).collect();
        let (planted, lowest) = (percentile(off.clone(), 95), percentile(toes(&motion), 1));
        println!("{}: planted balls off by {planted:.3} m at most, toes above {lowest:.3} m", row.take);
        wrong.extend((lowest <= -0.02).then(|| format!("{} {lowest}", row.take)));
        assert!(planted < 0.02, "{}: planted balls are {planted} m off the floor", row.take);
    }
    assert!(wrong.is_empty(), "toes below the floor: {wrong:?}");
}

/// Height of the lowest toe at every frame: balls and tips.
fn toes(motion: &Motion) -> Vec<f32> {
    let tip = |toe: usize| canonical().joints[toe].tip.unwrap();
    let mut globals = Vec::new();
    let at = |frame| {
        motion.globals(frame, &mut globals);
        let ends = [joint::LEFT_TOE, joint::RIGHT_TOE].map(|j| {
            let (ball, turn) = globals[j];
            ball.y.min((ball + turn * tip(j)).y)
        });
        ends[0].min(ends[1])
    };
    (0..motion.len()).map(at).collect()
}

#[test]
fn knees_bend_forwards() {
    let Some(folder) = mocap::folder() else { return };
    for take in ["02_01", "09_12", "18_01", "19_01", "60_03", "61_03", "16_11", "26_01"] {
        let motion = retarget::to_canonical(&load(&folder, take)).unwrap();
        let mut globals = Vec::new();
        let (mut bent, mut backwards) = (0, 0);
        for frame in 0..motion.len() {
            motion.globals(frame, &mut globals);
            for [hip, knee, ankle, toe] in [[1, 2, 3, 4], [5, 6, 7, 8]] {
                let at = |j: usize| globals[j].0;
                let side = (at(knee) - at(hip)).reject_from(at(ankle) - at(hip));
                if side.length() > 0.03 {
                    bent += 1;
                    backwards += usize::from(side.dot(at(toe) - at(ankle)) < 0.0);
                }
            }
        }
        assert!(bent > 50 && backwards * 50 < bent, "{take}: {backwards} of {bent} knees bend backwards");
    }
}

#[test]
fn a_walk_has_the_gait_of_a_walk() {
    let Some(folder) = mocap::folder() else { return };
    let motion = retarget::to_canonical(&load(&folder, "02_01")).unwrap();
    let moments = gait::moments(&motion, &gait::GaitOptions::default());
    let phases: Vec<gait::Phase> = moments.iter().map(|m| m.phase).collect();
    assert!(moments.len() >= 4, "{moments:?}");
    assert!(phases.windows(2).all(|p| p[0] != p[1]), "left and right alternate: {moments:?}");
    for pair in moments.windows(3) {
        let stride = (pair[2].frame - pair[0].frame) as f32 / 30.0;
        assert!((0.9..1.3).contains(&stride), "stride of {stride} s");
    }
    let path = &motion.path;
    let speed = path.points[0].distance(path.points[path.len() - 1]) / ((path.len() - 1) as f32 / 30.0);
    assert!((1.0..1.5).contains(&speed), "{speed} m/s");
    // Someone who walks straight ahead looks where they go.
    for frame in 10..path.len() - 10 {
        let way = path.points[frame + 10] - path.points[frame - 10];
        let off = crowdquilt::geom::wrap_angle(way.x.atan2(way.y) - path.headings[frame]);
        assert!(off.abs() < 0.35, "frame {frame}: {off} rad");
    }
}

#[test]
fn hands_meet_in_the_handshake() {
    let Some(folder) = mocap::folder() else { return };
    let pair = retarget::take(&[load(&folder, "18_01"), load(&folder, "19_01")]).unwrap();
    let (mut a, mut b) = (Vec::new(), Vec::new());
    let gaps: Vec<f32> = (0..pair[0].len())
        .map(|frame| {
            pair[0].globals(frame, &mut a);
            pair[1].globals(frame, &mut b);
            contacts::palm(&a, joint::RIGHT_HAND).distance(contacts::palm(&b, joint::RIGHT_HAND))
        })
        .collect();
    let held = gaps.iter().filter(|&&g| g < 0.1).count();
    assert!(held >= 20, "right palms within 10 cm for {held} frames only: {gaps:?}");
    assert!(gaps[0] > 0.5, "they start apart: {}", gaps[0]);
    let found = contacts::detect(&pair, &contacts::ContactOptions::default());
    assert_eq!(found.len(), 1, "{found:?}");
}

/// Hands of a person, left and right, as capsules at every frame: on any bones, at 30 frames a second.
type Hands = [Vec<Capsule>; 2];

const HANDS: [usize; 2] = [joint::LEFT_HAND, joint::RIGHT_HAND];

fn hand(joint: usize, at: (Vec3, Quat), size: f32) -> Capsule {
    let tip = canonical().joints[joint].tip.unwrap() * size;
    Capsule { a: at.0, b: at.0 + at.1 * tip, radius: 0.035 * size }
}

fn captured_hands(clip: &Clip) -> Hands {
    let rest = RestRig::of(&clip.skeleton);
    let found = match_rig(&rest).unwrap();
    let (joints, turns) = (found.joints.map(|j| j.unwrap_or(0)), rest_turns(&rest, &found));
    let bone = |a: usize, b: usize| rest.places[joints[a]].distance(rest.places[joints[b]]);
    use joint::*;
    let legs = bone(LEFT_UP_LEG, LEFT_LEG) + bone(LEFT_LEG, LEFT_FOOT);
    let legs = legs + bone(RIGHT_UP_LEG, RIGHT_LEG) + bone(RIGHT_LEG, RIGHT_FOOT);
    let size = 0.5 * legs / 0.83;
    let mut globals = Vec::new();
    HANDS.map(|joint| {
        let mut at = |frame: usize| {
            clip.globals(frame, &mut globals);
            let (wrist, turn) = globals[joints[joint]];
            hand(joint, (wrist, turn * turns[joint]), size)
        };
        (0..clip.frames()).step_by((clip.fps / 30.0) as usize).map(&mut at).collect()
    })
}

fn hands(motion: &Motion) -> Hands {
    let mut globals = Vec::new();
    HANDS.map(|joint| {
        let mut at = |frame: usize| {
            motion.globals(frame, &mut globals);
            hand(joint, globals[joint], 1.0)
        };
        (0..motion.len()).map(&mut at).collect()
    })
}

/// How much farther apart hands are than they were, palms and surfaces, at all frames at which at most 3 cm were
/// between them.
fn farther(was: [&Hands; 2], is: [&Hands; 2]) -> Vec<f32> {
    let palm = |h: &Capsule| h.a.midpoint(h.b);
    let measure = |a: &Capsule, b: &Capsule| [palm(a).distance(palm(b)), a.between(b).length() - a.radius - b.radius];
    let mut found = Vec::new();
    for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        for f in 0..is[0][i].len().min(is[1][j].len()) {
            let (was, is) = (measure(&was[0][i][f], &was[1][j][f]), measure(&is[0][i][f], &is[1][j][f]));
            found.extend((was[1] <= 0.03).then_some((is[0] - was[0]).max(is[1] - was[1])));
        }
    }
    found
}

/// The acceleration that palms stay below for 99 of 100 frames, m/s2.
fn jolt(motions: &[Motion]) -> f32 {
    let palms = motions.iter().flat_map(|m| HANDS.map(|hand| contacts::palm_trajectory(m, hand)));
    let of = |p: Vec<Vec3>| p.windows(3).map(|p| (p[2] - 2.0 * p[1] + p[0]).length() * 900.0).collect::<Vec<f32>>();
    percentile(palms.flat_map(of).collect(), 99)
}

/// Hands that touch in captures of pairs are within 2 cm of as near each other on bodies of another size.
#[test]
fn hands_of_pairs_are_as_near_each_other_as_captured() {
    let Some(folder) = mocap::folder() else { return };
    let rows: Vec<String> = mocap::rows(&folder).into_iter().map(|r| r.take).collect();
    for [one, other] in [["18", "19"], ["60", "61"]] {
        for take in rows.iter().filter_map(|t| t.strip_prefix(one)) {
            let clips = [load(&folder, &format!("{one}{take}")), load(&folder, &format!("{other}{take}"))];
            let was = clips.each_ref().map(captured_hands);
            let of = |motions: &[Motion]| farther([&was[0], &was[1]], [&hands(&motions[0]), &hands(&motions[1])]);
            // Alone, nobody minds the other's hands.
            let alone = clips.each_ref().map(|clip| retarget::to_canonical(clip).unwrap());
            let moved = retarget::take(&clips).unwrap();
            let (before, after) = (of(&alone), of(&moved));
            let most = |off: &[f32]| percentile(off.to_vec(), 100);
            let (frames, before, after) = (after.len(), most(&before), most(&after));
            println!(
                "{one}{take}: {frames} frames, hands farther apart by up to {before:.3} m; restored: {after:.3} m"
            );
            assert!(frames >= 20 && after < 0.02, "{one}{take}: {after}");
            let (rough, smooth) = (jolt(&moved), jolt(&alone));
            println!("{one}{take}: hands accelerate by {rough:.1} m/s2, alone {smooth:.1}");
            assert!(rough < 1.15 * smooth + 5.0, "{one}{take}: {rough} instead of {smooth} m/s2");
        }
    }
}

/// What a take file says about hands goes further: palms touch, whatever the capture's bones say.
#[test]
fn hands_that_a_take_says_touch_do() {
    let Some(folder) = mocap::folder() else { return };
    let mut pair = retarget::take(&[load(&folder, "18_01"), load(&folder, "19_01")]).unwrap();
    let found = contacts::detect(&pair, &contacts::ContactOptions::default());
    reach::keep(&mut pair, &found);
    let misses = reach::misses(&pair, &found[0]);
    let (mean, most) = (misses.iter().sum::<f32>() / misses.len() as f32, percentile(misses.clone(), 100));
    println!("handshake: palms miss by {mean:.4} m in the mean, {most:.4} at most");
    assert!(mean < 0.002 && most < 0.01, "{misses:?}");
}

/// Captures and samples keep to the limits of joints, but for a few frames of hands and rigs that rest oddly.
#[test]
fn captures_rarely_exceed_the_limits_of_joints() {
    let Some(folder) = mocap::folder() else { return };
    let mut shares = Vec::new();
    for row in mocap::rows(&folder) {
        let motion = retarget::to_canonical(&import::load(&row.file, &row.import).unwrap()).unwrap();
        let over = limits::measure(&motion);
        println!(
            "{}: {:.2} % beyond, worst {} by {:.0} degrees",
            row.take,
            100.0 * over.share,
            canonical().joints[over.joint].name,
            over.worst.to_degrees()
        );
        shares.push(over.share);
    }
    let (middle, most) = (percentile(shares.clone(), 50), percentile(shares, 100));
    println!("limits: median {:.3} % of joint frames beyond, most {:.2} %", 100.0 * middle, 100.0 * most);
    // The most is 141_16, whose knees were captured bent sideways by up to 32 degrees.
    assert!(middle < 0.005 && most < 0.06, "{middle} {most}");
}

#[test]
fn the_patches_of_the_examples_close_on_each_other() {
    let Some(folder) = mocap::folder() else { return };
    let takes = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/cmu");
    let set = cut_folder(&takes, Some(&folder)).unwrap();
    assert!(set.validate().is_empty());
    let shared = set.kinds.iter().filter(|k| k.people() > 1 && !k.contacts.is_empty()).count();
    assert!(set.kinds.len() >= 60 && shared >= 6, "{} kinds, {shared} shared", set.kinds.len());
    // From every group one can get to every other by single-person kinds, in few steps.
    let n = set.groups.len();
    for from in 0..n {
        let mut reached = vec![false; n];
        reached[from] = true;
        for _ in 0..3 {
            for (entry, exit) in single_kinds(&set) {
                reached[exit] |= reached[entry];
            }
        }
        assert!(reached.iter().all(|&r| r), "from {} not everything is reached", set.groups[from].name);
    }
    // Both ways round: steering.
    let turn = |k: &crowdquilt::patch::PatchKind| {
        let h = &k.fragments[0].motion.path.headings;
        h[h.len() - 1] - h[0]
    };
    let walks = || set.kinds.iter().filter(|k| k.people() == 1 && k.labels.iter().any(|l| l == "turn"));
    assert!(walks().any(|k| turn(k) > 0.5) && walks().any(|k| turn(k) < -0.5));
}

#[test]
fn the_patches_of_the_examples_are_clean() {
    let Some(folder) = mocap::folder() else { return };
    let takes = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/cmu");
    let set = cut_folder(&takes, Some(&folder)).unwrap();
    for kind in &set.kinds {
        for (role, fragment) in kind.fragments.iter().enumerate() {
            let m = &fragment.motion;
            for joint in 0..crowdquilt::motion::JOINT_COUNT {
                let points = plants::trajectory(m, joint);
                let jolts = points.windows(3).map(|p| (p[2] - 2.0 * p[1] + p[0]).length() * 900.0);
                let worst = jolts.fold(0.0, f32::max);
                assert!(worst < 250.0, "{} role {role} joint {joint}: {worst} m/s2", kind.name);
            }
            for plant in &m.plants {
                let ball = if plant.foot == Foot::Left { joint::LEFT_TOE } else { joint::RIGHT_TOE };
                let points = plants::trajectory(m, ball);
                let stay = &points[plant.begin as usize..=plant.end as usize];
                let slide = stay.iter().map(|p| p.with_y(0.0).distance(stay[0].with_y(0.0))).fold(0.0, f32::max);
                assert!(slide < 0.01, "{} role {role}: a planted foot slides by {slide} m", kind.name);
            }
        }
    }
}

#[test]
fn poses_of_one_group_are_alike() {
    let Some(folder) = mocap::folder() else { return };
    let takes = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/cmu");
    let set = cut_folder(&takes, Some(&folder)).unwrap();
    let alone: Vec<&Motion> = set.kinds.iter().filter(|k| k.people() == 1).map(|k| &k.fragments[0].motion).collect();
    for group in 0..set.groups.len() {
        let kinds = set.kinds.iter().filter(|k| k.people() == 1).map(|k| &k.fragments[0]).zip(&alone);
        let mut ports: Vec<(&Motion, usize)> = Vec::new();
        for (fragment, motion) in kinds {
            ports.extend((fragment.entry_group as usize == group).then_some((*motion, 0)));
            ports.extend((fragment.exit_group as usize == group).then_some((*motion, motion.len() - 1)));
        }
        let mut gaps = Vec::new();
        for (i, a) in ports.iter().enumerate() {
            gaps.extend(ports[i + 1..].iter().map(|b| pose::distance(a.0, a.1, b.0, b.1)));
        }
        let (middle, most) = (percentile(gaps.clone(), 50), percentile(gaps, 100));
        println!("{}: {} ports, median {middle:.3} m, most {most:.3} m", set.groups[group].name, ports.len());
        assert!(middle < 0.09 && most < 0.16, "{}: {middle} {most}", set.groups[group].name);
    }
}

fn single_kinds(set: &PatchSet) -> Vec<(usize, usize)> {
    let alone = set.kinds.iter().filter(|k| k.people() == 1);
    alone.map(|k| (k.fragments[0].entry_group as usize, k.fragments[0].exit_group as usize)).collect()
}
