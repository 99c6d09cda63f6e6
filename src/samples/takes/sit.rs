//! People sit down on a crate behind them and get up again: alone, to walk off, or opposite each other.

use glam::Vec3;

use super::actions::grip;
use super::meet::facing;
use super::solo;
use super::talk::{gesticulate, nod};
use crate::geom::Ground;
use crate::motion::Foot::{Left, Right};
use crate::samples::acting::Sight;
use crate::samples::actor::Actor;
use crate::samples::gait::NORMAL;
use crate::samples::gesture::Relative;
use crate::samples::posture::Channel::*;
use crate::samples::scene::{CRATE, Scene};

/// How far the hips go back, and where they are on the crate (m): heels stay clear of it, shins are upright.
const BACK: f32 = 0.40;
const HIPS_SEATED: f32 = CRATE[1] + 0.13;
/// Hips of somebody who stands, as high as the samples have them.
const HIPS_STANDING: f32 = 0.928;
/// Seconds from standing to sitting, and from there to standing.
const DOWN: f32 = 1.6;
const UP: f32 = 1.65;

pub(super) fn scenes() -> Vec<Scene> {
    vec![sit("sit", 1.2, rest), sit("sit-look", 2.5, look_about), sit_and_go(), sit_and_talk()]
}

/// Sits down from the cursor on, stays for some seconds, gets up; when seated and when standing again.
fn seat(a: &mut Actor, seconds: f32) -> [f32; 3] {
    let (down, up) = (DOWN, DOWN + seconds);
    a.pose([0.0, down, up, up + UP], &[(HipsUp, HIPS_SEATED - HIPS_STANDING), (HipsForward, -BACK)]);
    // The trunk leans forward as long as the hips are behind the feet, and comes up on the crate.
    let lean = |t: [f32; 4], much: f32| (t, [(PelvisPitch, 0.50 * much), (SpinePitch, 0.38 * much), (HeadPitch, -0.1)]);
    for (times, amounts) in [
        lean([0.0, 0.6 * DOWN, 0.75 * DOWN, down + 0.5], 1.0),
        lean([up - 0.45, up + 0.25, up + 0.45, up + 0.95 * UP], 1.1),
    ] {
        a.pose(times, &amounts);
    }
    a.pose([down - 0.3, down + 0.4, up - 0.4, up + 0.3], &[(PelvisPitch, -0.12), (SpinePitch, 0.16)]);
    a.pose([0.2, down, up, up + 1.2], &[(KneeOutLeft, 0.12), (KneeOutRight, 0.12), (StillArms, 1.0)]);
    hands_on_knees(a, [0.55, down + 0.15, up + 0.2, up + 1.05]);
    [down + 0.05, up - 0.05, up + UP]
}

fn hands_on_knees(a: &mut Actor, times: [f32; 4]) {
    for (side, s) in [(Left, 1.0), (Right, -1.0)] {
        // Thighs are level: the palms rest on them above the knees.
        let palm = grip(Relative::Path, [s * 0.15, 0.597, -0.08], [s * -0.15, -0.08, 1.0], [0.0, -1.0, -0.1]);
        a.reach(side, times, vec![(0.0, palm)]);
    }
}

/// What somebody does on the crate: from when to when they sit, in seconds from the cursor.
type Pastime = fn(&mut Actor, f32, f32);

fn rest(a: &mut Actor, from: f32, _: f32) {
    a.look([from, from + 0.5, from + 1.1, from + 1.7], Sight::Beside(Vec3::new(1.2, 0.9, 2.5)));
}

fn look_about(a: &mut Actor, from: f32, to: f32) {
    for (k, side) in [(0.0, 1.0), (1.2, -1.0)] {
        let times = [from + k, from + k + 0.5, from + k + 0.8, from + k + 1.3];
        a.look(times, Sight::Beside(Vec3::new(2.6 * side, 1.1, 2.0)));
        a.pose(times, &[(SpineYaw, 0.14 * side), (HeadRoll, -0.03 * side)]);
    }
    a.pose([to - 1.0, to - 0.6, to - 0.5, to - 0.1], &[(SpinePitch, 0.10), (HeadPitch, 0.08)]);
}

fn sit(name: &str, seconds: f32, pastime: Pastime) -> Scene {
    let mut a = Actor::standing();
    a.stand(20);
    let (from, t) = (a.now, a.t());
    let [down, up, end] = seat(&mut a, seconds);
    pastime(&mut a, down, up);
    a.stand((end * 30.0).ceil() as i32 + 3);
    let to = a.now;
    a.stand(20);
    let mut scene = solo(name, a, &[(name, &["action", "in_place", "sit"], from, to)]);
    scene.sit(0, t + down, t + up);
    scene
}

/// Sits down, gets up and walks off to the side.
fn sit_and_go() -> Scene {
    let mut a = Actor::standing();
    a.stand(20);
    let (from, t) = (a.now, a.t());
    let [down, up, end] = seat(&mut a, 1.1);
    a.look([down, down + 0.5, up + 0.5, end], Sight::Beside(Vec3::new(-1.8, 1.3, 2.0)));
    a.wait((end * 30.0).ceil() as i32);
    a.start(Right, NORMAL, -70f32.to_radians());
    let to = a.now;
    let mut scene = solo("sit-and-go", a, &[("sit-and-go", &["action", "start", "sit"], from, to)]);
    scene.sit(0, t + down, t + up);
    scene
}

/// Two people sit down opposite each other, talk, and get up.
fn sit_and_talk() -> Scene {
    let actor = |place: Ground| {
        let mut a = Actor::standing();
        a.stand(20);
        a.put(place);
        a
    };
    let mut actors: Vec<Actor> = facing(1.25).into_iter().map(actor).collect();
    let (from, t) = (actors[0].now, actors[0].t());
    let (mut seats, mut roles) = (Vec::new(), Vec::new());
    for (i, a) in actors.iter_mut().enumerate() {
        let late = 6 * i as i32;
        a.wait(late);
        let [down, up, end] = seat(a, 2.5);
        a.look([0.0, 0.4, end - 0.4, end], Sight::Person(1 - i));
        // The one speaks, the other listens.
        if i == 0 {
            gesticulate(a, Right, down + 0.9, 1);
        }
        nod(a, down + [2.4, 1.4][i]);
        seats.push([t + late as f32 / 30.0 + down, t + late as f32 / 30.0 + up]);
        a.stand((end * 30.0).ceil() as i32 + 3);
        roles.push((i, from, a.now));
    }
    let mut scene = Scene::new("sit-talk", actors);
    let core = [seats[0][0], seats[1][1]];
    scene.patch("sit-talk", &["friendly", "talk", "sit"], &roles, Some(core));
    seats.iter().enumerate().for_each(|(i, s)| scene.sit(i, s[0], s[1]));
    scene
}
