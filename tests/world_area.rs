//! Worlds from walkable polygons: cells, their check, and polygons as they should not be.

use std::path::Path;
use std::time::Instant;

use crowdquilt::check::world::check_world;
use crowdquilt::world::{Area, Built, Coordinates, PatternType, Template, WorldScene};

fn templates() -> Vec<Template> {
    vec![
        Template::new("place", "stone")
            .bordered("place", PatternType::mixed(3, 3))
            .bordered("lane", PatternType::mixed(2, 2)),
        Template::new("lane", "asphalt").bordered("lane", PatternType::mixed(3, 3)),
    ]
}

fn area(geojson: &str) -> crowdquilt::Result<Area> {
    let templates = templates();
    let grounds = Area::grounds_of_geojson(geojson, Coordinates::Metres, &templates)?;
    Ok(Area { templates, grounds, side: 8.0, period: 10.0, seed: 1 })
}

fn build(geojson: &str) -> crowdquilt::Result<Built> {
    area(geojson)?.build("test", &|_, _| true)
}

fn polygon(rings: &str) -> String {
    format!(r#"{{"type": "Polygon", "coordinates": [{rings}]}}"#)
}

/// A world that keeps the contract, and what was noted.
fn right(geojson: &str) -> Built {
    let built = build(geojson).unwrap_or_else(|e| panic!("{e}"));
    let report = check_world(&built.world);
    assert!(report.ok(), "{report}\n{:?}", built.notes);
    built
}

fn walkers(built: &Built) -> usize {
    built.world.walkers(&built.world.moment(0.0))
}

/// Area that a world's cells cover.
fn covered(built: &Built) -> f32 {
    let world = &built.world;
    let area = |kind: usize| {
        let o = world.kind(kind).outline();
        (1..o.len() - 1).map(|i| 0.5 * (o[i] - o[0]).perp_dot(o[i + 1] - o[0])).sum::<f32>()
    };
    (0..world.instances()).map(|i| area(world.kind_of(i))).sum()
}

#[test]
fn the_example_square_is_populated_and_right() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/worlds/square.toml");
    let scene = WorldScene::load(&file).unwrap();
    let built = scene.build(&|_, _| true).unwrap();
    let report = check_world(&built.world);
    assert!(report.ok(), "{report}");
    assert!(walkers(&built) > 250, "{} walkers", walkers(&built));
    assert!(built.world.instances() > 60);
    let again = scene.build(&|_, _| true).unwrap();
    assert!(again.world == built.world, "the same scene, the same world");
    let templates: std::collections::BTreeSet<usize> =
        (0..built.world.kinds()).map(|k| built.world.kind(k).template()).collect();
    assert_eq!(templates.len(), 3);
}

#[test]
fn cells_cover_the_ground_and_leave_out_holes() {
    let square = "[[0,0],[60,0],[60,60],[0,60],[0,0]]";
    let hole = "[[20,20],[20,40],[40,40],[40,20],[20,20]]";
    let built = right(&polygon(&format!("{square}, {hole}")));
    assert!((covered(&built) - 3_200.0).abs() < 1.0, "{}", covered(&built));
    assert!(walkers(&built) > 100);
    assert!(!built.notes.iter().any(|n| n.contains("repaired")), "{:?}", built.notes);
}

#[test]
fn shapes_of_all_kinds_are_right() {
    let shapes = [
        // A narrow cross, a triangle, a star with sharp points, a corridor that turns, a ring cut open.
        "[[20,0],[28,0],[28,20],[48,20],[48,28],[28,28],[28,48],[20,48],[20,28],[0,28],[0,20],[20,20],[20,0]]",
        "[[0,0],[50,5],[12,44],[0,0]]",
        "[[30,0],[37,20],[60,22],[42,36],[48,60],[30,46],[12,60],[18,36],[0,22],[23,20],[30,0]]",
        "[[0,0],[70,0],[70,70],[63,70],[63,7],[0,7],[0,0]]",
        "[[0,0],[50,0],[50,50],[0,50],[0,27],[8,27],[8,42],[42,42],[42,8],[8,8],[8,23],[0,23],[0,0]]",
    ];
    for shape in shapes {
        let built = right(&polygon(shape));
        assert!(walkers(&built) > 10, "{} walkers in {shape}", walkers(&built));
    }
}

