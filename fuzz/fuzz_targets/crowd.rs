//! Crowd-file bytes of any content: an error or a crowd that can be checked and exported, never a panic.
#![no_main]

use crowdquilt::stage::Crowd;
use crowdquilt_fuzz as _;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(crowd) = Crowd::from_bytes(bytes) else { return };
    assert_eq!(Crowd::from_bytes(&crowd.to_bytes()).expect("what was read can be written").characters.len(), crowd.characters.len());
});
