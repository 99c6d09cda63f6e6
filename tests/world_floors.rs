//! Worlds from the floors of meshes: a house piece by piece against known areas, which storey it is, and meshes as they should not be.

#[allow(dead_code)]
mod glb_file;

use std::time::Instant;

use crowdquilt::check::world::check_world;
use crowdquilt::world::{Area, FloorOptions, Grounds, PatternType, Sign, Template};
use proptest::prelude::*;
use serde_json::{Value, json};

type Corners = [[f32; 3]; 4];

/// A mesh of quads, each with a name for its node and its material.
#[derive(Default)]
struct Level {
    quads: Vec<(Corners, &'static str, &'static str)>,
}

impl Level {
    /// A level rectangle that faces up, from one corner to the other.
    fn plate(self, [x, z]: [f32; 2], [to_x, to_z]: [f32; 2], y: f32) -> Self {
        self.quad([[x, y, z], [x, y, to_z], [to_x, y, to_z], [to_x, y, z]])
    }

    fn quad(mut self, corners: Corners) -> Self {
        self.quads.push((corners, "", ""));
        self
    }

    /// A closed box.
    fn solid(self, a: [f32; 3], b: [f32; 3]) -> Self {
        let p = |i: [usize; 3]| [[a, b][i[0]][0], [a, b][i[1]][1], [a, b][i[2]][2]];
        let faces = [
            [[0, 1, 0], [0, 1, 1], [1, 1, 1], [1, 1, 0]],
            [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]],
            [[0, 0, 0], [0, 0, 1], [0, 1, 1], [0, 1, 0]],
            [[1, 0, 0], [1, 1, 0], [1, 1, 1], [1, 0, 1]],
            [[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]],
            [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
        ];
        faces.into_iter().fold(self, |level, face| level.quad(face.map(p)))
    }

    /// Names the node and material of what was added last.
    fn named(mut self, node: &'static str, material: &'static str) -> Self {
        let last = self.quads.last_mut().unwrap();
        (last.1, last.2) = (node, material);
        self
    }

    fn json(&self) -> (Value, Vec<u8>) {
        let bytes: Vec<u8> =
            self.quads.iter().flat_map(|(q, ..)| q.iter().flatten()).flat_map(|v| v.to_le_bytes()).collect();
        let count = self.quads.len();
        let indices: Vec<u8> = [0_u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()).collect();
        let accessor = |i: usize| {
            json!({"bufferView": 0, "byteOffset": 48 * i, "componentType": 5126, "count": 4, "type": "VEC3",
                "min": [0, 0, 0], "max": [0, 0, 0]})
        };
        let mut accessors: Vec<Value> = (0..count).map(accessor).collect();
        accessors.push(json!({"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}));
        let primitive = |i: usize| json!({"attributes": {"POSITION": i}, "indices": count, "material": i});
        let json = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": (0..count).collect::<Vec<_>>()}],
            "nodes": (0..count).map(|i| json!({"mesh": i, "name": self.quads[i].1})).collect::<Vec<_>>(),
            "meshes": (0..count).map(|i| json!({"primitives": [primitive(i)]})).collect::<Vec<_>>(),
            "materials": self.quads.iter().map(|q| json!({"name": q.2})).collect::<Vec<_>>(),
            "accessors": accessors,
            "bufferViews": [{"buffer": 0, "byteLength": bytes.len()},
                {"buffer": 0, "byteOffset": bytes.len(), "byteLength": indices.len()}],
            "buffers": [{"byteLength": bytes.len() + indices.len()}],
        });
        (json, [bytes, indices].concat())
    }

    fn read_with(&self, options: &FloorOptions) -> crowdquilt::Result<Grounds> {
        let (json, binary) = self.json();
        Area::grounds_of_mesh(&glb_file::write(&json, &binary), None, options, &signs())
    }

    fn read(&self) -> Grounds {
        self.read_with(&FloorOptions::default()).unwrap_or_else(|e| panic!("{e}"))
    }

    fn area(&self) -> f64 {
        area(&self.read(), None)
    }
}

fn signs() -> Vec<Sign> {
    ["floor", "lane"].map(|name| Sign { name: name.into(), ..Sign::default() }).to_vec()
}

fn signed(ring: &[[f64; 2]]) -> f64 {
    let pairs = (0..ring.len()).map(|i| (ring[i], ring[(i + 1) % ring.len()]));
    pairs.map(|(a, b)| 0.5 * (a[0] * b[1] - b[0] * a[1])).sum()
}

/// Area of the ground of a template, or of all.
fn area(grounds: &Grounds, template: Option<usize>) -> f64 {
    let own = grounds.found.iter().filter(|g| template.is_none() || g.template == template);
    own.map(|g| signed(&g.rings[0]).abs() - g.rings[1..].iter().map(|r| signed(r).abs()).sum::<f64>()).sum()
}

/// Whether a place is ground.
fn has(grounds: &Grounds, [x, z]: [f64; 2]) -> bool {
    let crosses = |ring: &[[f64; 2]]| {
        let pairs = (0..ring.len()).map(|i| (ring[i], ring[(i + 1) % ring.len()]));
        pairs.filter(|(a, b)| (a[1] > z) != (b[1] > z) && x < a[0] + (z - a[1]) / (b[1] - a[1]) * (b[0] - a[0])).count()
    };
    grounds.found.iter().any(|g| g.rings.iter().map(|ring| crosses(ring)).sum::<usize>() % 2 == 1)
}

fn near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() < within, "{found} m2, not {expected}");
}

