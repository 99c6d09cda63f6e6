//! Cutting a small take of two people on generated BVH files; one fault per test.

use std::path::{Path, PathBuf};

use super::{MakeOptions, PatchSet, cut_folder, make};
use crate::motion::take::TakeFile;
use crate::motion::{BodyPart, Foot, canonical};

/// A folder of its own that goes when dropped.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("crowdquilt-cut-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        std::fs::write(path.join("a.bvh"), walker(0.0)).unwrap();
        std::fs::write(path.join("b.bvh"), walker(1.0)).unwrap();
        Self(path)
    }

    fn write(&self, take: &str) -> PathBuf {
        let path = self.0.join("two.take.json");
        std::fs::write(&path, take).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A BVH file on the canonical skeleton: stiff, gliding along +z at 1 m/s beside the line x = `x`, for 3 s at 60 fps.
fn walker(x: f32) -> String {
    let joints = &canonical().joints;
    let mut text = String::from("HIERARCHY\n");
    let mut open: Vec<usize> = Vec::new();
    for (j, joint) in joints.iter().enumerate() {
        while open.last().copied() != joint.parent {
            open.pop();
            text += "}\n";
        }
        let (word, channels) = match joint.parent {
            None => ("ROOT", "6 Xposition Yposition Zposition Zrotation Yrotation Xrotation"),
            Some(_) => ("JOINT", "3 Zrotation Yrotation Xrotation"),
        };
        let o = joint.offset;
        text += &format!("{word} {} {{ OFFSET {} {} {} CHANNELS {channels}\n", joint.name, o.x, o.y, o.z);
        open.push(j);
    }
    text += &"}\n".repeat(open.len());
    text += "MOTION\nFrames: 181\nFrame Time: 0.0166666667\n";
    for frame in 0..181 {
        text += &format!("{x} 0.935 {} {}\n", frame as f32 / 60.0, "0 ".repeat(3 * joints.len()));
    }
    text
}

const TAKE: &str = r#"{
  "format": "crowdquilt-take", "version": 1, "name": "two",
  "people": [{"file": "a.bvh"}, {"file": "b.bvh", "import": {"metres_per_unit": 1.0}}],
  "plants": [{"person": 0, "foot": "left", "begin": 0.4, "end": 0.8}],
  "contacts": [{"a": {"person": 0, "part": "left_hand"}, "b": {"person": 1, "part": "torso"}, "begin": 1.0, "end": 2.9}],
  "ports": [{"person": 0, "time": 0.5, "pose": "walk_left"}, {"person": 0, "time": 2.51, "pose": "stand"},
            {"person": 1, "time": 0.9, "pose": "walk_right"}, {"person": 1, "time": 2.0, "pose": "stand"}],
  "patches": [
    {"name": "meet", "labels": ["calm"], "core": [1.2, 1.8],
     "roles": [{"person": 0, "begin": 0.5, "end": 2.5}, {"person": 1, "begin": 0.9, "end": 2.0}]},
    {"name": "alone", "labels": ["symmetric"], "roles": [{"person": 0, "begin": 0.5, "end": 2.5}]}]
}"#;

fn error(name: &str, take: &str) -> String {
    let folder = Folder::new(name);
    let path = folder.write(take);
    make(&[&path], &MakeOptions::default()).expect_err("must be refused").to_string()
}

fn refused(name: &str, from: &str, to: &str, says: &[&str]) {
    assert!(TAKE.contains(from));
    let found = error(name, &TAKE.replacen(from, to, 1));
    assert!(found.contains("two.take.json") && says.iter().all(|s| found.contains(s)), "{found}");
}

