//! Worlds from SVG drawings: every shape against its known area and place, what shapes are of, and drawings as they should not be.

use std::time::Instant;

use crowdquilt::check::world::check_world;
use crowdquilt::world::{Area, Grounds, PatternType, Sign, Template};
use proptest::prelude::*;

fn signs() -> Vec<Sign> {
    let sign = |name: &str, key, colour| Sign { name: name.into(), key, colour };
    vec![sign("square", Some('s'), Some([0xc9, 0xb2, 0x8f])), sign("lane", Some('l'), Some([0x80, 0x80, 0x80]))]
}

fn plain() -> Vec<Sign> {
    vec![Sign { name: "square".into(), key: None, colour: None }]
}

fn svg(content: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\">\n{content}</svg>"
    )
}

fn read(content: &str) -> Grounds {
    Area::grounds_of_svg(&svg(content), Some(1.0), &plain()).unwrap_or_else(|e| panic!("{content}: {e}"))
}

fn signed(ring: &[[f64; 2]]) -> f64 {
    (0..ring.len()).map(|i| (ring[i], ring[(i + 1) % ring.len()])).map(|(a, b)| 0.5 * (a[0] * b[1] - b[0] * a[1])).sum()
}

/// Area of all ground, without holes.
fn area(grounds: &Grounds) -> f64 {
    let of = |rings: &[Vec<[f64; 2]>]| {
        rings.iter().enumerate().map(|(i, ring)| if i == 0 { 1.0 } else { -1.0 } * signed(ring).abs()).sum::<f64>()
    };
    grounds.found.iter().filter(|g| g.template.is_some()).map(|g| of(&g.rings)).sum()
}

/// Least and largest x and z.
fn bounds(grounds: &Grounds) -> [f64; 4] {
    let all = || grounds.found.iter().flat_map(|g| g.rings.iter().flatten());
    let least = |axis: usize| all().map(|p| p[axis]).fold(f64::INFINITY, f64::min);
    let most = |axis: usize| all().map(|p| p[axis]).fold(f64::NEG_INFINITY, f64::max);
    [least(0), least(1), most(0), most(1)]
}

#[test]
fn every_shape_has_its_area_and_place() {
    let pi = std::f64::consts::PI;
    let cases = [
        ("<rect x='5' y='7' width='30' height='20'/>", 600.0, [5.0, 7.0, 35.0, 27.0]),
        ("<rect width='30' height='20' rx='5'/>", 600.0 - 100.0 + pi * 25.0, [0.0, 0.0, 30.0, 20.0]),
        ("<rect width='30' height='20' rx='5' ry='90'/>", 600.0 - 200.0 + pi * 50.0, [0.0, 0.0, 30.0, 20.0]),
        ("<circle cx='-20' cy='20' r='20'/>", pi * 400.0, [-40.0, 0.0, 0.0, 40.0]),
        ("<ellipse cx='30' cy='20' rx='30' ry='20'/>", pi * 600.0, [0.0, 0.0, 60.0, 40.0]),
        ("<polygon points='0,0 40,0 40,30'/>", 600.0, [0.0, 0.0, 40.0, 30.0]),
        ("<polyline points='0 0 40-0 40 30'/>", 600.0, [0.0, 0.0, 40.0, 30.0]),
        ("<path d='M10 10 L50 10 L50 40 L10 40 Z'/>", 1_200.0, [10.0, 10.0, 50.0, 40.0]),
        ("<path d='m10 10 40 0 0 30 -40 0z'/>", 1_200.0, [10.0, 10.0, 50.0, 40.0]),
        ("<path d='M10,10H50V40H10V10'/>", 1_200.0, [10.0, 10.0, 50.0, 40.0]),
        ("<path d='M10,10h40v30h-40z'/>", 1_200.0, [10.0, 10.0, 50.0, 40.0]),
        // A parabola over 60 m, 30 m high: two thirds of the box.
        ("<path d='M0 0 Q30 60 60 0Z'/>", 1_200.0, [0.0, 0.0, 60.0, 30.0]),
        ("<path d='M0 0 q30 60 60 0t60 0z'/>", 2_400.0, [0.0, -30.0, 120.0, 30.0]),
        ("<path d='M0 0 Q30 60 60 0T120 0Z'/>", 2_400.0, [0.0, -30.0, 120.0, 30.0]),
        // A cubic over 60 m whose control points are 40 m above its ends: by integration 3/5 of 60 x 40.
        ("<path d='M0 0 C0 40 60 40 60 0Z'/>", 1_440.0, [0.0, 0.0, 60.0, 30.0]),
        ("<path d='M0 0c0 40 60 40 60 0s60-40 60 0z'/>", 2_880.0, [0.0, -30.0, 120.0, 30.0]),
        // Arcs: half a circle, the large part of one, one that is too small and grows, one that is turned.
        ("<path d='M0 0A20 20 0 0 1 40 0Z'/>", pi * 200.0, [0.0, -20.0, 40.0, 0.0]),
        ("<path d='M0 0a20 20 0 0 0 40 0z'/>", pi * 200.0, [0.0, 0.0, 40.0, 20.0]),
        ("<path d='M20 0A20 20 0 1 1 0 20L20 20Z'/>", pi * 300.0, [0.0, 0.0, 40.0, 40.0]),
        ("<path d='M0 0A1 1 0 0 1 40 0Z'/>", pi * 200.0, [0.0, -20.0, 40.0, 0.0]),
        ("<path d='M0 0A20 10 90 0 1 0 40Z'/>", pi * 100.0, [0.0, 0.0, 10.0, 40.0]),
        // A line where a radius is nothing; flags without spaces.
        ("<path d='M0 0A0 9 0 0 1 40 0L40 30Z'/>", 600.0, [0.0, 0.0, 40.0, 30.0]),
        ("<path d='M0 0a20,20 0 0140 0z'/>", pi * 200.0, [0.0, -20.0, 40.0, 0.0]),
        // Two parts, the second relative to where the first began.
        ("<path d='M0 0h10v10h-10zm20 0h10v10h-10z'/>", 200.0, [0.0, 0.0, 30.0, 10.0]),
        ("<path d='M0 0h10v10h-10zh-10v-10h10z'/>", 200.0, [-10.0, -10.0, 10.0, 10.0]),
    ];
    for (shape, expected, box_of) in cases {
        let found = read(shape);
        let length = 2.0 * (box_of[2] - box_of[0] + box_of[3] - box_of[1]);
        // Within the tolerance of 2 cm all around.
        assert!((area(&found) - expected).abs() < 0.021 * length, "{shape}: {} m2, not {expected}", area(&found));
        let off = bounds(&found).iter().zip(box_of).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 0.021, "{shape}: {:?}, not {box_of:?}", bounds(&found));
        assert!(found.notes.is_empty(), "{shape}: {:?}", found.notes);
    }
}

