//! From stitched fragments to a person's final full-body motion: bodies are carried along the deformed paths, blended
//! where fragments meet, their feet locked to the ground, their hands put onto whom they touch and what they carry. A
//! pass over whole tracks, not over patches.

mod arm;
mod carry;
mod feet;
mod fit;
mod leg;
mod prop;
#[cfg(test)]
pub(crate) mod testing;
mod touch;

use glam::{Quat, Vec2, Vec3};
use rayon::prelude::*;

use crate::geom::Torus;
use crate::motion::{JOINT_COUNT, Motion, canonical};
use crate::patch::{PatchKind, filed_rotation};
use crate::stage::{Character, Crowd, FragmentUse, Prop};

pub use fit::{Hold, fit, holds};

/// A fragment in a person's life: what was captured, and how it is placed and timed.
#[derive(Clone, Copy)]
pub struct Segment<'a> {
    /// The patch kind it is a fragment of.
    pub kind: &'a PatchKind,
    /// The deformed path and the frames from entry to exit.
    pub placed: &'a FragmentUse,
}

impl<'a> Segment<'a> {
    /// The capture.
    pub fn motion(&self) -> &'a Motion {
        &self.kind.fragments[self.placed.role as usize].motion
    }

    /// Source frame (with fraction) shown at a frame of the crowd.
    pub fn source_frame(&self, frame: i32) -> f32 {
        let last = self.motion().len() - 1;
        let at = (frame - self.placed.begin) as f32 * last as f32 / (self.placed.end - self.placed.begin) as f32;
        at.clamp(0.0, last as f32)
    }

    /// Frame of the crowd (with fraction) that shows a source frame.
    pub fn frame_of(&self, source_frame: f32) -> f32 {
        self.placed.begin as f32 + source_frame / self.rate()
    }

    /// Source frames per frame of the crowd.
    pub fn rate(&self) -> f32 {
        (self.motion().len() - 1) as f32 / (self.placed.end - self.placed.begin) as f32
    }
}

/// A person's final motion.
#[derive(Clone, Debug, Default)]
pub struct Body {
    /// First frame.
    pub begin: u32,
    /// Hips position per frame.
    pub root: Vec<Vec3>,
    /// Rotations, frame-major: hips' global, others local.
    pub rotations: Vec<Quat>,
    /// Indices of the frames on which a leg is too short for where its foot is planted.
    pub strained: Vec<usize>,
}

impl Body {
    /// Rotations of all joints at frame `index` of the motion.
    pub fn pose(&self, index: usize) -> &[Quat] {
        &self.rotations[index * JOINT_COUNT..(index + 1) * JOINT_COUNT]
    }

    /// Global joint transforms at frame `index` of the motion, into `out`.
    pub fn globals(&self, index: usize, out: &mut Vec<(Vec3, Quat)>) {
        canonical().globals(self.root[index], self.pose(index), out);
    }
}

/// People's final motions, and the boxes that they carry.
#[derive(Clone, Debug, Default)]
pub struct Performance {
    /// Everybody's motion.
    pub bodies: Vec<Body>,
    /// The boxes.
    pub props: Vec<Prop>,
    /// The order of the boxes.
    keys: Vec<prop::Key>,
}

impl Performance {
    /// Takes over the motions of some people and the boxes that they carry: `who` are their numbers, ascending.
    fn replace(&mut self, who: &[usize], bodies: Vec<Body>, led: Vec<(prop::Key, Prop)>) {
        let is_old = |key: &prop::Key| who.binary_search(&key.1).is_err();
        let kept = std::mem::take(&mut self.keys).into_iter().zip(std::mem::take(&mut self.props));
        let mut all: Vec<(prop::Key, Prop)> = kept.filter(|(key, _)| is_old(key)).collect();
        all.extend(led.into_iter().map(|((sat, person, segment, k), mut prop)| {
            prop.holds.iter_mut().for_each(|h| h.character = who[h.character as usize] as u32);
            ((sat, who[person], segment, k), prop)
        }));
        all.sort_by_key(|(key, _)| *key);
        (self.keys, self.props) = all.into_iter().unzip();
        who.iter().zip(bodies).for_each(|(&person, body)| self.bodies[person] = body);
    }
}