#[test]
fn cuts_on_one_clock_and_frame() {
    let folder = Folder::new("good");
    folder.write(TAKE);
    let set = PatchSet::from_folder(&folder.0).unwrap();
    let names: Vec<&str> = set.kinds.iter().map(|k| k.name.as_str()).collect();
    assert_eq!(names, ["meet", "alone", "meet-mirror"]);
    let meet = &set.kinds[0];
    assert_eq!(meet.core, Some((21, 39)));
    let [a, b] = &meet.fragments[..] else { panic!("two people") };
    assert_eq!((a.begin, a.motion.len(), b.begin, b.motion.len()), (0, 61, 12, 34));
    let group = |g: u32| set.groups[g as usize].name.as_str();
    assert_eq!((group(a.entry_group), group(b.entry_group), group(a.exit_group)), ("walk_left", "walk_right", "stand"));
    let c = &meet.contacts[0];
    assert_eq!((c.a.role, c.a.part, c.b.part, c.begin, c.end), (0, BodyPart::LeftHand, BodyPart::Torso, 15, 45));
    assert_eq!((a.motion.plants[0].begin, a.motion.plants[0].end), (0, 9));
    let at_18 = |f: &super::Fragment| f.motion.path.points[18 - f.begin as usize];
    assert!((at_18(b) - at_18(a) - glam::Vec2::X).length() < 1e-3);
    let all = meet.fragments.iter().flat_map(|f| &f.motion.path.points);
    assert!((all.clone().sum::<glam::Vec2>() / all.count() as f32).length() < 1e-4);
}

#[test]
fn mirrored_copies_swap_sides() {
    let folder = Folder::new("mirror");
    folder.write(TAKE);
    let set = PatchSet::from_folder(&folder.0).unwrap();
    let (meet, twin) = (&set.kinds[0], &set.kinds[2]);
    assert!(twin.mirrored && twin.core == meet.core);
    let group = |g: u32| set.groups[g as usize].name.as_str();
    assert_eq!(group(twin.fragments[0].entry_group), "walk_right");
    assert_eq!(twin.contacts[0].a.part, BodyPart::RightHand);
    assert_eq!(twin.fragments[0].motion.plants[0].foot, Foot::Right);
    let gap = |k: &super::PatchKind| k.fragments[1].motion.path.points[0].x - k.fragments[0].motion.path.points[12].x;
    assert!((gap(meet) + gap(twin)).abs() < 1e-3 && gap(meet) > 0.9);
}

#[test]
fn captures_may_lie_elsewhere() {
    let folder = Folder::new("elsewhere");
    let takes = folder.0.join("takes");
    std::fs::create_dir_all(&takes).unwrap();
    std::fs::write(takes.join("two.take.json"), TAKE).unwrap();
    assert!(cut_folder(&takes, Some(&folder.0)).is_ok());
    let found = cut_folder(&takes, None).unwrap_err().to_string();
    assert!(found.contains("a.bvh"), "{found}");
    assert!(cut_folder(Path::new("nowhere"), None).unwrap_err().to_string().contains("nowhere"));
    std::fs::remove_file(takes.join("two.take.json")).unwrap();
    assert!(cut_folder(&takes, None).unwrap_err().to_string().contains("found none"));
}

#[test]
fn malformed_json_is_named_by_line() {
    refused("json", "\"version\": 1,", "\"version\": ,", &["line 2"]);
    refused("field", "\"labels\": [\"calm\"]", "\"lables\": []", &["line 9", "lables"]);
    refused("version", "\"version\": 1,", "\"version\": 2,", &["expected 'crowdquilt-take' version 1"]);
}

#[test]
fn a_take_cut_at_any_length_is_refused() {
    for n in (0..TAKE.len()).step_by(7) {
        assert!(TakeFile::parse(&TAKE[..n]).unwrap_err().to_string().contains("line "), "cut at {n}");
    }
}

#[test]
fn a_port_must_be_near() {
    let says = ["patch meet", "person 1", "expected a port at 2 s", "the nearest at 2.1 s"];
    refused("port", "\"time\": 2.0, \"pose\"", "\"time\": 2.1, \"pose\"", &says);
}

