//! Worlds from walkable polygons: cells, their check, and polygons as they should not be.

use std::path::Path;
use std::time::Instant;

use crowdquilt::check::world::check_world;
use crowdquilt::world::{Area, Built, Coordinates, Goal, Layout, PatternType, Shard, Site, Spot, Template, WorldScene};
use glam::Vec2;

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
    Ok(Area { templates, grounds, side: 8.0, period: 10.0, goals: Vec::new(), notes: Vec::new(), seed: 1 })
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

/// A square with a lane to the east.
fn square_and_lane() -> Area {
    area(
        r#"{"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [[[0,0],[48,0],[48,48],[0,48],[0,0]]]}},
        {"type": "Feature", "properties": {"template": "lane"}, "geometry": {"type": "Polygon", "coordinates": [[[40,16],[96,16],[96,32],[40,32],[40,16]]]}}]}"#,
    )
    .unwrap()
}

fn goal(from: Spot, to: Spot, rounds: usize) -> Goal {
    Goal { from, to, rounds }
}

#[test]
fn people_go_there_and_back_on_polygons_too() {
    // The middle of the map is the origin: the lane begins at x = 0. Nobody goes to a dead end, as there is no way on.
    let (west, east) = (Vec2::new(-34.0, 8.0), Vec2::new(20.0, 1.0));
    let goals = vec![
        goal(Spot::At(west), Spot::At(east), 2),
        goal(Spot::Template("lane".into()), Spot::Template("place".into()), 1),
    ];
    let area = Area { goals, ..square_and_lane() };
    let built = area.build("goals", &|_, _| true).unwrap();
    let world = &built.world;
    let report = check_world(world);
    assert!(report.ok(), "{report}");
    assert!(!built.notes.iter().any(|note| note.starts_with("goal")), "{:?}", built.notes);
    let (from, to) = (world.patch_at(west.as_dvec2()).unwrap(), world.patch_at(east.as_dvec2()).unwrap());
    let journey = world.journey(from, to, 1000.0).unwrap();
    let speed = f64::from(west.distance(east)) / (journey.arrival - journey.departure);
    assert!((0.3..1.6).contains(&speed), "{speed} m/s");
    // Who goes there comes back: on one cycle without end.
    let back = world.journey(to, from, journey.arrival).unwrap();
    assert!(back.arrival > journey.arrival);
    // Nothing else is changed by goals: cells that no round passes are the same.
    let plain = square_and_lane().build("goals", &|_, _| true).unwrap().world;
    assert_eq!(plain.instances(), world.instances());
    assert!(plain != *world);
    // In pieces, by somebody who knows the scene and which cells failed, it is the same world.
    let scene = WorldScene { name: "goals".into(), layout: Layout::Area(area) };
    let mut site = Site::new(&scene).unwrap();
    while !site.left().is_empty() {
        let worker = Site::after(&scene, site.failures()).unwrap();
        assert_eq!(worker.left(), site.left());
        site.take(Shard::solve(&worker, site.left(), 1, &|_| true).unwrap()).unwrap();
        site.end_round().unwrap();
    }
    assert!(site.bake().unwrap().world == *world);
}

#[test]
fn goals_that_are_nowhere_on_the_ground_are_named() {
    for (from, expected) in [
        (Spot::At(Vec2::new(900.0, 0.0)), "goal 2: expected a place on the ground, found At(Vec2(900.0, 0.0))"),
        (Spot::Template("moon".into()), "goal 2: expected a place on the ground, found Template(\"moon\")"),
    ] {
        let sound = goal(Spot::Template("lane".into()), Spot::Template("place".into()), 1);
        let goals = vec![sound, goal(from, Spot::Template("place".into()), 1)];
        let error = Area { goals, ..square_and_lane() }.build("goals", &|_, _| true).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

/// A scene that reads its ground from a file.
fn scene(area: &str) -> crowdquilt::Result<WorldScene> {
    let text = format!(
        "[area]\n{area}\n[[templates]]\nname = 'square'\nborders.square = {{ type = 'mixed', in = 3, out = 3 }}"
    );
    WorldScene::from_toml(&text, &Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/worlds"))
}

#[test]
fn scenes_say_how_their_files_are_meant() {
    let refused = |area: &str, expected: &str| {
        let error = scene(area).unwrap_err().to_string();
        assert!(error.contains(expected) && error.contains("line 1"), "expected {expected:?} in {error:?}");
    };
    assert!(scene("file = 'plan.svg'\nmetres_per_unit = 0.1").is_ok());
    assert!(scene("file = 'level.glb'\nstep_m = 0.2").is_ok());
    refused("file = 'plan.svg'", "plan.svg: svg: expected metres_per_unit");
    refused("file = 'plan.svg'\ncoordinates = 'metres'", "expected coordinates with GeoJSON only, found SVG");
    refused("file = 'square.geojson'", "expected coordinates = \"metres\" or \"degrees\" for GeoJSON, found none");
    refused(
        "file = 'square.geojson'\ncoordinates = 'feet'",
        "expected coordinates \"metres\" or \"degrees\", found \"feet\"",
    );
    refused("file = 'level.glb'\nmetres_per_unit = 2", "expected metres_per_unit with SVG only, found glTF");
    refused("file = 'plan.svg'\nmetres_per_unit = 0.1\nhead_m = 2", "height_m with glTF only, found SVG");
    refused("file = 'level.glb'\nhead_m = 20", "expected head_m from 1 to 10, found 20");
    refused(
        "file = 'city.png'",
        "expected an area: GeoJSON (.geojson), SVG (.svg), glTF (.gltf, .glb); found none of them (.png)",
    );
    refused("file = 'nowhere.svg'", "nowhere.svg");
}

#[test]
fn the_examples_of_drawings_and_floors_are_populated_and_right() {
    for (name, templates, least) in [("plan", 3, 150), ("level", 3, 100)] {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("examples/worlds/{name}.toml"));
        let built = WorldScene::load(&file).unwrap().build(&|_, _| true).unwrap();
        let report = check_world(&built.world);
        assert!(report.ok(), "{name}: {report}");
        assert!(walkers(&built) > least, "{name}: {} walkers; {:?}", walkers(&built), built.notes);
        let found: std::collections::BTreeSet<usize> =
            (0..built.world.kinds()).map(|k| built.world.kind(k).template()).collect();
        assert_eq!(found.len(), templates, "{name}");
    }
}
