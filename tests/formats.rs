//! Captures in one format say what they say in another.
//!
//! Tests of real captures say so and pass where there are none.

mod fixture;
mod mocap;

use std::path::{Path, PathBuf};

use crowdquilt::motion::take::ImportOptions;
use crowdquilt::motion::{Clip, JOINT_COUNT, import};
use glam::{Quat, Vec3};

fn load(path: &Path, options: ImportOptions) -> Clip {
    import::load(path, &options).unwrap_or_else(|e| panic!("{e}"))
}

fn trajectory(clip: &Clip, joint: &str) -> Vec<Vec3> {
    clip.trajectory(clip.skeleton.find(joint).unwrap_or_else(|| panic!("no joint {joint}")))
}

fn farthest(a: &[Vec3], b: &[Vec3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

/// ASF's joints, and those that stand at the same place in cgspeed's BVH conversion. (Fingers and thumbs are left
/// out: the conversion lost the wrist's bone like the thorax's.)
const TWINS: [(&str, &str); 25] = [
    ("root", "Hips"),
    ("lhipjoint", "LHipJoint"),
    ("lfemur", "LeftUpLeg"),
    ("ltibia", "LeftLeg"),
    ("lfoot", "LeftFoot"),
    ("ltoes", "LeftToeBase"),
    ("rhipjoint", "RHipJoint"),
    ("rfemur", "RightUpLeg"),
    ("rtibia", "RightLeg"),
    ("rfoot", "RightFoot"),
    ("rtoes", "RightToeBase"),
    ("lowerback", "LowerBack"),
    ("upperback", "Spine"),
    ("thorax", "Spine1"),
    ("lowerneck", "Neck"),
    ("upperneck", "Neck1"),
    ("head", "Head"),
    ("lclavicle", "LeftShoulder"),
    ("lhumerus", "LeftArm"),
    ("lradius", "LeftForeArm"),
    ("lwrist", "LeftHand"),
    ("rclavicle", "RightShoulder"),
    ("rhumerus", "RightArm"),
    ("rradius", "RightForeArm"),
    ("rwrist", "RightHand"),
];

#[test]
fn amc_and_bvh_of_one_capture_agree() {
    let Some(folder) = mocap::folder() else { return };
    let amc = load(&folder.join("asfamc/02_01.amc"), ImportOptions::default());
    let unit = Some(0.0564444);
    let repairs = ImportOptions {
        metres_per_unit: unit,
        drop_first_frames: Some(1),
        restore_thorax: Some(true),
        ..Default::default()
    };
    let bvh = load(&folder.join("bvh/02_01.bvh"), repairs);
    assert_eq!(amc.frames(), bvh.frames());
    assert!((amc.fps - bvh.fps).abs() < 0.01);
    let mut most = 0.0f32;
    for (ours, theirs) in TWINS {
        let far = farthest(&trajectory(&amc, ours), &trajectory(&bvh, theirs));
        assert!(far < 0.005, "{ours} and {theirs}: {far} m apart");
        most = most.max(far);
    }
    println!("AMC and BVH: {} joints, {} frames, {:.2} mm apart at most", TWINS.len(), amc.frames(), 1e3 * most);
}

/// Any real or generated clip comes back from both files that we write: places within 0.1 mm, rotations within 0.01
/// degrees.
fn round_trips(clip: &Clip) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let unit = ImportOptions { metres_per_unit: Some(1.0), ..Default::default() };
    let glb = folder.join(format!("{}.clip.glb", clip.name));
    std::fs::write(&glb, crowdquilt::export::clip_glb(clip)).unwrap();
    same(clip, &load(&glb, ImportOptions::default()), "GLB");
    let bvh = folder.join(format!("{}.clip.bvh", clip.name));
    std::fs::write(&bvh, crowdquilt::motion::bvh::write(clip)).unwrap();
    same(clip, &load(&bvh, unit), "BVH");
}

fn same(clip: &Clip, back: &Clip, format: &str) {
    let place = |what: &str| format!("{} as {format}: {what}", clip.name);
    assert_eq!(clip.frames(), back.frames(), "{}", place("frames"));
    assert!((clip.fps / back.fps - 1.0).abs() < 1e-5, "{} {} {}", place("rate"), clip.fps, back.fps);
    assert_eq!(clip.skeleton.joints.len(), back.skeleton.joints.len(), "{}", place("joints"));
    let order: Vec<usize> =
        clip.skeleton.joints.iter().map(|j| back.skeleton.find(&j.name).expect("the joint's name")).collect();
    let (mut a, mut b) = (Vec::new(), Vec::new());
    for frame in 0..clip.frames() {
        clip.globals(frame, &mut a);
        back.globals(frame, &mut b);
        for (j, (ours, &at)) in a.iter().zip(&order).enumerate() {
            let far = ours.0.distance(b[at].0);
            assert!(far < 1e-4, "{} frame {frame} joint {j}: {far} m", place("place"));
            let turned = turn_between(ours.1, b[at].1).to_degrees();
            assert!(turned < 0.01, "{} frame {frame} joint {j}: {turned} degrees", place("rotation"));
        }
    }
    for (joint, &at) in clip.skeleton.joints.iter().zip(&order) {
        if let Some(tip) = joint.tip {
            assert!(back.skeleton.joints[at].tip.unwrap().distance(tip) < 1e-4, "{}", place("tip"));
        }
    }
}

/// The angle between two rotations. (By its sine, since single precision cannot tell small angles by their cosine.)
fn turn_between(a: Quat, b: Quat) -> f32 {
    2.0 * (a.as_dquat().inverse() * b.as_dquat()).xyz().length().min(1.0).asin() as f32
}

#[test]
fn samples_come_back_from_every_file() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("formats_samples");
    crowdquilt::samples::write(&folder, 1).unwrap();
    let mut files: Vec<PathBuf> = std::fs::read_dir(&folder).unwrap().map(|e| e.unwrap().path()).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "bvh"));
    files.sort();
    assert!(files.len() > 10, "{}", files.len());
    for file in files {
        round_trips(&load(&file, ImportOptions::default()));
    }
}