#[test]
fn people_and_times_must_exist() {
    refused("person", "{\"person\": 1, \"begin\": 0.9", "{\"person\": 7, \"begin\": 0.9", &["patch meet", "found 7"]);
    refused("twice", "{\"person\": 1, \"begin\": 0.9", "{\"person\": 0, \"begin\": 0.9", &["person 0 twice"]);
    refused("end", "\"begin\": 0.9, \"end\": 2.0", "\"begin\": 0.9, \"end\": 9.0", &["person 1", "capture's 3.000 s"]);
    refused("order", "\"begin\": 0.9, \"end\": 2.0", "\"begin\": 2.9, \"end\": 2.0", &["begin <= end"]);
    refused("core", "[1.2, 1.8]", "[0.2, 1.8]", &["patch meet", "core"]);
}

#[test]
fn names_must_be_unique() {
    refused("name", "\"name\": \"alone\"", "\"name\": \"meet\"", &["patch meet", "of this name before"]);
}

#[test]
fn several_sources_make_one_set() {
    let folders = ["one", "other"].map(Folder::new);
    let other = TAKE.replace("\"two\"", "\"three\"").replace("meet", "part").replace("\"alone\"", "\"single\"");
    let paths = [folders[0].write(TAKE), folders[1].write(&other)];
    let made = make(&paths, &MakeOptions::default()).unwrap();
    let takes: Vec<&str> = made.takes.iter().map(|c| c.take.name.as_str()).collect();
    assert_eq!(takes, ["two", "three"]);
    let names: Vec<&str> = made.set.kinds.iter().map(|k| k.name.as_str()).collect();
    assert_eq!(names, ["meet", "alone", "part", "single", "meet-mirror", "part-mirror"]);
    let found = make(&[&paths[0], &paths[0]], &MakeOptions::default()).unwrap_err().to_string();
    assert!(found.contains("take two") && found.contains("a name of its own"), "{found}");
}

#[test]
fn a_bad_capture_is_named() {
    let folder = Folder::new("capture");
    let path = folder.write(TAKE);
    std::fs::write(folder.0.join("b.bvh"), walker(0.0).replace("left_hand", "thing")).unwrap();
    let found = make(&[&path], &MakeOptions::default()).unwrap_err().to_string();
    assert!(found.contains("capture b: skeleton") && found.contains("left_hand"), "{found}");
}

/// The take with a box that both people hold in turn; as wide as their arms are spread.
fn with_box(held: &str) -> String {
    let prop = format!("\"props\": [{{\"name\": \"box\", \"size\": [1.6, 0.3, 0.3], \"held\": {held}}}], \"patches\"");
    TAKE.replacen("\"patches\"", &prop, 1).replace("\"walk_left\"", "\"carry_walk_left\"")
}

#[test]
fn boxes_are_cut_with_who_holds_them() {
    let folder = Folder::new("box");
    let pass = r#"[{"person": 0, "begin": 0.1, "end": 1.5}, {"person": 1, "begin": 1.5, "end": 1.8}]"#;
    folder.write(&with_box(pass));
    let error = PatchSet::from_folder(&folder.0).unwrap_err().to_string();
    assert!(
        error.contains("patch alone: prop box: person 0 hands it to person 1: expected both in the patch"),
        "{error}"
    );
    let only = with_box(pass);
    let (both, _) = only.split_once(",\n    {\"name\": \"alone\"").unwrap();
    folder.write(&format!("{both}]}}"));
    let set = PatchSet::from_folder(&folder.0).unwrap();
    let prop = &set.kinds[0].props[0];
    // The first brings it, both hold it for 8 frames, the second puts it down.
    let holds: Vec<(u32, u32, u32)> = prop.holds.iter().map(|h| (h.role, h.begin, h.end)).collect();
    assert_eq!(holds, [(0, 0, 34), (1, 26, 39)]);
    assert!(prop.before.is_none() && prop.after.is_some());
    // Its width is along the line between the hands, which point to the sides.
    let after = prop.after.unwrap();
    let person = set.kinds[0].fragments[1].motion.path.points[39 - 12];
    assert!(after.heading.abs() < 1e-3 && after.ground().position.distance(person) < 0.05, "{after:?} {person}");
    assert_eq!((set.kinds[1].carried_in(0), set.kinds[1].carried_out(1)), (Some(0), None));
}