/// The final motion of a person over the frames 0..=last_frame of the crowd at which the person is there.
///
/// `segments` are in order of time and each begins where the one before ends. O(frames x joints).
pub fn refine(segments: &[Segment], last_frame: u32) -> Body {
    let mut body = walk(segments, last_frame);
    prop::lead(&[segments.to_vec()], std::slice::from_mut(&mut body), last_frame);
    body
}

fn walk(segments: &[Segment], last_frame: u32) -> Body {
    let mut body = carry::carry(segments, last_frame);
    feet::lock(segments, &mut body);
    body
}

/// The final motions of people who act together: each as [`refine`]d alone, but brought to touch again whom they touched,
/// and boxes go from hand to hand. On a torus they may be whole periods apart. In parallel over people.
pub fn refine_all(people: &[Vec<Segment>], last_frame: u32, torus: Torus) -> Performance {
    let mut out = Performance { bodies: vec![Body::default(); people.len()], ..Performance::default() };
    let who: Vec<usize> = (0..people.len()).collect();
    refine_some(people, &who, last_frame, torus, &mut out);
    out
}

/// The same of some of them only; `who` are their numbers, ascending. Who shares a patch with one of them must be one of
/// them.
pub fn refine_some(people: &[Vec<Segment>], who: &[usize], last_frame: u32, torus: Torus, out: &mut Performance) {
    let people: Vec<Vec<Segment>> = who.iter().map(|&person| people[person].clone()).collect();
    let mut bodies: Vec<Body> = people.par_iter().map(|segments| walk(segments, last_frame)).collect();
    touch::restore(&people, &mut bodies, torus);
    let led = prop::lead(&people, &mut bodies, last_frame);
    out.replace(who, bodies, led);
}

fn smoothstep(x: f32) -> f32 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// A crowd's full bodies made anew from its fragments and builds alone: what tiling ends with, as a pass of its own. A
/// crowd as it was baked comes out as it is. O(people x frames), in parallel over people.
pub fn refine_crowd(crowd: &Crowd) -> Crowd {
    if crowd.domain.periodic.t {
        // Everybody's life goes on as it began: the middle one of three laps knows what comes before and after.
        let (last, torus) = (crowd.domain.last_frame, crowd.domain.torus());
        let laps = refine_crowd(&crowd.laps(3));
        let mut again = Crowd { domain: crowd.domain.clone(), ..laps.cut(last, 2 * last) };
        for (now, was) in again.characters.iter_mut().zip(&crowd.characters) {
            // Who is in another tile a lap later comes back to this one.
            let away = now.root[0] - was.root[0];
            now.move_by(-torus.whole(Vec2::new(away.x, away.z)));
        }
        return again;
    }
    let people: Vec<Vec<Segment>> = crowd.characters.iter().map(|c| segments_of(crowd, c)).collect();
    let Performance { bodies, props, .. } = refine_all(&people, crowd.domain.last_frame, crowd.domain.torus());
    let dress = |((body, segments), c): ((Body, &Vec<Segment>), &Character)| {
        let body = fit(&body, &holds(segments, body.begin), &c.build);
        let rotations = body.rotations.into_iter().map(filed_rotation).collect();
        Character { begin: body.begin, root: body.root, rotations, ..c.clone() }
    };
    let characters = bodies.into_par_iter().zip(&people).zip(&crowd.characters).map(dress).collect();
    Crowd { characters, props, ..crowd.clone() }
}

fn segments_of<'a>(crowd: &'a Crowd, character: &'a Character) -> Vec<Segment<'a>> {
    let kind = |placed: &FragmentUse| &crowd.set.kinds[crowd.instances[placed.instance as usize].kind as usize];
    character.fragments.iter().map(|placed| Segment { kind: kind(placed), placed }).collect()
}
