//! Meshes of any content: an error, or a floor of which a small world can be built, never a panic or a hang.
#![no_main]

use crowdquilt::world::{Area, FloorOptions, Sign};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let signs = [Sign { name: "place".into(), ..Sign::default() }];
    if let Ok(grounds) = Area::grounds_of_mesh(bytes, None, &FloorOptions::default(), &signs) {
        crowdquilt_fuzz::build(grounds.found);
    }
});