#[test]
fn boxes_must_make_sense() {
    let refused = |name: &str, held: &str, says: &[&str]| {
        let found = error(name, &with_box(held));
        assert!(found.contains("two.take.json") && says.iter().all(|s| found.contains(s)), "{found}");
    };
    let hold =
        |person: usize, begin: f32, end: f32| format!(r#"{{"person": {person}, "begin": {begin}, "end": {end}}}"#);
    let two = |a: String, b: String| format!("[{a}, {b}]");
    refused("box-person", &format!("[{}]", hold(4, 0.1, 0.5)), &["props[0].held[0]", "below 2, found 4"]);
    refused("box-order", &two(hold(0, 1.0, 1.5), hold(1, 0.5, 2.0)), &["props[0].held[1]", "after the hold before"]);
    refused("box-again", &two(hold(0, 0.1, 1.5), hold(0, 1.2, 2.0)), &["props[0].held[1]", "person 0 again"]);
    let rests = two(hold(0, 0.1, 1.2), hold(1, 1.5, 1.8));
    refused(
        "box-rests",
        &rests,
        &["patch meet: prop box", "person 1 to take it up where person 0 put it down", "m away"],
    );
    let late = two(hold(0, 0.1, 0.7), hold(1, 0.6, 1.8));
    refused("box-late", &late, &["patch meet: prop box", "expected both to be in the patch"]);
    let size = |from: &str, to: &str| with_box("[]").replacen(from, to, 1);
    assert!(error("box-size", &size("[1.6, 0.3", "[1.6, -0.3")).contains("props[0].size"));
    assert!(error("box-field", &size("\"size\"", "\"sise\"")).contains("sise"));
}

#[test]
fn a_box_without_hands_on_it_is_refused_or_left_out() {
    let narrow = with_box(r#"[{"person": 0, "begin": 0.1, "end": 2.8}]"#).replace("[1.6, 0.3", "[0.4, 0.3");
    let says = ["prop box", "person 0, 0.10 s to 2.80 s", "expected hands on both faces of a box 0.40 m wide", "m off"];
    let found = error("far-hands", &narrow);
    assert!(says.iter().all(|s| found.contains(s)), "{found}");
    // Of what nobody annotated only the box is left out.
    let folder = Folder::new("far-hands-raw");
    let (raw, _) = narrow.split_once("\"patches\"").unwrap();
    let path = folder.write(&format!("{raw}\"patches\": []}}"));
    let made = make(&[&path], &MakeOptions::default()).unwrap();
    let notes = made.notes(0).join("\n");
    assert!(notes.contains("prop box is left out") && says.iter().all(|s| notes.contains(s)), "{notes}");
    assert!(made.takes[0].take.props.is_empty());
}

#[test]
fn a_sitter_must_be_on_the_box() {
    let sat = |height: f32| {
        let sat = r#""sat": [{"person": 0, "begin": 1.0, "end": 2.0}]"#;
        let prop = format!(r#""props": [{{"name": "crate", "size": [0.5, {height}, 0.5], {sat}}}], "patches""#);
        TAKE.replacen("\"patches\"", &prop, 1)
    };
    let found = error("low-crate", &sat(0.4));
    assert!(found.contains("prop crate: person 0") && found.contains("a seat 0.40 m high"), "{found}");
    let folder = Folder::new("crate");
    let set = PatchSet::from_folder(folder.write(&sat(0.805)).parent().unwrap()).unwrap();
    // It glides along under the stiff sitter's feet; the crate stands where the hips were at first.
    for kind in &set.kinds {
        let prop = kind.props.iter().find(|p| p.name == "crate").unwrap();
        let (seat, rest) = (prop.sat[0], prop.before.unwrap());
        let fragment = &kind.fragments[seat.role as usize];
        let under = fragment.motion.path.points[(seat.begin - fragment.begin) as usize];
        assert!(prop.before == prop.after && rest.ground().position.distance(under) < 1e-4, "{rest:?} {under}");
        assert!((rest.middle.y - 0.4025).abs() < 1e-4, "{rest:?}");
    }
}
