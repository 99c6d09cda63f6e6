//! Encounters: who comes so near to whom, and when, that their bodies are to be tested against each other.
//!
//! They are found from few moments, since between two of them nobody gets far, and kept person by person: somebody's
//! motion lies together in memory, what everybody does at one moment does not.

use std::ops::RangeInclusive;

use glam::Vec2;
use rayon::prelude::*;

use super::domain::Domain;
use super::figure::{Figure, frame_at};
use super::places::Places;
use crate::geom::Torus;
use crate::motion::canonical;
use crate::refine::Body;

/// No part of a body of any build is farther than this from the same part of the canonical body who does the same, metres.
const OUTGROWN: f32 = 0.18;
/// Bodies come nearer than this, metres: whoever is farther from another is so with any build.
const GAP: f32 = 2.0 * OUTGROWN;
/// Ticks before and after each moment that is looked at until the next one's begin.
const AROUND: i32 = 4;

/// Encounters of people with canonical bodies.
#[derive(Default)]
pub(super) struct Encounters {
    /// How far each body reaches from its hips on the ground, frame by frame, metres.
    reaches: Vec<Vec<f32>>,
    /// Whom with larger numbers somebody is near, and at which ticks, sorted.
    near: Vec<Vec<(u32, i32)>>,
    /// The largest of all reaches, and the longest step of anybody's hips, metres.
    widest: f32,
    longest_step: f32,
}

impl Encounters {
    /// Everybody's. O(ticks x people), in parallel.
    pub fn of(bodies: &[Body], domain: &Domain) -> Self {
        let none = || vec![vec![]; bodies.len()];
        let mut encounters = Self { reaches: vec![vec![]; bodies.len()], near: none(), ..Self::default() };
        encounters.renew(bodies, domain, &vec![true; bodies.len()]);
        encounters
    }