#[test]
fn fill_rules_decide_what_is_a_hole() {
    let frame = |inner: &str, rule: &str| area(&read(&format!("<path {rule} d='M0 0h40v40h-40z {inner}'/>"))).round();
    let (same, other) = ("M10 10h20v20h-20z", "M10 10v20h20v-20z");
    assert_eq!(frame(same, ""), 1_600.0);
    assert_eq!(frame(other, ""), 1_200.0);
    assert_eq!(frame(same, "fill-rule='evenodd'"), 1_200.0);
    assert_eq!(frame(same, "style='fill-rule: evenodd'"), 1_200.0);
    // A star whose middle is surrounded twice.
    let star = "d='M50 0 L79 90 L2 35 L98 35 L21 90Z'";
    let (full, hollow) = (read(&format!("<path {star}/>")), read(&format!("<path fill-rule='evenodd' {star}/>")));
    assert!(area(&full) > area(&hollow) + 500.0);
    let bow_tie = read("<polygon points='0,0 40,40 40,0 0,40'/>");
    assert_eq!(area(&bow_tie).round(), 800.0);
}

#[test]
fn transforms_of_groups_add_up() {
    let cases = [
        ("translate(5 7)", [5.0, 7.0, 15.0, 27.0]),
        ("scale(2)", [0.0, 0.0, 20.0, 40.0]),
        ("rotate(90)", [-20.0, 0.0, 0.0, 10.0]),
        ("rotate(90 10 10)", [0.0, 0.0, 20.0, 10.0]),
        ("matrix(0 1 1 0 3 4)", [3.0, 4.0, 23.0, 14.0]),
        ("skewX(45)", [0.0, 0.0, 30.0, 20.0]),
        ("translate(100,0) scale(-1 1)", [90.0, 0.0, 100.0, 20.0]),
    ];
    for (transform, expected) in cases {
        let shape = "<rect width='10' height='20'/>";
        for content in [
            format!("<g transform='{transform}'><g>{shape}</g></g>"),
            format!("<rect transform='{transform}' width='10' height='20'/>"),
            format!("<g transform='translate(-9 -9)'><a><g transform='translate(9 9) {transform}'>{shape}</g></a></g>"),
        ] {
            let off = bounds(&read(&content)).iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-9, "{content}: {:?}", bounds(&read(&content)));
        }
    }
}

