//! Builds: everybody gets a body of their own.
//!
//! A crowd is planned with canonical bodies. Here builds are dealt out and motions fitted to them. Where a fitted body
//! cannot reach what it touches, or enters another body, its bones give way towards the canonical ones, in two steps;
//! the canonical body did fit. Girth stays, so that nobody becomes a clone.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::bake::{Chains, segments_of};
use super::boxes::depth_in;
use super::domain::Domain;
use super::library::Library;
use crate::geom::{Capsule, Cuboid};
use crate::motion::{Build, JOINT_COUNT, body_capsules};
use crate::patch::turn_between;
use crate::refine::{Body, Hold, Segment, fit, holds};
use crate::stage::Prop;

/// Steps from a build to the canonical bones.
const TONES: usize = 3;
/// Joints may turn this much faster than in the captures.
const RUSH: f32 = 1.18;
/// No body reaches further from its hips than this, metres.
const REACH: f32 = 1.1;
/// Interpenetration that is let pass, metres.
const TOLERANCE: f32 = 0.005;
/// People of one patch may be this much deeper in each other than with canonical bodies, metres.
const TOGETHER: f32 = 0.003;

/// Everybody's build, and their motion fitted to it. Deterministic in `seed`.
pub(super) fn people(chains: Chains, bodies: Vec<Body>, props: &[Prop], seed: u64) -> Vec<(Arc<Build>, Body)> {
    let dealt = deal(bodies.len(), seed);
    let holds: Vec<Vec<Hold>> = (0..bodies.len()).into_par_iter().map(|p| holds_of(chains, p, &bodies[p])).collect();
    let dress = |p: usize, tone: usize| {
        let wearable = |&tone: &usize| {
            let build = &Build::catalogue()[dealt[p]][tone];
            let body = fit(&bodies[p], &holds[p], build);
            let sound = body.strained.len() <= bodies[p].strained.len()
                && !rushes(&body, chains.library)
                && !in_wall(&body, build, chains.domain);
            (tone == TONES - 1 || sound).then_some((tone, body))
        };
        (tone..TONES).find_map(|tone| wearable(&tone)).expect("the last tone is always worn")
    };
    let mut fitted: Vec<(usize, Body)> = (0..bodies.len()).into_par_iter().map(|p| dress(p, 0)).collect();
    let mut changed = vec![true; bodies.len()];
    while changed.contains(&true) {
        let clashes = clashes(chains, &bodies, &fitted, &dealt, &changed);
        let bumps = bumps(&bodies, props, &fitted, &dealt, &changed);
        changed = giving_way(&clashes, &fitted);
        bumps.into_iter().for_each(|p| changed[p] |= fitted[p].0 + 1 < TONES);
        let again: Vec<(usize, (usize, Body))> =
            (0..bodies.len()).into_par_iter().filter(|&p| changed[p]).map(|p| (p, dress(p, fitted[p].0 + 1))).collect();
        again.into_iter().for_each(|(p, dressed)| fitted[p] = dressed);
    }
    let build = |p: usize, tone: usize| Build::catalogue()[dealt[p]][tone].clone();
    fitted.into_iter().enumerate().map(|(p, (tone, body))| (build(p, tone), body)).collect()
}

/// True if a joint turns faster than in the captures, with some allowance.
fn rushes(body: &Body, library: &Library) -> bool {
    (1..body.root.len()).any(|f| {
        let (before, now) = (body.pose(f - 1), body.pose(f));
        (0..JOINT_COUNT).any(|j| turn_between(before[j], now[j]) > RUSH * library.fastest[j])
    })
}