fn room() -> Level {
    Level::default().plate([0.0, 0.0], [10.0, 10.0], 0.0)
}

#[test]
fn what_is_too_low_to_walk_under_blocks() {
    near(room().area(), 100.0, 0.2);
    // A table: its plate and 10 cm around it.
    let table = room().solid([3.0, 0.7, 3.0], [5.0, 0.75, 4.0]);
    near(table.area(), 100.0 - 2.2 * 1.2, 0.2);
    assert!(!has(&table.read(), [4.0, 3.5]) && has(&table.read(), [4.0, 4.2]));
    // A balcony high enough, and one that is not.
    near(room().solid([0.0, 2.8, 0.0], [10.0, 3.0, 2.0]).area(), 100.0, 0.2);
    near(room().solid([0.0, 1.5, 0.0], [10.0, 1.7, 2.0]).area(), 100.0 - 21.0, 0.2);
    let tall = FloorOptions { head_m: 2.9, ..FloorOptions::default() };
    near(area(&room().solid([0.0, 2.8, 0.0], [10.0, 3.0, 2.0]).read_with(&tall).unwrap(), None), 79.0, 0.2);
    // A carpet and a threshold are stepped on, a bench is not.
    near(room().solid([3.0, 0.0, 3.0], [5.0, 0.02, 5.0]).area(), 100.0, 0.2);
    near(room().solid([0.0, 0.0, 5.0], [10.0, 0.15, 5.2]).area(), 100.0, 0.2);
    near(room().solid([3.0, 0.0, 3.0], [5.0, 0.45, 4.0]).area(), 100.0 - 2.2 * 1.2, 0.2);
    // A pillar with a foot: what is inside is no floor, though nothing is above it for 3 m.
    near(room().solid([3.0, 0.0, 3.0], [7.0, 3.0, 7.0]).area(), 100.0 - 4.2 * 4.2, 0.2);
}

#[test]
fn walls_part_rooms_and_doors_join_them() {
    // Without thickness, through all of the room: the larger part counts.
    let wall = |from: f32, to: f32| [[6.0, 0.0, from], [6.0, 3.0, from], [6.0, 3.0, to], [6.0, 0.0, to]];
    let parted = room().quad(wall(0.0, 10.0));
    near(parted.area(), 59.0, 0.2);
    assert!(
        parted.read().notes.iter().any(|n| n.contains("39 m2 of the floor cannot be reached")),
        "{:?}",
        parted.read().notes
    );
    let door = room().quad(wall(0.0, 4.0)).quad(wall(6.0, 10.0));
    near(door.area(), 100.0 - 0.2 * 8.2, 0.2);
    assert!(has(&door.read(), [6.0, 5.0]) && !has(&door.read(), [6.0, 3.0]));
    let lintel = room().solid([6.0, 2.1, 0.0], [6.2, 3.0, 10.0]);
    near(lintel.area(), 100.0, 0.2);
}