#[test]
fn scales_are_given_or_physical() {
    let found = |attributes: &str, given: Option<f64>| {
        let text = format!("<svg {attributes}><rect width='100' height='50'/></svg>");
        Area::grounds_of_svg(&text, given, &plain()).map(|grounds| bounds(&grounds)[2])
    };
    let right = |attributes: &str, given: Option<f64>, metres: f64| {
        let found = found(attributes, given).unwrap();
        assert!((found - metres).abs() < 1e-3, "{attributes} {given:?}: {found}");
    };
    right("", Some(0.5), 50.0);
    right("width='9mm' viewBox='0 0 9 9'", Some(0.5), 50.0);
    right("width='8000mm' height='4000mm' viewBox='0 0 80 40'", None, 10.0);
    right("width='1000cm' viewBox='5 5 200 100'", None, 5.0);
    right("width='100in'", None, 100.0 * 0.0254 / 96.0);
    for (attributes, given, expected) in [
        ("", None, "expected metres_per_unit, or a width in mm, cm, in, pt or pc, found none"),
        ("width='100'", None, "found \"100\""),
        ("width='100%'", None, "found \"100%\""),
        ("width='9m' ", None, "found \"9m\""),
        ("width='80cm' viewBox='0 0 0 9'", None, "expected a viewBox"),
        ("width='80cm' height='80cm' viewBox='0 0 80 40'", None, "expected one scale"),
        ("", Some(0.0), "expected metres per unit from"),
        ("", Some(f64::NAN), "expected metres per unit from"),
    ] {
        let error = found(attributes, given).unwrap_err().to_string();
        assert!(error.contains(expected), "{attributes}: {error}");
    }
    // A length within the drawing with a unit of its own.
    let text = svg("<rect width='1in' height='96'/>");
    let inch = Area::grounds_of_svg(&text, Some(0.5), &plain()).unwrap();
    assert!((area(&inch) - 48.0 * 48.0).abs() < 1e-9);
}

#[test]
fn words_and_colours_say_what_shapes_are() {
    let rect = "width='20' height='20'";
    let of = |content: &str| {
        let grounds = Area::grounds_of_svg(&svg(content), Some(1.0), &signs()).unwrap();
        grounds.found.iter().map(|g| g.template).collect::<Vec<_>>()
    };
    assert_eq!(of(&format!("<rect class='wide lane' {rect}/>")), [Some(1)]);
    assert_eq!(of(&format!("<rect id='lane-7' {rect}/>")), [Some(1)]);
    assert_eq!(of(&format!("<rect id='l' {rect}/>")), [Some(1)]);
    assert_eq!(of(&format!("<g inkscape:label='lane'><rect id='rect99' fill='#c9b28f' {rect}/></g>")), [Some(1)]);
    assert_eq!(of(&format!("<g id='lane'><g><rect class='square' {rect}/></g></g>")), [Some(0)]);
    assert_eq!(of(&format!("<rect fill='#808080' {rect}/>")), [Some(1)]);
    assert_eq!(of(&format!("<rect fill='gray' {rect}/>")), [Some(1)]);
    assert_eq!(of(&format!("<g style='fill:rgb(128,128,128)'><rect {rect}/></g>")), [Some(1)]);
    assert_eq!(of(&format!("<rect fill='red' style='fill: #808080 !important' {rect}/>")), [Some(1)]);
    // What is drawn later lies on top and comes first; what is blocked is nobody's.
    let layers = format!("<rect class='square' {rect}/><rect class='lane' {rect}/><circle id='blocked' r='3'/>");
    assert_eq!(of(&layers), [None, Some(1), Some(0)]);
    // Colours that no template has are decoration; if no template has one, all shapes are of the first.
    let content = svg(&format!("<rect class='lane' {rect}/><rect fill='red' {rect}/><rect fill='none' {rect}/>"));
    let grounds = Area::grounds_of_svg(&content, Some(1.0), &signs()).unwrap();
    assert_eq!(grounds.found.len(), 1);
    let notes = grounds.notes.join("; ");
    assert!(notes.contains("1 shapes of colour #ff0000 that name no template, the first at line 2: rect"), "{notes}");
    assert!(notes.contains("1 shapes without fill"), "{notes}");
    assert_eq!(read(&format!("<rect fill='red' {rect}/>")).found[0].template, Some(0));
}

