//! One good file, one fault per test.

use super::read;
use crate::motion::Clip;

const GOOD: &str = "HIERARCHY
ROOT Hips
{
  OFFSET 0 1 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation
  JOINT Left Arm
  {
    OFFSET 1 0 0
    CHANNELS 3 Yrotation Zrotation Xrotation
    End Site
    {
      OFFSET 0.5 0 0
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.0333333
0 1 0 0 0 0 0 0 0
1 2 3 90 0 0 0 90 0
";

fn message(text: &str) -> String {
    read(text.as_bytes()).expect_err("must be refused").to_string()
}

fn refused(from: &str, to: &str, line: usize, says: &str) {
    assert!(GOOD.contains(from));
    let found = message(&GOOD.replacen(from, to, 1));
    assert!(found.contains(&format!("line {line}:")) && found.contains(says), "{found}");
}

fn good() -> Clip {
    read(GOOD.as_bytes()).unwrap()
}

#[test]
fn reads_joints_channels_and_frames() {
    let clip = good();
    assert_eq!(clip.skeleton.joints.len(), 2);
    assert_eq!((clip.skeleton.joints[1].name.as_str(), clip.skeleton.joints[1].parent), ("Left Arm", Some(0)));
    assert_eq!(clip.skeleton.joints[1].tip.unwrap().x, 0.5);
    assert!((clip.fps - 30.0).abs() < 1e-3 && clip.frames() == 2);
    let mut globals = Vec::new();
    clip.globals(1, &mut globals);
    // The root's quarter turn about z sends +x to +y; the arm's own sends +y to -x.
    assert!((globals[1].0 - glam::Vec3::new(1.0, 3.0, 3.0)).length() < 1e-5, "{:?}", globals[1]);
    assert!((globals[1].1 * glam::Vec3::X + glam::Vec3::X).length() < 1e-5);
}

#[test]
fn rotations_multiply_in_the_order_of_the_channels() {
    let text = GOOD.replace("1 2 3 90 0 0 0 90 0", "1 2 3 0 0 0 30 40 50");
    let clip = read(text.as_bytes()).unwrap();
    let angles = [30.0f32, 40.0, 50.0].map(f32::to_radians);
    let expected = glam::Quat::from_euler(glam::EulerRot::YZX, angles[0], angles[1], angles[2]);
    assert!(clip.pose(1)[1].dot(expected).abs() > 1.0 - 1e-6);
}

#[test]
fn line_ends_and_byte_order_mark_do_not_matter() {
    assert_eq!(read(GOOD.replace('\n', "\r\n").as_bytes()).unwrap(), good());
    assert_eq!(read(format!("\u{feff}{GOOD}").as_bytes()).unwrap(), good());
    assert_eq!(read(GOOD.replace("\n{", " {").replace("\n  {", "{").as_bytes()).unwrap(), good());
}

#[test]
fn every_cut_is_refused_with_a_line() {
    for n in 0..GOOD.len() - " 90 0\n".len() {
        let found = message(&GOOD[..n]);
        assert!(found.contains("line "), "cut at {n}: {found}");
    }
}

#[test]
fn empty_file() {
    assert!(message("").contains("line 1: expected HIERARCHY, found the end"));
}

#[test]
fn binary_file() {
    let bytes = [b"HIERARCHY\nROOT \xff\xfe".as_slice(), &[0; 40]].concat();
    assert!(read(&bytes).unwrap_err().to_string().contains("line 2: expected text"));
    assert!(message("\0\0\0\0").contains("expected HIERARCHY"));
}

#[test]
fn not_a_number() {
    refused("1 2 3 90", "1 nan 3 90", 20, "expected a finite number, found 'nan'");
    refused("1 2 3 90", "1 1e99 3 90", 20, "expected a finite number");
    refused("OFFSET 1 0 0", "OFFSET 1 x 0", 8, "expected a finite number, found 'x'");
}

#[test]
fn no_frames() {
    refused("Frames: 2", "Frames: 0", 17, "expected at least one frame");
    refused("Frames: 2", "Frames: -2", 17, "expected a number of frames");
}

#[test]
fn promised_frames_that_are_not_there() {
    refused("Frames: 2", "Frames: 18446744073709551615", 20, "frames, found the end after 2");
    refused("Frames: 2", "Frames: 1", 20, "expected the end after 1 frames");
}

#[test]
fn frame_time_must_be_above_zero_and_no_eternity() {
    refused("0.0333333", "0", 18, "expected a frame time above 0");
    refused("0.0333333", "-0.01", 18, "expected a frame time above 0");
    refused("0.0333333", "1e-45", 18, "expected a frame time above 0");
    refused("0.0333333", "1e9", 18, "at most 1 second");
}

#[test]
fn root_must_have_its_channels() {
    let from = "6 Xposition Yposition Zposition Zrotation Yrotation Xrotation";
    refused(from, "3 Zrotation Yrotation Xrotation", 16, "expected a channel Xposition");
    refused(from, "3 Xposition Yposition Zposition", 16, "expected rotation channels");
}

#[test]
fn channels_must_be_known_and_few() {
    refused("CHANNELS 3", "CHANNELS 999999999", 9, "expected 0 to 6 channels");
    refused("Zrotation Xrotation\n    End", "Wrotation Xrotation\n    End", 9, "found 'Wrotation'");
}

#[test]
fn wrong_count_of_numbers_in_a_frame() {
    refused("1 2 3 90 0 0", "1 2 3 90 0", 20, "frame 1: expected 9 numbers, found 8");
    refused("1 2 3 90 0 0", "1 2 3 90 0 0 7", 20, "frame 1: expected 9 numbers, found 10");
}

#[test]
fn unknown_word_in_the_hierarchy() {
    refused("End Site", "Ent Site", 10, "found 'Ent'");
}

#[test]
fn a_deep_chain_costs_no_call_stack() {
    let n = 100_000;
    let joint = "JOINT j { OFFSET 0 1 0 CHANNELS 1 Xrotation\n";
    let root = "HIERARCHY ROOT r { OFFSET 0 0 0 CHANNELS 4 Xposition Yposition Zposition Yrotation\n";
    let frame = "0 ".repeat(n + 4);
    let text = [root, &joint.repeat(n), &"}\n".repeat(n + 1), "\nMOTION\nFrames: 1\nFrame Time: 1\n", &frame].concat();
    assert_eq!(read(text.as_bytes()).unwrap().skeleton.joints.len(), n + 1);
}

#[test]
fn joints_without_channels_cannot_multiply_memory() {
    let root = "HIERARCHY ROOT r { CHANNELS 4 Xposition Yposition Zposition Yrotation\n";
    let text = [root, &"JOINT j { }\n".repeat(1000), "}\nMOTION\nFrames: 1\nFrame Time: 1\n0 0 0 0"].concat();
    assert!(message(&text).contains("1001 joints with 4 channels"));
}
