//! Two people greet: handshake, high five (standing and in passing), bow, hug.

use glam::{Vec2, Vec3};

use super::actions::grip;
use super::meet::{Encounter, both, facing};
use crate::geom::Ground;
use crate::motion::BodyPart::{LeftHand, RightHand, Torso};
use crate::motion::Foot::{Left, Right};
use crate::samples::acting::Sight;
use crate::samples::actor::Actor;
use crate::samples::gait::NORMAL;
use crate::samples::gesture::Relative::Path;
use crate::samples::posture::Channel::*;
use crate::samples::scene::Scene;

const SHAKE: f32 = 0.88;
const FIVE: f32 = 0.84;
const HUG: f32 = 0.40;

fn rad(degrees: f32) -> f32 {
    degrees.to_radians()
}

pub(super) fn scenes() -> Vec<Scene> {
    let friendly: &[&str] = &["friendly"];
    let mut all = Vec::new();
    let turns = [rad(90.0), rad(70.0)];
    all.extend(both(&Encounter {
        name: "handshake",
        labels: friendly,
        places: &facing(SHAKE),
        turns: &turns,
        play: shake,
    }));
    let turns = [rad(75.0), rad(100.0)];
    all.extend(both(&Encounter {
        name: "high-five",
        labels: friendly,
        places: &facing(FIVE),
        turns: &turns,
        play: five,
    }));
    let turns = [rad(-80.0), rad(-95.0)];
    all.extend(both(&Encounter { name: "bow", labels: friendly, places: &facing(1.3), turns: &turns, play: bow }));
    let turns = [rad(100.0), rad(95.0)];
    let mut places = facing(HUG);
    places[1].position.x = 0.07;
    all.extend(both(&Encounter { name: "hug", labels: friendly, places: &places, turns: &turns, play: hug }));
    all.push(five_in_passing());
    all
}

/// Lays a handshake of actors 0 and 1 who stand [`SHAKE`] apart.
pub(super) fn shake(scene: &mut Scene, t: f32) -> f32 {
    let (touch, release) = (t + 0.6, t + 1.5);
    for a in &mut scene.actors[..2] {
        let at = |y: f32| grip(Path, [-0.004, y, 0.5 * SHAKE], [0.14, 0.02, 1.0], [1.0, 0.0, -0.1]);
        let mut grips =
            vec![(t + 0.1, grip(Path, [-0.10, 0.96, 0.30], [0.2, 0.0, 1.0], [1.0, 0.2, 0.0])), (touch, at(1.01))];
        grips.extend(
            [1.05, 0.985, 1.04, 0.995].iter().enumerate().map(|(i, &y)| (touch + 0.17 * (i + 1) as f32, at(y))),
        );
        grips.push((release, at(1.01)));
        grips.push((release + 0.3, grip(Path, [-0.14, 0.95, 0.28], [0.1, -0.2, 1.0], [1.0, 0.2, 0.0])));
        a.reach(Right, [t, t + 0.5, release, release + 0.5], grips);
        a.pose(
            [t + 0.1, touch, release, release + 0.45],
            &[(SpinePitch, 0.09), (SpineYaw, 0.10), (HipsForward, 0.025)],
        );
        a.pose([touch, touch + 0.2, touch + 0.3, touch + 0.6], &[(HeadPitch, 0.10)]);
    }
    let now = scene.actors[0].t();
    scene.contact((0, RightHand), (1, RightHand), now + touch, now + release);
    2.0
}

