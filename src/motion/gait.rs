//! Recurring poses at which motion can be cut: mid-stance of a walk, and standing still.
//!
//! Mid-stance is the moment at which the swinging leg passes the planted one. It is found more sharply than heel
//! strikes, both feet's plants are clear of it, and its poses differ little between walks.

use glam::{Vec2, Vec3};

use super::skeleton::{JOINT_COUNT, joint};
use super::{FPS, Foot, Motion, plants};
use crate::geom::Turn;

/// What recurs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Phase {
    /// The left foot is planted, the right leg swings past it.
    WalkLeft,
    /// The right foot is planted, the left leg swings past it.
    WalkRight,
    /// Standing upright and still on both feet.
    Stand,
}

impl Phase {
    /// The pose group's name in take files.
    pub fn group(self) -> &'static str {
        match self {
            Self::WalkLeft => "walk_left",
            Self::WalkRight => "walk_right",
            Self::Stand => "stand",
        }
    }

    /// The phase seen in a mirror.
    pub fn mirrored(self) -> Self {
        match self {
            Self::WalkLeft => Self::WalkRight,
            Self::WalkRight => Self::WalkLeft,
            Self::Stand => Self::Stand,
        }
    }
}

/// A frame at which a phase is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Frame of the motion.
    pub frame: usize,
    /// What is reached.
    pub phase: Phase,
}

/// What counts as walking and as standing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaitOptions {
    /// Slowest walk, metres per second of the hips at mid-stance; default 0.45.
    pub min_speed: f32,
    /// Fastest; default 2.2 (running has other poses).
    pub max_speed: f32,
    /// Standing: the hips move slower than this, m/s; default 0.12.
    pub still_hips: f32,
    /// Standing: hands and head move slower than this, m/s; default 0.35.
    pub still_hands: f32,
    /// Standing: the ankles are at most this far apart, metres; default 0.45.
    pub max_stance: f32,
}

impl Default for GaitOptions {
    fn default() -> Self {
        Self { min_speed: 0.45, max_speed: 2.2, still_hips: 0.12, still_hands: 0.35, max_stance: 0.45 }
    }
}

/// All mid-stances and standing frames of a motion with foot plants, sorted by frame. Standing counts at every frame,
/// a mid-stance at the one nearest to it. O(frames).
pub fn moments(motion: &Motion, options: &GaitOptions) -> Vec<Moment> {
    let joints = Joints::of(motion);
    let mut found = Vec::new();
    for frame in 1..motion.len() {
        for (foot, phase) in [(Foot::Left, Phase::WalkLeft), (Foot::Right, Phase::WalkRight)] {
            found.extend(joints.passing(motion, foot, frame, options).map(|frame| Moment { frame, phase }));
        }
    }
    let stands = (0..motion.len()).filter(|&f| joints.standing(motion, f, options));
    found.extend(stands.map(|frame| Moment { frame, phase: Phase::Stand }));
    found.sort_by_key(|m| (m.frame, m.phase));
    found.dedup();
    found
}

/// Positions of all joints, frame-major.
struct Joints(Vec<Vec3>);

impl Joints {
    fn of(motion: &Motion) -> Self {
        let mut globals = Vec::with_capacity(JOINT_COUNT);
        let mut all = Vec::with_capacity(motion.len() * JOINT_COUNT);
        for frame in 0..motion.len() {
            motion.globals(frame, &mut globals);
            all.extend(globals.iter().map(|g| g.0));
        }
        Self(all)
    }

    fn at(&self, frame: usize, joint: usize) -> Vec3 {
        self.0[frame * JOINT_COUNT + joint]
    }

    fn speed(&self, motion: &Motion, frame: usize, joint: usize) -> f32 {
        let (a, b) = (frame.saturating_sub(2), (frame + 2).min(motion.len() - 1));
        (self.at(b, joint) - self.at(a, joint)).length() * FPS / (b - a).max(1) as f32
    }

    /// How far the swinging ankle is ahead of the planted one, along the path's heading.
    fn lead(&self, motion: &Motion, planted: Foot, frame: usize) -> f32 {
        let (stance, swing) = match planted {
            Foot::Left => (joint::LEFT_FOOT, joint::RIGHT_FOOT),
            Foot::Right => (joint::RIGHT_FOOT, joint::LEFT_FOOT),
        };
        let gap = self.at(frame, swing) - self.at(frame, stance);
        Turn::from_angle(-motion.path.headings[frame]).apply(Vec2::new(gap.x, gap.z)).y
    }

    /// The frame nearest to a pass of the other leg between `frame - 1` and `frame`, if there is one.
    fn passing(&self, motion: &Motion, planted: Foot, frame: usize, options: &GaitOptions) -> Option<usize> {
        let (before, after) = (self.lead(motion, planted, frame - 1), self.lead(motion, planted, frame));
        let swings = before < 0.0 && after >= 0.0;
        let here = if -before < after { frame - 1 } else { frame };
        let speed = self.speed(motion, here, joint::HIPS);
        let walks = (options.min_speed..options.max_speed).contains(&speed);
        let other = super::mirror::foot(planted);
        let alone = plants::is_planted(motion, planted, here) && !plants::is_planted(motion, other, here);
        (swings && walks && alone).then_some(here)
    }

    fn standing(&self, motion: &Motion, frame: usize, options: &GaitOptions) -> bool {
        use joint::*;
        let planted = [Foot::Left, Foot::Right].iter().all(|&foot| plants::is_planted(motion, foot, frame));
        let slow = |j: usize, limit: f32| self.speed(motion, frame, j) < limit;
        let stance = self.at(frame, LEFT_FOOT).distance(self.at(frame, RIGHT_FOOT));
        let upright = motion.heights[frame] > 0.85 && self.at(frame, HEAD).y > 1.4;
        let arms_down = [LEFT_HAND, RIGHT_HAND].iter().all(|&hand| self.at(frame, hand).y < 1.1);
        planted
            && upright
            && arms_down
            && stance < options.max_stance
            && slow(HIPS, options.still_hips)
            && [HEAD, LEFT_HAND, RIGHT_HAND].iter().all(|&j| slow(j, options.still_hands))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::testing::{standing, walking};

    #[test]
    fn a_walk_has_alternating_mid_stances_and_no_stand() {
        let moments = moments(&walking(4.0), &GaitOptions::default());
        assert!((6..=8).contains(&moments.len()), "{moments:?}");
        for pair in moments.windows(2) {
            assert_ne!(pair[0].phase, pair[1].phase);
            let step = pair[1].frame - pair[0].frame;
            assert!((15..=17).contains(&step), "a step of {step} frames, expected 16: {moments:?}");
        }
        assert!(moments.iter().all(|m| m.phase != Phase::Stand));
    }

    #[test]
    fn someone_who_stands_stands_at_every_frame() {
        let found = moments(&standing(1.0), &GaitOptions::default());
        assert_eq!(found.len(), 31);
        assert!(found.iter().all(|m| m.phase == Phase::Stand));
    }

    #[test]
    fn the_mirror_image_swaps_sides() {
        let walk = walking(3.0);
        let moments_of = |m: &Motion| moments(m, &GaitOptions::default());
        let (one, other) = (moments_of(&walk), moments_of(&crate::motion::mirror(&walk)));
        assert_eq!(one.len(), other.len());
        for (a, b) in one.iter().zip(&other) {
            assert_eq!(a.frame, b.frame);
            assert_ne!(a.phase, b.phase);
        }
    }
}
