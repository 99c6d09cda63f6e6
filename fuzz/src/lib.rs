//! What the C compiler's coverage of comparisons calls (`make fuzz` compiles ufbx with it) and libFuzzer lacks; and worlds to try.

use crowdquilt::world::{Area, Ground, PatternType, Template};

/// Builds a world on ground, if it is small: large worlds take their time.
pub fn build(grounds: Vec<Ground>) {
    let far = grounds.iter().flat_map(|g| g.rings.iter().flatten()).flatten().fold(0.0_f64, |far, v| far.max(v.abs()));
    if far < 40.0 {
        let templates = vec![Template::new("place", "stone").bordered("place", PatternType::mixed(2, 2))];
        let area =
            Area { templates, grounds, side: 8.0, period: 10.0, goals: Vec::new(), notes: Vec::new(), seed: 1 };
        let _ = area.build("fuzz", &|_, _| true);
    }
}

/// A comparison of doubles.
#[unsafe(no_mangle)]
pub extern "C" fn __sanitizer_cov_trace_cmpd(_: f64, _: f64) {}

/// A comparison of floats.
#[unsafe(no_mangle)]
pub extern "C" fn __sanitizer_cov_trace_cmpf(_: f32, _: f32) {}
