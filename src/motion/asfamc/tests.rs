//! A small figure whose numbers are worked out by hand, and one fault per test.

use glam::{Quat, Vec3};

use super::{Figure, Turns, amc, asf};
use crate::motion::Clip;

const ASF: &str = "# hand-written
:version 1.10
:name test
:units
  mass 1.0
  length 0.45
  angle deg
:documentation
   name begin end
:root
   order TX TY TZ RX RY RZ
   axis XYZ
   position 1 0 0
   orientation 0 0 0
:bonedata
  begin
     id 1
     name hip
     direction 0 2 0
     length 3
     axis 0 0 0 XYZ
  end
  begin
     id 2
     name leg
     direction 1 0 0
     length 4
     axis 0 0 90 XYZ
     dof rx rz
     limits (-160.0 20.0)
            (-70.0 70.0)
  end
  begin
     id 3
     name foot
     direction 0 0 1
     length 1
     axis -90 0 20 XYZ
     dof rx
  end
:hierarchy
  begin
    root hip
    hip leg
    leg foot
  end
";

const AMC: &str = "#!OML:ASF test
:FULLY-SPECIFIED
:DEGREES
1
root 0 0 0 0 0 0
leg 0 0
foot 0
2
root 1 2 3 0 90 0
leg 90 0
foot 30
";

fn figure() -> Figure {
    asf::read(ASF.as_bytes()).unwrap()
}

fn clip(amc: &str) -> Clip {
    amc::read(&figure(), amc.as_bytes()).unwrap()
}

fn refused(file: &str, from: &str, to: &str, line: usize, says: &str) {
    assert!(file.contains(from), "{from}");
    let text = file.replacen(from, to, 1);
    let found = if file == ASF {
        asf::read(text.as_bytes()).expect_err("must be refused").to_string()
    } else {
        amc::read(&figure(), text.as_bytes()).expect_err("must be refused").to_string()
    };
    assert!(found.contains(&format!("line {line}:")) && found.contains(says), "{found}");
}

fn near(a: Vec3, b: Vec3) {
    assert!((a - b).length() < 1e-5, "{a} instead of {b}");
}

#[test]
fn joints_stand_where_bones_begin() {
    let figure = figure();
    let joints = &figure.skeleton.joints;
    let names: Vec<&str> = joints.iter().map(|j| j.name.as_str()).collect();
    assert_eq!(names, ["root", "hip", "leg", "foot"]);
    assert_eq!(joints.iter().map(|j| j.parent).collect::<Vec<_>>(), [None, Some(0), Some(1), Some(2)]);
    near(joints[2].offset, Vec3::new(0.0, 3.0, 0.0)); // directions are unit vectors, whatever their length
    near(joints[3].offset, Vec3::new(4.0, 0.0, 0.0));
    near(joints[3].tip.unwrap(), Vec3::Z);
    assert_eq!(figure.metres_per_unit, Some(0.0254 / 0.45));
    assert_eq!(asf::read(ASF.replace("length 0.45", "length 1.0").as_bytes()).unwrap().metres_per_unit, None);
}

#[test]
fn rest_is_identity_and_motion_turns_about_the_bones_own_axes() {
    let clip = clip(AMC);
    assert!(clip.pose(0).iter().all(|q| q.angle_between(Quat::IDENTITY) < 1e-6));
    near(clip.root[0], Vec3::X);
    near(clip.root[1], Vec3::new(2.0, 2.0, 3.0));
    // The leg's frame is turned by 90 degrees about z: its x axis is the world's y.
    assert!(clip.pose(1)[2].angle_between(Quat::from_rotation_y(std::f32::consts::FRAC_PI_2)) < 1e-3);
    let mut globals = Vec::new();
    clip.globals(1, &mut globals);
    near(globals[2].0, Vec3::new(2.0, 5.0, 3.0));
    // Root and leg each turn by 90 degrees about y: the bone along +x goes to -x.

    near(globals[3].0, Vec3::new(-2.0, 5.0, 3.0));
}

#[test]
fn turns_are_about_fixed_axes_in_their_order() {
    let angles = Vec3::new(0.3, -0.8, 1.2);
    let [x, y, z] = [Quat::from_rotation_x(0.3), Quat::from_rotation_y(-0.8), Quat::from_rotation_z(1.2)];
    assert!(Turns([0, 1, 2]).rotation(angles).angle_between(z * y * x) < 1e-3);
    assert!(Turns([2, 0, 1]).rotation(angles).angle_between(y * x * z) < 1e-3);
}

#[test]
fn radians_of_either_file() {
    let half = std::f32::consts::FRAC_PI_2.to_string();
    let turned = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
    let amc = AMC.replace("leg 90 0", &format!("leg {half} 0")).replace("0 90 0", &format!("0 {half} 0"));
    let by_header = clip(&amc.replace(":DEGREES", ":RADIANS"));
    assert!(by_header.pose(1)[0].angle_between(turned) < 1e-3);
    let asf = ASF.replace("angle deg", "angle rad").replace("0 0 90 XYZ", &format!("0 0 {half} XYZ"));
    let figure = asf::read(asf.as_bytes()).unwrap();
    let by_units = amc::read(&figure, amc.replace(":DEGREES\n", "").as_bytes()).unwrap();
    assert!(by_units.pose(1)[2].angle_between(turned) < 1e-3);
}

