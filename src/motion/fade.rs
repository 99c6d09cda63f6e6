//! How two motions that follow each other share the difference between them: either side takes a part of it, in value
//! and in rate, and fades it out by a cubic, so that the result is continuous and smooth (C1).

use glam::{Quat, Vec3};

/// Weights of the difference (entry minus exit) and of the difference of rates per frame, `frames` before the meeting,
/// for the side before, which takes `share` of it over `window` frames.
pub(crate) fn before(share: f32, window: f32, frames: f32) -> (f32, f32) {
    let s = 1.0 - frames / window;
    if s <= 0.0 { (0.0, 0.0) } else { (share * s * s * (3.0 - 2.0 * s), share * window * s * s * (s - 1.0)) }
}

/// The same `frames` after the meeting, for the side after.
pub(crate) fn after(share: f32, window: f32, frames: f32) -> (f32, f32) {
    let s = frames / window;
    if s >= 1.0 {
        return (0.0, 0.0);
    }
    let left = 1.0 - s;
    (-share * left * left * (1.0 + 2.0 * s), -share * window * s * left * left)
}

/// The rotation vector, of at most half a turn, that leads from one rotation to another.
pub(crate) fn turn_from(from: Quat, to: Quat) -> Vec3 {
    let q = to * from.inverse();
    (if q.w < 0.0 { -q } else { q }).to_scaled_axis()
}
