//! Patch-set bytes of any content: an error or a valid set, never a panic.
#![no_main]

use crowdquilt::patch::PatchSet;
use crowdquilt_fuzz as _;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(set) = PatchSet::from_bytes(bytes) {
        assert!(set.validate().is_empty());
    }
});
