//! Boxes carried by people whose captures know of none: arms led onto them.

mod composing;

use composing::{SOURCES, edited, made, sample_set};
use crowdquilt::check::check;
use crowdquilt::geom::{Polygon, Upright};
use crowdquilt::motion::contacts::palm;
use crowdquilt::motion::joint::{LEFT_FORE_ARM, LEFT_HAND, RIGHT_FORE_ARM, RIGHT_HAND};
use crowdquilt::motion::{FPS, limits};
use crowdquilt::patch::compose::compose;
use crowdquilt::patch::{PatchKind, PatchProp, Source};
use crowdquilt::tiling::{Options, Scene, Status, tile};
use glam::{Quat, Vec2, Vec3};
use proptest::prelude::*;

const CARRIED: &str = include_str!("../examples/compose/carry-by-hand.compose.toml");

/// Somebody squats, takes a box up, stands, squats again and puts it down.
const LIFT: &str = r#"
name = "lift"

[clips]
up = { patch = "take-up" }
down = { patch = "put-down" }

[[roles]]
name = "ann"
plays = ["up", "down"]

[[props]]
name = "box"
size = [0.36, 0.26, 0.30]
grip = [-0.03, 0.05]
held = [{ who = "ann", from = "ann.up@1.25", to = "ann.down@1.35", carried = [
    { at = "ann.up@1.25", up = 0.13, ahead = 0.68 },
    { at = "ann.up@1.8", up = 0.5, ahead = 0.66 },
    { at = "ann.up@2.55", up = 1.0, ahead = 0.36 },
    { at = "ann.down@0.15", up = 1.0, ahead = 0.36 },
    { at = "ann.down@0.8", up = 0.6, ahead = 0.65 },
    { at = "ann.down@1.35", up = 0.13, ahead = 0.68 },
] }]
"#;

/// The samples' take-up and put-down as captures that know of no box.
fn without_boxes() -> Vec<Source> {
    let bare = |source: &Source| {
        let mut source = source.clone();
        source.take.props.clear();
        source.take.ports.iter_mut().for_each(|p| p.pose = p.pose.replace("carry_", ""));
        source
    };
    SOURCES.iter().filter(|s| ["take-up", "put-down"].contains(&s.take.name.as_str())).map(bare).collect()
}

fn lifted(text: &str) -> crowdquilt::Result<PatchKind> {
    compose(text, &without_boxes(), &mut Vec::new())
}

fn joints(kind: &PatchKind, clock: u32) -> Vec<(Vec3, Quat)> {
    let mut globals = Vec::new();
    kind.fragments[0].motion.globals(clock as usize, &mut globals);
    globals
}

fn palms(kind: &PatchKind, clock: u32) -> [Vec3; 2] {
    let globals = joints(kind, clock);
    [palm(&globals, LEFT_HAND), palm(&globals, RIGHT_HAND)]
}

/// Palms are on both faces while a box is held, and it goes neither through the floor nor by leaps.
fn expect_held(kind: &PatchKind, prop: &PatchProp) {
    let hold = prop.holds[0];
    let places: Vec<Upright> = (hold.begin..=hold.end).map(|clock| prop.place(kind, clock).unwrap()).collect();
    for (clock, place) in (hold.begin..).zip(&places) {
        for (palm, side) in palms(kind, clock).into_iter().zip([1.0, -1.0]) {
            let on_face = Vec3::new(side * (0.5 * prop.size[0] + 0.012), -prop.grip[0], -prop.grip[1]);
            let off = place.seen_from(palm).distance(on_face);
            assert!(off < 0.015, "frame {clock}: a palm is {off} m off");
        }
        assert!(place.middle.y > 0.5 * prop.size[1] - 0.01, "frame {clock}: {place:?}");
    }
    let jolt = places.windows(3).map(|p| (p[2].middle - 2.0 * p[1].middle + p[0].middle).length() * FPS * FPS);
    let jolt = jolt.fold(0.0, f32::max);
    assert!(jolt < 9.0, "the box is moved by {jolt} m/s^2");
}

