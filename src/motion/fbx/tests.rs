//! A text file of two people, written by hand, whose places are worked out by hand.

use glam::{Quat, Vec3};

use super::read;
use crate::motion::Clip;

/// Two people of two joints each, centimetres, y up, 30 frames a second: Bob's hips turn about z from 90 (as at rest)
/// to 180 degrees, Ann's go from x = 1 m to x = 2 m.
fn file() -> String {
    let mut objects = String::new();
    let mut connections = String::new();
    for (i, (name, x, turned)) in [("Bob", 0, 90), ("Ann", 100, 0)].into_iter().enumerate() {
        let (hips, head) = (10 + i, 20 + i);
        objects += &model(hips, &format!("{name}:Hips"), [x, 100, 0], turned);
        objects += &model(head, &format!("{name}:Head"), [50, 0, 0], 0);
        connections += &format!("C: \"OO\",{hips},0\nC: \"OO\",{head},{hips}\n");
        for joint in [hips, head] {
            let limb = 1000 + joint;
            objects +=
                &format!("NodeAttribute: {limb}, \"NodeAttribute::\", \"LimbNode\" {{\nTypeFlags: \"Skeleton\"\n}}\n");
            connections += &format!("C: \"OO\",{limb},{joint}\n");
        }
    }
    objects += "AnimationStack: 100, \"AnimStack::Walk\", \"\" {\nProperties70:  {\n\
        P: \"LocalStop\", \"KTime\", \"Time\", \"\",46186158000\n}\n}\nAnimationLayer: 101, \"AnimLayer::Base\", \"\" {\n}\n";
    objects += &curve(110, "R", [90, 180], 0);
    objects += &curve(120, "T", [100, 200], 100);
    connections += "C: \"OO\",101,100\nC: \"OO\",110,101\nC: \"OO\",120,101\n\
        C: \"OP\",110,10, \"Lcl Rotation\"\nC: \"OP\",111,110, \"d|Z\"\n\
        C: \"OP\",120,11, \"Lcl Translation\"\nC: \"OP\",121,120, \"d|X\"\n";
    format!(
        "; FBX 7.4.0 project file\nFBXHeaderExtension:  {{\nFBXHeaderVersion: 1003\nFBXVersion: 7400\n}}\n\
        GlobalSettings:  {{\nVersion: 1000\nProperties70:  {{\n{}}}\n}}\n\
        Objects:  {{\n{objects}}}\nConnections:  {{\n{connections}}}\n",
        settings([1, 1], [2, 1], [0, 1])
    )
}

fn settings(up: [i32; 2], front: [i32; 2], coord: [i32; 2]) -> String {
    let axes = [("Up", up), ("Front", front), ("Coord", coord)];
    let axes = axes.map(|(name, [axis, sign])| {
        format!("P: \"{name}Axis\", \"int\", \"Integer\", \"\",{axis}\nP: \"{name}AxisSign\", \"int\", \"Integer\", \"\",{sign}\n")
    });
    let rest = "P: \"UnitScaleFactor\", \"double\", \"Number\", \"\",1\nP: \"TimeMode\", \"enum\", \"\", \"\",6\n";
    axes.concat() + rest
}

fn model(id: usize, name: &str, [x, y, z]: [i32; 3], turned: i32) -> String {
    format!(
        "Model: {id}, \"Model::{name}\", \"LimbNode\" {{\nVersion: 232\nProperties70:  {{\n\
        P: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",{x},{y},{z}\n\
        P: \"Lcl Rotation\", \"Lcl Rotation\", \"\", \"A\",0,0,{turned}\n}}\n}}\n"
    )
}

/// A curve node, which says what has no curve, and its curve over one frame.
fn curve(id: usize, name: &str, [from, to]: [i32; 2], y: i32) -> String {
    format!(
        "AnimationCurveNode: {id}, \"AnimCurveNode::{name}\", \"\" {{\nProperties70:  {{\n\
        P: \"d|Y\", \"Number\", \"\", \"A\",{y}\n}}\n}}\n\
        AnimationCurve: {}, \"AnimCurve::\", \"\" {{\nDefault: 0\nKeyVer: 4008\nKeyTime: *2 {{\na: 0,1539538600\n}}\n\
        KeyValueFloat: *2 {{\na: {from},{to}\n}}\nKeyAttrFlags: *1 {{\na: 4\n}}\n\
        KeyAttrDataFloat: *4 {{\na: 0,0,0,0\n}}\nKeyAttrRefCount: *1 {{\na: 2\n}}\n}}\n",
        id + 1
    )
}