#[test]
fn what_is_not_understood_is_told() {
    let square = "<rect class='square' width='20' height='20'/>";
    let cases = [
        ("<text>hello</text><text>you</text>", "2 text elements, the first at line 2: text"),
        ("<use href='#x'/>", "1 use elements"),
        ("<image id='photo'/>", "1 image elements, the first at line 2: image \"photo\""),
        ("<foreignObject/>", "1 foreignObject elements"),
        ("<svg><rect width='9' height='9'/></svg>", "1 svg elements"),
        ("<style>.a{fill:red}</style>", "1 style elements"),
        ("<g display='none'><rect class='square' width='9' height='9'/></g>", "1 hidden elements"),
        ("<rect class='square' visibility='hidden' width='9' height='9'/>", "1 hidden elements"),
        ("<rect class='square' clip-path='url(#c)' width='9' height='9'/>", "1 clip-path attributes"),
        ("<rect class='square' mask='url(#c)' width='9' height='9'/>", "1 mask attributes"),
        ("<path class='square' fill='none' d='M0 0L50 50L50 0'/>", "1 open lines without fill"),
        ("<path class='square' d='M0 0L50 50'/>", "1 shapes without area"),
    ];
    for (content, expected) in cases {
        let notes = read(&format!("{content}\n{square}")).notes.join("; ");
        assert!(notes.contains(expected), "{content}: {notes:?}");
    }
    let silent = "<defs><rect id='square' width='900' height='9'/></defs><title>x</title><metadata/><line x2='9'/>";
    let found = read(&format!("{silent}{square}"));
    assert!(found.notes.is_empty() && area(&found) == 400.0, "{:?}", found.notes);
    assert_eq!(area(&read("<rect width='0' height='20'/><circle r='0'/><rect width='5' height='5'/>")), 25.0);
}

#[test]
fn what_is_no_drawing_is_refused_with_the_place() {
    let deep = format!("{}{}", "<g>".repeat(300), "</g>".repeat(300));
    let many = format!("<polygon points='{}'/>", "0,0 9,9 ".repeat(10_001));
    let cases = [
        (String::new(), "expected a sound SVG file"),
        ("<svg".into(), "expected a sound SVG file"),
        ("<svg>\n<g></svg>".into(), "line 2: expected a sound SVG file"),
        ("<html/>".into(), "line 1: html: expected an svg element, found \"html\""),
        (svg(""), "expected at least one closed shape to walk on, found none"),
        (svg("<text/>"), "found none; left out: 1 text elements"),
        (svg("<rect class='blocked' width='9' height='9'/>"), "expected at least one closed shape"),
        (svg("<path id='p' d='M0 0 L10 x'/>"), "line 2: path \"p\": d: expected path data"),
        (svg("<path d='L10 10'/>"), "d: expected path data"),
        (svg("<rect width='-4' height='9'/>"), "line 2: rect: width: expected 0 or more, found -4"),
        (svg("<rect width='4' height='9' rx='-1'/>"), "rx: expected 0 or more"),
        (svg("<rect width='10%' height='9'/>"), "width: expected a length in units of the drawing"),
        (svg("<circle r='two'/>"), "r: expected a length"),
        (svg("<polygon points='0,0 9,9 9'/>"), "points: expected pairs of numbers, found 5 numbers"),
        (svg("<polygon points='0,0 9,x'/>"), "points: expected pairs of numbers"),
        (svg("<g transform='turn(9)'/>"), "line 2: g: expected a transform, found \"turn(9)\""),
        (
            svg("<rect width='1e9' height='9'/>"),
            "expected places within 100000 m of the origin, found [1000000000, 0] m",
        ),
        (svg("<rect transform='scale(1e300)' width='9' height='9'/>"), "expected places within"),
        (svg("<circle r='1e308'/>"), "r: expected a length of at most 1e12"),
        (svg("<circle r='1e999'/>"), "r: expected a length"),
        (svg("<ellipse rx='1e11' ry='1e-11'/>"), "expected places within"),
        (svg("<path d='M0 0A1e308 1e308 0 0 1 40 0Z'/>"), "expected at least one closed shape"),
        (svg("<path d='M0 0A1 1 0 0 1 1e308 1e308Z'/>"), "expected places within"),
        (svg(&deep), "expected groups at most 200 deep"),
        (svg(&many), "expected at most 20000 corners in all"),
    ];
    for (text, expected) in cases {
        let begin = Instant::now();
        let found = match Area::grounds_of_svg(&text, Some(1.0), &plain()) {
            Ok(grounds) => panic!("expected {expected:?}, found {} m2 in {text:.200}", area(&grounds)),
            Err(error) => error.to_string(),
        };
        assert!(found.contains(expected), "expected {expected:?} in {found:?}");
        assert!(begin.elapsed().as_secs() < 5);
    }
}