/// Elbows and hands never jump, and no joint turns farther than it can.
fn expect_smooth(kind: &PatchKind) {
    let motion = &kind.fragments[0].motion;
    let frames: Vec<Vec<(Vec3, Quat)>> = (0..motion.len() as u32).map(|f| joints(kind, f)).collect();
    for joint in [LEFT_FORE_ARM, RIGHT_FORE_ARM, LEFT_HAND, RIGHT_HAND] {
        for (f, w) in frames.windows(3).enumerate() {
            let jolt = (w[2][joint].0 - 2.0 * w[1][joint].0 + w[0][joint].0).length() * FPS * FPS;
            assert!(jolt < 30.0, "joint {joint}, frame {f}: {jolt} m/s^2");
            let turn = w[1][joint].1.angle_between(w[0][joint].1);
            assert!(turn < 0.35, "joint {joint}, frame {f}: turned by {turn}");
        }
    }
    let excess = limits::measure(motion);
    assert!(excess.worst < 0.09, "{excess:?}");
}

#[test]
fn somebody_carries_a_box_of_which_the_capture_knows_nothing() {
    let kind = made(CARRIED).unwrap();
    let prop = &kind.props[0];
    assert!(prop.before.is_none() && prop.after.is_none(), "brought along, and taken along");
    expect_held(&kind, prop);
    expect_smooth(&kind);
    // As far ahead and as high as told, at the moments told.
    let at = |clock: u32| {
        let path = kind.fragments[0].motion.path.at(clock as usize);
        path.inverse().apply3(prop.place(&kind, clock).unwrap().middle)
    };
    for (clock, up) in [(0, 1.0), (18, 1.08)] {
        assert!(at(clock).distance(Vec3::new(0.0, up, 0.36)) < 0.01, "frame {clock}: {}", at(clock));
    }
    // Legs and trunk move as captured.
    let bare = made(CARRIED.split("[[props]]").next().unwrap()).unwrap();
    let [carried, bare] = [&kind, &bare].map(|k| &k.fragments[0].motion);
    assert_eq!((&carried.path, &carried.heights), (&bare.path, &bare.heights));
    for f in 0..bare.len() {
        assert_eq!(carried.pose(f)[..14], bare.pose(f)[..14], "frame {f}");
    }
}

#[test]
fn ports_with_a_box_in_the_hands_are_those_of_people_who_carry() {
    let mut groups = sample_set().groups;
    let before = groups.len();
    let kind = compose(CARRIED, &SOURCES, &mut groups).unwrap();
    let names = [kind.fragments[0].entry_group, kind.fragments[0].exit_group].map(|g| groups[g as usize].name.clone());
    assert_eq!(names, ["carry_stand", "carry_stand"]);
    assert_eq!(groups.len(), before, "the samples' own");
}

#[test]
fn a_box_is_taken_up_and_put_down() {
    let kind = lifted(LIFT).unwrap();
    let prop = &kind.props[0];
    expect_held(&kind, prop);
    expect_smooth(&kind);
    let rests = [prop.before.unwrap(), prop.after.unwrap()];
    assert!(rests.iter().all(|r| (r.middle.y - 0.13).abs() < 1e-4), "{rests:?}");
    let hold = prop.holds[0];
    assert!(prop.place(&kind, hold.begin + 40).unwrap().middle.y > 0.95);
    // Reaching, hands come from outside: they are never in it.
    for clock in hold.begin - 12..hold.begin {
        for palm in palms(&kind, clock) {
            assert!(rests[0].seen_from(palm).x.abs() > 0.18, "frame {clock}: {palm}");
        }
    }
}

