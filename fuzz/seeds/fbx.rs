//! A small FBX file as text and as binary: two people of two joints; one turns, one walks.

/// A property.
enum Value {
    Integer(i64),
    Double(f64),
    Text(String),
    /// An object's name and class, which the two forms join differently.
    Name(String, &'static str),
    Integers(Vec<i64>),
    Floats(Vec<f32>),
    Flags(Vec<i32>),
}

use Value::{Double, Flags, Floats, Integer, Integers, Name, Text};

/// A record with its properties and those below it.
struct Record {
    name: &'static str,
    values: Vec<Value>,
    below: Vec<Record>,
}

fn record(name: &'static str, values: Vec<Value>, below: Vec<Record>) -> Record {
    Record { name, values, below }
}

fn text_value(text: &str) -> Value {
    Text(text.into())
}

fn property(name: &str, kind: &str, values: &[f64]) -> Record {
    let head = [name, kind, "", "A"].map(text_value);
    record("P", head.into_iter().chain(values.iter().map(|&v| Double(v))).collect(), vec![])
}

fn properties(list: Vec<Record>) -> Record {
    record("Properties70", vec![], list)
}

fn object(kind: &'static str, id: i64, name: &str, class: &'static str, sub: &str, below: Vec<Record>) -> Record {
    record(kind, vec![Integer(id), Name(name.into(), class), text_value(sub)], below)
}

fn connect(from: i64, to: i64, property: &str) -> Record {
    let kind = text_value(if property.is_empty() { "OO" } else { "OP" });
    let mut values = vec![kind, Integer(from), Integer(to)];
    values.extend((!property.is_empty()).then(|| text_value(property)));
    record("C", values, vec![])
}

/// The file's records.
fn file() -> Vec<Record> {
    let header = vec![
        record("FBXHeaderVersion", vec![Integer(1003)], vec![]),
        record("FBXVersion", vec![Integer(7400)], vec![]),
    ];
    let settings =
        ["UpAxis", "FrontAxis", "CoordAxis", "UnitScaleFactor", "TimeMode"].into_iter().zip([1.0, 2.0, 0.0, 1.0, 6.0]);
    let settings = settings.map(|(name, value)| property(name, "double", &[value])).collect();
    let (mut objects, mut connections) = (Vec::new(), Vec::new());
    for (i, name) in ["Bob", "Ann"].into_iter().enumerate() {
        let (hips, head) = (10 + i as i64, 20 + i as i64);
        objects.push(model(hips, &format!("{name}:Hips"), [100.0 * i as f64, 100.0, 0.0]));
        objects.push(model(head, &format!("{name}:Head"), [50.0, 0.0, 0.0]));
        connections.extend([connect(hips, 0, ""), connect(head, hips, "")]);
        for joint in [hips, head] {
            let flags = record("TypeFlags", vec![text_value("Skeleton")], vec![]);
            objects.push(object("NodeAttribute", 1000 + joint, "", "NodeAttribute", "LimbNode", vec![flags]));
            connections.push(connect(1000 + joint, joint, ""));
        }
    }
    objects.push(object(
        "AnimationStack",
        100,
        "Walk",
        "AnimStack",
        "",
        vec![properties(vec![property("LocalStop", "KTime", &[4.6e10])])],
    ));
    objects.push(object("AnimationLayer", 101, "Base", "AnimLayer", "", vec![]));
    connections.push(connect(101, 100, ""));
    for (id, name, target, axis) in [(110, "Lcl Rotation", 10, "d|Z"), (120, "Lcl Translation", 11, "d|X")] {
        objects.push(object(
            "AnimationCurveNode",
            id,
            "R",
            "AnimCurveNode",
            "",
            vec![properties(vec![property("d|Y", "Number", &[100.0])])],
        ));
        objects.push(curve(id + 1));
        connections.extend([connect(id, 101, ""), connect(id, target, name), connect(id + 1, id, axis)]);
    }
    vec![
        record("FBXHeaderExtension", vec![], header),
        record("GlobalSettings", vec![], vec![properties(settings)]),
        record("Objects", vec![], objects),
        record("Connections", vec![], connections),
    ]
}

fn model(id: i64, name: &str, place: [f64; 3]) -> Record {
    let turned = property("Lcl Rotation", "Lcl Rotation", &[0.0, 0.0, 90.0]);
    let placed = property("Lcl Translation", "Lcl Translation", &place);
    object("Model", id, name, "Model", "LimbNode", vec![properties(vec![placed, turned])])
}

fn curve(id: i64) -> Record {
    let keys = vec![
        record("KeyTime", vec![Integers(vec![0, 1_539_538_600, 3_079_077_200])], vec![]),
        record("KeyValueFloat", vec![Floats(vec![90.0, 180.0, 120.0])], vec![]),
        record("KeyAttrFlags", vec![Flags(vec![4, 8])], vec![]),
        record("KeyAttrDataFloat", vec![Floats(vec![0.0; 8])], vec![]),
        record("KeyAttrRefCount", vec![Flags(vec![2, 1])], vec![]),
    ];
    object("AnimationCurve", id, "", "AnimCurve", "", keys)
}

/// The text form.
pub fn text() -> String {
    let mut text = String::from("; FBX 7.4.0 project file\n");
    file().iter().for_each(|record| write_text(&mut text, record));
    text
}

fn write_text(text: &mut String, record: &Record) {
    let list = |numbers: Vec<String>| format!("*{} {{\na: {}\n}}", numbers.len(), numbers.join(","));
    let value = |value: &Value| match value {
        Integer(v) => v.to_string(),
        Double(v) => v.to_string(),
        Text(v) => format!("\"{v}\""),
        Name(name, class) => format!("\"{class}::{name}\""),
        Integers(v) => list(v.iter().map(i64::to_string).collect()),
        Floats(v) => list(v.iter().map(f32::to_string).collect()),
        Flags(v) => list(v.iter().map(i32::to_string).collect()),
    };
    let values: Vec<String> = record.values.iter().map(value).collect();
    *text += &format!("{}: {}", record.name, values.join(", "));
    if !record.below.is_empty() || matches!(record.name, "Connections" | "AnimationLayer") {
        *text += " {\n";
        record.below.iter().for_each(|r| write_text(text, r));
        *text += "}";
    }
    *text += "\n";
}

/// The binary form, version 7.4.
pub fn binary() -> Vec<u8> {
    let mut bytes = [b"Kaydara FBX Binary  \0\x1a\0".as_slice(), &7400u32.to_le_bytes()].concat();
    file().iter().for_each(|record| write_binary(&mut bytes, record));
    bytes.extend([0; 13]);
    bytes
}

fn write_binary(bytes: &mut Vec<u8>, record: &Record) {
    let values: Vec<u8> = record.values.iter().flat_map(binary_value).collect();
    let begin = bytes.len();
    bytes.extend([0; 4]);
    bytes.extend((record.values.len() as u32).to_le_bytes());
    bytes.extend((values.len() as u32).to_le_bytes());
    bytes.push(record.name.len() as u8);
    bytes.extend(record.name.as_bytes());
    bytes.extend(values);
    if !record.below.is_empty() {
        record.below.iter().for_each(|r| write_binary(bytes, r));
        bytes.extend([0; 13]);
    }
    let end = bytes.len() as u32;
    bytes[begin..begin + 4].copy_from_slice(&end.to_le_bytes());
}

fn binary_value(value: &Value) -> Vec<u8> {
    let text = |text: &[u8]| [b"S".as_slice(), &(text.len() as u32).to_le_bytes(), text].concat();
    let array = |kind: u8, count: usize, data: Vec<u8>| {
        let words = [count as u32, 0, data.len() as u32];
        [vec![kind], words.iter().flat_map(|w| w.to_le_bytes()).collect(), data].concat()
    };
    match value {
        Integer(v) => [b"L".as_slice(), &v.to_le_bytes()].concat(),
        Double(v) => [b"D".as_slice(), &v.to_le_bytes()].concat(),
        Text(v) => text(v.as_bytes()),
        Name(name, class) => text(&[name.as_bytes(), b"\0\x01", class.as_bytes()].concat()),
        Integers(v) => array(b'l', v.len(), v.iter().flat_map(|x| x.to_le_bytes()).collect()),
        Floats(v) => array(b'f', v.len(), v.iter().flat_map(|x| x.to_le_bytes()).collect()),
        Flags(v) => array(b'i', v.len(), v.iter().flat_map(|x| x.to_le_bytes()).collect()),
    }
}
