//! FBX bytes of any content: an error or clips that can be retargeted, never a panic.
#![no_main]

use crowdquilt::motion::{import, retarget, take::ImportOptions};
use crowdquilt_fuzz as _;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(clips) = import::from_bytes("fuzz.fbx", bytes, &ImportOptions::default()) else { return };
    for clip in clips {
        assert_eq!(clip.rotations.len(), clip.frames() * clip.skeleton.joints.len());
        assert!(clip.rotations.iter().all(|q| q.is_normalized()));
        // Retargeting long clips would be all that is tested.
        if clip.rotations.len() < 500 {
            let _ = retarget::to_canonical(&clip);
        }
    }
});
