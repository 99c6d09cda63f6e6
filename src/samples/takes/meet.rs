//! People who walk up (or stand there), do something together, and leave (or stay).

use crate::geom::Ground;
use crate::motion::Foot::{Left, Right};
use crate::samples::acting::Sight;
use crate::samples::actor::Actor;
use crate::samples::gait::{Gait, NORMAL, SLOW};
use crate::samples::scene::Scene;

/// How people come to the place of an encounter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Coming {
    Walking,
    Standing,
}

/// An encounter to be played.
pub(super) struct Encounter<'a> {
    pub name: &'a str,
    pub labels: &'a [&'a str],
    /// Where everybody stands.
    pub places: &'a [Ground],
    /// By how much everybody turns (radians) when walking away.
    pub turns: &'a [f32],
    /// Lays the gestures from the given second after the actors' cursor on; returns how many seconds they take.
    pub play: fn(&mut Scene, f32) -> f32,
}

/// Two people facing each other at a distance (m): the first looks along +z.
pub(super) fn facing(distance: f32) -> [Ground; 2] {
    [Ground::IDENTITY, Ground::new(glam::Vec2::new(0.0, distance), std::f32::consts::PI)]
}

/// The encounter walking up and away, and again from standing to standing.
pub(super) fn both(encounter: &Encounter) -> Vec<Scene> {
    [Coming::Walking, Coming::Standing].map(|coming| meet(encounter, coming)).into()
}

/// Plays an encounter as one patch.
pub(super) fn meet(e: &Encounter, coming: Coming) -> Scene {
    let suffix = if coming == Coming::Walking { "walk" } else { "stand" };
    let name = format!("{}-{suffix}", e.name);
    let (actors, entries) = arrive(e.places, coming);
    let mut scene = Scene::new(&name, actors);
    // Walkers raise their hands before the last step is done, and turn away while they lower them.
    let overlap = if coming == Coming::Walking { 0.35 } else { 0.0 };
    let began = scene.actors[0].t() - overlap;
    let seconds = (e.play)(&mut scene, -overlap);
    look_at_each_other(&mut scene, -overlap, seconds);
    let core = [began.max(0.0), began + seconds];
    let mut roles = Vec::new();
    for (i, actor) in scene.actors.iter_mut().enumerate() {
        actor.wait(((seconds - 2.0 * overlap) * 30.0).ceil() as i32);
        if coming == Coming::Walking {
            let foot = if e.turns[i] > 0.0 { Left } else { Right };
            actor.start(foot, NORMAL, e.turns[i]);
        } else {
            actor.stand(2);
        }
        roles.push((i, entries[i], actor.now));
    }
    let core = [core[0], core[1] - overlap];
    scene.patch(&name, &[e.labels, &[suffix]].concat(), &roles, Some(core));
    scene
}

/// Actors who are at their places at the same moment, their cursors there; and the frames of the ports before.
pub(super) fn arrive(places: &[Ground], coming: Coming) -> (Vec<Actor>, Vec<i32>) {
    let plan = |i: usize| if i.is_multiple_of(2) { (NORMAL, 1) } else { (SLOW, 1) };
    let approach = |i: usize| {
        let mut a = Actor::standing();
        walk_up(&mut a, plan(i), i);
        a.now
    };
    let latest = (0..places.len()).map(approach).max().unwrap_or(0) + 6;
    let come = |(i, &place): (usize, &Ground)| {
        let mut a = Actor::standing();
        let entry = if coming == Coming::Walking {
            a.stand(latest - approach(i));
            walk_up(&mut a, plan(i), i)
        } else {
            a.stand(20);
            a.now
        };
        a.put(place);
        if coming == Coming::Walking {
            a.unmark();
        }
        (a, entry)
    };
    places.iter().enumerate().map(come).unzip()
}

/// Walks and stops; returns the frame of the port before stopping.
pub(super) fn walk_up(a: &mut Actor, (gait, halves): (Gait, usize), i: usize) -> i32 {
    a.start(if i.is_multiple_of(2) { Left } else { Right }, gait, 0.0);
    a.walk(gait, halves);
    let entry = a.now;
    a.stop(0.0);
    entry
}

/// Everybody looks at the next one over the encounter, from before it to after.
pub(super) fn look_at_each_other(scene: &mut Scene, from: f32, seconds: f32) {
    let count = scene.actors.len();
    for (i, actor) in scene.actors.iter_mut().enumerate() {
        let before = if from < 0.0 { 0.5 } else { 0.0 };
        let times = [from - before, from - before + 0.4, from + seconds - 0.3, from + seconds + 0.2 * before];
        if count == 2 {
            actor.look(times, Sight::Person(1 - i));
        } else {
            let middle = from + 0.55 * seconds;
            actor.look([times[0], times[1], middle - 0.2, middle + 0.2], Sight::Person((i + 1) % count));
            actor.look([middle - 0.2, middle + 0.2, times[2], times[3]], Sight::Person((i + count - 1) % count));
        }
    }
}
