//! Take files of any content: an error or a valid take, never a panic.
#![no_main]

use crowdquilt::motion::take::TakeFile;
use crowdquilt_fuzz as _;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Ok(take) = TakeFile::parse(text) {
        assert!(take.validate().is_empty());
    }
});
