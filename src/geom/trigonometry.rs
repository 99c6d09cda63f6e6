//! Sine and cosine for inner loops: a few products, no call, the same bits on all machines.

use std::f32::consts::FRAC_2_PI;

/// A quarter turn in two parts, the first of which has few digits, so that its multiples are exact.
const QUARTER: [f32; 2] = [1.570_312_5, 4.838_268e-4];
/// Added and taken away again, it rounds to whole numbers.
const ROUNDING: f32 = 12_582_912.0;

/// Sine and cosine of an angle of at most some thousand radians, to 2e-7 near zero; polynomials of the Cephes library on an eighth
/// of a turn to both sides of the nearest quarter.
#[inline(always)]
pub(crate) fn sin_cos(angle: f32) -> (f32, f32) {
    let rounded = angle * FRAC_2_PI + ROUNDING;
    let quarters = rounded - ROUNDING;
    let r = (angle - quarters * QUARTER[0]) - quarters * QUARTER[1];
    let r2 = r * r;
    let sin = r + r * r2 * (-0.166_666_54 + r2 * (0.008_332_161 - r2 * 0.000_195_152_95));
    let cos = 1.0 - 0.5 * r2 + r2 * r2 * (0.041_666_646 + r2 * (-0.001_388_731_6 + r2 * 0.000_024_433_157));
    // Bits, not branches: quarters of a turn come in no order. The last ones of the rounded number say which it is.
    let quarter = rounded.to_bits();
    let other = (sin.to_bits() ^ cos.to_bits()) & (quarter & 1).wrapping_neg();
    let (sin, cos) = (sin.to_bits() ^ other, cos.to_bits() ^ other);
    let sign = |quarter: u32| (quarter & 2) << 30;
    (f32::from_bits(sin ^ sign(quarter)), f32::from_bits(cos ^ sign(quarter.wrapping_add(1))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_those_of_the_library() {
        for i in -40_000..40_000 {
            let angle = i as f32 * 0.01;
            let (sin, cos) = sin_cos(angle);
            let expected = f64::from(angle).sin_cos();
            // The quarters' second part is rounded, too.
            let allowed = 3e-7 + 1e-9 * f64::from(angle.abs());
            assert!((f64::from(sin) - expected.0).abs() < allowed, "{angle}: {sin}, {}", expected.0);
            assert!((f64::from(cos) - expected.1).abs() < allowed, "{angle}: {cos}, {}", expected.1);
        }
    }
}