    /// Somebody's with people of larger numbers: theirs, and the tick; sorted.
    pub fn with(&self, person: usize) -> impl Iterator<Item = (usize, i32)> + '_ {
        self.near[person].iter().map(|&(other, tick)| (other as usize, tick))
    }

    /// Again for those who move in a new way; people must not have come or gone.
    pub fn renew(&mut self, bodies: &[Body], domain: &Domain, is_new: &[bool]) {
        self.measure(bodies, is_new);
        for (near, &new) in self.near.iter_mut().zip(is_new) {
            near.retain(|&(other, _)| !new && !is_new[other as usize]);
        }
        let frames = domain.frames();
        let moments: Vec<i32> = (frames.start + AROUND..frames.end + AROUND).step_by(2 * AROUND as usize + 1).collect();
        let around = |places: &mut Places, &moment: &i32| {
            let ticks = moment - AROUND..=(moment + AROUND).min(frames.end - 1);
            self.found_in(places, bodies, domain.torus, is_new, ticks)
        };
        let found: Vec<Vec<(u32, u32, i32)>> = moments.par_iter().map_init(Places::default, around).collect();
        found.into_iter().flatten().for_each(|(a, b, tick)| self.near[a as usize].push((b, tick)));
        self.near.par_iter_mut().for_each(|near| {
            near.sort_unstable();
            near.dedup();
        });
    }

    fn measure(&mut self, bodies: &[Body], is_new: &[bool]) {
        let reach = |body: &Body, frame: usize| Figure::at(body, canonical(), frame).radius;
        let new = self.reaches.par_iter_mut().zip(bodies).zip(is_new).filter(|(_, new)| **new);
        let [widest, longest] = new
            .map(|((reaches, body), _)| {
                *reaches = (0..body.root.len()).map(|frame| reach(body, frame)).collect();
                let step = |pair: &[glam::Vec3]| pair[0].distance(pair[1]);
                let longest = body.root.windows(2).map(step).fold(0.0, f32::max);
                [reaches.iter().copied().fold(0.0, f32::max), longest]
            })
            .reduce(|| [0.0; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])]);
        (self.widest, self.longest_step) = (self.widest.max(widest), self.longest_step.max(longest));
    }

    /// Encounters over some ticks, somebody new in each.
    fn found_in(
        &self,
        places: &mut Places,
        bodies: &[Body],
        torus: Torus,
        is_new: &[bool],
        ticks: RangeInclusive<i32>,
    ) -> Vec<(u32, u32, i32)> {
        let mut found = Vec::new();
        let reach = 2.0 * (self.widest + AROUND as f32 * self.longest_step) + GAP;
        places.look(ticks.clone(), bodies.iter(), torus, reach);
        places.pairs(reach, |a, b| {
            if is_new[a] || is_new[b] {
                let (a, b) = (a.min(b), a.max(b));
                let near = ticks.clone().filter(|&tick| self.are_near(bodies, [a, b], tick, torus, GAP));
                found.extend(near.map(|tick| (a as u32, b as u32, tick)));
            }
        });
        found
    }

    /// True if two people may be nearer to each other than `gap` at a tick: the discs around them are.
    pub fn are_near(&self, bodies: &[Body], people: [usize; 2], tick: i32, torus: Torus, gap: f32) -> bool {
        let place = |person: usize| {
            let (body, reaches) = (&bodies[person], &self.reaches[person]);
            let frame = frame_at(body, tick)?;
            Some((Vec2::new(body.root[frame].x, body.root[frame].z), reaches[frame]))
        };
        let [a, b] = people.map(place);
        a.zip(b).is_some_and(|((a, reach_a), (b, reach_b))| {
            let reach = reach_a + reach_b + gap;
            torus.nearest(a - b).length_squared() < reach * reach
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::joint::*;
    use crate::motion::{Build, JOINT_COUNT, Motion, testing};
    use crate::refine::fit;
    use crate::refine::testing::body;
    use crate::tiling::Scene;
    use glam::{Quat, Vec3};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Somebody who stands with the arms turned by an angle: half a turn upwards is straight up.
    fn with_arms_up(angle: f32) -> Motion {
        let mut motion = testing::standing(1.0);
        for pose in motion.rotations.chunks_exact_mut(JOINT_COUNT) {
            pose[LEFT_ARM] = Quat::from_rotation_z(angle);
            pose[RIGHT_ARM] = Quat::from_rotation_z(-angle);
        }
        motion
    }

    #[test]
    fn no_build_outgrows_the_canonical_body_by_more_than_is_looked_for() {
        let mut motions = vec![testing::walking(4.0)];
        motions.extend([-1.5, 0.0, 0.8, 1.4].map(with_arms_up));
        let mut farthest = 0.0f32;
        for original in motions.iter().map(body) {
            for build in Build::catalogue().iter().flatten() {
                let fitted = fit(&original, &[], build);
                for frame in 0..original.root.len() {
                    let was = Figure::at(&original, canonical(), frame);
                    let is = Figure::at(&fitted, &build.skeleton, frame);
                    let away = |ends: (Vec3, Vec3)| ends.0.distance(ends.1);
                    let parts = was.capsules.iter().zip(&is.capsules);
                    farthest = parts.map(|(p, q)| away((p.a, q.a)).max(away((p.b, q.b)))).fold(farthest, f32::max);
                }
            }
        }
        assert!(farthest > 0.1 && farthest < OUTGROWN, "{farthest}");
    }

    /// People who walk from somewhere at some time, some of them for a moment only.
    fn walkers(rng: &mut ChaCha8Rng) -> Vec<Body> {
        let walk = body(&testing::walking(9.0));
        let walker = |_| {
            let by = Vec3::new(rng.random_range(0.0..7.0), 0.0, rng.random_range(0.0..7.0));
            let turn = Quat::from_rotation_y(rng.random_range(-3.0..3.0));
            let frames = rng.random_range(2..walk.root.len());
            let mut body = Body { begin: rng.random_range(0..300), ..walk.clone() };
            body.root.truncate(frames);
            body.rotations.truncate(frames * JOINT_COUNT);
            body.root.iter_mut().for_each(|p| *p = by + turn * *p);
            body.rotations.iter_mut().step_by(JOINT_COUNT).for_each(|q| *q = turn * *q);
            body
        };
        (0..60).map(walker).collect()
    }

    /// Between the surfaces of two bodies, metres.
    fn distance(a: &Figure, b: &Figure) -> f32 {
        let pairs = a.capsules.iter().flat_map(|p| b.capsules.iter().map(move |q| (p, q)));
        pairs.map(|(p, q)| p.between(q).length() - p.radius - q.radius).fold(f32::INFINITY, f32::min)
    }

    fn all(encounters: &Encounters) -> Vec<(usize, usize, i32)> {
        let of = |a: usize| encounters.with(a).map(move |(b, tick)| (a, b, tick));
        (0..encounters.near.len()).flat_map(of).collect()
    }

    #[test]
    fn all_encounters_are_found_whoever_moves_in_a_new_way() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for periodic in ["", "periodic = [\"x\", \"z\"]"] {
            let text =
                format!("region = [[0, 0], [7, 0], [7, 7], [0, 7]]\nduration_secs = 10\ncharacters = 1\n{periodic}\n");
            let scene = Scene::from_toml(&text).unwrap();
            let domain = Domain::new(&scene).unwrap();
            let mut bodies = walkers(&mut rng);
            let mut encounters = Encounters::of(&bodies, &domain);
            for round in 0..3 {
                let figure =
                    |p: usize, tick: i32| Some(Figure::at(&bodies[p], canonical(), frame_at(&bodies[p], tick)?));
                let (mut expected, found) = (Vec::new(), all(&encounters));
                for (a, b) in (0..bodies.len()).flat_map(|a| (a + 1..bodies.len()).map(move |b| (a, b))) {
                    for tick in domain.frames() {
                        if let (Some(p), Some(q)) = (figure(a, tick), figure(b, tick))
                            && distance(&p, &q.beside(&p, domain.torus)) < GAP
                        {
                            expected.push((a, b, tick));
                        }
                    }
                }
                assert!(expected.len() > 500, "{}", expected.len());
                assert!(expected.iter().all(|e| found.binary_search(e).is_ok()), "round {round} {periodic}");
                assert!(found.len() < 4 * expected.len(), "{} for {}", found.len(), expected.len());
                let is_new: Vec<bool> = (0..bodies.len()).map(|p| p % 5 == round).collect();
                let others = walkers(&mut rng);
                (0..bodies.len()).filter(|&p| is_new[p]).for_each(|p| bodies[p] = others[p].clone());
                encounters.renew(&bodies, &domain, &is_new);
            }
        }
    }
}