#[test]
fn channels_of_the_root_in_any_order() {
    let asf = ASF.replace("order TX TY TZ RX RY RZ", "order rz ry rx tz ty tx");
    let figure = asf::read(asf.as_bytes()).unwrap();
    let clip = amc::read(&figure, AMC.replace("root 1 2 3 0 90 0", "root 0 90 0 3 2 1").as_bytes()).unwrap();
    near(clip.root[1], Vec3::new(2.0, 2.0, 3.0));
    assert!(clip.pose(1)[0].angle_between(Quat::from_rotation_y(std::f32::consts::FRAC_PI_2)) < 1e-3);
}

#[test]
fn bones_in_another_order_and_windows_line_ends() {
    let good = clip(AMC);
    assert_eq!(clip(&AMC.replace("leg 90 0\nfoot 30", "foot 30\nleg 90 0")), good);
    assert_eq!(clip(&AMC.replace('\n', "\r\n")), good);
    assert_eq!(asf::read(ASF.replace('\n', "\r\n").as_bytes()).unwrap(), figure());
}

#[test]
fn faults_of_the_skeleton_name_their_line() {
    refused(ASF, "direction 1 0 0", "direction 1 nan 0", 26, "expected 3 numbers, found 'nan'");
    refused(ASF, "name foot", "name leg", 40, "expected one bone 'leg', found another");
    refused(ASF, "dof rx rz", "dof rx rw", 29, "found 'rw'");
    refused(ASF, "0 0 90 XYZ", "0 0 90 XXZ", 28, "expected an order such as XYZ, found 'XXZ'");
    refused(ASF, "angle deg", "angle gon", 7, "found 'gon'");
    refused(ASF, "leg foot", "leg toe", 45, "expected a bone of :bonedata, found 'toe'");
    refused(ASF, "leg foot", "leg foot\nroot foot", 46, "expected one parent of 'foot'");
    refused(ASF, "leg foot", "", 33, "expected bone 'foot' to hang from the root");
    refused(ASF, "hip leg", "foot leg", 23, "no way to it");
    refused(ASF, ":hierarchy", ":other", 46, "expected :bonedata and :hierarchy");
    refused(ASF, "order TX TY TZ", "order", 46, "expected an order with TX TY TZ");
}

#[test]
fn faults_of_the_motion_name_line_and_frame() {
    refused(AMC, "leg 90 0", "leg 90", 10, "'leg': expected 2 numbers, found 1");
    refused(AMC, "leg 90 0", "leg 90 0 0", 10, "'leg': expected 2 numbers, found 3");
    refused(AMC, "leg 90 0", "leg 90 inf", 10, "expected a finite number, found 'inf'");
    refused(AMC, "leg 90 0", "arm 90 0", 10, "frame 2: expected a bone of the ASF file, found 'arm'");
    refused(AMC, "leg 90 0", "foot 9 ", 11, "frame 2: expected 'foot' once");
    refused(AMC, "leg 90 0\n", "", 8, "frame 2: expected a line for 'leg', found none");
    refused(AMC, "leg 90 0\nfoot 30\n", "", 8, "frame 2: expected a line for 'leg', found none");
    refused(AMC, "\n2\n", "\n3\n", 8, "expected frame 2, found 3");
    refused(AMC, ":DEGREES", "DEGREES", 3, "expected a header");
    refused(AMC, "\n2\n", "\n2 x\n", 8, "expected a frame's number alone");
}

#[test]
fn every_cut_is_refused_or_shorter() {
    for n in 0..AMC.len() {
        match amc::read(&figure(), &AMC.as_bytes()[..n]) {
            Ok(clip) => assert!(clip.frames() == 1 || n + 2 >= AMC.len(), "cut at {n}"),
            Err(error) => assert!(error.to_string().contains("line "), "cut at {n}: {error}"),
        }
        let _ = asf::read(&ASF.as_bytes()[..n.min(ASF.len())]);
    }
    for n in 0..ASF.len() - 6 {
        assert!(
            asf::read(&ASF.as_bytes()[..n]).map_or_else(|e| e.to_string().contains("line "), |f| f.bones.len() == 4)
        );
    }
}

#[test]
fn bones_without_channels_cannot_multiply_memory() {
    let bones: String = (0..100).map(|i| format!("begin\nname b{i}\nend\n")).collect();
    let asf = ASF.replace(":hierarchy\n  begin\n", &format!("{bones}:hierarchy\nbegin\n"));
    let tree: String = (0..100).map(|i| format!("root b{i}\n")).collect();
    let error = asf::read(format!("{asf}{tree}").as_bytes()).unwrap_err().to_string();
    assert!(error.contains("104 bones with 9 channels"), "{error}");
}