#[test]
fn drawings_made_to_take_for_ever_do_not() {
    let begin = Instant::now();
    let laughs = "<!DOCTYPE svg [<!ENTITY a 'aaaaaaaaaa'>\
        <!ENTITY b '&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;'><!ENTITY c '&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;'>\
        <!ENTITY d '&c;&c;&c;&c;&c;&c;&c;&c;&c;&c;'><!ENTITY e '&d;&d;&d;&d;&d;&d;&d;&d;&d;&d;'>\
        <!ENTITY f '&e;&e;&e;&e;&e;&e;&e;&e;&e;&e;'><!ENTITY g '&f;&f;&f;&f;&f;&f;&f;&f;&f;&f;'>]>\
        <svg><text>&g;</text></svg>";
    assert!(Area::grounds_of_svg(laughs, Some(1.0), &plain()).is_err());
    let lasting = "<!DOCTYPE svg [<!ENTITY a '&b;'><!ENTITY b '&a;'>]><svg><text>&a;</text></svg>";
    assert!(Area::grounds_of_svg(lasting, Some(1.0), &plain()).is_err());
    // Curves that are as long as can be, and groups without end.
    let curves = format!("<path d='M0 0{}'/>", "C9e4 9e4 -9e4 9e4 0 0".repeat(20_000));
    assert!(Area::grounds_of_svg(&svg(&curves), Some(1.0), &plain()).is_err());
    let groups = "<g>".repeat(100_000);
    assert!(Area::grounds_of_svg(&format!("<svg>{groups}"), Some(1.0), &plain()).is_err());
    let whole = format!("<svg>{groups}{}</svg>", "</g>".repeat(100_000));
    assert!(Area::grounds_of_svg(&whole, Some(1.0), &plain()).is_err());
    assert!(begin.elapsed().as_secs() < 20, "{:?}", begin.elapsed());
}

/// A shape of any kind, somewhere, perhaps turned: mostly sound, sometimes not.
fn shape() -> impl Strategy<Value = String> {
    let place = || -30..30_i32;
    let corners = prop::collection::vec((place(), place()), 0..8);
    let class = prop::sample::select(vec!["square", "lane", "blocked"]);
    let outline = prop_oneof![
        (place(), place(), 0..40_u32, 0..40_u32, 0..9_u32)
            .prop_map(|(x, y, w, h, r)| format!("<rect x='{x}' y='{y}' width='{w}' height='{h}' rx='{r}' CLASS/>")),
        (place(), place(), 0..25_u32).prop_map(|(x, y, r)| format!("<circle cx='{x}' cy='{y}' r='{r}' CLASS/>")),
        corners.clone().prop_map(|all| {
            let points: Vec<String> = all.iter().map(|(x, y)| format!("{x},{y}")).collect();
            format!("<polygon points='{}' CLASS/>", points.join(" "))
        }),
        (corners, prop::sample::select(vec!["L", "T", "Q0,0 ", "S9,-9 ", "C9,9 -9,20 ", "A9,5 30 1 0 "])).prop_map(
            |(all, command)| {
                let text: String = all.iter().map(|(x, y)| format!("{command}{x},{y}")).collect();
                format!("<path d='M0,0{text}z' fill-rule='evenodd' CLASS/>")
            }
        ),
    ];
    (outline, class, -180..180_i32).prop_map(|(outline, class, turn)| {
        outline.replace("CLASS", &format!("class='{class}' transform='rotate({turn})'"))
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn any_soup_of_shapes_is_a_world_or_a_message(shapes in prop::collection::vec(shape(), 1..10)) {
        let begin = Instant::now();
        let templates = vec![
            Template::new("square", "stone").bordered("square", PatternType::mixed(2, 2)),
            Template::new("lane", "asphalt").bordered("square", PatternType::mixed(1, 1)),
        ];
        let text = svg(&shapes.concat());
        let built = Area::grounds_of_svg(&text, Some(1.0), &signs()).and_then(|Grounds { found, notes }| {
            let area =
                Area { templates, grounds: found, side: 8.0, period: 10.0, goals: Vec::new(), notes, seed: 1 };
            area.build("soup", &|_, _| true)
        });
        match built {
            Ok(built) => {
                let report = check_world(&built.world);
                prop_assert!(report.ok(), "{}", report);
            }
            Err(error) => prop_assert!(error.to_string().contains("expected"), "{}", error),
        }
        prop_assert!(begin.elapsed().as_secs() < 60);
    }
}