fn five(scene: &mut Scene, t: f32) -> f32 {
    let hit = t + 0.72;
    for a in &mut scene.actors {
        let back = grip(Path, [-0.30, 1.56, 0.08], [-0.15, 1.0, -0.25], [0.1, 0.0, 1.0]);
        let slap = grip(Path, [0.0, 1.60, 0.5 * FIVE - 0.004], [0.05, 1.0, 0.15], [0.0, 0.0, 1.0]);
        let after = grip(Path, [-0.20, 1.38, 0.30], [0.1, 0.9, 0.4], [0.1, -0.3, 1.0]);
        let grips = vec![(t + 0.05, after), (t + 0.42, back), (hit, slap), (hit + 0.12, slap), (hit + 0.4, after)];
        a.reach_with(Right, [t, t + 0.40, hit + 0.15, hit + 0.75], grips, Vec3::new(1.0, -0.9, 0.0));
        a.pose([t + 0.1, t + 0.42, t + 0.45, hit], &[(SpineYaw, -0.14), (SpinePitch, -0.03)]);
        a.pose([t + 0.42, hit, hit + 0.12, hit + 0.6], &[(SpineYaw, 0.16), (SpinePitch, 0.06), (HipsForward, 0.02)]);
    }
    let now = scene.actors[0].t();
    scene.contact((0, RightHand), (1, RightHand), now + hit, now + hit + 0.12);
    1.5
}

fn bow(scene: &mut Scene, t: f32) -> f32 {
    for (i, a) in scene.actors.iter_mut().enumerate() {
        let t = t + 0.12 * i as f32;
        let deep = if i == 0 { 1.0 } else { 1.15 };
        a.pose(
            [t + 0.05, t + 0.75, t + 1.05, t + 1.75],
            &[
                (PelvisPitch, 0.34 * deep),
                (SpinePitch, 0.24 * deep),
                (HipsForward, -0.075 * deep),
                (HeadPitch, 0.16),
                (StillArms, 1.0),
            ],
        );
        // Hands slide down the thighs.
        a.pose(
            [t + 0.05, t + 0.75, t + 1.05, t + 1.75],
            &[(FlexLeft, 0.13), (FlexRight, 0.13), (ElbowLeft, -0.1), (ElbowRight, -0.1)],
        );
    }
    1.95
}

/// Right arm over, left arm under.
fn hug(scene: &mut Scene, t: f32) -> f32 {
    let (touch, release) = (t + 0.75, t + 1.35);
    for (i, a) in scene.actors.iter_mut().enumerate() {
        // The other's middle in this one's frame is a little to one side.
        let side = if i == 0 { 0.07 } else { -0.07 };
        let over = |open: f32| {
            let palm = [side - 0.02 - 0.26 * open, 1.395 + 0.095 * open, HUG + 0.075 - 0.20 * open];
            grip(Path, palm, [0.8 - 0.8 * open, -0.5 + 0.6 * open, 0.1 + 0.9 * open], [0.5 * open, -0.4, -1.0 + open])
        };
        let under = |open: f32| {
            let palm = [side + 0.17 + 0.195 * open, 1.19 + 0.02 * open, HUG + 0.145 - 0.215 * open];
            // Flat on the other's back where it turns into the flank.
            let shut = 1.0 - open;
            grip(Path, palm, [-0.75 * shut, 0.1, 0.6 + 0.4 * open], [-0.5 - 0.1 * shut, 0.0, -0.8 * shut])
        };
        let times = [t, t + 0.5, release, release + 0.6];
        let above = grip(Path, [side - 0.18, 1.56, HUG - 0.02], [0.3, 0.0, 1.0], [0.4, -1.0, 0.0]);
        let grips = vec![
            (t + 0.1, over(1.0)),
            (t + 0.47, above),
            (touch, over(0.0)),
            (release, over(0.0)),
            (release + 0.22, above),
            (release + 0.45, over(1.0)),
        ];
        a.reach_with(Right, times, grips, Vec3::new(1.0, 0.45, -0.1));
        let flank = grip(Path, [side + 0.31, 1.19, HUG + 0.07], [-0.1, 0.1, 1.0], [-1.0, 0.0, 0.0]);
        let grips = vec![
            (t + 0.1, under(1.0)),
            (t + 0.47, flank),
            (touch, under(0.0)),
            (release, under(0.0)),
            (release + 0.22, flank),
            (release + 0.45, under(1.0)),
        ];
        a.reach_with(Left, times, grips, Vec3::new(1.0, -0.75, -0.05));
        a.pose(
            [t + 0.2, touch, release, release + 0.5],
            &[(SpinePitch, 0.10), (PelvisPitch, 0.07), (HeadYaw, 0.15), (HipsForward, 0.005)],
        );
        // The heads pass each other to the side, and stay there until the bodies are apart.
        a.pose([t + 0.1, touch - 0.15, release + 0.2, release + 0.7], &[(SpineRoll, 0.14), (HeadRoll, 0.10)]);
        step_apart(a, release + 0.20);
        // Pats the back.
        a.pose([touch + 0.25, touch + 0.4, touch + 0.45, touch + 0.6], &[(SpinePitch, 0.012)]);
    }
    let now = scene.actors[0].t();
    for (a, b) in [(0, 1), (1, 0)] {
        scene.contact((a, RightHand), (b, Torso), now + touch, now + release);
        scene.contact((a, LeftHand), (b, Torso), now + touch, now + release);
    }
    2.55
}

