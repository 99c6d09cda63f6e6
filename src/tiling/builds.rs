//! Builds: everybody gets a body of their own.
//!
//! A crowd is planned with canonical bodies. Here builds are dealt out and motions fitted to them. Where a fitted body
//! cannot reach what it touches, or enters another body, its bones give way towards the canonical ones, in two steps;
//! the canonical body did fit. Girth stays, so that nobody becomes a clone.

use std::sync::Arc;

use glam::Vec2;
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::bake::{Chains, segments_of};
use super::boxes::depth_in;
use super::domain::Spot;
use super::encounters::Encounters;
use super::faults::Haste;
use super::figure::{Figure, Figures, REACH, TOLERANCE, frame_at};
use super::places::Places;
use super::torsos::{Meeting, meetings};
use crate::geom::Cuboid;
use crate::motion::{Build, canonical};
use crate::refine::{Body, Hold, Performance, Segment, fit, holds};
use crate::stage::Prop;

/// Steps from a build to the canonical bones.
const TONES: usize = 3;
/// Joints may turn this much faster than in the captures.
const RUSH: f32 = 1.18;
/// People of one patch may be this much deeper in each other than with canonical bodies, metres.
const TOGETHER: f32 = 0.003;

/// Everybody's build, and their motion fitted to it. Deterministic in `seed`.
pub(super) fn people(
    chains: Chains,
    played: &Performance,
    encounters: &Encounters,
    seed: u64,
) -> Vec<(Arc<Build>, Body)> {
    let mut fitting = Fitting::begin(chains, played, encounters, seed);
    let mut changed = vec![true; played.bodies.len()];
    while changed.contains(&true) {
        let mut clashes = fitting.clashes(&changed);
        clashes.extend(fitting.missed(&changed));
        let bumps = fitting.bumps(&changed);
        changed = fitting.giving_way(&clashes);
        bumps.into_iter().for_each(|p| changed[p] |= fitting.worn[p].tone + 1 < TONES);
        fitting.change(&changed);
    }
    let builds: Vec<Arc<Build>> = (0..changed.len()).map(|p| fitting.build(p).clone()).collect();
    builds.into_iter().zip(fitting.worn).map(|(build, worn)| (build, worn.body)).collect()
}

/// Who wears what so far.
struct Fitting<'a> {
    chains: Chains<'a>,
    props: &'a [Prop],
    /// Everybody's motion with a canonical body.
    bodies: &'a [Body],
    holds: Vec<Vec<Hold>>,
    encounters: &'a Encounters,
    meetings: Vec<Meeting>,
    /// Everybody's build, an index into the catalogue.
    dealt: Vec<usize>,
    worn: Vec<Worn>,
}

/// A build given way by some steps, and the motion fitted to it.
struct Worn {
    tone: usize,
    body: Body,
}

impl<'a> Fitting<'a> {
    fn begin(chains: Chains<'a>, played: &'a Performance, encounters: &'a Encounters, seed: u64) -> Self {
        let Performance { bodies, props, .. } = played;
        let people = 0..bodies.len();
        let holds = people.clone().into_par_iter().map(|p| holds_of(chains, p, &bodies[p])).collect();
        let (meetings, dealt) = (meetings(chains), deal(bodies.len(), seed));
        let mut out = Self { chains, props, bodies, holds, encounters, meetings, dealt, worn: vec![] };
        out.worn = people.into_par_iter().map(|p| out.dress(p, 0)).collect();
        out
    }

