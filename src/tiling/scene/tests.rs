use super::*;
use crate::tiling::prefer::{Field, Form};

const VALID: &str =
    "region = [[0, 0], [12, 0], [12, 12], [0, 12]]\nduration_secs = 20.0\ncharacters = 70\ninteraction = 0.3\n";

/// Everything that a scene may hold.
const WHOLE: &str = r#"
region = [[0, 0], [12, 0], [12, 12], [0, 12]]
duration_secs = 20
density = 0.5
interaction = 0.2
limits = "published"
kinds = { only = ["walk", "greet"], without = ["box"] }
obstacles = [[[2, 2], [3, 2], [3, 3]]]
periodic = ["x", "t"]
rivals = ["bump"]

[[obstacle]]
outline = [[-0.5, -0.2], [0.5, -0.2], [0.5, 0.2], [-0.5, 0.2]]
height = 0.25
path = [[0, 1, 6], [10, 11, 6, 90], [20, 1, 6]]

[[prefer]]
what = "attract"
point = [6, 6]
within = 2
[[prefer]]
what = "avoid"
path = [[0, 0], [12, 12]]
within = 1.5
strength = 3
labels = ["greet"]
during = [5, 10]
[[prefer]]
what = "direction"
around = [6, 6]
clockwise = true
[[prefer]]
what = "labels"
ratios = { greet = 2.0, walk = 0.5 }
[[prefer]]
what = "schedule"
times = [[2, 4], [8, 9]]
fade_secs = 0.5

[[source]]
from = [0, 4]
to = [0, 8]
heading_deg = 90
spread_deg = 10
group = "walk_left"
rate = 0.5
from_secs = 2
to_secs = 12
team = "red"
[[sink]]
at = [12, 6]

[[place]]
kind = "bow"
position = [6, 6]
heading_deg = 45
time_secs = 1.5

[[team]]
name = "red"
characters = 15
start = [[0, 0], [4, 0], [4, 12], [0, 12]]
heading_deg = 90
[[team]]
name = "blue"
characters = 15
start = [[8, 0], [12, 0], [12, 12], [8, 12]]
"#;

fn problem(text: &str) -> String {
    Scene::from_toml(text).unwrap_err().to_string()
}

#[test]
fn a_scene_of_few_words_loads() {
    let scene = Scene::from_toml(VALID).unwrap();
    assert_eq!((scene.characters, scene.last_frame()), (70, 600));
    let plain = Scene::new(scene.region.clone(), 20.0, 70);
    assert_eq!(scene, plain);
}

#[test]
fn a_scene_with_everything_loads() {
    let scene = Scene::from_toml(WHOLE).unwrap();
    assert_eq!((scene.characters, scene.limits), (72, Limits::PUBLISHED));
    assert_eq!(scene.obstacles.len(), 2);
    assert!(scene.obstacles[0].is_wall() && !scene.obstacles[1].is_wall());
    let place = scene.obstacles[1].place(5.0);
    assert!(place.position.distance(Vec2::new(6.0, 6.0)) < 1e-5 && (place.heading - 45f32.to_radians()).abs() < 1e-5);
    assert!(!scene.kinds.lets_pass(&["walk".into(), "box".into()]) && scene.kinds.lets_pass(&["greet".into()]));
    let forms: Vec<&Form> = scene.preference.terms.iter().map(|t| &t.form).collect();
    assert!(matches!(forms[0], Form::Attract { to, within } if to.len() == 1 && *within == 2.0));
    assert!(matches!(forms[1], Form::Avoid { from, .. } if from.len() == 2));
    assert_eq!(scene.preference.terms[1].during, Some([5.0, 10.0]));
    assert_eq!((scene.preference.terms[1].strength, scene.preference.terms[0].strength), (3.0, 1.0));
    assert_eq!(forms[2], &Form::Direction(Field::Around(Vec2::splat(6.0), true)));
    assert!(matches!(forms[3], Form::Ratios(r) if r.len() == 2));
    assert!(matches!(forms[4], Form::Schedule { times, fade } if times.len() == 2 && *fade == 0.5));
    let source = &scene.sources[0];
    assert_eq!(source.times, [3.0, 5.0, 7.0, 9.0, 11.0]);
    assert_eq!((source.gate.to, source.team.as_deref()), (Vec2::new(0.0, 8.0), Some("red")));
    assert_eq!(scene.sinks[0].gate.from, scene.sinks[0].gate.to);
    assert_eq!((scene.placed[0].kind.as_str(), scene.placed[0].secs), ("bow", 1.5));
    assert_eq!(scene.teams.iter().map(|t| t.characters).sum::<usize>(), 30);
    assert_eq!(scene.periodic, Periodic { x: true, z: false, t: true });
}