/// Two short steps back.
fn step_apart(a: &mut Actor, t: f32) {
    let (began, back) = (a.now, Vec2::new(0.0, -0.20));
    a.shift(back, t - 0.05, 0.75);
    a.now = began + (t * 30.0).round() as i32;
    // The left foot first: the weight, and with it the head, goes to the right, away from the other's.
    a.step_from(Left, began, Ground::new(back, 0.0), 11);
    a.step_from(Right, began, Ground::new(back, 0.0), 11);
    a.now = began;
}

/// Two people walk past each other and slap hands.
fn five_in_passing() -> Scene {
    let (aside, ahead) = (0.33, 0.27);
    let places =
        [Ground::new(Vec2::new(aside, -ahead), 0.0), Ground::new(Vec2::new(-aside, ahead), std::f32::consts::PI)];
    let mut entries = Vec::new();
    let mut actors = Vec::new();
    for (i, place) in places.into_iter().enumerate() {
        let mut a = Actor::standing();
        a.stand(8);
        a.start(if i == 0 { Left } else { Right }, NORMAL, 0.0);
        a.walk(NORMAL, 1);
        entries.push(a.now);
        a.walk(NORMAL, 3);
        a.put(place);
        let up = grip(Path, [-0.20, 1.46, 0.26], [0.0, 1.0, 0.25], [0.05, -0.1, 1.0]);
        let palm = Vec3::new(0.0, 1.52, if i == 0 { -0.004 } else { 0.004 });
        let world = |v: Vec3| if i == 0 { v } else { Vec3::new(-v.x, v.y, -v.z) };
        let mut slap = grip(crate::samples::gesture::Relative::World, [0.0; 3], [0.0; 3], [0.0; 3]);
        (slap.palm, slap.fingers, slap.facing) = (palm, world(Vec3::new(-0.1, 1.0, 0.1)), world(Vec3::Z));
        let grips = vec![
            (-0.75, up),
            (-0.45, up),
            (-0.05, slap),
            (0.03, slap),
            (0.30, grip(Path, [-0.31, 1.22, 0.27], [-0.1, 0.4, 0.9], [0.5, -0.4, 0.4])),
        ];
        a.reach_with(Right, [-0.85, -0.30, 0.06, 0.75], grips, Vec3::new(1.0, -0.9, 0.0));
        a.look([-1.3, -0.8, 0.05, 0.45], Sight::Person(1 - i));
        a.pose([-0.4, -0.05, 0.06, 0.45], &[(SpineYaw, 0.10), (SpinePitch, 0.02)]);
        a.walk(NORMAL, 2);
        // No port while the arm is up.
        let (entry, exit) = (entries[i], a.now);
        a.ports.retain(|p| p.0 <= entry || p.0 >= exit);
        actors.push(a);
    }
    let exits: Vec<i32> = actors.iter().map(|a| a.now).collect();
    let mut scene = Scene::new("high-five-passing", actors);
    let hit = scene.actors[0].t() - 34.0 / 30.0;
    scene.contact((0, RightHand), (1, RightHand), hit - 0.05, hit + 0.03);
    let roles = [(0, entries[0], exits[0]), (1, entries[1], exits[1])];
    scene.patch("high-five-passing", &["friendly", "walk"], &roles, Some([hit - 0.4, hit + 0.2]));
    scene
}
