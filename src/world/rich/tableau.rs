//! A few people who do something in one place, over and over.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Quat, Vec2, Vec3};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::geom::{Capsule, Disc, Ground, smallest_circle};
use crate::motion::{JOINT_COUNT, body_capsules, canonical};
use crate::stage::world::Act;
use crate::world::{FramePatch, Limits, Shape, Standing, StaticObject};

/// A disc reaches this much beyond the body, metres: rounding must not matter.
const ROUNDING: f32 = 0.01;

/// Tableaux that are wider are left out, metres.
const WIDEST: f32 = 1.6;

/// What somebody does who stays: a clip, and how many seconds it is ahead.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Role {
    /// The clip.
    pub act: Arc<Act>,
    /// Seconds.
    pub lead: f32,
}

/// Somebody of a tableau.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Member {
    /// Where the disc is that all of the body stays in at all times, and where the person looks on average.
    pub at: Ground,
    /// Radius of the disc, metres.
    pub radius: f32,
    /// What it does, seen from there.
    pub act: Arc<Act>,
}

/// People who do something together, or one alone, in a frame of their own about their middle.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Tableau {
    /// The people.
    pub members: Vec<Member>,
    /// What they sit on: middle, full extents in x and z, angle.
    pub seats: Vec<(Vec2, Vec2, f32)>,
    /// Radius of a disc about the middle that holds all of it, metres.
    pub reach: f32,
}

impl Tableau {
    /// Of full-body motions in one frame (each over one round, the same length), with what the people sit on.
    pub(super) fn new(motions: Vec<Act>, seats: Vec<(Vec2, Vec2, f32)>) -> Self {
        let members: Vec<Member> = motions.into_iter().map(member).collect();
        let corner = |(middle, size, _): &(Vec2, Vec2, f32)| (*middle, 0.5 * size.length());
        let (middle, reach) = around(members.iter().map(|m| (m.at.position, m.radius)).chain(seats.iter().map(corner)));
        let seen = |m: Member| Member { at: Ground::new(m.at.position - middle, m.at.heading), ..m };
        let seats = seats.into_iter().map(|(at, size, angle)| (at - middle, size, angle)).collect();
        Self { members: members.into_iter().map(seen).collect(), seats, reach }
    }

    /// Whether it is small enough for a place among others.
    pub(super) fn is_small(&self) -> bool {
        self.reach < WIDEST
    }

    /// Several side by side, all looking the same way on average, each as wide as it is.
    pub(super) fn row<'a>(all: impl Iterator<Item = &'a Self>) -> Self {
        let (mut members, mut seats, mut x) = (Vec::new(), Vec::new(), 0.0);
        for one in all {
            let heading = one.members.first().map_or(0.0, |m| m.at.heading);
            let to = Ground::new(Vec2::new(x + one.reach, 0.0), 0.0).then(Ground::new(Vec2::ZERO, -heading));
            members.extend(one.members.iter().map(|m| Member { at: to.then(m.at), ..m.clone() }));
            seats.extend(one.seats.iter().map(|&(at, size, angle)| (to.apply(at), size, angle + heading)));
            x += 2.0 * one.reach;
        }
        let middle = Vec2::new(0.5 * x, 0.0);
        members.iter_mut().for_each(|m| m.at.position -= middle);
        seats.iter_mut().for_each(|s| s.0 -= middle);
        Self { members, seats, reach: 0.5 * x }
    }

    /// Several who stand in a circle, side by side, and look at its middle; each of them is alone.
    pub(super) fn ring(all: &[&Self]) -> Self {
        let (n, wide) = (all.len(), |k: usize| all[k % all.len()].reach);
        let chord = (0..n).map(|k| wide(k) + wide(k + 1)).fold(0.0, f32::max);
        let radius = 0.5 * chord / (0.5 * TAU / n as f32).sin();
        let place = |(k, one): (usize, &&Self)| {
            let angle = TAU * k as f32 / n as f32;
            let turn = angle + 0.5 * TAU - one.members.first().map_or(0.0, |m| m.at.heading);
            let to = Ground::new(radius * Vec2::new(angle.sin(), angle.cos()), turn);
            one.members.iter().map(move |m| Member { at: to.then(m.at), ..m.clone() }).collect::<Vec<_>>()
        };
        let members = all.iter().enumerate().flat_map(place).collect();
        Self { members, seats: vec![], reach: radius + (0..n).map(wide).fold(0.0, f32::max) }
    }

    /// Puts it into a frame-patch somewhere at random, called `name`. Returns whether there was room.
    pub(in crate::world) fn join(
        &self,
        name: &str,
        frame: &mut FramePatch,
        limits: &Limits,
        rng: &mut ChaCha8Rng,
    ) -> bool {
        let make = |at: Vec2, _| Shape::disc(at, self.reach);
        let Some(Shape::Disc { centre, .. }) = frame.find_room(make, limits, rng) else { return false };
        let at = Ground::new(centre, rng.random::<f32>() * TAU);
        let lead = self.members.first().map_or(0.0, |m| m.act.step * m.act.roots.len() as f32) * rng.random::<f32>();
        for member in &self.members {
            let Ground { position, heading } = at.then(member.at);
            let role = Some(Role { act: member.act.clone(), lead });
            frame.people.push(Standing { name: name.into(), position, heading, radius: member.radius, role });
        }
        for &(middle, size, angle) in &self.seats {
            // A heading turns from z to x, an angle from x to z.
            let shape = Shape::oblong(at.apply(middle), size, angle - at.heading);
            frame.objects.push(StaticObject { name: "seat".into(), shape });
        }
        true
    }
}

