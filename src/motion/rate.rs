//! The rate at which keys of any times are sampled.

use super::nodes::Timing;

/// Fastest rate that keys are sampled at.
const FASTEST: f64 = 240.0;
/// Curves are sampled at least this often, however few keys they have.
const SMOOTH: f64 = 30.0;
/// Slowest rate.
const SLOWEST: f64 = 1.0;

/// When to sample keys at these times between two moments: at `fps`, else at the rate of the densest keys. Where
/// `smooth`, the motion between keys is curved and sampled between them too.
pub(crate) fn timing(times: &[&[f32]], [begin, end]: [f64; 2], fps: Option<f64>, smooth: bool) -> Timing {
    if !(begin.is_finite() && end > begin) {
        return Timing { begin: if begin.is_finite() { begin } else { 0.0 }, fps: fps.unwrap_or(SMOOTH), frames: 1 };
    }
    let fps = fps.unwrap_or_else(|| key_rate(times, end - begin, smooth));
    // Single precision may put the last key a little before its frame.
    let frames = ((end - begin) * fps + 0.01).floor() as usize;
    Timing { begin, fps, frames: frames.saturating_add(1) }
}

fn key_rate(times: &[&[f32]], seconds: f64, smooth: bool) -> f64 {
    let gaps = || times.iter().flat_map(|t| t.windows(2)).map(|pair| f64::from(pair[1]) - f64::from(pair[0]));
    let least = gaps().fold(f64::INFINITY, f64::min).max(1.0 / FASTEST);
    if !least.is_finite() {
        return SMOOTH;
    }
    // Times far from 0 are coarse in single precision, so that the densest gaps are averaged.
    let (mut sum, mut count) = (0.0, 0.0);
    for gap in gaps().filter(|gap| (0.99 * least..1.3 * least).contains(gap)) {
        (sum, count) = (sum + gap, count + 1.0);
    }
    let rate = meant(if count > 0.0 { count / sum } else { 1.0 / least }, seconds).min(FASTEST);
    let floor = if smooth { SMOOTH } else { SLOWEST };
    // Whole multiples hit every key.
    if rate < floor { rate * (floor / rate).ceil() } else { rate }
}

/// The rate that is meant by an estimate: it fits a whole number of frames into the time, and where a common rate
/// (a whole number, or one of television) does too, it is that one.
fn meant(rate: f64, seconds: f64) -> f64 {
    let whole = (rate * seconds).round();
    let rate = if (rate * seconds - whole).abs() < 0.1 { whole / seconds } else { rate };
    let television = [24.0, 30.0, 60.0, 120.0].map(|r| r / 1.001);
    let candidates = [rate.round()].into_iter().chain(television);
    let nearest = candidates.min_by(|a, b| (a - rate).abs().total_cmp(&(b - rate).abs())).unwrap_or(rate);
    let same = ((nearest - rate) * seconds).abs() < 0.01 && (nearest / rate - 1.0).abs() < 1e-3;
    if nearest >= 1.0 && same { nearest } else { rate }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys(fps: f64, frames: usize, begin: f64) -> Vec<f32> {
        (0..frames).map(|f| (begin + f as f64 / fps) as f32).collect()
    }

    fn of(times: &[&[f32]], smooth: bool) -> Timing {
        let all = || times.iter().flat_map(|t| t.iter()).copied();
        let ends = [all().fold(f32::INFINITY, f32::min), all().fold(f32::NEG_INFINITY, f32::max)];
        timing(times, ends.map(f64::from), None, smooth)
    }

    #[test]
    fn every_key_of_an_even_track_is_a_frame() {
        for fps in [1.0, 12.5, 23.976, 24.0, 25.0, 29.97, 30.0, 59.94, 60.0, 90.0, 119.88, 120.0, 240.0] {
            for (frames, begin) in [(2, 0.0), (7, 0.0), (900, 10.0), (20_000, 0.0)] {
                let timing = of(&[&keys(fps, frames, begin)], false);
                assert_eq!(timing.frames, frames, "{fps} from {begin}: {timing:?}");
                assert!((timing.fps / fps - 1.0).abs() < 1e-3, "{fps}: {timing:?}");
            }
        }
    }

    #[test]
    fn the_densest_track_decides_up_to_240() {
        assert_eq!(of(&[&[0.0, 10.0], &keys(60.0, 601, 0.0), &[0.0, 0.5, 1.0]], false).fps, 60.0);
        assert_eq!(of(&[&keys(1000.0, 1001, 0.0)], false).fps, 240.0);
        assert_eq!(of(&[&[0.0, 1e-7, 2.0]], false).fps, 240.0);
    }

    #[test]
    fn sparse_keys() {
        assert_eq!(of(&[&[0.0, 1.0, 2.0]], true), Timing { begin: 0.0, fps: 30.0, frames: 61 });
        assert_eq!(of(&[&[0.0, 2.0, 4.0]], false), Timing { begin: 0.0, fps: 1.0, frames: 5 });
        assert_eq!(of(&[&[3.0]], true).frames, 1);
        assert_eq!(of(&[], true), Timing { begin: 0.0, fps: 30.0, frames: 1 });
    }

    #[test]
    fn a_wish_is_kept() {
        let timing = timing(&[&keys(120.0, 121, 0.0)], [0.0, 1.0], Some(50.0), true);
        assert_eq!((timing.fps, timing.frames), (50.0, 51));
    }
}