#[test]
fn slopes_are_floor_up_to_the_limit() {
    let ramp =
        |rise: f32| Level::default().quad([[0.0, 0.0, 0.0], [0.0, 0.0, 10.0], [10.0, rise, 10.0], [10.0, rise, 0.0]]);
    near(ramp(9.9).area(), 100.0, 0.2);
    let steep = ramp(10.1).read_with(&FloorOptions::default()).unwrap_err().to_string();
    assert!(steep.contains("expected triangles that face up by 45 degrees, found none of 2"), "{steep}");
    let gentle = FloorOptions { slope_deg: 20.0, ..FloorOptions::default() };
    assert!(ramp(4.0).read_with(&gentle).is_err());
    assert!(ramp(3.5).read_with(&gentle).is_ok());
}

/// A room with a terrace 80 cm higher beside it, and perhaps a ramp.
fn terrace(ramp: bool) -> Level {
    let level = room().solid([10.0, 0.0, 0.0], [16.0, 0.8, 10.0]);
    if !ramp {
        return level;
    }
    level.quad([[6.0, 0.0, 4.0], [6.0, 0.0, 6.0], [10.0, 0.8, 6.0], [10.0, 0.8, 4.0]])
}

#[test]
fn ramps_lead_to_terraces_and_ledges_part_them() {
    let joined = terrace(true);
    let found = joined.read();
    // Beside the ramp, where it is more than a step high, and along the ledge 10 cm are lost.
    near(area(&found, None), 160.0 - 0.1 * 8.0 - 2.0 * 0.1 * 2.5, 0.3);
    assert!(has(&found, [8.0, 5.0]) && has(&found, [13.0, 1.0]) && has(&found, [9.8, 1.0]));
    assert!(!has(&found, [9.95, 1.0]) && !has(&found, [9.0, 3.95]));
    let apart = terrace(false).read();
    near(area(&apart, None), 99.0, 0.2);
    assert!(apart.notes.iter().any(|n| n.contains("height_m chooses): 60 m2 at 0.8 m")), "{:?}", apart.notes);
    let upper = FloorOptions { height_m: Some(0.9), ..FloorOptions::default() };
    near(area(&terrace(false).read_with(&upper).unwrap(), None), 60.0, 0.2);
}

/// A hall, stairs of 17 steps, and a gallery above one part of the hall.
fn gallery() -> Level {
    let hall = Level::default().plate([0.0, 0.0], [20.0, 10.0], 0.0).solid([9.1, 2.9, 0.0], [16.1, 3.06, 10.0]);
    (0..17).fold(hall, |level, i| {
        let x = 4.0 + 0.3 * i as f32;
        level.solid([x, 0.0, 0.0], [x + 0.3, 0.18 * (i + 1) as f32, 2.0])
    })
}

#[test]
fn stairs_are_climbed_and_the_height_says_which_storey_counts() {
    let hall = gallery().read();
    let total = area(&hall, None);
    assert!((190.0..200.0).contains(&total), "{total}");
    assert!(has(&hall, [5.0, 1.0]), "the first steps");
    assert!(!has(&hall, [8.9, 1.0]), "the last ones have the hall below them");
    assert!(has(&hall, [12.0, 8.0]) && has(&hall, [18.0, 5.0]));
    let upper = gallery().read_with(&FloorOptions { height_m: Some(3.0), ..FloorOptions::default() }).unwrap();
    assert!(has(&upper, [12.0, 8.0]) && has(&upper, [8.9, 1.0]) && has(&upper, [5.0, 1.0]) && has(&upper, [2.0, 5.0]));
    // Behind the gallery the hall is out of reach: the gallery hides what leads there.
    assert!(!has(&upper, [18.0, 5.0]) && !has(&upper, [9.05, 5.0]));
}

