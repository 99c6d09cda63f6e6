//! Foot plants: the times over which the ball of a foot stays in place on the floor.

use glam::Vec3;

use super::skeleton::{JOINT_COUNT, joint};
use super::{FPS, Foot, Motion, Plant};

/// When a foot counts as planted. Speeds are of the ball (toe joint), by central differences.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantOptions {
    /// A plant begins below this speed, m/s; default 0.25.
    pub begin_below: f32,
    /// It lasts while the speed is below this, m/s; default 0.40.
    pub end_above: f32,
    /// The ball is at most this high, metres; default 0.08 (planted it is at 0.02, in swing above 0.05).
    pub max_height: f32,
    /// A plant ends where the ball has risen this far above its lowest height in the plant, metres; default 0.03
    /// (the heel lifts, the foot rolls over the toes).
    pub max_rise: f32,
    /// Shorter plants are dropped, seconds; default 0.1.
    pub min_seconds: f32,
}

impl Default for PlantOptions {
    fn default() -> Self {
        Self { begin_below: 0.25, end_above: 0.40, max_height: 0.08, max_rise: 0.03, min_seconds: 0.1 }
    }
}

/// The foot plants of a motion, sorted by begin, left before right. O(frames).
pub fn detect(motion: &Motion, options: &PlantOptions) -> Vec<Plant> {
    let mut plants = Vec::new();
    for (foot, ball) in [(Foot::Left, joint::LEFT_TOE), (Foot::Right, joint::RIGHT_TOE)] {
        detect_foot(foot, &trajectory(motion, ball), options, &mut plants);
    }
    plants.sort_by_key(|p| (p.begin, p.foot));
    plants
}

/// Whether a foot is planted at a frame.
pub fn is_planted(motion: &Motion, foot: Foot, frame: usize) -> bool {
    motion.plants.iter().any(|p| p.foot == foot && (p.begin as usize..=p.end as usize).contains(&frame))
}

/// Global positions of one joint of a motion at every frame.
pub fn trajectory(motion: &Motion, of: usize) -> Vec<Vec3> {
    let mut globals = Vec::with_capacity(JOINT_COUNT);
    let at = |frame| {
        motion.globals(frame, &mut globals);
        globals[of].0
    };
    (0..motion.len()).map(at).collect()
}

/// Speeds in m/s at every frame, by central differences (one-sided at the ends).
pub fn speeds(points: &[Vec3], fps: f32) -> Vec<f32> {
    let last = points.len().saturating_sub(1);
    let at = |i: usize| {
        let (a, b) = (i.saturating_sub(1), (i + 1).min(last));
        (points[b] - points[a]).length() * fps / (b - a).max(1) as f32
    };
    (0..points.len()).map(at).collect()
}

/// The plants of one foot, whose ball is at these places frame by frame, after those in `out`. O(frames).
pub(crate) fn detect_foot(foot: Foot, ball: &[Vec3], options: &PlantOptions, out: &mut Vec<Plant>) {
    let speed = speeds(ball, FPS);
    let low = |i: usize| ball[i].y <= options.max_height;
    let may_last = |i: usize| low(i) && speed[i] < options.end_above;
    let mut frame = 0;
    while frame < ball.len() {
        if !(low(frame) && speed[frame] < options.begin_below) {
            frame += 1;
            continue;
        }
        // Hysteresis works both ways: the frames before that were slow enough to last belong to the plant as well.
        let mut begin = frame;
        while begin > 0 && may_last(begin - 1) {
            begin -= 1;
        }
        while frame + 1 < ball.len() && may_last(frame + 1) {
            frame += 1;
        }
        let lowest = ball[begin..=frame].iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
        let risen = |i: usize| ball[i].y > lowest + options.max_rise;
        let first = (begin..=frame).find(|&i| !risen(i)).unwrap_or(frame);
        let last = (first..=frame).rev().find(|&i| !risen(i)).unwrap_or(first);
        if (last - first) as f32 >= options.min_seconds * FPS {
            out.push(Plant { foot, begin: first as u32, end: last as u32 });
        }
        frame += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball that stays for 0.5 s, then swings 0.7 m in 0.4 s, 6 cm high, over and over.
    fn steps() -> Vec<Vec3> {
        let at = |frame: usize| {
            let (cycle, within) = (frame / 27, (frame % 27) as f32);
            let swing = ((within - 15.0) / 12.0).max(0.0);
            let eased = swing * swing * (3.0 - 2.0 * swing);
            let height = 0.02 + 0.06 * (std::f32::consts::PI * swing).sin();
            Vec3::new(0.1, height, 0.7 * (cycle as f32 + eased))
        };
        (0..200).map(at).collect()
    }

    #[test]
    fn every_stance_is_found_and_no_swing() {
        let mut plants = Vec::new();
        detect_foot(Foot::Left, &steps(), &PlantOptions::default(), &mut plants);
        assert_eq!(plants.len(), 8);
        let truth = |frame: usize| frame % 27 <= 15;
        let found = |frame: usize| plants.iter().any(|p| (p.begin as usize..=p.end as usize).contains(&frame));
        let wrong = (0..200).filter(|&f| truth(f) != found(f)).count();
        assert!(wrong <= 16, "{wrong} of 200 frames wrong: {plants:?}");
    }

    #[test]
    fn a_foot_held_still_in_the_air_is_not_planted() {
        let mut plants = Vec::new();
        detect_foot(Foot::Right, &[Vec3::new(0.0, 0.3, 0.0); 60], &PlantOptions::default(), &mut plants);
        assert!(plants.is_empty());
    }
}
