//! Rig files of any content: an error or a rig that can be asked for, never a panic.
#![no_main]

use crowdquilt::motion::canonical;
use crowdquilt::motion::retarget::rigfile::RigFile;
use crowdquilt_fuzz as _;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Ok(rig) = RigFile::parse(text) {
        let _ = rig.apply(&mut canonical().clone());
    }
});