#[test]
fn materials_and_nodes_name_templates() {
    let level = Level::default()
        .plate([0.0, 0.0], [10.0, 10.0], 0.0)
        .plate([10.0, 0.0], [20.0, 10.0], 0.0)
        .named("lane.001", "")
        .plate([0.0, 10.0], [10.0, 20.0], 0.0)
        .named("lane", "floor")
        .plate([10.0, 10.0], [20.0, 20.0], 0.0)
        .named("", "blocked");
    let found = level.read();
    near(area(&found, Some(0)), 200.0, 0.3);
    near(area(&found, Some(1)), 100.0, 0.3);
    assert!(!has(&found, [15.0, 15.0]));
}

#[test]
fn nodes_place_meshes_and_mirror_them() {
    let (mut json, binary) = room().json();
    let read = |json: &Value| {
        let bytes = glb_file::write(json, &binary);
        Area::grounds_of_mesh(&bytes, None, &FloorOptions::default(), &signs()).map_err(|e| e.to_string())
    };
    json["nodes"] = json!([{"mesh": 0, "translation": [100, 0, 5], "scale": [-2, 1, 1]}]);
    let found = read(&json).unwrap();
    near(area(&found, None), 200.0, 0.4);
    assert!(has(&found, [81.0, 14.0]) && !has(&found, [101.0, 6.0]));
    json["nodes"] = json!([{"mesh": 0, "scale": [1, -1, 1]}]);
    assert!(read(&json).unwrap_err().contains("face up"), "mirrored up and down");
    json["nodes"] = json!([{"mesh": 0, "rotation": [1, 0, 0, 0]}]);
    assert!(read(&json).unwrap_err().contains("face up"));
    json["materials"][0]["doubleSided"] = json!(true);
    assert!(read(&json).is_ok());
    // Without indices, as a fan.
    json["nodes"] = json!([{"mesh": 0}]);
    json["meshes"][0]["primitives"][0] = json!({"attributes": {"POSITION": 0}, "mode": 6});
    near(area(&read(&json).unwrap(), None), 100.0, 0.2);
}

#[test]
fn what_is_no_floor_is_refused_with_the_place() {
    let (sound, binary) = room().json();
    let changed = |change: &dyn Fn(&mut Value)| {
        let mut json = sound.clone();
        change(&mut json);
        let begin = Instant::now();
        let bytes = glb_file::write(&json, &binary);
        let error = Area::grounds_of_mesh(&bytes, None, &FloorOptions::default(), &signs()).unwrap_err();
        assert!(begin.elapsed().as_secs() < 10);
        error.to_string()
    };
    let expect =
        |error: String, expected: &str| assert!(error.contains(expected), "expected {expected:?} in {error:?}");
    expect(changed(&|j| j["asset"]["version"] = json!("1.0")), "asset: expected version 2");
    expect(changed(&|j| j["scenes"] = json!([])), "expected one of 0 scenes");
    expect(changed(&|j| j["scenes"] = json!([{"nodes": []}])), "meshes: expected triangles in the scene, found none");
    expect(changed(&|j| j["nodes"][0]["mesh"] = json!(7)), "node 0: expected one of 1 meshes, found number 7");
    expect(changed(&|j| j["nodes"][0]["children"] = json!([0])), "node 0: expected one parent");
    expect(changed(&|j| j["accessors"][1]["count"] = json!(60)), "mesh 0 primitive 0, accessor 1");
    expect(
        changed(&|j| j["accessors"][0]["count"] = json!(2)),
        "mesh 0 primitive 0: expected numbers of 2 vertices, found number 2",
    );
    expect(changed(&|j| j["meshes"][0]["primitives"][0]["mode"] = json!(9)), "expected a mode of glTF 2.0");
    expect(changed(&|j| j["meshes"][0]["primitives"][0]["mode"] = json!(1)), "expected triangles in the scene");
    expect(changed(&|j| j["meshes"][0]["primitives"][0]["attributes"] = json!({})), "expected POSITION, found none");
    expect(changed(&|j| j["meshes"][0]["primitives"][0]["material"] = json!(4)), "expected one of 1 materials");
    expect(
        changed(&|j| j["extensionsRequired"] = json!(["KHR_draco_mesh_compression"])),
        "expected plain buffers, found KHR_draco",
    );
    expect(changed(&|j| j["nodes"][0]["scale"] = json!([1e9, 1, 1])), "node 0: expected places within 100000 m");
    expect(
        changed(&|j| j["nodes"][0]["matrix"] = json!([1e38, 0, 0, 0, 0, 1e38, 0, 0, 0, 0, 1e38, 0, 1e38, 0, 0, 1])),
        "within 100000 m",
    );
    expect(
        changed(&|j| j["buffers"][0] = json!({"byteLength": 60, "uri": "other.bin"})),
        "expected all data in the file itself",
    );
    expect(changed(&|j| j["nodes"][0]["scale"] = json!([0, 0, 0])), "expected triangles that face up by 45 degrees");
    let low = room().solid([-1.0, 1.0, -1.0], [11.0, 1.2, 11.0]);
    let under =
        low.read_with(&FloorOptions { height_m: Some(0.0), ..FloorOptions::default() }).unwrap_err().to_string();
    expect(under, "floor: expected room for people of 2 m, found none");
    for (options, expected) in [
        (FloorOptions { slope_deg: 90.0, ..FloorOptions::default() }, "expected slope_deg from 0 to 80, found 90"),
        (FloorOptions { step_m: 0.0, ..FloorOptions::default() }, "expected step_m from 0.01 to 1, found 0"),
        (FloorOptions { head_m: f64::NAN, ..FloorOptions::default() }, "expected head_m from 1 to 10, found NaN"),
    ] {
        expect(room().read_with(&options).unwrap_err().to_string(), expected);
    }
}

