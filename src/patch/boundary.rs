//! Where patches can begin and end: frames whose poses are near a pose group's exemplar (paper section 4.2 in small).
//!
//! The paper clusters all frames and looks for the fewest groups that serve all patches. Here the groups are known
//! beforehand, mid-stance of either foot and standing ([`gait`]), because those recur in every capture of people on
//! foot; each group is stood for by its medoid, and boundaries are the frames nearest to one.

use std::ops::RangeInclusive;

use glam::Vec3;

use crate::motion::gait::{self, GaitOptions, Phase};
use crate::motion::{Motion, mirror, pose};

/// Frames before and after one that count in comparing poses, so that speeds count as well (0.07 s each way).
const HALF_WINDOW: usize = 2;

/// The pose that stands for a group.
#[derive(Clone, Debug)]
pub struct Exemplar {
    /// Which group.
    pub phase: Phase,
    /// The body's points over a short window, see [`pose::window`].
    cloud: Vec<Vec3>,
}

/// A frame at which a patch may begin or end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boundary {
    /// Frame of the motion.
    pub frame: usize,
    /// The group its pose belongs to.
    pub phase: Phase,
    /// Distance to the group's exemplar, metres (see [`pose::window_distance`]).
    pub distance: f32,
}

/// The exemplars of all groups that occur in the motions: of all [`gait::moments`], and their mirror images, the one
/// with the smallest sum of distances to the others. The exemplars of the two feet are each other's mirror images.
/// Of long stands every tenth frame is looked at. O(moments squared).
pub fn exemplars(motions: &[Motion]) -> Vec<Exemplar> {
    let mut clouds: Vec<(Phase, Vec<Vec3>)> = Vec::new();
    let mirrored: Vec<Motion> = motions.iter().map(mirror::motion).collect();
    for motion in motions.iter().chain(&mirrored) {
        for m in gait::moments(motion, &GaitOptions::default()) {
            if m.phase == Phase::WalkLeft || (m.phase == Phase::Stand && m.frame % 10 == 0) {
                clouds.push((m.phase, pose::window(motion, m.frame, HALF_WINDOW)));
            }
        }
    }
    let mut found = Vec::new();
    if let Some(cloud) = medoid(&clouds, Phase::WalkLeft) {
        found.push(Exemplar { phase: Phase::WalkRight, cloud: mirror::cloud(&cloud) });
        found.push(Exemplar { phase: Phase::WalkLeft, cloud });
    }
    found.extend(medoid(&clouds, Phase::Stand).map(|cloud| Exemplar { phase: Phase::Stand, cloud }));
    found.sort_by_key(|e| e.phase);
    found
}

fn medoid(clouds: &[(Phase, Vec<Vec3>)], phase: Phase) -> Option<Vec<Vec3>> {
    let own = || clouds.iter().filter(|(p, _)| *p == phase).map(|(_, c)| c);
    let sum = |c: &Vec<Vec3>| own().map(|other| pose::cloud_distance(c, other)).sum::<f32>();
    own().map(|c| (sum(c), c)).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, c)| c.clone())
}

/// Distance in metres of a frame's pose to an exemplar.
pub fn distance(motion: &Motion, frame: usize, exemplar: &Exemplar) -> f32 {
    pose::cloud_distance(&exemplar.cloud, &pose::window(motion, frame, HALF_WINDOW))
}

/// The frame in `frames` (clamped to the motion) whose pose is nearest to any of the exemplars; `None` where there is
/// no frame or no exemplar.
pub fn nearest(motion: &Motion, frames: RangeInclusive<usize>, exemplars: &[Exemplar]) -> Option<Boundary> {
    let last = motion.len().checked_sub(1)?;
    let candidates = (*frames.start()..=last.min(*frames.end())).flat_map(|frame| {
        exemplars.iter().map(move |e| Boundary { frame, phase: e.phase, distance: distance(motion, frame, e) })
    });
    candidates.min_by(|a, b| a.distance.total_cmp(&b.distance))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::testing::{standing, walking};

    #[test]
    fn every_group_has_an_exemplar_near_its_own_poses_only() {
        let (walk, stand) = (walking(4.0), standing(1.0));
        let exemplars = exemplars(&[walk.clone(), stand.clone()]);
        assert_eq!(
            exemplars.iter().map(|e| e.phase).collect::<Vec<_>>(),
            [Phase::WalkLeft, Phase::WalkRight, Phase::Stand]
        );
        for m in gait::moments(&walk, &GaitOptions::default()) {
            let found = nearest(&walk, m.frame..=m.frame, &exemplars).unwrap();
            assert_eq!(found.phase, m.phase);
            assert!(found.distance < 0.03, "{found:?}");
        }
        assert_eq!(nearest(&stand, 0..=99, &exemplars).unwrap().phase, Phase::Stand);
        let far: Vec<f32> = exemplars.iter().map(|e| distance(&stand, 15, e)).collect();
        assert!(far[2] < 1e-4 && far[0] > 0.05 && far[1] > 0.05, "{far:?}");
    }

    #[test]
    fn nothing_is_near_where_there_is_nothing() {
        let exemplars = exemplars(&[standing(1.0)]);
        assert_eq!(exemplars.len(), 1);
        assert!(nearest(&standing(1.0), 500..=600, &exemplars).is_none());
        assert!(nearest(&Motion::default(), 0..=10, &exemplars).is_none());
        assert!(nearest(&standing(1.0), 0..=10, &[]).is_none());
    }
}
