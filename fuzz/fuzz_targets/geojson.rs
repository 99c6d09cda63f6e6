//! Maps of any content: an error, or a small world that can be built, never a panic or a hang.
#![no_main]

use crowdquilt::world::{Area, Coordinates, Template};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let templates = [Template::new("place", "stone")];
    if let Ok(grounds) = Area::grounds_of_geojson(text, Coordinates::Metres, &templates) {
        crowdquilt_fuzz::build(grounds);
    }
});
