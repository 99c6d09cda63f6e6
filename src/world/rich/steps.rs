//! Steps of those who meet: when their feet stand in their clips, so that the walk before and after goes in step with them, and each
//! foot goes over from walk to clip while it is in the air.

use std::ops::Range;

use glam::{Quat, Vec3};

use crate::motion::plants::{PlantOptions, detect_foot};
use crate::motion::{Foot, JOINT_COUNT, canonical, joint};
use crate::stage::world::{Acts, feet_with_body};

/// A foot that is in the air goes over only if this part of its step is still to come.
const STILL: f64 = 0.6;
/// From the middle of a stance to that of the other foot's it takes no longer than this, seconds.
const LONGEST: f64 = 1.0;

/// When the left and the right foot stand, seconds since the begin of the clip.
pub(in crate::world) struct Steps([Vec<Range<f64>>; 2]);

impl Steps {
    /// Of a clip. O(frames).
    pub fn of(acts: &Acts, act: usize) -> Self {
        let step = f64::from(acts.steps[act]);
        let (mut balls, mut pose, mut globals) = ([vec![], vec![]], [Quat::IDENTITY; JOINT_COUNT], Vec::new());
        for frame in 0..acts.frames(act).len() {
            let root = acts.sample_once(act, frame as f64 * step, &mut pose);
            canonical().globals(root, &pose, &mut globals);
            balls[0].push(globals[joint::LEFT_TOE].0);
            balls[1].push(globals[joint::RIGHT_TOE].0);
        }
        let stances = |foot: Foot, balls: &[Vec3]| {
            let mut plants = Vec::new();
            detect_foot(foot, balls, &PlantOptions::default(), &mut plants);
            plants.iter().map(|p| f64::from(p.begin) * step..f64::from(p.end) * step).collect()
        };
        Self([stances(Foot::Left, &balls[0]), stances(Foot::Right, &balls[1])])
    }

    /// How far through a cycle of two steps somebody is at a time, as walking cycles count: 0 in the middle of a stance of the left
    /// foot, a half in that of the right one. `None` if nobody steps then.
    pub fn phase(&self, secs: f64) -> Option<f64> {
        let middles = |foot: usize| self.0[foot].iter().map(move |s| (0.5 * (s.start + s.end), 0.5 * foot as f64));
        let mut all: Vec<(f64, f64)> = middles(0).chain(middles(1)).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let far = |pair: &[(f64, f64)]| (pair[0].0 - secs).max(secs - pair[1].0).max(0.0);
        let steps = all.windows(2).filter(|w| w[0].1 != w[1].1 && w[1].0 - w[0].0 < LONGEST && w[1].0 - w[0].0 > 0.1);
        let pair = steps.min_by(|a, b| far(a).total_cmp(&far(b))).filter(|pair| far(pair) < LONGEST)?;
        Some((pair[0].1 + 0.5 * (secs - pair[0].0) / (pair[1].0 - pair[0].0)).rem_euclid(1.0))
    }

    /// When each foot begins and ends to go over from the walk to the clip, and from the clip to the walk, of somebody who comes in and
    /// goes out at these times: as [`Acts::walker_feet`].
    pub fn changes(&self, enter: f64, leave: f64) -> [f64; 8] {
        let mut times = feet_with_body(enter as f32, leave as f32).map(f64::from);
        for (foot, stances) in self.0.iter().enumerate() {
            let airs = || stances.windows(2).map(|w| w[0].end..w[1].start).filter(|air| air.end > air.start);
            let part = |air: &Range<f64>, from: f64, to: f64| air.start.max(from)..air.end.min(to);
            let enough =
                |air: &Range<f64>, whole: &Range<f64>| air.end - air.start >= STILL * (whole.end - whole.start);
            let first = airs().map(|air| (part(&air, enter, leave), air)).find(|(some, air)| enough(some, air));
            let last = airs().map(|air| (part(&air, enter, leave), air)).rfind(|(some, air)| enough(some, air));
            if let (Some((first, _)), Some((last, _))) = (first, last)
                && first.end <= last.start
            {
                times[2 * foot..2 * foot + 2].copy_from_slice(&[first.start, first.end]);
                times[4 + 2 * foot..6 + 2 * foot].copy_from_slice(&[last.start, last.end]);
            }
        }
        times
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Who steps twice a second: the left foot stands from 0 to 0.6 s, the right one from 0.5 to 1.1 s, and so on.
    fn walking() -> Steps {
        let stances = |begin: f64| (0..6).map(|k| begin + f64::from(k)..begin + f64::from(k) + 0.6).collect();
        Steps([stances(0.0), stances(0.5)])
    }

    #[test]
    fn phases_are_those_of_the_walking_cycles() {
        for (secs, wanted) in [(0.3, 0.0), (0.55, 0.25), (0.8, 0.5), (1.05, 0.75), (2.3, 0.0), (0.1, 0.8)] {
            let found = walking().phase(secs).unwrap();
            assert!((found - wanted).abs() < 1e-6, "{found} at {secs}");
        }
        assert_eq!(walking().phase(60.0), None);
    }

    #[test]
    fn feet_go_over_in_the_air() {
        let times = walking().changes(0.1, 5.3);
        let wanted = [0.6, 1.0, 1.1, 1.5, 4.6, 5.0, 4.1, 4.5];
        assert!(times.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-6), "{times:?}");
        // Of the left foot's step too little is left, of the right one's enough.
        let times = walking().changes(0.85, 5.3);
        assert!((times[0] - 1.6).abs() < 1e-6 && (times[2] - 1.1).abs() < 1e-6, "{times:?}");
    }
}
