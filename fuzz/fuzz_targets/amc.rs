//! An ASF file, a line of `=====`, an AMC file, both of any content: an error or a clip that can be repaired and
//! retargeted, never a panic.
#![no_main]

use crowdquilt::motion::{asfamc, import, retarget, take::ImportOptions};
use crowdquilt_fuzz as _;
use libfuzzer_sys::fuzz_target;

const BETWEEN: &[u8] = b"\n=====\n";

fuzz_target!(|bytes: &[u8]| {
    let Some(at) = bytes.windows(BETWEEN.len()).position(|w| w == BETWEEN) else { return };
    let Ok(figure) = asfamc::read_skeleton(&bytes[..at]) else { return };
    let Ok(clip) = asfamc::read(&figure, &bytes[at + BETWEEN.len()..]) else { return };
    let poses = clip.frames() * clip.skeleton.joints.len();
    assert_eq!(clip.rotations.len(), poses);
    assert!(poses <= 64 * bytes.len(), "memory out of proportion to the input");
    if let Ok(clip) = import::repair(clip, &ImportOptions::default()) {
        let _ = retarget::to_canonical(&clip);
    }
});