#[test]
fn each_fault_names_its_line() {
    let crossed = VALID.replace("[12, 12], [0, 12]", "[0, 12], [12, 12]");
    assert!(problem(&crossed).contains("line 1") && problem(&crossed).contains("cross"), "{}", problem(&crossed));
    let negative = VALID.replace("20.0", "-1.0");
    assert!(problem(&negative).contains("line 2"), "{}", problem(&negative));
    assert!(problem(&VALID.replace("70", "0")).contains("line 3"));
    assert!(problem(&VALID.replace("0.3", "nan")).contains("line 4"));
    assert!(problem("region = 3").contains("line 1"));
    assert!(problem(&format!("{VALID}colour = 1")).contains("line 5"));
}

/// One fault each: what is written in place of what, and what the message must hold.
#[test]
fn every_block_tells_what_is_wrong_with_it() {
    let cases: [(&str, &str, &str); 22] = [
        ("height = 0.25", "height = -1", "obstacle height: expected a number from 0.01"),
        ("[10, 11, 6, 90]", "[30, 11, 6, 90]", "order of time"),
        ("[10, 11, 6, 90]", "[10, 11]", "way-points"),
        ("outline = ", "outlines = ", "no such key"),
        ("what = \"attract\"", "what = \"atract\"", "\"attract\" or \"avoid\""),
        ("point = [6, 6]", "point = [6, 6]\npath = [[0, 0], [1, 1]]", "either a `point`"),
        ("within = 2", "within = 0", "within"),
        ("around = [6, 6]", "around = [6, 6]\nheading_deg = 3", "one of `toward`"),
        ("clockwise = true", "clockwise = 1", "true or false"),
        ("greet = 2.0", "greet = 0", "kinds.without"),
        ("[[2, 4], [8, 9]]", "[[4, 2]]", "from before to"),
        ("from = [0, 4]\n", "", "either `at` or both"),
        ("rate = 0.5", "rate = 0.5\ntimes = [1]", "no `rate`"),
        ("rate = 0.5\n", "", "people per second"),
        ("team = \"red\"", "team = \"green\"", "\"green\""),
        ("time_secs = 1.5\n", "", "time_secs: expected seconds, found nothing"),
        ("kind = \"bow\"", "kind = 3", "a text in quotes"),
        ("name = \"blue\"", "name = \"red\"", "twice"),
        ("[\"x\", \"t\"]", "[\"y\"]", "found \"y\""),
        ("density = 0.5", "density = 0.5\ncharacters = 4", "found both"),
        ("density = 0.5", "density = \"much\"", "found \"much\""),
        ("limits = \"published\"", "limits = \"loose\"", "found \"loose\""),
    ];
    for (valid, broken, expected) in cases {
        let text = WHOLE.replacen(valid, broken, 1);
        assert_ne!(text, WHOLE, "{valid}");
        let found = problem(&text);
        assert!(found.contains(expected), "{broken}: {found}");
        // The line of the key, or of the block's beginning.
        let at = WHOLE[..WHOLE.find(valid).unwrap()].lines().count();
        let line: usize = found.split("line ").nth(1).unwrap().split(':').next().unwrap().parse().unwrap();
        assert!(line.abs_diff(at) <= 10, "{broken}: line {line}, expected about {at}: {found}");
    }
}

#[test]
fn all_problems_are_told_at_once() {
    let text =
        VALID.replace("20.0", "-1.0").replace("70", "0") + "colour = 3\n[[sink]]\n[[prefer]]\nwhat = \"avoid\"\n";
    let found = problem(&text);
    for line in ["line 2", "line 3", "line 5", "line 6", "line 7"] {
        assert!(found.contains(line), "{line}: {found}");
    }
    assert!(problem("region = [[0, 0\nx = = 2\n").contains("line 2"));
}