/// Middle and radius of the smallest circle around discs.
fn around(discs: impl Iterator<Item = (Vec2, f32)>) -> (Vec2, f32) {
    let discs: Vec<Disc> = discs.map(|(at, radius)| (at.as_dvec2(), f64::from(radius))).collect();
    let (middle, radius) = smallest_circle(&discs);
    (middle.as_vec2(), radius as f32)
}

/// Somebody with a motion: seen from the middle of the circle that the body stays in.
fn member(motion: Act) -> Member {
    let (middle, radius) = around(extent(&motion));
    let ahead = motion.rotations.iter().step_by(JOINT_COUNT).map(|q| *q * Vec3::Z);
    let ahead: Vec2 = ahead.map(|v| Vec2::new(v.x, v.z)).sum();
    let at = Ground::new(middle, ahead.x.atan2(ahead.y));
    Member { at, radius: radius + ROUNDING, act: Arc::new(seen_from(at, motion)) }
}

/// All capsules of a body at all frames as discs on the ground.
fn extent(motion: &Act) -> impl Iterator<Item = (Vec2, f32)> {
    let (mut globals, mut capsules) = (Vec::new(), Vec::<Capsule>::new());
    for (root, pose) in motion.roots.iter().zip(motion.rotations.chunks_exact(JOINT_COUNT)) {
        canonical().globals(*root, pose, &mut globals);
        body_capsules(&globals, &mut capsules);
    }
    let ground = |p: Vec3| Vec2::new(p.x, p.z);
    capsules.into_iter().flat_map(move |c| [(ground(c.a), c.radius), (ground(c.b), c.radius)])
}

/// The same motion in the frame of a place.
fn seen_from(at: Ground, motion: Act) -> Act {
    let back = at.inverse();
    let turn: Quat = back.rotation();
    let roots = motion.roots.iter().map(|&p| back.apply3(p)).collect();
    let mut rotations = motion.rotations;
    rotations.iter_mut().step_by(JOINT_COUNT).for_each(|q| *q = turn * *q);
    Act { step: motion.step, roots, rotations }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everybody_is_where_the_motion_was() {
        let standing = |x: f32, heading: f32| {
            let mut pose = [Quat::IDENTITY; JOINT_COUNT];
            pose[0] = Quat::from_rotation_y(heading);
            Act { step: 0.1, roots: vec![Vec3::new(x, 0.95, 2.0); 4], rotations: pose.repeat(4) }
        };
        let tableau = Tableau::new(vec![standing(1.0, 0.3), standing(2.0, -1.2)], vec![]);
        let [a, b] = [&tableau.members[0], &tableau.members[1]];
        assert!((a.at.position.distance(b.at.position) - 1.0).abs() < 0.02);
        assert!((a.at.heading - 0.3).abs() < 1e-4 && (b.at.heading + 1.2).abs() < 1e-4);
        for member in [a, b] {
            assert!((member.act.rotations[0] * Vec3::Z).distance(Vec3::Z) < 1e-4);
            // The T-pose's arms reach as far on both sides.
            assert!(member.act.roots[0].x.abs() < 0.02 && member.radius > 0.6);
        }
        assert!(tableau.reach > 0.5 + a.radius - 0.02 && tableau.reach < 0.5 + a.radius + 0.1);
    }

    #[test]
    fn who_stands_in_a_circle_looks_at_its_middle_and_touches_nobody() {
        let alone = |heading: f32| {
            let mut pose = [Quat::IDENTITY; JOINT_COUNT];
            pose[0] = Quat::from_rotation_y(heading);
            Tableau::new(vec![Act { step: 0.1, roots: vec![Vec3::Y; 2], rotations: pose.repeat(2) }], vec![])
        };
        let singles = [alone(0.7), alone(-2.0), alone(0.0)];
        for n in 2..=3 {
            let ring = Tableau::ring(&singles.iter().take(n).collect::<Vec<_>>());
            for (i, member) in ring.members.iter().enumerate() {
                let Ground { position, heading } = member.at;
                assert!((-position.normalize()).distance(Vec2::new(heading.sin(), heading.cos())) < 1e-3, "{n}, {i}");
                assert!(position.length() + member.radius <= ring.reach + 1e-4);
                for other in &ring.members[..i] {
                    assert!(position.distance(other.at.position) > member.radius + other.radius - 0.01);
                }
            }
        }
    }
}
