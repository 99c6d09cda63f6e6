//! Scene files of any content: an error or a scene, never a panic.
#![no_main]

use crowdquilt::tiling::Scene;
use crowdquilt_fuzz as _;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let _ = Scene::from_toml(text);
});
