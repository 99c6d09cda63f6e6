//! Hopping on one leg with folded arms, as chicken fighters do, and how they bump into each other.

use std::f32::consts::PI;

use glam::Vec2;

use super::solo;
use crate::geom::Ground;
use crate::motion::BodyPart::Torso;
use crate::motion::Foot::{self, Left, Right};
use crate::samples::actor::{Actor, secs};
use crate::samples::hopping::{HOP, PACE};
use crate::samples::posture::Channel::*;
use crate::samples::scene::Scene;

/// Label of all that is hopped: only used where a scene asks for it.
const LABEL: &str = "hop";

pub(super) fn scenes() -> Vec<Scene> {
    let mut all: Vec<Scene> = COURSES.iter().map(course).collect();
    all.push(begin_and_end());
    all.extend(BUMPS.iter().map(bump));
    all
}

/// A way hopped: its name and its hops, each with speed in the air, speed at mid-stance after, and degrees turned.
type Course = (&'static str, &'static [(f32, f32, f32)]);

const P: f32 = PACE;

const COURSES: [Course; 15] = [
    ("hop", &[(P, P, 0.0)]),
    ("hop-twice", &[(P, P, 0.0), (P, P, 0.0)]),
    ("hop-dash", &[(1.15, 1.15, 0.0), (1.3, P, 0.0)]),
    ("hop-dash-far", &[(1.15, 1.25, 0.0), (1.35, 1.25, 0.0), (1.2, P, 0.0)]),
    ("hop-short", &[(0.4, P, 0.0)]),
    ("hop-slow", &[(0.3, 0.3, 0.0), (0.3, P, 0.0)]),
    ("hop-in-place", &[(0.1, 0.0, 0.0), (0.0, 0.0, 0.0), (0.15, P, 0.0)]),
    ("hop-left-15", &[(P, P, 15.0)]),
    ("hop-right-15", &[(P, P, -15.0)]),
    ("hop-left-40", &[(0.6, 0.6, 20.0), (0.6, P, 20.0)]),
    ("hop-right-40", &[(0.6, 0.6, -20.0), (0.6, P, -20.0)]),
    ("hop-left-90", &[(0.5, 0.4, 30.0), (0.4, 0.4, 30.0), (0.5, P, 30.0)]),
    ("hop-right-90", &[(0.5, 0.4, -30.0), (0.4, 0.4, -30.0), (0.5, P, -30.0)]),
    ("hop-round-left", &[(0.2, 0.0, 45.0), (0.0, 0.0, 45.0), (0.0, 0.0, 45.0), (0.2, P, 45.0)]),
    ("hop-round-right", &[(0.2, 0.0, -45.0), (0.0, 0.0, -45.0), (0.0, 0.0, -45.0), (0.2, P, -45.0)]),
];

fn hop_along(a: &mut Actor, hops: &[(f32, f32, f32)]) {
    let from = a.now;
    for &(speed, end, turn) in hops {
        a.hop_on(speed, end, turn.to_radians());
    }
    // Ports have one pace.
    let to = a.now;
    a.ports.retain(|p| p.0 <= from || p.0 >= to);
}

/// A way on the right leg; mirror images are on the left one.
fn course(&(name, hops): &Course) -> Scene {
    let mut a = Actor::hopper(Right);
    hop_along(&mut a, &[(P, P, 0.0)]);
    let from = a.now;
    hop_along(&mut a, hops);
    let to = a.now;
    hop_along(&mut a, &[(P, P, 0.0)]);
    let turns: f32 = hops.iter().map(|h| h.2).sum();
    let label = if turns == 0.0 { "straight" } else { "turn" };
    solo(name, a, &[(name, &[LABEL, label], from, to)])
}

/// From standing to hopping and back.
fn begin_and_end() -> Scene {
    let mut a = Actor::standing();
    a.stand(20);
    let from = a.now;
    a.begin_to_hop(Right);
    let begun = a.now;
    hop_along(&mut a, &[(P, P, 0.0)]);
    let ending = a.now;
    a.end_hopping();
    let ended = a.now;
    a.stand(20);
    solo(
        "hop-begin-end",
        a,
        &[("hop-begin", &[LABEL, "begin"], from, begun), ("hop-end", &[LABEL, "end"], ending, ended)],
    )
}

