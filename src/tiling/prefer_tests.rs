use super::*;
use crate::patch::PatchKind;
use std::f32::consts::{FRAC_PI_2, PI};

fn term(form: Form) -> Term {
    Term { form, strength: 1.0, labels: vec![], during: None }
}

fn stay(x: f32, z: f32, heading: f32, secs: f32) -> Stay {
    Stay { position: Vec2::new(x, z), heading, secs }
}

fn kind(name: &str, labels: &[&str]) -> PatchKind {
    PatchKind { name: name.into(), labels: labels.iter().map(|&l| l.to_owned()).collect(), ..PatchKind::default() }
}

fn set() -> PatchSet {
    let kinds = vec![kind("walk", &["walk"]), kind("hug", &["greet", "slow"]), kind("wave", &["greet"])];
    PatchSet { kinds, ..PatchSet::default() }
}

fn value(form: Form, at: Stay) -> f32 {
    term(form).reluctance(at)
}

#[test]
fn f1_attracts_to_points_and_paths_and_keeps_away() {
    let to = |to: &[(f32, f32)]| to.iter().map(|&(x, z)| Vec2::new(x, z)).collect::<Vec<_>>();
    let point = |at: Stay| value(Form::Attract { to: to(&[(1.0, 2.0)]), within: 2.0 }, at);
    assert_eq!((point(stay(1.0, 2.0, 0.0, 0.0)), point(stay(1.0, 6.0, 1.0, 3.0))), (0.0, 4.0));
    let path = |at: Stay| value(Form::Attract { to: to(&[(0.0, 0.0), (4.0, 0.0), (4.0, 4.0)]), within: 1.0 }, at);
    assert_eq!((path(stay(2.0, 1.0, 0.0, 0.0)), path(stay(6.0, 3.0, 0.0, 0.0))), (1.0, 4.0));
    let avoid = |at: Stay| value(Form::Avoid { from: to(&[(0.0, 0.0)]), within: 2.0 }, at);
    assert_eq!((avoid(stay(0.0, 0.0, 0.0, 0.0)), avoid(stay(1.0, 0.0, 0.0, 0.0))), (1.0, 0.25));
    assert_eq!(avoid(stay(2.5, 0.0, 0.0, 0.0)), 0.0);
}

#[test]
fn f2_goes_along_fields() {
    let along = |field: Field, x: f32, z: f32, heading: f32| value(Form::Direction(field), stay(x, z, heading, 0.0));
    // Heading 90 degrees looks along +x.
    assert!(along(Field::Toward(Vec2::new(5.0, 0.0)), 0.0, 0.0, FRAC_PI_2).abs() < 1e-6);
    assert!((along(Field::Away(Vec2::new(5.0, 0.0)), 0.0, 0.0, FRAC_PI_2) - 2.0).abs() < 1e-6);
    assert!((along(Field::Heading(PI), 3.0, 3.0, FRAC_PI_2) - 1.0).abs() < 1e-6);
    let path = vec![Vec2::ZERO, Vec2::new(0.0, 4.0), Vec2::new(4.0, 4.0)];
    assert!(along(Field::Along(path.clone()), 1.0, 1.0, 0.0).abs() < 1e-6);
    assert!(along(Field::Along(path), 3.0, 3.0, FRAC_PI_2).abs() < 1e-6);
    // Clockwise with x right and z up: from the top (+z) to the right (+x).
    assert!(along(Field::Around(Vec2::ZERO, true), 0.0, 2.0, FRAC_PI_2).abs() < 1e-6);
    assert!(along(Field::Around(Vec2::ZERO, false), 0.0, 2.0, -FRAC_PI_2).abs() < 1e-6);
    assert_eq!(along(Field::Toward(Vec2::ZERO), 0.0, 0.0, 1.0), 0.0);
}

#[test]
fn f3_keeps_to_a_schedule_and_f4_to_ratios() {
    let schedule = Form::Schedule { times: vec![[2.0, 4.0], [8.0, 9.0]], fade: 0.5 };
    let at = |secs: f32| value(schedule.clone(), stay(0.0, 0.0, 0.0, secs));
    assert_eq!((at(3.0), at(8.5), at(5.0), at(1.5)), (0.0, 0.0, 4.0, 1.0));
    let ratios = Form::Ratios(vec![("greet".into(), 4.0), ("slow".into(), 0.5)]);
    let ready = Ready::new(&Preference { terms: vec![term(ratios)] }, &set());
    let weights = [0, 1, 2].map(|k| ready.weight_of_kind(k));
    assert!(
        (weights[2] / weights[0] - 4.0).abs() < 1e-5 && (weights[1] / weights[0] - 2.0).abs() < 1e-5,
        "{weights:?}"
    );
    assert!((weights[2] - 1.0).abs() < 1e-6, "the most wanted has F = 1: {weights:?}");
}

#[test]
fn terms_are_of_some_kinds_and_times_only_and_multiply() {
    let attract = Form::Attract { to: vec![Vec2::ZERO], within: 1.0 };
    let terms = vec![
        Term { labels: vec!["greet".into()], strength: 0.5, ..term(attract) },
        Term { during: Some([5.0, 6.0]), ..term(Form::Direction(Field::Heading(0.0))) },
    ];
    let ready = Ready::new(&Preference { terms }, &set());
    let at = |secs: f32| stay(2.0, 0.0, PI, secs);
    let found = [0, 1].map(|k| [ready.reluctance(k, at(0.0)), ready.reluctance(k, at(5.5))]);
    assert_eq!(found, [[0.0, 2.0], [2.0, 4.0]]);
    assert!((ready.weight_of_stay(1, at(5.5)) - (-4.0f32).exp()).abs() < 1e-6);
}

#[test]
fn tables_say_what_functions_said() {
    let (columns, nodes) = Grid::nodes(Vec2::ZERO, Vec2::splat(4.0), 1.0);
    let grid = |k: f32| {
        let values = nodes.iter().map(|p| k * (p.x + p.y)).collect();
        Grid { origin: Vec2::ZERO, cell: 1.0, columns, values }
    };
    assert!((value(Form::Places(grid(1.0)), stay(1.5, 2.25, 0.0, 0.0)) - 3.75).abs() < 1e-5);
    let headings = Form::Headings((0..4).map(|k| grid(k as f32)).collect());
    for (heading, k) in [(0.1, 0.0), (FRAC_PI_2, 1.0), (PI, 2.0), (-FRAC_PI_2, 3.0), (-0.1, 0.0)] {
        assert!((value(headings.clone(), stay(1.0, 1.0, heading, 0.0)) - 2.0 * k).abs() < 1e-5, "{heading}");
    }
    let times = Form::Times { step: 2.0, values: vec![0.0, 1.0, 5.0] };
    assert_eq!([-1.0, 1.0, 3.0, 9.0].map(|t| value(times.clone(), stay(0.0, 0.0, 0.0, t))), [0.0, 0.5, 3.0, 5.0]);
    let kinds = Preference { terms: vec![term(Form::Kinds(vec![("hug".into(), 2.0)]))] };
    let ready = Ready::new(&kinds, &set());
    assert_eq!([0, 1].map(|k| ready.reluctance(k, stay(0.0, 0.0, 0.0, 0.0))), [0.0, 2.0]);
}
