//! Pose groups: the recurring poses among all candidates of a collection and their images in a mirror.

use rayon::prelude::*;

use super::candidates::{Candidate, FASTEST_REST, SLOWEST_STEP, candidates};
use super::cloud::Cloud;
use super::cluster::{Distances, groups};
use super::{BoundaryOptions, Moment};
use crate::motion::Motion;
use crate::motion::gait::Phase;

/// A recurring pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Where it occurs; no two of its poses are farther apart than the threshold.
    pub members: Vec<Moment>,
    /// The pose in their middle.
    middle: Cloud,
    /// What they are.
    pub phase: Phase,
    /// The group of its poses' images in a mirror; itself where left and right do not matter.
    pub twin: usize,
}

impl Group {
    /// Whether a pose, at which the hips have this speed in m/s, could be a member.
    pub(super) fn admits(&self, cloud: &Cloud, speed: f32, radius: f32) -> bool {
        let speeds = if self.phase == Phase::Stand { 0.0..FASTEST_REST } else { SLOWEST_STEP..f32::INFINITY };
        speeds.contains(&speed) && self.middle.distance(cloud) < radius
    }
}

/// Candidates of a collection: where, and which phase of a step.
pub(super) struct Pool {
    pub at: Vec<(Moment, Phase)>,
}

impl Pool {
    /// At most `most` candidates: of longer collections the rests are thinned out, and then everything.
    pub fn new(takes: &[&[Motion]], quiet: &[Vec<Vec<bool>>], most: usize) -> Self {
        let mut sparse = 1;
        let mut at = Self::gather(takes, quiet, sparse);
        while at.len() > most && sparse < 64 {
            sparse *= 2;
            at = Self::gather(takes, quiet, sparse);
        }
        let step = at.len().div_ceil(most.max(1)).max(1);
        Self { at: at.into_iter().step_by(step).collect() }
    }

    fn gather(takes: &[&[Motion]], quiet: &[Vec<Vec<bool>>], sparse: usize) -> Vec<(Moment, Phase)> {
        let mut all = Vec::new();
        for (take, people) in takes.iter().enumerate() {
            for (person, motion) in people.iter().enumerate() {
                let found = candidates(motion, &quiet[take][person], sparse);
                all.extend(found.iter().map(|&Candidate { frame, phase }| (Moment { take, person, frame }, phase)));
            }
        }
        all
    }

    /// The largest groups, at most `options.groups`, each followed by its twin.
    ///
    /// Clusters are where poses recur; a group is all candidates within half the threshold of its cluster's middle, so
    /// that no two of them are farther apart than the threshold, and a pose near two clusters serves both.
    pub fn largest(&self, takes: &[&[Motion]], options: &BoundaryOptions) -> Vec<Group> {
        let pair = |(m, _): &(Moment, Phase)| Cloud::pair(&takes[m.take][m.person], m.frame);
        let clouds: Vec<[Cloud; 2]> = self.at.par_iter().map(pair).collect();
        let count = clouds.len();
        // Poses of different phases never are one group: what is a step to one is a rest to the other.
        let between = |i: usize, j: usize, phase: Phase, image: usize| match self.at[i].1 == phase {
            true => clouds[i][0].distance(&clouds[j][image]),
            false => f32::INFINITY,
        };
        let own = |i: usize, j: usize| between(i, j, self.at[j].1, 0);
        let distances = Distances::with_images(count, own, |i, j| between(i, j, self.at[j].1.mirrored(), 1));
        let clusters = groups(distances.clone(), options.threshold);
        let mut balls: Vec<Ball> = Vec::new();
        for members in &clusters {
            let middle = middle(members, &distances);
            for middle in [middle, image(middle, count)] {
                balls.push(Ball { middle, members: distances.within(middle, 0.5 * options.threshold) });
            }
        }
        self.pick(balls, &clouds, &distances, options)
    }

    /// The largest balls with their images, as long as there is room for both; none whose middle is in one before.
    fn pick(
        &self,
        mut balls: Vec<Ball>,
        clouds: &[[Cloud; 2]],
        distances: &Distances,
        options: &BoundaryOptions,
    ) -> Vec<Group> {
        let radius = 0.5 * options.threshold;
        balls.sort_by_key(|b| (std::cmp::Reverse(b.members.len()), b.middle));
        let mut groups: Vec<Group> = Vec::new();
        let mut middles: Vec<usize> = Vec::new();
        for ball in balls {
            let image = image(ball.middle, self.at.len());
            let own_image = distances.at(ball.middle, image) < radius;
            let known = middles.iter().any(|&m| distances.at(m, ball.middle) < radius);
            let room = groups.len() + if own_image { 1 } else { 2 } <= options.groups;
            if known || !room {
                continue;
            }
            let next = groups.len();
            middles.push(ball.middle);
            if own_image {
                groups.push(self.group(&ball, next, clouds));
            } else {
                middles.push(image);
                let twin = Ball { middle: image, members: distances.within(image, radius) };
                groups.extend([self.group(&ball, next + 1, clouds), self.group(&twin, next, clouds)]);
            }
        }
        groups
    }

    fn group(&self, ball: &Ball, twin: usize, clouds: &[[Cloud; 2]]) -> Group {
        let count = self.at.len();
        let own = ball.members.iter().filter(|&&i| i < count);
        Group {
            members: own.map(|&i| self.at[i].0).collect(),
            middle: clouds[ball.middle % count][ball.middle / count].clone(),
            phase: self.phase(ball.middle),
            twin,
        }
    }

    /// The phase of a candidate, or of the image of one.
    fn phase(&self, i: usize) -> Phase {
        let phase = self.at[i % self.at.len()].1;
        if i < self.at.len() { phase } else { phase.mirrored() }
    }
}

/// Candidates and images around one of them.
struct Ball {
    middle: usize,
    members: Vec<usize>,
}

/// The member with the least sum of distances to all.
fn middle(members: &[usize], distances: &Distances) -> usize {
    let sum = |i: usize| members.iter().map(|&j| distances.at(i, j)).sum::<f32>();
    let sums = members.iter().map(|&i| (sum(i), i));
    sums.min_by(|a, b| a.0.total_cmp(&b.0)).expect("clusters have members").1
}

fn image(i: usize, count: usize) -> usize {
    (i + count) % (2 * count)
}
