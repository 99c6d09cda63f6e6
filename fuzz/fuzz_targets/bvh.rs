//! BVH bytes of any content: an error or a clip that can be repaired, retargeted and cut, never a panic.
#![no_main]

use crowdquilt::motion::{bvh, import, retarget, take::ImportOptions};
use crowdquilt_fuzz as _;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(clip) = bvh::read(bytes) else { return };
    let joints = clip.skeleton.joints.len();
    assert_eq!(clip.rotations.len(), clip.frames() * joints);
    assert!(clip.frames() * joints <= 64 * bytes.len(), "memory out of proportion to the input");
    if let Ok(clip) = import::repair(clip, &ImportOptions::default()) {
        let _ = retarget::to_canonical(&clip);
    }
});
