//! What the C compiler's coverage of comparisons calls (`make fuzz` compiles ufbx with it) and libFuzzer lacks.

/// A comparison of doubles.
#[unsafe(no_mangle)]
pub extern "C" fn __sanitizer_cov_trace_cmpd(_: f64, _: f64) {}

/// A comparison of floats.
#[unsafe(no_mangle)]
pub extern "C" fn __sanitizer_cov_trace_cmpf(_: f32, _: f32) {}
