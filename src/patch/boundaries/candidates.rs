//! Frames at which motion may be cut: somebody stands on the feet and carries on from there. That is mid-stance of a
//! step, when one leg passes the planted other, or a rest with both feet planted; and nothing happens with others.

use glam::Vec3;

use crate::motion::gait::{self, GaitOptions, Phase};
use crate::motion::{FPS, Foot, Motion, plants};

/// Slowest step, m/s: dancers' steps are slower than walks.
pub(super) const SLOWEST_STEP: f32 = 0.25;
/// Fastest that hips move in a rest, m/s.
pub(super) const FASTEST_REST: f32 = 0.35;
/// Every so manieth frame of a rest is a candidate; the first and last always.
const STRIDE: usize = 3;

/// What a candidate frame is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Candidate {
    /// Frame of the motion.
    pub frame: usize,
    /// Mid-stance of which foot, or standing on both.
    pub phase: Phase,
}

/// The candidates among the frames that are `quiet`, sorted. Rests are thinned out by `sparse`.
pub(super) fn candidates(motion: &Motion, quiet: &[bool], sparse: usize) -> Vec<Candidate> {
    let options = GaitOptions { min_speed: SLOWEST_STEP, ..Default::default() };
    let steps = gait::moments(motion, &options).into_iter().filter(|m| m.phase != Phase::Stand);
    let mut found: Vec<Candidate> =
        steps.filter(|m| quiet[m.frame]).map(|m| Candidate { frame: m.frame, phase: m.phase }).collect();
    let resting = resting(motion);
    let open = |f: usize| quiet[f] && resting[f];
    for first in (0..motion.len()).filter(|&f| open(f) && (f == 0 || !open(f - 1))) {
        let last = (first..motion.len()).take_while(|&f| open(f)).last().unwrap_or(first);
        let frames = (first..last).step_by(STRIDE * sparse).chain([last]);
        found.extend(frames.map(|frame| Candidate { frame, phase: Phase::Stand }));
    }
    found.sort_unstable();
    // A slow step's mid-stance may fall into a rest: it is a step.
    found.dedup_by(|later, kept| later.frame == kept.frame);
    found
}

/// How fast the hips go over the ground at every frame, m/s.
pub(super) fn speeds(motion: &Motion) -> Vec<f32> {
    let hips: Vec<Vec3> = motion.path.points.iter().map(|p| Vec3::new(p.x, 0.0, p.y)).collect();
    plants::speeds(&hips, FPS)
}

/// Both feet planted and hips slow.
fn resting(motion: &Motion) -> Vec<bool> {
    let speeds = speeds(motion);
    let mut feet = [vec![false; motion.len()], vec![false; motion.len()]];
    for p in &motion.plants {
        let end = (p.end as usize).min(motion.len().saturating_sub(1));
        feet[usize::from(p.foot == Foot::Right)][p.begin as usize..=end].fill(true);
    }
    (0..motion.len()).map(|f| feet[0][f] && feet[1][f] && speeds[f] < FASTEST_REST).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::testing::{standing, walking};

    #[test]
    fn steps_at_mid_stance_and_rests_now_and_then() {
        let walk = walking(3.0);
        let all = candidates(&walk, &vec![true; walk.len()], 1);
        assert!(all.len() >= 4 && all.iter().all(|c| c.phase != Phase::Stand), "{all:?}");
        let stand = standing(1.0);
        let frames: Vec<usize> = candidates(&stand, &vec![true; stand.len()], 1).iter().map(|c| c.frame).collect();
        assert!(frames.len() >= stand.len() / 3 && frames[0] == 0 && *frames.last().unwrap() == stand.len() - 1);
        let half: Vec<bool> = (0..stand.len()).map(|f| f >= 10).collect();
        assert!(candidates(&stand, &half, 4).iter().all(|c| c.frame >= 10));
        assert!(candidates(&stand, &vec![false; stand.len()], 1).is_empty());
    }
}
