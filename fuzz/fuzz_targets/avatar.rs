//! Users' characters of any content: an error or a character, never a panic.
#![no_main]

use crowdquilt::export::Avatar;
use crowdquilt_fuzz as _;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = Avatar::open(bytes);
});
