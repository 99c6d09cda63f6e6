//! Patches composed by hand out of the generated samples: what is said holds, and what cannot be is refused with its
//! line.

mod composing;

use std::path::Path;

use composing::{SOURCES, crowd_with, edited, made, sample_set};
use crowdquilt::check;
use crowdquilt::geom::{Ground, wrap_angle};
use crowdquilt::motion::contacts::palm;
use crowdquilt::motion::{FPS, JOINT_COUNT, Motion, MotionPath, joint};
use crowdquilt::patch::compose::{add, compose};
use crowdquilt::patch::{CutOptions, PatchKind, PatchSet, mirrored};
use glam::{Quat, Vec2};
use proptest::prelude::*;

const MEET: &str = include_str!("../examples/compose/meet-and-bow.compose.toml");
const ROWS: &str = include_str!("../examples/compose/rows-bow.compose.toml");
const PUSH: &str = include_str!("../examples/compose/push-and-stumble.compose.toml");

/// Two walkers of two cycles each.
const WALK: &str = r#"
name = "walk-together"
[clips]
walk = { patch = "walk-1.15-cycle" }
slow = { patch = "walk-1.15-cycle" }
[[roles]]
name = "ann"
plays = ["walk", "slow"]
[[roles]]
name = "bob"
plays = ["walk", "slow"]
"#;

/// One walker of one cycle.
fn one_walker() -> String {
    let second = WALK.find("[[roles]]\nname = \"bob\"").unwrap();
    WALK[..second].replace("[\"walk\", \"slow\"]", "[\"walk\"]")
}

/// Where one role stands seen from another at a frame of the patch's clock.
fn seen(kind: &PatchKind, from: usize, who: usize, tick: u32) -> Ground {
    let at = |role: usize| {
        let f = &kind.fragments[role];
        f.motion.path.at((tick - f.begin) as usize)
    };
    at(from).inverse().then(at(who))
}

fn assert_stands(kind: &PatchKind, from: usize, who: usize, tick: u32, at: [f32; 3]) {
    let found = seen(kind, from, who, tick);
    let miss = found.position.distance(Vec2::new(at[1], at[0]));
    assert!(miss < 1e-3, "{who} seen from {from} at {tick}: {found:?}, {miss} m off");
    let turn = wrap_angle(found.heading - at[2].to_radians()).to_degrees();
    assert!(turn.abs() < 0.1, "{who} seen from {from} at {tick}: {turn} degrees off");
}

