//! ASF bytes of any content: an error or a figure whose joints form a tree, never a panic.
#![no_main]

use crowdquilt::motion::asfamc;
use crowdquilt_fuzz as _;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(figure) = asfamc::read_skeleton(bytes) else { return };
    let joints = &figure.skeleton.joints;
    assert_eq!(joints.len(), figure.bones.len());
    assert!(joints.iter().enumerate().all(|(i, j)| j.parent.is_none_or(|p| p < i)));
});