    fn build(&self, person: usize) -> &'static Arc<Build> {
        &Build::catalogue()[self.dealt[person]][self.worn[person].tone]
    }

    /// The first step from `tone` on with which a person moves soundly; the last is always worn.
    fn dress(&self, person: usize, tone: usize) -> Worn {
        let wear = |tone: usize| {
            let build = &Build::catalogue()[self.dealt[person]][tone];
            let body = fit(&self.bodies[person], &self.holds[person], build);
            (tone == TONES - 1 || self.is_sound(person, &body, build)).then_some(Worn { tone, body })
        };
        (tone..TONES).find_map(wear).expect("the last tone is always worn")
    }

    fn is_sound(&self, person: usize, body: &Body, build: &Build) -> bool {
        let Chains { library, domain, .. } = self.chains;
        let haste = Haste::new(library, RUSH);
        let spot = |f: usize| Spot::ground(body.begin as i32 + f as i32);
        let near = |f: &usize| !domain.holds(spot(*f), Vec2::new(body.root[*f].x, body.root[*f].z), REACH);
        let figure = |f: usize| Some((f, Figure::of(body, &build.skeleton, (body.begin as usize + f) as i32)?));
        body.strained.len() <= self.bodies[person].strained.len()
            && !(0..body.root.len()).any(|f| haste.is_exceeded(body, f))
            && !(0..body.root.len())
                .filter(near)
                .filter_map(figure)
                .any(|(f, figure)| figure.is_in_wall(domain, spot(f).tick))
    }

    /// Those who change give way one step further.
    fn change(&mut self, changed: &[bool]) {
        let people = (0..changed.len()).into_par_iter().filter(|&p| changed[p]);
        let again: Vec<(usize, Worn)> = people.map(|p| (p, self.dress(p, self.worn[p].tone + 1))).collect();
        again.into_iter().for_each(|(p, worn)| self.worn[p] = worn);
    }

    /// Of every two who clash, the one whose build is farther from the canonical one gives way.
    fn giving_way(&self, clashes: &[(usize, usize)]) -> Vec<bool> {
        let mut changed = vec![false; self.worn.len()];
        for &(a, b) in clashes {
            let (left_a, left_b) = (TONES - 1 - self.worn[a].tone, TONES - 1 - self.worn[b].tone);
            if changed[a] || changed[b] || left_a.max(left_b) == 0 {
                continue;
            }
            changed[if left_a >= left_b { a } else { b }] = true;
        }
        changed
    }

    fn figure(&self, person: usize, tick: i32) -> Option<Figure> {
        Figure::of(&self.worn[person].body, &self.build(person).skeleton, tick)
    }

    fn canonical_figure(&self, person: usize, tick: i32) -> Option<Figure> {
        Figure::of(&self.bodies[person], canonical(), tick)
    }

    /// All pairs, one or both of them changed, whose fitted bodies are in each other where the canonical ones are not.
    fn clashes(&self, changed: &[bool]) -> Vec<(usize, usize)> {
        let of_person = |figures: &mut Figures, p: usize| {
            let (body, bones) = (&self.worn[p].body, &self.build(p).skeleton);
            figures.begin(body.root.len());
            let mut clashes: Vec<(usize, usize)> = Vec::new();
            for (q, tick) in self.encounters.with(p) {
                let is_known = clashes.last().is_some_and(|&(_, last)| last == q);
                if (changed[p] || changed[q])
                    && !is_known
                    && let Some(frame) = frame_at(body, tick)
                    && self.is_clash((p, figures.at(body, bones, frame)), q, tick)
                {
                    clashes.push((p, q));
                }
            }
            clashes
        };
        let people = (0..self.worn.len()).into_par_iter();
        people.map_init(Figures::default, of_person).flatten_iter().collect()
    }

    /// The pairs, one or both of them changed, whose torsos no longer meet.
    fn missed(&self, changed: &[bool]) -> Vec<(usize, usize)> {
        let missed = |m: &&Meeting| {
            m.people.iter().any(|&p| changed[p])
                && m.is_missed(
                    m.people.map(|p| (&self.worn[p].body, &self.build(p).skeleton)),
                    m.people.map(|p| (&self.bodies[p], canonical())),
                )
        };
        self.meetings.iter().filter(missed).map(|m| (m.people[0], m.people[1])).collect()
    }

    fn is_clash(&self, (p, a): (usize, &Figure), q: usize, tick: i32) -> bool {
        let torus = self.chains.domain.torus;
        let Some(b) = self.figure(q, tick) else { return false };
        let depth = a.depth_into(&b.beside(a, torus));
        if depth <= TOLERANCE {
            return false;
        }
        let instance = |p: usize| self.chains.piece_at(p, tick).map(|piece| piece.instance);
        let allowed = if instance(p) == instance(q) { TOGETHER } else { 0.0 };
        match (self.canonical_figure(p, tick), self.canonical_figure(q, tick)) {
            (Some(a), Some(b)) => depth > a.depth_into(&b.beside(&a, torus)) + allowed,
            _ => true,
        }
    }

    /// The changed people whose fitted bodies are deeper in a box than the canonical ones; not those who hold it.
    fn bumps(&self, changed: &[bool]) -> Vec<usize> {
        let at_tick = |places: &mut Places, tick: i32| -> Vec<usize> {
            let here: Vec<(&Prop, Cuboid)> =
                self.props.iter().filter_map(|prop| Some((prop, prop.at_frame(tick as u32)?))).collect();
            if here.is_empty() {
                return vec![];
            }
            places.look(tick..=tick, self.worn.iter().map(|w| &w.body), self.chains.domain.torus, 2.0 * REACH);
            let near = |(prop, cuboid): &(&Prop, Cuboid)| {
                let near = places.near(cuboid.at.ground().position, REACH + cuboid.radius());
                let strangers = near.filter(|&p| changed[p] && prop.holders(tick as u32).all(|h| h != p as u32));
                strangers.filter(|&p| self.is_bump(p, cuboid, tick)).collect::<Vec<_>>()
            };
            here.iter().flat_map(near).collect()
        };
        let ticks = self.chains.domain.frames().into_par_iter();
        let mut all: Vec<usize> = ticks.map_init(Places::default, at_tick).flatten_iter().collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    fn is_bump(&self, person: usize, cuboid: &Cuboid, tick: i32) -> bool {
        let Some(now) = self.figure_near(person, tick, cuboid) else { return false };
        let depth = depth_in(cuboid, &now.capsules);
        let canonical = |then: Figure| depth > depth_in(cuboid, &then.capsules) + TOGETHER;
        depth > TOLERANCE && self.canonical_figure(person, tick).is_none_or(canonical)
    }

    /// A person at a tick who may touch a box.
    fn figure_near(&self, person: usize, tick: i32, cuboid: &Cuboid) -> Option<Figure> {
        let away = |f: &Figure| cuboid.at.ground().position.distance(f.center);
        self.figure(person, tick).filter(|f| away(f) < cuboid.radius() + f.radius)
    }
}