/// True if a limb is ever in a wall.
fn in_wall(body: &Body, build: &Build, domain: &Domain) -> bool {
    let inside = |p: Vec3, radius: f32| domain.holds(Vec2::new(p.x, p.z), radius - TOLERANCE);
    let near = |f: &usize| !domain.holds(Vec2::new(body.root[*f].x, body.root[*f].z), REACH);
    (0..body.root.len()).filter(near).any(|f| {
        let shape = Shape::new(0, body, build, body.begin as i32 + f as i32).expect("a frame of the body");
        // Bones are so short that three discs each are as good as the whole.
        let free = |c: &Capsule| [0.0, 0.5, 1.0].into_iter().all(|t| inside(c.a.lerp(c.b, t), c.radius));
        !shape.capsules.iter().all(free)
    })
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

/// Of every two who clash, the one whose build is farther from the canonical one gives way.
fn giving_way(clashes: &[(usize, usize)], fitted: &[(usize, Body)]) -> Vec<bool> {
    let mut changed = vec![false; fitted.len()];
    for &(a, b) in clashes {
        let (left_a, left_b) = (TONES - 1 - fitted[a].0, TONES - 1 - fitted[b].0);
        if changed[a] || changed[b] || left_a.max(left_b) == 0 {
            continue;
        }
        changed[if left_a >= left_b { a } else { b }] = true;
    }
    changed
}

/// All pairs, one or both of them changed, whose fitted bodies are in each other where the canonical ones are not.
fn clashes(
    chains: Chains,
    bodies: &[Body],
    fitted: &[(usize, Body)],
    dealt: &[usize],
    changed: &[bool],
) -> Vec<(usize, usize)> {
    let at_tick = |tick: i32| -> Vec<(usize, usize)> {
        let mut shapes = present(bodies, fitted, dealt, tick);
        shapes.sort_by(|a, b| a.left().total_cmp(&b.left()).then(a.person.cmp(&b.person)));
        let mut pairs = Vec::new();
        for (i, a) in shapes.iter().enumerate() {
            for b in shapes[i + 1..].iter().take_while(|b| b.left() < a.center.x + a.radius) {
                if (changed[a.person] || changed[b.person]) && clash(chains, bodies, a, b, tick) {
                    pairs.push((a.person.min(b.person), a.person.max(b.person)));
                }
            }
        }
        pairs
    };
    let mut all: Vec<(usize, usize)> = (0..chains.domain.horizon).into_par_iter().flat_map_iter(at_tick).collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// The changed people whose fitted bodies are deeper in a box than the canonical ones; not those who hold it.
fn bumps(bodies: &[Body], props: &[Prop], fitted: &[(usize, Body)], dealt: &[usize], changed: &[bool]) -> Vec<usize> {
    let bumps = |p: usize| {
        let build = &Build::catalogue()[dealt[p]][fitted[p].0];
        props.iter().any(|prop| {
            (prop.begin..=prop.end()).any(|frame| {
                let Some(cuboid) = prop.at_frame(frame) else { return false };
                let near = |s: &Shape| {
                    let middle = cuboid.at.ground().position;
                    middle.distance(s.center) < cuboid.radius() + s.radius && prop.holders(frame).all(|h| h != p as u32)
                };
                let tick = frame as i32;
                let Some(now) = Shape::near(p, &fitted[p].1, build, tick, &cuboid).filter(near) else { return false };
                let depth = depth_in(&cuboid, &now.capsules);
                depth > TOLERANCE
                    && Shape::new(p, &bodies[p], &Build::canonical(), tick)
                        .is_none_or(|then| depth > depth_in(&cuboid, &then.capsules) + TOGETHER)
            })
        })
    };
    (0..bodies.len()).into_par_iter().filter(|&p| changed[p] && bumps(p)).collect()
}

fn clash(chains: Chains, bodies: &[Body], a: &Shape, b: &Shape, tick: i32) -> bool {
    let depth = a.depth_into(b);
    if depth <= TOLERANCE {
        return false;
    }
    let instance = |p: usize| chains.piece_at(p, tick).map(|piece| piece.instance);
    let allowed = if instance(a.person) == instance(b.person) { TOGETHER } else { 0.0 };
    let canonical = |s: &Shape| Shape::new(s.person, &bodies[s.person], &Build::canonical(), tick);
    match (canonical(a), canonical(b)) {
        (Some(p), Some(q)) => depth > p.depth_into(&q) + allowed,
        _ => true,
    }
}

/// A body's capsules at a tick, and the disc on the ground that covers them.
struct Shape {
    person: usize,
    capsules: Vec<Capsule>,
    center: Vec2,
    radius: f32,
}

fn present(bodies: &[Body], fitted: &[(usize, Body)], dealt: &[usize], tick: i32) -> Vec<Shape> {
    let shape = |p: usize| Shape::new(p, &fitted[p].1, &Build::catalogue()[dealt[p]][fitted[p].0], tick);
    (0..bodies.len()).filter_map(shape).collect()
}

impl Shape {
    fn new(person: usize, body: &Body, build: &Build, tick: i32) -> Option<Self> {
        let frame = usize::try_from(tick - body.begin as i32).ok().filter(|&f| f < body.root.len())?;
        let (mut globals, mut capsules) = (Vec::new(), Vec::new());
        build.skeleton.globals(body.root[frame], body.pose(frame), &mut globals);
        body_capsules(&globals, &mut capsules);
        let ground = |v: Vec3| Vec2::new(v.x, v.z);
        let center = ground(body.root[frame]);
        let reach = |c: &Capsule| ground(c.a).distance(center).max(ground(c.b).distance(center)) + c.radius;
        let radius = capsules.iter().map(reach).fold(0.0, f32::max);
        Some(Self { person, capsules, center, radius })
    }

    /// The shape, unless its hips are out of reach of a box.
    fn near(person: usize, body: &Body, build: &Build, tick: i32, cuboid: &Cuboid) -> Option<Self> {
        let frame = usize::try_from(tick - body.begin as i32).ok().filter(|&f| f < body.root.len())?;
        let away = (body.root[frame] - cuboid.at.middle).with_y(0.0).length();
        if away > REACH + cuboid.radius() { None } else { Self::new(person, body, build, tick) }
    }

    fn left(&self) -> f32 {
        self.center.x - self.radius
    }

    /// Depth of the deepest pair of capsules, metres; 0 if none touch.
    fn depth_into(&self, other: &Self) -> f32 {
        if self.center.distance(other.center) >= self.radius + other.radius {
            return 0.0;
        }
        let mut deepest = 0.0f32;
        for a in &self.capsules {
            let (middle, half) = ((a.a + a.b) * 0.5, a.a.distance(a.b) * 0.5 + a.radius);
            for b in &other.capsules {
                let reach = half + b.a.distance(b.b) * 0.5 + b.radius - deepest;
                if middle.distance_squared((b.a + b.b) * 0.5) < reach * reach {
                    deepest = deepest.max(a.penetration(b));
                }
            }
        }
        deepest
    }
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