#[test]
fn broken_polygons_are_repaired_and_told() {
    let noted = |geojson: &str, expected: &str| {
        let built = right(geojson);
        assert!(built.notes.iter().any(|n| n.contains(expected)), "expected {expected:?} in {:?}", built.notes);
        built
    };
    let bow_tie = polygon("[[0,0],[40,40],[40,0],[0,40],[0,0]]");
    assert!((covered(&noted(&bow_tie, "polygon 0 was repaired")) - 800.0).abs() < 2.0);
    let clockwise = polygon("[[0,0],[0,40],[40,40],[40,0],[0,0]]");
    assert!((covered(&right(&clockwise)) - 1_600.0).abs() < 1.0);
    let open = polygon("[[0,0],[40,0],[40,40],[0,40]]");
    assert!((covered(&right(&open)) - 1_600.0).abs() < 1.0);
    let doubled = polygon("[[0,0],[0,0],[40,0],[40,0],[40,40],[0,40],[0,40],[0,0]]");
    right(&doubled);
    let spike = polygon("[[0,0],[40,0],[40,20],[90,20],[40,20],[40,40],[0,40],[0,0]]");
    assert!((covered(&noted(&spike, "polygon 0 was repaired")) - 1_600.0).abs() < 2.0);
    let hole_outside = polygon("[[0,0],[40,0],[40,40],[0,40],[0,0]], [[60,60],[70,60],[70,70],[60,70],[60,60]]");
    right(&hole_outside);
    // Two features on each other are one ground.
    let two = r#"{"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [[[0,0],[40,0],[40,30],[0,30],[0,0]]]}},
        {"type": "Feature", "properties": {"template": "lane"}, "geometry": {"type": "Polygon", "coordinates": [[[30,10],[80,10],[80,20],[30,20],[30,10]]]}},
        {"type": "Feature", "properties": null, "geometry": {"type": "Polygon", "coordinates": [[[5,5],[6,6],[7,7],[5,5]]]}},
        {"type": "Feature", "properties": null, "geometry": {"type": "Point", "coordinates": [1, 1]}},
        {"type": "Feature", "properties": null, "geometry": null}]}"#;
    assert!((covered(&noted(two, "polygon 2 has no area")) - 1_600.0).abs() < 2.0);
    let sliver = polygon("[[0,0],[200,0.01],[200,0.02],[0,0.02],[0,0]]");
    let found = build(&sliver).unwrap_err().to_string();
    assert!(found.contains("expected ground to walk on, found none"), "{found}");
}

#[test]
fn what_is_no_map_is_refused_with_the_place() {
    let cases = [
        ("[1, 2".to_string(), "line 1: expected GeoJSON"),
        ("{}".into(), "expected a GeoJSON object with a type"),
        (r#"{"type": "FeatureCollection"}"#.into(), "features: expected a list"),
        (r#"{"type": "FeatureCollection", "features": []}"#.into(), "expected at least one Polygon"),
        (polygon("[[0,0],[1e9,0],[1e9,1e9],[0,1e9]]"), "expected coordinates within 10000000 m, found [1000000000"),
        (polygon("[[0,0],[1e400,0],[1,1]]"), "expected GeoJSON"),
        (polygon("[[0,0],[\"a\",0],[1,1]]"), "expected a position [x, y], found [\"a\",0]"),
        (polygon("[[0],[1],[2]]"), "expected a position"),
        (polygon("7"), "expected lists of coordinates"),
        (polygon(""), "found none"),
        (polygon("[[0,0],[1,1]]"), "found none"),
        (polygon("[[0,0],[90000,0],[90000,90000],[0,90000]]"), "expected a world of at most 20000 m"),
        (
            r#"{"type": "Feature", "properties": {"template": "moon"}, "geometry": null}"#.into(),
            "expected a template of [\"place\", \"lane\"], found \"moon\"",
        ),
    ];
    for (text, expected) in cases {
        let begin = Instant::now();
        let found = build(&text).unwrap_err().to_string();
        assert!(found.contains(expected), "expected {expected:?} in {found:?}");
        assert!(begin.elapsed().as_secs() < 5);
    }
    let degrees = Area::grounds_of_geojson(&polygon("[[0,0],[500,0],[1,1]]"), Coordinates::Degrees, &templates());
    assert!(degrees.unwrap_err().to_string().contains("expected degrees"));
}

#[test]
fn degrees_are_metres_about_the_middle() {
    let text = polygon("[[13.4,52.5],[13.401,52.5],[13.401,52.5005],[13.4,52.5005],[13.4,52.5]]");
    let grounds = Area::grounds_of_geojson(&text, Coordinates::Degrees, &templates()).unwrap();
    let ring = &grounds[0].rings[0];
    let (width, depth) = (ring[1][0] - ring[0][0], ring[0][1] - ring[2][1]);
    assert!((width - 67.7).abs() < 0.2 && (depth - 55.6).abs() < 0.2, "{width} x {depth}");
}

#[test]
fn random_rubbish_neither_hangs_nor_panics() {
    use rand::{RngExt, SeedableRng};
    for seed in 0..60 {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let corners = rng.random_range(3..14);
        let mut number = || rng.random_range(-40.0..40.0_f64);
        let ring = |number: &mut dyn FnMut() -> f64| {
            let points: Vec<String> = (0..corners).map(|_| format!("[{:.1},{:.1}]", number(), number())).collect();
            format!("[{}]", points.join(","))
        };
        let rings = format!("{}, {}", ring(&mut number), ring(&mut number));
        match build(&polygon(&rings)) {
            Ok(built) => {
                let report = check_world(&built.world);
                assert!(report.ok(), "seed {seed}: {report}");
            }
            Err(error) => assert!(error.to_string().contains("expected"), "seed {seed}: {error}"),
        }
    }
}