/// Index of everybody's build in the catalogue: shuffled rounds of all builds, never the same twice in a row.
fn deal(people: usize, seed: u64) -> Vec<usize> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(1);
    let kinds = Build::catalogue().len();
    let mut dealt: Vec<usize> = Vec::with_capacity(people + kinds);
    while dealt.len() < people {
        let mut round: Vec<usize> = (0..kinds).collect();
        round.shuffle(&mut rng);
        if dealt.last() == round.first() {
            let other = rng.random_range(1..kinds);
            round.swap(0, other);
        }
        dealt.extend(round);
    }
    dealt.truncate(people);
    dealt
}

fn holds_of(chains: Chains, person: usize, body: &Body) -> Vec<Hold> {
    let uses = segments_of(chains, person);
    let segments: Vec<_> = uses.iter().map(|(kind, placed)| Segment { kind, placed }).collect();
    holds(&segments, body.begin)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_in_number_differ_and_every_build_is_as_frequent() {
        for seed in 0..50 {
            let dealt = deal(80, seed);
            assert!(dealt.windows(2).all(|w| w[0] != w[1]), "seed {seed}: {dealt:?}");
            for kind in 0..Build::catalogue().len() {
                assert_eq!(dealt.iter().filter(|&&d| d == kind).count(), 10, "seed {seed}, build {kind}");
            }
        }
        assert_ne!(deal(80, 1), deal(80, 2));
        assert_eq!(deal(80, 1), deal(80, 1));
    }
}