#[test]
fn meshes_that_are_too_large_are_refused_at_once() {
    let (mut json, binary) = room().json();
    let begin = Instant::now();
    json["nodes"] = (0..500_001).map(|_| json!({"mesh": 0})).collect();
    json["scenes"] = json!([{"nodes": (0..500_001).collect::<Vec<_>>()}]);
    let read = |json: &Value| {
        let bytes = glb_file::write(json, &binary);
        Area::grounds_of_mesh(&bytes, None, &FloorOptions::default(), &signs()).unwrap_err().to_string()
    };
    assert!(read(&json).contains("expected at most 1000000 triangles, found more"));
    // Fewer, all on each other.
    json["nodes"] = (0..10_000).map(|_| json!({"mesh": 0})).collect();
    json["scenes"] = json!([{"nodes": (0..10_000).collect::<Vec<_>>()}]);
    assert!(read(&json).contains("pairs of triangles above each other, found more"));
    assert!(begin.elapsed().as_secs() < 60, "{:?}", begin.elapsed());
}

#[test]
fn a_large_terrain_is_read_soon() {
    let mut level = Level::default();
    let height = |x: i32, z: i32| ((x * x + 3 * z) % 7) as f32 * 0.1;
    for (x, z) in (0..100).flat_map(|x| (0..100).map(move |z| (x, z))) {
        let p = |dx: i32, dz: i32| [2.0 * (x + dx) as f32, height(x + dx, z + dz), 2.0 * (z + dz) as f32];
        level = level.quad([p(0, 0), p(0, 1), p(1, 1), p(1, 0)]);
    }
    let begin = Instant::now();
    near(level.area(), 40_000.0, 2.0);
    assert!(begin.elapsed().as_secs() < 60, "{:?}", begin.elapsed());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, ..ProptestConfig::default() })]

    #[test]
    fn any_soup_of_quads_is_a_world_or_a_message(
        quads in prop::collection::vec(prop::array::uniform4((-20..20_i32, -2..4_i32, -20..20_i32)), 1..30),
        height in prop::option::of(-2.0..4.0_f64),
    ) {
        let begin = Instant::now();
        let level = quads.iter().fold(Level::default(), |level, quad| {
            level.quad(quad.map(|(x, y, z)| [x as f32, y as f32 * 0.4, z as f32]))
        });
        let options = FloorOptions { height_m: height, ..FloorOptions::default() };
        let built = level.read_with(&options).and_then(|Grounds { found, notes }| {
            let templates = signs().iter().map(|sign| {
                Template::new(&sign.name, "stone").bordered("floor", PatternType::mixed(2, 2))
            }).collect();
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