#[test]
fn captures_come_back_from_every_file() {
    let Some(folder) = mocap::folder() else { return };
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder.join("bvh")).unwrap().map(|e| e.unwrap().path()).collect();
    files.sort();
    for file in files {
        let mut clip = load(&file, ImportOptions::default());
        let (frames, joints) = (clip.frames().min(300), clip.skeleton.joints.len());
        clip.root.truncate(frames);
        clip.rotations.truncate(frames * joints);
        round_trips(&clip);
    }
}

#[test]
fn everybody_of_an_exported_crowd_comes_back() {
    let mut crowd = fixture::crowd();
    let late = &mut crowd.characters[fixture::WALKER];
    late.begin = 20;
    late.root.drain(..20);
    late.rotations.drain(..20 * JOINT_COUNT);
    let early = &mut crowd.characters[fixture::SHAKER];
    early.root.truncate(80);
    early.rotations.truncate(80 * JOINT_COUNT);
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("formats_crowd.glb");
    std::fs::write(&path, crowdquilt::export::glb(&crowd)).unwrap();
    let clips = import::load_all(&path, &ImportOptions::default()).unwrap();
    assert_eq!(clips.len(), crowd.characters.len());
    for (i, clip) in clips.iter().enumerate() {
        let expected = crowdquilt::export::clip(&crowd, i).unwrap();
        assert_eq!(clip.name, format!("formats_crowd.person_{i}"));
        assert_eq!((clip.frames(), clip.fps), (expected.frames(), expected.fps));
        let (mut a, mut b) = (Vec::new(), Vec::new());
        for frame in 0..clip.frames() {
            expected.globals(frame, &mut a);
            clip.globals(frame, &mut b);
            for (joint, found) in expected.skeleton.joints.iter().zip(&a) {
                let at = clip.skeleton.find(&joint.name).unwrap();
                // The file's rotations are 16-bit integers.
                assert!(found.0.distance(b[at].0) < 2e-4, "person {i} frame {frame} {}", joint.name);
            }
        }
    }
    let one = ImportOptions { character: Some("person_2".into()), ..Default::default() };
    assert_eq!(import::load(&path, &one).unwrap(), clips[2]);
    let error = import::load(&path, &ImportOptions::default()).unwrap_err().to_string();
    assert!(error.contains("import.character") && error.contains("'person_0', 'person_1'"), "{error}");
    let nobody = ImportOptions { character: Some("Bob".into()), ..Default::default() };
    let error = import::load(&path, &nobody).unwrap_err().to_string();
    assert!(error.contains("formats_crowd.glb") && error.contains("found 'Bob'"), "{error}");
}

#[test]
fn an_amc_file_finds_its_skeleton() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("formats_asf");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    write("7_01.amc", ":FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 0 0 0 0 0\n");
    let asf =
        ":units\nlength 0.45\n:bonedata\nbegin\nname leg\ndirection 0 -1 0\nlength 20\nend\n:hierarchy\nroot leg\n";
    let options = |skeleton: Option<&str>| ImportOptions { skeleton: skeleton.map(Into::into), ..Default::default() };
    let load = |skeleton| import::load(&folder.join("7_01.amc"), &options(skeleton)).map_err(|e| e.to_string());
    assert!(load(None).unwrap_err().contains("expected the skeleton 7.asf beside it"));
    write("other.asf", asf);
    let clip = load(None).unwrap();
    assert_eq!(clip.name, "7_01");
    let tip = clip.skeleton.joints[1].tip.unwrap().length();
    assert!((tip - 20.0 * 0.0254 / 0.45).abs() < 1e-5, "{tip}");
    write("another.asf", "nothing");
    assert!(load(None).unwrap_err().contains("found 2 .asf files"));
    write("7.asf", asf);
    assert!(load(None).is_ok());
    assert!(load(Some("another.asf")).unwrap_err().contains("another.asf: line 1: expected :bonedata"));
    assert!(load(Some("none.asf")).unwrap_err().contains("none.asf"));
}

#[test]
fn what_is_no_capture_is_told_what_is() {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("walk.c3d");
    std::fs::write(&path, [2, 80, 0, 0]).unwrap();
    let error = import::load(&path, &ImportOptions::default()).unwrap_err().to_string();
    for word in ["walk.c3d", "BVH", "AMC", "FBX", "glTF"] {
        assert!(error.contains(word), "{error}");
    }
}
