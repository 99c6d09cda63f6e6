//! Captures in one format say what they say in another.
//!
//! The real ones are in `../shared/mocap`, or where `CROWDQUILT_MOCAP` says; tests of them say so and pass without.

use std::path::{Path, PathBuf};

use crowdquilt::motion::take::ImportOptions;
use crowdquilt::motion::{Clip, import};
use glam::Vec3;

/// The folder of captures, if it is there.
fn mocap() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = std::env::var_os("CROWDQUILT_MOCAP").map_or_else(|| root.join("../shared/mocap"), PathBuf::from);
    if folder.join("index.csv").is_file() {
        return Some(folder);
    }
    eprintln!("skipped: no captures at {} (set CROWDQUILT_MOCAP to a folder with index.csv)", folder.display());
    None
}

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
    let Some(folder) = mocap() else { return };
    let amc = load(&folder.join("asfamc/02_01.amc"), ImportOptions::default());
    let unit = Some(0.0564444);
    let repairs =
        ImportOptions { metres_per_unit: unit, drop_first_frames: 1, restore_thorax: true, ..Default::default() };
    let bvh = load(&folder.join("bvh/02_01.bvh"), repairs);
    assert_eq!(amc.frames(), bvh.frames());
    assert!((amc.fps - bvh.fps).abs() < 0.01);
    for (ours, theirs) in TWINS {
        let far = farthest(&trajectory(&amc, ours), &trajectory(&bvh, theirs));
        assert!(far < 0.005, "{ours} and {theirs}: {far} m apart");
    }
}