/// Breaks a composition that works and expects one message with all of `expected`.
fn fails(result: impl Fn(&str) -> crowdquilt::Result<PatchKind>, text: &str, from: &str, to: &str, expected: &[&str]) {
    assert!(text.contains(from), "the test replaces nothing: {from}");
    let message = result(&text.replacen(from, to, 1)).map(|k| k.name).unwrap_err().to_string();
    assert!(expected.iter().all(|e| message.contains(e)), "expected {expected:?}, found {message}");
}

#[test]
fn boxes_that_nobody_can_carry_so_are_refused_with_their_line() {
    let fails_carried = |from: &str, to: &str, expected: &[&str]| fails(made, CARRIED, from, to, expected);
    let fails_lift = |from: &str, to: &str, expected: &[&str]| fails(lifted, LIFT, from, to, expected);
    fails_carried(
        "ahead = 0.36 },\n    { at = \"ann.stop",
        "ahead = 0.9 },\n    { at = \"ann.stop",
        &["line 15", "prop box: expected it within reach of ann's hands", "out of reach at 0."],
    );
    fails_carried("ann@0\"", "ann.stop@0.6\"", &["line 15", "expected moments in order", "'ann.start@0.6'"]);
    fails_carried("ann@0\"", "ann\"", &["line 15", "a moment (with @)", "'ann'"]);
    fails_carried("ann@0\"", "ann@90\"", &["line 15", "expected a moment within", "'ann@90'"]);
    fails_carried("up = 1.0", "up = nan", &["line 15", "'ann@0'", "within 3 m", "NaN"]);
    fails_carried("up = 1.0", "up = 1.0, left = 1", &["line 19", "carried (at, up, ahead)"]);
    fails_carried("size = [0.36, 0.26, 0.30]", "", &["line 15", "the box's size"]);
    fails_carried("held =", "sat =", &["line 15", "carried", "sat on"]);
    fails_carried(
        "up = 1.0, ahead = 0.36 },\n    { at = \"ann.start",
        "up = 0.9, ahead = 0.2 },\n    { at = \"ann.start",
        &["line 10", "ann", "deep in box"],
    );
    fails_lift(
        "up = 0.13, ahead = 0.68 },\n    { at = \"ann.up",
        "up = 0.3, ahead = 0.6 },\n    { at = \"ann.up",
        &["ann to take it up on the ground", "above"],
    );
    let known = |text: &str| made(text);
    fails(known, LIFT, "name = \"lift\"", "name = \"known\"", &["line 12", "'ann'", "knows of no box"]);
}

#[test]
fn crowds_are_tiled_with_it() {
    let mut set = sample_set();
    set.kinds.retain(|k| ["carry-pivot", "carry-idle"].iter().any(|name| k.name.starts_with(name)));
    let kind = compose(CARRIED, &SOURCES, &mut set.groups).unwrap();
    set.kinds.push(kind);
    assert!(set.validate().is_empty(), "{:?}", set.validate());
    let region = Polygon::rectangle(Vec2::ZERO, Vec2::splat(10.0));
    let scene = Scene { region, characters: 8, duration_secs: 20.0, interaction: 0.0, ..Scene::demo() };
    let outcome = tile(&scene, &set, &Options { seed: 1, ..Options::default() }, &mut |_| true).unwrap();
    let report = check(&outcome.crowd);
    assert!(report.ok() && outcome.status == Status::Perfect, "{report}");
    assert_eq!(outcome.crowd.props.len(), 8, "a box each");
    let kinds = outcome.crowd.instances.iter().map(|i| outcome.crowd.set.kinds[i.kind as usize].name.as_str());
    assert!(kinds.clone().any(|name| name == "carry-by-hand"), "{:?}", kinds.collect::<Vec<_>>());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn no_edit_of_a_file_panics(
        edits in prop::collection::vec((0.0f32..1.0, prop::sample::select(b"0123456789.-@[]\"= abe\n#".to_vec())), 1..4),
    ) {
        if let Err(error) = made(&edited(CARRIED, &edits)) {
            prop_assert!(error.to_string().starts_with("compose file: line "), "{error}");
        }
    }
}