/// Two who rush at each other and bump shoulders.
struct Bump {
    name: &'static str,
    /// On which feet they hop.
    feet: [Foot; 2],
    /// How far apart they are when they meet.
    apart: f32,
    /// Speed after the bump; what is hopped then.
    thrown: [f32; 2],
    after: [&'static [(f32, f32, f32)]; 2],
}

const BACK: &[(f32, f32, f32)] = &[(-0.35, -0.1, 0.0), (0.0, 0.0, 50.0), (0.2, P, 50.0)];
const FAR_BACK: &[(f32, f32, f32)] = &[(-0.6, -0.3, 0.0), (-0.3, 0.0, -35.0), (0.0, 0.0, -45.0), (0.2, P, -30.0)];
const SPUN: &[(f32, f32, f32)] = &[(-0.3, -0.1, 50.0), (0.0, 0.0, 50.0), (0.2, P, 40.0)];
const ON: &[(f32, f32, f32)] = &[(0.0, 0.0, -35.0), (0.2, P, -40.0)];

const BUMPS: [Bump; 4] = [
    Bump { name: "bump", feet: [Right, Right], apart: 0.605, thrown: [-0.5, -0.5], after: [BACK, BACK] },
    Bump { name: "bump-far", feet: [Right, Left], apart: 0.575, thrown: [-0.35, -0.7], after: [BACK, FAR_BACK] },
    Bump { name: "bump-spin", feet: [Right, Right], apart: 0.61, thrown: [-0.25, -0.45], after: [ON, SPUN] },
    Bump { name: "bump-on", feet: [Left, Right], apart: 0.588, thrown: [-0.2, -0.6], after: [ON, FAR_BACK] },
];

/// How far apart their ways are.
const ASIDE: f32 = 0.17;

fn bump(b: &Bump) -> Scene {
    let mut entries = Vec::new();
    let mut actors = Vec::new();
    let mut hit = 0.0;
    for i in 0..2 {
        let mut a = Actor::hopper(b.feet[i]);
        hop_along(&mut a, &[(P, P, 0.0)]);
        entries.push(a.now);
        a.hop_on(1.05, 1.05, 0.0);
        // They meet in the middle of the flight.
        let middle = (HOP[0] + HOP[1]) / 2;
        hit = a.t() + secs(middle);
        a.now += middle;
        let place = if i == 0 { Ground::IDENTITY } else { Ground::new(Vec2::new(-ASIDE, b.apart), PI) };
        a.put(place);
        a.now -= middle;
        strike(&mut a, secs(middle), b.thrown[i]);
        hop_along(&mut a, b.after[i]);
        actors.push(a);
    }
    let mut scene = Scene::new(b.name, actors);
    let roles: Vec<_> = (0..2).map(|i| (i, entries[i], scene.actors[i].now)).collect();
    let latest = scene.actors.iter().map(|a| a.now).max().unwrap_or(0) + HOP[2];
    for (a, (_, entry, exit)) in scene.actors.iter_mut().zip(roles.clone()) {
        a.ports.retain(|p| p.0 <= entry || p.0 == exit);
        while a.now < latest {
            hop_along(a, &[(P, P, 0.0)]);
        }
    }
    scene.contact((0, Torso), (1, Torso), hit - 0.04, hit + 0.04);
    scene.patch(b.name, &[LABEL, "bump"], &roles, Some([hit - 0.3, hit + 0.5]));
    scene
}

/// A hop into the other, the right shoulder first, `after` seconds from the cursor; thrown back at some speed.
fn strike(a: &mut Actor, after: f32, thrown: f32) {
    let lunge = [after - 0.42, after - 0.06, after + 0.06, after + 0.6];
    a.pose(lunge, &[(PelvisYaw, 0.30), (SpineYaw, 0.42), (SpinePitch, 0.10), (HeadYaw, -0.45)]);
    let jolt = [after, after + 0.12, after + 0.2, after + 0.7];
    a.pose(jolt, &[(SpinePitch, -0.16), (HeadPitch, 0.10), (SpineRoll, 0.05)]);
    let t = a.t();
    a.hop_on(thrown, thrown, 0.0);
    // The speed changes while they touch, not at the ends of the flight.
    let speeds = &mut a.plan.speeds;
    speeds.truncate(speeds.len() - 3);
    speeds.extend([(t + after - 0.08, 1.1), (t + after + 0.09, thrown), (t + secs(HOP[2]), thrown)]);
}