fn clips(text: &str) -> Vec<Clip> {
    read(text.as_bytes(), None, None).unwrap().clips
}

fn near(a: Vec3, b: Vec3) {
    assert!((a - b).length() < 1e-5, "{a} instead of {b}");
}

#[test]
fn two_people_on_one_clock_in_metres() {
    let clips = clips(&file());
    assert_eq!(clips.iter().map(|c| c.name.as_str()).collect::<Vec<_>>(), ["Bob", "Ann"]);
    for clip in &clips {
        assert_eq!((clip.frames(), clip.fps), (2, 30.0));
        assert_eq!(clip.skeleton.joints.iter().map(|j| j.name.as_str()).collect::<Vec<_>>(), ["Hips", "Head"]);
    }
    let head = |clip: &Clip| clip.trajectory(1);
    near(head(&clips[0])[0], Vec3::new(0.0, 1.5, 0.0));
    near(head(&clips[0])[1], Vec3::new(-0.5, 1.0, 0.0));
    near(head(&clips[1])[0], Vec3::new(1.5, 1.0, 0.0));
    near(head(&clips[1])[1], Vec3::new(2.5, 1.0, 0.0));
}

#[test]
fn rest_has_no_rotations_whatever_the_file_says() {
    let bob = &clips(&file())[0];
    near(bob.skeleton.joints[1].offset, Vec3::new(0.0, 0.5, 0.0));
    assert!(bob.pose(0).iter().all(|q| q.angle_between(Quat::IDENTITY) < 1e-3));
    assert!(bob.pose(1)[0].angle_between(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2)) < 1e-3);
}

#[test]
fn other_axes_and_units_become_ours() {
    let z_up = file().replace(&settings([1, 1], [2, 1], [0, 1]), &settings([2, 1], [1, -1], [0, 1]));
    // The file's y (where hips stand and heads are) is to the front of a scene with z up, which is our -z.
    let found = clips(&z_up);
    near(found[0].root[0], Vec3::new(0.0, 0.0, -1.0));
    near(found[0].trajectory(1)[0], Vec3::new(0.0, 0.0, -1.5));
    near(found[0].skeleton.joints[1].offset, Vec3::new(0.0, 0.0, -0.5));
    let metres = file().replace(
        "\"UnitScaleFactor\", \"double\", \"Number\", \"\",1",
        "\"UnitScaleFactor\", \"double\", \"Number\", \"\",100",
    );
    near(clips(&metres)[0].trajectory(1)[0], Vec3::new(0.0, 150.0, 0.0));
}

#[test]
fn sampled_as_asked_and_by_name() {
    let text = file();
    let found = read(text.as_bytes(), Some("Walk"), Some(60.0)).unwrap().clips;
    assert_eq!((found[0].frames(), found[0].fps), (3, 60.0));
    near(found[1].root[1], Vec3::new(1.5, 1.0, 0.0));
    let error = read(text.as_bytes(), Some("Run"), None).err().unwrap().to_string();
    assert!(error.contains("import.animation") && error.contains("found 'Walk'"), "{error}");
}

#[test]
fn broken_files_are_refused() {
    let text = file();
    let says = |text: &str, what: &str| {
        let error = read(text.as_bytes(), None, None).err().unwrap().to_string();
        assert!(error.contains(what), "{error}");
    };
    says("", "expected an FBX file");
    says("Kaydara FBX Binary  \0\x1a\0\u{1}", "expected an FBX file");
    says(&text.replace("AnimationCurve:", "Unknown:"), "expected an animation that moves a tree of nodes");
    says(&text.replace("AnimationStack:", "Unknown:"), "expected a take");
    for n in (0..text.len()).step_by(7) {
        let _ = read(&text.as_bytes()[..n], None, None);
    }
}

#[test]
fn few_bytes_cannot_ask_for_many_frames() {
    let long = file().replace("a: 0,1539538600", "a: 0,1539538600,9000000000000000").replace("*2 {", "*3 {");
    let long = long.replace("a: 90,180", "a: 90,180,0").replace("a: 100,200", "a: 100,200,0");
    let long = long.replace("\"\",46186158000", "\"\",9000000000000000").replace("*1 {\na: 2\n", "*1 {\na: 3\n");
    let error = read(long.as_bytes(), None, None).err().unwrap().to_string();
    assert!(error.contains("expected no more poses of joints than"), "{error}");
}
