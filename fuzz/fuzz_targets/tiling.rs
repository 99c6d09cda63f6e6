//! Checkpoint bytes of any content, signed so that the digest does not keep them out: an error or a checkpoint that can be
//! written again, never a panic.
#![no_main]

use crowdquilt::tiling::Checkpoint;
use crowdquilt_fuzz as _;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let mut bytes = bytes.to_vec();
    Checkpoint::sign(&mut bytes);
    let Ok(kept) = Checkpoint::from_bytes(&bytes) else { return };
    assert_eq!(Checkpoint::from_bytes(&kept.to_bytes()).expect("what was read can be written"), kept);
});