/// The largest change of an edge's length over all frames that both have, metres.
fn stretch(played: &Motion, captured: &[f32]) -> f32 {
    let edges = played.path.points.windows(2).map(|p| p[1].distance(p[0]));
    edges.zip(captured).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

fn edges(motion: &Motion) -> Vec<f32> {
    motion.path.points.windows(2).map(|p| p[1].distance(p[0])).collect()
}

#[test]
fn two_meet_and_bow() {
    let kind = made(MEET).unwrap();
    assert_eq!((kind.name.as_str(), kind.people(), kind.labels.len()), ("meet-and-bow", 2, 2));
    let (first, last) = kind.core.unwrap();
    assert_stands(&kind, 0, 1, first, [1.3, 0.0, 180.0]);
    // Both do as captured, but where clips are joined.
    let bow = SOURCES.iter().find(|s| s.take.name == "bow-stand").unwrap();
    let since = |role: usize, ticks: u32| {
        let path = &bow.motions[role].path;
        path.at(20).inverse().then(path.at(20 + ticks as usize))
    };
    let facing = Ground::new(Vec2::new(0.0, 1.3), std::f32::consts::PI);
    for tick in first + 10..=last - 10 {
        let expected = since(0, tick - first).inverse().then(facing).then(since(1, tick - first));
        let found = seen(&kind, 0, 1, tick);
        assert!(found.position.distance(expected.position) < 1e-3, "tick {tick}: {found:?} {expected:?}");
        assert!(wrap_angle(found.heading - expected.heading).abs() < 2e-3, "tick {tick}");
    }
    // They come from afar.
    assert!(seen(&kind, 0, 1, 0).position.y > 2.4);
}

#[test]
fn two_rows_of_five_bow_one_after_the_other() {
    let mut groups = Vec::new();
    let kind = compose(ROWS, &SOURCES, &mut groups).unwrap();
    assert_eq!(kind.people(), 10);
    assert!(groups.iter().any(|g| g.name == "stand"));
    // Roles: the hosts and guests of the first pair, then of the second, ...
    for pair in 0..5 {
        let (host, guest) = (2 * pair, 2 * pair + 1);
        let begin = kind.fragments[host].begin;
        assert_eq!(begin, 3 * pair as u32, "each is 0.1 s later");
        assert_eq!(kind.fragments[guest].begin, begin);
        assert_stands(&kind, host, guest, begin, [1.5, 0.0, 180.0]);
        if pair > 0 {
            assert_stands(&kind, host - 2, host, begin, [0.0, 0.9, 0.0]);
        }
    }
}

#[test]
fn a_row_of_one_role_stands_before_somebody_alone() {
    let kind = made(&ROWS.replace("[\"host\", \"guest\"]", "[\"guest\"]")).unwrap();
    assert_eq!(kind.people(), 6);
    assert_stands(&kind, 0, 1, 0, [1.5, 0.0, 180.0]);
    assert_stands(&kind, 1, 2, kind.fragments[2].begin, [0.0, 0.9, 0.0]);
}

#[test]
fn a_push_reaches_the_chest() {
    let kind = made(PUSH).unwrap();
    assert_eq!(kind.contacts.len(), 2);
    let begin = kind.contacts[0].begin;
    assert_stands(&kind, 0, 1, begin, [0.72, 0.0, 180.0]);
    let mut globals = [Vec::new(), Vec::new()];
    for tick in begin..=kind.contacts[0].end {
        for (fragment, out) in kind.fragments.iter().zip(&mut globals) {
            fragment.motion.globals((tick - fragment.begin) as usize, out);
        }
        let chest = globals[1][joint::SPINE2].0;
        for hand in [joint::LEFT_HAND, joint::RIGHT_HAND] {
            let apart = palm(&globals[0], hand).distance(chest);
            assert!(apart < 0.22, "tick {tick}: {apart} m from the middle of the chest");
        }
    }
}

#[test]
fn clips_are_joined_without_a_jerk() {
    let kind = made(MEET).unwrap();
    let fastest = |motion: &Motion| {
        let turns = (1..motion.len()).flat_map(|f| (0..JOINT_COUNT).map(move |j| (f, j)));
        turns.map(|(f, j)| motion.pose(f)[j].angle_between(motion.pose(f - 1)[j])).fold(0.0, f32::max)
    };
    let of_samples = SOURCES.iter().flat_map(|s| &s.motions).map(fastest).fold(0.0, f32::max);
    for fragment in &kind.fragments {
        let motion = &fragment.motion;
        assert!(fastest(motion) <= of_samples);
        let jolt = motion.path.points.windows(3).map(|p| (p[2] - 2.0 * p[1] + p[0]).length()).fold(0.0, f32::max);
        assert!(jolt * FPS * FPS < 8.0, "{jolt}");
        // One plant goes on over a joint.
        for (i, p) in motion.plants.iter().enumerate() {
            assert!(motion.plants[..i].iter().all(|q| q.foot != p.foot || q.end + 1 < p.begin), "{:?}", motion.plants);
        }
    }
}

#[test]
fn what_holds_at_two_moments_bends_the_way_between() {
    let text = format!(
        "{WALK}
[[places]]
who = \"bob.walk@0\"
seen_from = \"ann.walk@0\"
left = 0.8
turn_deg = 0
[[places]]
who = \"bob.slow@1\"
seen_from = \"ann.slow@1\"
left = 1.0
ahead = 0.1
turn_deg = 10
"
    );
    let kind = made(&text).unwrap();
    let last = kind.fragments[0].motion.len() as u32 - 1;
    assert_stands(&kind, 0, 1, 0, [0.0, 0.8, 0.0]);
    assert_stands(&kind, 0, 1, last - 4, [0.1, 1.0, 10.0]);
    let alone = made(WALK.split("[[roles]]\nname = \"bob\"").next().unwrap()).unwrap();
    let captured = edges(&alone.fragments[0].motion);
    for fragment in &kind.fragments {
        let found = stretch(&fragment.motion, &captured);
        assert!((1e-4..0.0141).contains(&found), "{found} m");
        let bend = fragment.motion.path.headings.windows(2).map(|h| (h[1] - h[0]).abs()).fold(0.0, f32::max);
        assert!(bend < 4f32.to_radians(), "{bend}");
    }
}

#[test]
fn times_that_differ_are_spread_over_the_way_between() {
    let at = |moment: &str, other: &str| {
        let place = format!("[[places]]\nwho = \"bob{moment}\"\nseen_from = \"ann{other}\"\n");
        place + "left = 1.0\nturn_deg = 0\n"
    };
    // Bob does in 1.7 s what Ann does in 1.8 s, and goes nearly as far.
    let text = format!("{WALK}{}{}", at("@0.2", "@0.2"), at("@1.9", "@2.0").replace("left", "ahead = -0.05\nleft"));
    let kind = made(&text).unwrap();
    let [ann, bob] = [0, 1].map(|r| &kind.fragments[r]);
    assert!(bob.motion.len().abs_diff(ann.motion.len()) >= 2, "{} and {}", bob.motion.len(), ann.motion.len());
    assert_stands(&kind, 0, 1, ann.begin + 6, [0.0, 1.0, 0.0]);
    let (first, last) = kind.core.unwrap();
    assert_stands(&kind, 0, 1, first, [0.0, 1.0, 0.0]);
    assert_stands(&kind, 0, 1, last, [-0.05, 1.0, 0.0]);
    assert!((51..=54).contains(&(last - first)), "{first} to {last}");
}

#[test]
fn starts_are_kept() {
    let text = WALK
        .replace("[[roles]]\nname = \"bob\"\n", "start = { x = 1.0, z = 2.0, heading_deg = 30.0 }\n[[roles]]\nname = \"bob\"\nstart = { x = 3.0, z = 2.0, heading_deg = -90.0, time = 0.5 }\n");
    let kind = made(&text).unwrap();
    assert_eq!([kind.fragments[0].begin, kind.fragments[1].begin], [0, 15]);
    let [a, b] = [0, 1].map(|r| kind.fragments[r].motion.path.at(0));
    let between = b.position - a.position;
    assert!(between.distance(Vec2::new(2.0, 0.0)) < 1e-4, "{between}");
    assert!((a.heading.to_degrees() - 30.0).abs() < 0.01 && (b.heading.to_degrees() + 90.0).abs() < 0.01);
}

#[test]
fn a_clip_may_end_elsewhere() {
    let path = |text: &str| made(text).map(|kind| kind.fragments[0].motion.path.clone());
    let reached = |path: &MotionPath| path.at(0).inverse().then(path.at(path.len() - 1));
    let alone = one_walker();
    let free = path(&alone).unwrap();
    let there = reached(&free);
    // Farther, to the left, and turned as well.
    let (at, turn) = (there.position + Vec2::new(0.2, 0.3), there.heading + 0.4);
    let end = format!(", end = {{ ahead = {}, left = {}, turn_deg = {} }}", at.y, at.x, turn.to_degrees());
    let text = alone.replacen("cycle\" }", &format!("cycle\"{end} }}"), 1);
    let led = path(&text).unwrap();
    assert!(reached(&led).position.distance(at) < 1e-4, "{:?}", reached(&led));
    assert!(wrap_angle(reached(&led).heading - turn).abs() < 1e-4);
    // Evenly: no frame turns or moves by more of it than another.
    let per_frame = 0.4 / (free.len() - 1) as f32;
    for i in 1..free.len() {
        let more = (led.headings[i] - led.headings[i - 1]) - (free.headings[i] - free.headings[i - 1]);
        assert!((more - per_frame).abs() < 1e-4, "frame {i}: {more}");
    }
    fails(&text, "ahead = ", "ahead = 1", &["line 4", "clip walk", "of where it leads", "found 1"]);
    fails(&text, "turn_deg = ", "turn_deg = 16", &["line 4", "clip walk", "of where it turns to", "deg"]);
    fails(&text, "ahead = ", "away = ", &["line 4", "away"]);
}

#[test]
fn moving_and_turning_the_sources_changes_nothing() {
    let there = Ground::new(Vec2::new(-3.0, 7.0), 2.0);
    let mut moved = SOURCES.clone();
    for motion in moved.iter_mut().flat_map(|s| &mut s.motions) {
        motion.path.points.iter_mut().for_each(|p| *p = there.apply(*p));
        motion.path.headings.iter_mut().for_each(|h| *h += there.heading);
    }
    for text in [MEET, ROWS, PUSH] {
        let (a, b) = (made(text).unwrap(), compose(text, &moved, &mut Vec::new()).unwrap());
        assert_eq!((a.core, &a.contacts, a.people()), (b.core, &b.contacts, b.people()));
        for (p, q) in a.fragments.iter().zip(&b.fragments) {
            assert_eq!((p.begin, p.motion.len(), &p.motion.plants), (q.begin, q.motion.len(), &q.motion.plants));
            for f in 0..p.motion.len() {
                let (here, there) = (p.motion.path.at(f), q.motion.path.at(f));
                assert!(here.position.distance(there.position) < 1e-4, "frame {f}");
                assert!(wrap_angle(here.heading - there.heading).abs() < 1e-4, "frame {f}");
            }
            let poses = p.motion.rotations.iter().zip(&q.motion.rotations);
            assert!(poses.map(|(a, b)| 1.0 - a.dot(*b).abs()).fold(0.0, f32::max) < 1e-5);
        }
    }
}

/// Breaks a composition that works and expects one message with all of `expected`.
fn fails(text: &str, from: &str, to: &str, expected: &[&str]) {
    assert!(text.contains(from), "the test replaces nothing: {from}");
    let message = made(&text.replacen(from, to, 1)).map(|k| k.name).unwrap_err().to_string();
    assert!(expected.iter().all(|e| message.contains(e)), "expected {expected:?}, found {message}");
}

#[test]
fn what_is_mistyped_is_named_with_its_line() {
    fails(MEET, "labels", "lables", &["line 4", "lables"]);
    fails(MEET, "name = \"meet-and-bow\"", "name = \"\"", &["line 3", "a name"]);
    fails(MEET, "patch = \"stop\"", "patch = \"stopp\"", &["line 7", "stopp", "stop-22"]);
    fails(MEET, "patch = \"stop\"", "patch = \"stop\", person = 1", &["line 7", "either take"]);
    fails(MEET, "role = 1", "role = 2", &["line 9", "below 2", "found 2"]);
    fails(MEET, "take = \"start-stop-90\"", "take = \"start-stop\", person = 3", &["line 10", "below 1"]);
    fails(MEET, "from = 0.5", "from = 1.3", &["line 10", "port", "1.3"]);
    fails(MEET, "from = 0.5, to = 2.1", "from = 2.1, to = 0.5", &["line 10", "an end after its begin"]);
    fails(MEET, "from = 0.5", "from = -1", &["line 10", "-1"]);
    fails(MEET, "\"bow\", \"start\"", "\"bo\", \"start\"", &["line 12", "ann", "'bo'"]);
    fails(MEET, "[\"stop\", \"bow\", \"start\"]", "[]", &["line 12", "ann", "1 to 64 clips"]);
    let often = format!("\"bow\", {}\"start\"", "\"bow\", ".repeat(64));
    fails(MEET, "\"bow\", \"start\"", &often, &["line 12", "ann", "1 to 64 clips", "found 67"]);
    fails(MEET, "\"bow\", \"start\"", "\"start\", \"bow\"", &["line 12", "ann", "'stand'"]);
    fails(MEET, "name = \"bob\"", "name = \"ann\"", &["line 16", "second role 'ann'"]);
    fails(MEET, "name = \"bob\"", "name = \"b.ob\"", &["line 16", "without '.'"]);
}

#[test]
fn moments_that_are_not_there_are_named_with_their_line() {
    fails(MEET, "who = \"bob.bow_back\"", "who = \"rob.bow_back\"", &["line 21", "'rob'"]);
    fails(MEET, "who = \"bob.bow_back\"", "who = \"bob.bow\"", &["line 21", "bob plays", "'bow'"]);
    fails(MEET, "who = \"bob.bow_back\"", "who = \"ann.bow\"", &["line 21", "seen from itself"]);
    fails(MEET, "who = \"bob.bow_back\"", "who = \"bob.bow_back@1\"", &["line 21", "two moments"]);
    fails(MEET, "who = \"bob.bow_back\"", "who = \"bob.bow_back@x\"", &["line 21", "seconds after '@'"]);
    fails(MEET, "ahead = 1.3", "ahead = nan", &["line 21", "NaN"]);
    fails(PUSH, "victim.stumble@0.62", "victim.stumble@9", &["line 21", "2.33 s", "victim.stumble@9"]);
    fails(PUSH, "a = \"bully.left_hand\"", "a = \"bully.nose\"", &["line 26", "left_hand", "bully.nose"]);
    fails(PUSH, "a = \"bully.left_hand\"", "a = \"bully.torso\"", &["line 26", "with a hand"]);
    fails(PUSH, "to = \"bully.push@0.80\"", "to = \"bully.push@0.20\"", &["line 26", "expected a time while"]);
    fails(ROWS, "count = 5", "count = 50", &["line 25", "at most 64", "found 100"]);
    fails(ROWS, "count = 5", "count = 0", &["line 25", "count from 2"]);
    fails(ROWS, "roles = [\"host\", \"guest\"]", "roles = [\"ghost\"]", &["line 25", "ghost"]);
    fails(ROWS, "delay = 0.1", "delay = 30", &["line 25", "delay"]);
}

#[test]
fn what_cannot_hold_is_refused_and_says_by_how_much() {
    let end = MEET.find("# All through").unwrap();
    fails(&MEET[..end], "name = \"bob\"", "name = \"rob\"", &["line 16", "rob", "a start, or a place"]);
    let text = parting(1.5);
    fails(&text, "left", "left", &["line 26", "bob.start@1.4", "limit", "per frame", "s of start"]);
    fails(&parting(30.0), "left", "left", &["line 26", "bob.start@1.4", "too far"]);
    let other = "[[places]]\nwho = \"bob.bow_back\"\nseen_from = \"ann.bow\"\nahead = 1.4\n";
    fails(&format!("{MEET}\n{other}"), "1.4", "1.5", &["line 26", "contradicts"]);
    fails(MEET, "ahead = 1.3", "ahead = 0.3", &["line 16", "ann", "bob", "deep"]);
    fails(PUSH, "ahead = 0.72", "ahead = 1.2", &["line 26", "reach each other", "bully", "victim"]);
}

#[test]
fn a_clip_may_be_seen_in_a_mirror() {
    let alone = one_walker();
    let mut set = PatchSet { groups: vec![], ..sample_set() };
    let kind = |text: &str, set: &mut PatchSet| compose(text, &SOURCES, &mut set.groups).unwrap();
    let (plain, seen) =
        (kind(&alone, &mut set), kind(&alone.replacen("cycle\"", "cycle\", mirror = true", 1), &mut set));
    let twin = mirrored(&plain, &mut set.groups);
    assert_eq!(seen.fragments[0].motion.rotations, twin.fragments[0].motion.rotations);
    assert_eq!(seen.fragments[0].entry_group, twin.fragments[0].entry_group);
    assert_ne!(seen.fragments[0].entry_group, plain.fragments[0].entry_group);
}

#[test]
fn a_clip_may_end_as_it_begins() {
    // From the left foot to the right one: no two poses are less alike.
    let text = one_walker().replacen("walk-1.15-cycle\"", "walk-1.15-half\"", 1);
    let gap = |text: &str| {
        let motion = made(text).unwrap().fragments[0].motion.clone();
        let last = motion.len() - 1;
        let between = |a: usize, b: usize| {
            motion.pose(a).iter().zip(motion.pose(b)).map(|(p, q)| p.angle_between(*q)).fold(0.0, f32::max)
        };
        let steps = (0..last).map(|f| between(f, f + 1)).fold(0.0, f32::max);
        (between(0, last), (motion.heights[0] - motion.heights[last]).abs(), steps)
    };
    let (free, led) = (gap(&text), gap(&text.replacen("half\"", "half\", loop = true", 1)));
    assert!(free.0 > 0.3 && led.0 < 1e-3 && led.1 < 1e-4, "{free:?} {led:?}");
    assert!(led.2 < 1.6 * free.2, "nothing jumps: {free:?} {led:?}");
}

/// Two who bow, and then have got so much farther apart than they would walk by themselves.
fn parting(by: f32) -> String {
    let kind = made(MEET).unwrap();
    let at = seen(&kind, 0, 1, kind.core.unwrap().1 + 42);
    let more = "[[places]]\nwho = \"bob.start@1.4\"\nseen_from = \"ann.start@1.4\"\n";
    let (ahead, left, turn) = (at.position.y + by, at.position.x, at.heading.to_degrees());
    format!("{MEET}\n{more}ahead = {ahead}\nleft = {left}\nturn_deg = {turn}\n")
}

#[test]
fn wider_limits_allow_more() {
    let wide = |text: String| text.replace("labels", "limits = \"published\"\nlabels");
    let holds = |text: String| made(&text).is_ok();
    let steps = (0..30).map(|i| 0.1 * i as f32);
    let (tight, published): (Vec<bool>, Vec<bool>) =
        steps.map(|a| (holds(parting(a)), holds(wide(parting(a))))).unzip();
    assert!(tight[0] && !tight[29] && !published[29], "{tight:?} {published:?}");
    let count = |v: &[bool]| v.iter().filter(|x| **x).count();
    assert!(count(&published) > count(&tight), "{tight:?} {published:?}");
    assert!(tight.iter().zip(&published).all(|(t, p)| p | !t));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn no_edit_of_a_file_panics(
        text in prop::sample::select(vec![MEET, ROWS, PUSH]),
        edits in prop::collection::vec((0.0f32..1.0, prop::sample::select(b"0123456789.-@[]\"= abe\n#".to_vec())), 1..4),
    ) {
        if let Err(error) = made(&edited(text, &edits)) {
            prop_assert!(error.to_string().starts_with("compose file: line "), "{error}");
        }
    }
}

#[test]
fn one_arm_mirrors_the_other() {
    let with = |arms: &str| made(&MEET.replace("bow = { patch = \"bow-stand\", role = 0 }", arms));
    let bow = with("bow = { patch = \"bow-stand\", role = 0, arms = \"left\" }").unwrap();
    let (own, plain) = (&bow.fragments[0].motion, &made(MEET).unwrap().fragments[0].motion);
    let image = |q: Quat| Quat::from_xyzw(q.x, -q.y, -q.z, q.w);
    let frame = plain.len() / 2;
    for left in [joint::LEFT_ARM, joint::LEFT_FORE_ARM, joint::LEFT_HAND] {
        let [pose, before] = [own, plain].map(|m| m.pose(frame));
        assert_eq!(pose[left], before[left], "the left arm is as captured");
        assert!(pose[joint::mirror(left)].angle_between(image(pose[left])) < 1e-3, "joint {left}");
    }
    let wrong = with("bow = { patch = \"bow-stand\", role = 0, arms = \"both\" }").unwrap_err().to_string();
    assert!(wrong.contains("line 8") && wrong.contains("both"), "{wrong}");
}

#[test]
fn compose_files_beside_others_join_the_set() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/compose");
    let mut set = sample_set();
    let before = set.clone();
    add(&mut set, std::slice::from_ref(&folder), &SOURCES, &CutOptions::default()).unwrap();
    assert_eq!(set.kinds.len(), before.kinds.len() + 14, "seven, and their mirror images");
    assert_eq!(set.kinds[..before.kinds.len()], before.kinds);
    let kind = |name: &str| set.kinds.iter().find(|k| k.name == name).unwrap();
    let image = mirrored(kind("push-and-stumble"), &mut set.groups.clone());
    assert_eq!(image.contacts, kind("push-and-stumble-mirror").contacts);
    let again = PatchSet::from_bytes(&set.to_bytes()).unwrap();
    assert_eq!(again, set, "a composed kind comes back from a file as it is");
    let twice = add(&mut set, &[folder], &SOURCES, &CutOptions::default()).unwrap_err().to_string();
    assert!(twice.contains("carry-and-pass") && twice.contains("a new name"), "{twice}");
    let missing = add(&mut set, &["nowhere.compose.toml".into()], &SOURCES, &CutOptions::default()).unwrap_err();
    assert!(missing.to_string().contains("nowhere.compose.toml"), "{missing}");
}

#[test]
fn crowds_are_tiled_with_composed_patches() {
    for (text, people, share) in [(MEET, 14, 0.3), (PUSH, 12, 0.2), (ROWS, 20, 0.02)] {
        let (crowd, name) = crowd_with(text, 10.0, people, 14.0, share);
        assert!(check::summary(&crowd).multi_person_share >= f64::from(share), "{name}");
    }
}
