//! Scene files of worlds: the examples, and what is wrong with broken ones, with lines.

use std::path::Path;

use crowdquilt::world::{Layout, Plan, WorldScene, scenes};

fn examples() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/worlds"))
}

#[test]
fn the_example_scenes_are_the_papers_worlds() {
    let street = WorldScene::load(&examples().join("street.toml")).unwrap();
    assert_eq!((street.name.as_str(), street.layout), ("street", Layout::Map(scenes::street(3).unwrap())));
    let city = WorldScene::load(&examples().join("city.toml")).unwrap();
    let Layout::Map(city) = city.layout else { panic!("a map") };
    // The same world; the scene's borders are said once, from one side.
    let ours = scenes::city(32, false, 1).unwrap();
    let named = |plan: &Plan| -> Vec<Vec<String>> {
        plan.cells.iter().map(|row| row.iter().map(|&t| plan.templates[t].name.clone()).collect()).collect()
    };
    assert_eq!(named(&city), named(&ours));
    assert_eq!(city.templates, ours.templates);
}

const VALID: &str = r#"
period_secs = 10.0
map = """
ss
ss
"""

[[templates]]
name = "street"
key = "s"
objects = [{ name = "lamp", disc = 0.15, number = [0, 1] }]
people = [{ name = "talk", group = [2, 3], density = 0.01 }]
borders.street = { type = "mixed", in = 2, out = 2 }
"#;

fn problem(from: &str, to: &str) -> String {
    assert!(VALID.contains(from), "{from}");
    WorldScene::from_toml(&VALID.replace(from, to), examples()).unwrap_err().to_string()
}

#[test]
fn each_fault_names_its_line() {
    WorldScene::from_toml(VALID, examples()).unwrap();
    let cases = [
        ("10.0", "1.0", "line 2: expected period_secs from 2 to 300, found 1"),
        ("10.0", "nan", "line 2: expected period_secs"),
        ("ss\n\"", "sx\n\"", "line 3: map: row 2, column 2: expected the key of a template, found 'x'"),
        ("period_secs", "colour", "line 2"),
        ("disc = 0.15", "disc = -1.0", "furnishing \"lamp\""),
        ("disc = 0.15, ", "", "line 11: object \"lamp\": expected either disc or box"),
        ("number = [0, 1]", "number = [0, 1], density = 0.1", "line 11: \"lamp\": expected either number or density"),
        ("[2, 3]", "[3, 1000]", "gathering \"talk\""),
        ("borders.street", "borders.moon", "line 13: expected a border to one of the templates, found \"moon\""),
        ("\"mixed\"", "\"maze\"", "line 13: border to \"street\": expected type empty, one-way, mixed"),
        ("\"mixed\"", "\"door\"", "line 13: border to \"street\": expected door = [begin, end]"),
        ("\"mixed\"", "\"one-way\"", "line 13: border to \"street\": expected people in one direction"),
        ("in = 2", "in = 9999", "line 13: border to \"street\": expected at most 200 people"),
        ("in = 2", "in = -2", "line 13"),
        ("out = 2", "out = 2, green = [0.1, 0.2]", "line 13: border to \"street\": expected green only with"),
    ];
    for (from, to, expected) in cases {
        let found = problem(from, to);
        assert!(found.contains(expected), "expected {expected:?} in {found:?}");
    }
}

#[test]
fn all_problems_are_told_at_once() {
    let text = VALID.replace("10.0", "0.0").replace("mixed", "maze").replace("disc = 0.15, ", "");
    let found = WorldScene::from_toml(&text, examples()).unwrap_err().to_string();
    assert!(["line 2", "line 11", "line 13"].iter().all(|line| found.contains(line)), "{found}");
}

#[test]
fn maps_in_pictures_name_file_and_pixel() {
    let city = std::fs::read_to_string(examples().join("city.toml")).unwrap();
    let problem = |text: String| WorldScene::from_toml(&text, examples()).unwrap_err().to_string();
    let found = problem(city.replace("#c9b28f", "#c9b28e"));
    assert!(found.contains("line 8") && found.contains("city.png: pixel 5 of row 5"), "{found}");
    let found = problem(city.replace("#c9b28f", "brown"));
    assert!(found.contains("expected a colour as #rrggbb, found \"brown\""), "{found}");
    let found = problem(city.replace("city.png", "town.png"));
    assert!(found.contains("town.png") && found.contains("No such file"), "{found}");
    let found = problem(city.replace("city.png", "city.toml.png"));
    assert!(found.contains("city.toml.png"), "{found}");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let bytes = std::fs::read(examples().join("city.png")).unwrap();
    for cut in 0..bytes.len() {
        std::fs::write(folder.join("cut.png"), &bytes[..cut]).unwrap();
        let text = city.replace("city.png", "cut.png");
        // The last chunk says only that the picture is over.
        let whole = cut + 12 >= bytes.len();
        assert!(whole || WorldScene::from_toml(&text, folder).is_err(), "cut at {cut}");
    }
}
