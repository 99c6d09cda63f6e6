//! Maps of any content: an error, or a small world that can be built, never a panic or a hang.
#![no_main]

use crowdquilt::world::{Area, Coordinates, PatternType, Template};
use crowdquilt_fuzz as _;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let templates = vec![Template::new("place", "stone").bordered("place", PatternType::mixed(2, 2))];
    let Ok(grounds) = Area::grounds_of_geojson(text, Coordinates::Metres, &templates) else { return };
    let far = grounds.iter().flat_map(|g| g.rings.iter().flatten()).flatten().fold(0.0_f64, |far, v| far.max(v.abs()));
    // Large worlds take their time.
    if far < 40.0 {
        let _ = Area { templates, grounds, side: 8.0, period: 10.0, seed: 1 }.build("fuzz", &|_, _| true);
    }
});
