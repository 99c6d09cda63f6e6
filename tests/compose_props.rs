//! Boxes in patches composed by hand out of the generated samples: carried, passed, put down and taken up, sat on.

mod composing;

use composing::{crowd_with, edited, made};
use crowdquilt::geom::Cuboid;
use crowdquilt::motion::body_capsules;
use crowdquilt::motion::contacts::palm;
use crowdquilt::motion::joint::{LEFT_HAND, RIGHT_HAND};
use crowdquilt::patch::{PatchKind, PatchProp};
use glam::{Quat, Vec3};
use proptest::prelude::*;

const CARRY: &str = include_str!("../examples/compose/carry-and-pass.compose.toml");
const REST: &str = include_str!("../examples/compose/put-and-take.compose.toml");
const SIT: &str = include_str!("../examples/compose/sit-on-box.compose.toml");

fn joints(kind: &PatchKind, role: usize, clock: u32) -> Vec<(Vec3, Quat)> {
    let (fragment, mut globals) = (&kind.fragments[role], Vec::new());
    fragment.motion.globals((clock - fragment.begin) as usize, &mut globals);
    globals
}

/// Where a role's palms have a box.
fn between_palms(kind: &PatchKind, prop: &PatchProp, role: usize, clock: u32) -> Vec3 {
    let globals = joints(kind, role, clock);
    prop.between(palm(&globals, LEFT_HAND), palm(&globals, RIGHT_HAND)).middle
}

#[test]
fn a_box_is_carried_to_somebody_and_passed() {
    let kind = made(CARRY).unwrap();
    let [prop] = &kind.props[..] else { panic!("one box, found {:?}", kind.props) };
    let [giver, taker] = prop.holds[..] else { panic!("two who hold it, found {:?}", prop.holds) };
    assert_eq!((giver.role, taker.role), (0, 1));
    assert!(prop.before.is_some() && prop.after.is_some(), "taken up, and put down");
    // Both have it where both have it, all the time that they share.
    assert!((8..30).contains(&(giver.end - taker.begin)), "{:?}", prop.holds);
    for clock in taker.begin..=giver.end {
        let [a, b] = [0, 1].map(|role| between_palms(&kind, prop, role, clock));
        assert!(a.distance(b) < 0.04, "frame {clock}: {} m between", a.distance(b));
    }
    // It was carried some way.
    let at = |clock: u32| prop.place(&kind, clock).unwrap().middle;
    assert!(at(giver.begin).distance(at(giver.end)) > 1.2);
    assert!(at(giver.begin).y < 0.2 && at(taker.end).y < 0.2 && at(giver.end).y > 0.9);
}

#[test]
fn a_box_rests_where_it_was_put_until_another_takes_it_up() {
    for (rest, frames) in [("2.0", 60), ("1.5", 45)] {
        let kind = made(&REST.replace("rest = 2.0", &format!("rest = {rest}"))).unwrap();
        let prop = &kind.props[0];
        let [ann, bob] = prop.holds[..] else { panic!("two who hold it, found {:?}", prop.holds) };
        assert_eq!(bob.begin - ann.end, frames);
        let put = between_palms(&kind, prop, 0, ann.end).with_y(0.13);
        let taken = between_palms(&kind, prop, 1, bob.begin).with_y(0.13);
        assert!(put.distance(taken) < 0.002, "{put} {taken}");
        for clock in ann.end + 1..bob.begin {
            assert!(prop.place(&kind, clock).unwrap().middle.distance(put) < 1e-3, "frame {clock}");
        }
        // Bob is on the other side of it.
        let stand = |role: usize, clock: u32| {
            kind.fragments[role].motion.path.at((clock - kind.fragments[role].begin) as usize)
        };
        let turn = stand(0, ann.end).heading - stand(1, bob.begin).heading;
        assert!(turn.cos() < -0.99, "{turn}");
    }
}

#[test]
fn somebody_sits_on_a_box() {
    let kind = made(SIT).unwrap();
    let prop = &kind.props[0];
    assert!(prop.holds.is_empty() && prop.before == prop.after);
    let seat = prop.sat[0];
    assert!(seat.role == 0 && seat.end - seat.begin > 60, "{seat:?}");
    let cuboid = Cuboid::new(prop.before.unwrap(), prop.size);
    for clock in seat.begin..=seat.end {
        let hips = joints(&kind, 0, clock)[0].0;
        let at = cuboid.at.seen_from(hips);
        assert!((at.y - 0.13 - cuboid.half.y).abs() < 0.01 && at.x.abs() < 0.05 && at.z.abs() < 0.1, "{at}");
    }
    for (role, fragment) in kind.fragments.iter().enumerate() {
        for clock in fragment.begin..fragment.begin + fragment.motion.len() as u32 {
            let mut capsules = Vec::new();
            body_capsules(&joints(&kind, role, clock), &mut capsules);
            let deep = capsules.iter().map(|c| cuboid.penetration(c)).fold(0.0, f32::max);
            assert!(deep < 0.015, "role {role} at {clock}: {deep} m deep in the crate");
        }
    }
}

