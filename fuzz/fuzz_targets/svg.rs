//! Drawings of any content: an error, or a small world that can be built, never a panic or a hang.
#![no_main]

use crowdquilt::world::{Area, Sign};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let sign = Sign { name: "place".into(), key: Some('p'), colour: Some([255, 0, 0]) };
    if let Ok(grounds) = Area::grounds_of_svg(text, Some(0.1), &[sign]) {
        crowdquilt_fuzz::build(grounds.found);
    }
});