#[test]
fn a_row_of_sitters_has_a_crate_each() {
    let text =
        SIT.replace("# The crate", "[row]\nroles = [\"sitter\", \"guest\"]\ncount = 3\nspacing = 1.6\n# The crate");
    let kind = made(&text).unwrap();
    assert_eq!((kind.people(), kind.props.len()), (6, 3));
    let names: Vec<&str> = kind.props.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["crate", "crate-2", "crate-3"]);
    let [a, b] = [0, 1].map(|i| kind.props[i].before.unwrap().middle);
    assert!((a.distance(b) - 1.6).abs() < 0.02, "{a} {b}");
    assert_eq!(kind.props.iter().map(|p| p.sat[0].role).collect::<Vec<_>>(), [0, 2, 4]);
}

/// Breaks a composition that works and expects one message with all of `expected`.
fn fails(text: &str, from: &str, to: &str, expected: &[&str]) {
    assert!(text.contains(from), "the test replaces nothing: {from}");
    let message = made(&text.replacen(from, to, 1)).map(|k| k.name).unwrap_err().to_string();
    assert!(expected.iter().all(|e| message.contains(e)), "expected {expected:?}, found {message}");
}

#[test]
fn boxes_that_cannot_be_are_refused_with_their_line() {
    let (props, _) = CARRY.split_once("[[props]]").unwrap();
    fails(CARRY, &CARRY[props.len()..], "", &["line 16", "[[props]]", "giver", "in the hands"]);
    fails(CARRY, "held = [\"giver\", \"taker\"]", "held = [\"giver\"]", &["line 20", "taker", "found none"]);
    fails(CARRY, "held = [\"giver\", \"taker\"]", "", &["line 25", "found nobody"]);
    fails(
        CARRY,
        "held = [\"giver\", \"taker\"]",
        "held = [\"taker\", \"giver\"]",
        &["line 25", "taker to take it up on the ground"],
    );
    fails(CARRY, "held = [\"giver\", \"taker\"]", "held = [\"giver\", \"nobody\"]", &["line 25", "'nobody'"]);
    fails(CARRY, "held = [\"giver\", \"taker\"]", "held = [\"giver.start@1\"]", &["line 20", "taker"]);
    fails(REST, "rest = 2.0", "rest = 0.5", &["line 15", "bob", "ann", "deep"]);
    fails(CARRY, "name = \"box\"", "name = \"box\"\nsize = [0.5, 0.3, 0.3]", &["line 25", "0.5", "0.36"]);
    fails(CARRY, "name = \"box\"", "name = \"box\"\nsize = [0.5, 0.3, 0.0]", &["line 25", "extents above 0"]);
    fails(CARRY, "name = \"box\"", "name = \"box\"\nrest = 1e9", &["line 25", "a rest of 0.1 to 60 s"]);
    fails(CARRY, "name = \"box\"", "name = \"box\"\nsat = [\"giver\"]", &["line 25", "found both"]);
    fails(CARRY, "\"stop\", \"give\"", "\"stop\"", &["line 25", "giver to let go of it"]);
    fails(REST, "\"put_down\", \"leave\"", "\"leave\"", &["line 20", "'ann' holds a box", "say from when to when"]);
    fails(SIT, "sat = [\"sitter\"]", "sat = [\"guest\"]", &["line 25", "'guest' sits on a box"]);
    fails(SIT, "ahead = 1.4", "ahead = -0.5\nturn_deg = 0", &["line 15", "guest", "deep"]);
}

#[test]
fn hands_and_hips_far_from_a_box_are_refused() {
    let dated = "held = [{ who = \"ann\", from = \"ann.leave@0.2\", to = \"ann.leave@1.0\" }]\nsize = [1.9, 0.3, 0.3]";
    let text = REST.replace("\"put_down\", \"leave\"", "\"leave\"").replace("[\"wait\", \"take_up\"]", "[\"wait\"]");
    let text = text.replace("[[roles]]\nname = \"bob\"", "[[roles]]\nname = \"bob\"\nstart = { z = 3.0 }");
    let text = text.replace("[[roles]]\nname = \"ann\"", "[[roles]]\nname = \"ann\"\nstart = { z = 0.0 }");
    fails(&text, "held = [\"ann\", \"bob\"]", dated, &["prop box: ann", "expected hands on both faces", "1.90 m wide"]);
    let high = "sat = [{ who = \"sitter\", from = \"sitter.sit@0.2\", to = \"sitter.sit@3.0\" }]";
    fails(SIT, "sat = [\"sitter\"]", high, &["prop crate: sitter", "a seat 0.40 m high", "found one 0."]);
}

#[test]
fn crowds_are_tiled_with_them() {
    for (text, people, share) in [(CARRY, 10, 0.15), (REST, 12, 0.005), (SIT, 10, 0.15)] {
        let (crowd, name) = crowd_with(text, 11.0, people, 20.0, share);
        let composed = crowd.instances.iter().filter(|i| crowd.set.kinds[i.kind as usize].name == name).count();
        assert!(composed >= 1 && !crowd.props.is_empty(), "{name}: {composed} instances");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn no_edit_of_a_file_panics(
        text in prop::sample::select(vec![CARRY, REST, SIT]),
        edits in prop::collection::vec((0.0f32..1.0, prop::sample::select(b"0123456789.-@[]\"= abe\n#".to_vec())), 1..4),
    ) {
        if let Err(error) = made(&edited(text, &edits)) {
            prop_assert!(error.to_string().starts_with("compose file: line "), "{error}");
        }
    }
}
