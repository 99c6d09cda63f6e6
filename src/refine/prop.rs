//! Boxes: where they are, and the hands that hold them.
//!
//! A box is where the palms that hold it are, level, its width along the line between them; so it follows its holder
//! over stitches and deformed paths. Taken up it leaves the place where it rested within a moment, put down it comes to
//! rest likewise; passed it goes from one pair of hands to the other while both hold it. Then all hands are led onto its
//! faces by inverse kinematics, with a smooth beginning and end. A box that is only sat on stays where it is.

use std::collections::BTreeMap;
use std::f32::consts::{PI, TAU};

use glam::{Quat, Vec3};

use super::arm::{fade, move_hand};
use super::carry::ground_at;
use super::{Body, Segment, smoothstep};
use crate::geom::{Upright, wrap_angle};
use crate::motion::JointId;
use crate::motion::contacts::{PALM_DEPTH, palm};
use crate::motion::joint::{LEFT_HAND, RIGHT_HAND};
use crate::patch::PatchProp;
use crate::stage::{Holding, Prop};

/// Frames over which a hand begins and ceases to be led.
const FADE_FRAMES: i32 = 8;
/// Frames over which a box that is taken up leaves its place, and one that is put down comes to rest.
const LIFT_FRAMES: f32 = 8.0;
/// Most that a hand is led aside, metres.
const MAX_SHIFT: f32 = 0.15;
const HANDS: [JointId; 2] = [LEFT_HAND, RIGHT_HAND];

/// A box's place in the order of all: those that are held first, each by who is the first in number to hold it, that
/// person's segment and the number of the box in its kind.
pub(super) type Key = (bool, usize, usize, usize);

/// Puts hands onto the boxes that they hold, and answers these. O(people x frames with a box in the hands).
pub(super) fn lead(people: &[Vec<Segment>], bodies: &mut [Body], last_frame: u32) -> Vec<(Key, Prop)> {
    let mut props = Vec::new();
    for (key, stints) in found(people) {
        let life = Life::new(stints, bodies);
        life.turns.iter().for_each(|turn| life.put_hands(turn, &mut bodies[turn.person]));
        props.extend(life.prop(last_frame).map(|prop| (key, prop)));
    }
    for (person, segments) in people.iter().enumerate() {
        for (at, segment) in segments.iter().enumerate() {
            props.extend(standing(segment, last_frame).map(|(k, prop)| ((true, person, at, k), prop)));
        }
    }
    props
}

/// The boxes that nobody moves, on which the person of a segment is the first to sit.
fn standing<'a>(segment: &'a Segment, last_frame: u32) -> impl Iterator<Item = (usize, Prop)> + 'a {
    let role = segment.placed.role;
    segment.kind.props.iter().enumerate().filter(|(_, p)| p.holds.is_empty()).filter_map(move |(k, p)| {
        let (_, clock) = p.anchors()[0].filter(|a| a.0 == role)?;
        let frame = (clock - segment.kind.fragments[role as usize].begin) as usize;
        let place = p.before?.carried(world_from_patch(segment, frame));
        let places = vec![place; last_frame as usize + 1];
        Some((k, Prop { name: p.name.clone(), size: p.size, begin: 0, places, holds: vec![] }))
    })
}

/// A hold of a patch's box by one person.
struct Stint<'a> {
    person: usize,
    prop: &'a PatchProp,
    /// First and last frame of the crowd, with fraction.
    span: [f32; 2],
    /// Where the box rests in the world before it is taken up and after it is put down.
    rests: [Option<Upright>; 2],
}

impl<'a> Stint<'a> {
    fn all(person: usize, segment: &Segment<'a>, prop: &'a PatchProp) -> impl Iterator<Item = Self> {
        let fragment = &segment.kind.fragments[segment.placed.role as usize];
        let role = segment.placed.role;
        let kind = segment.kind;
        (0..prop.holds.len()).filter(move |&i| prop.holds[i].role == role).map(move |i| {
            let hold = &prop.holds[i];
            let [begin, end] = [hold.begin, hold.end].map(|clock| (clock - fragment.begin) as usize);
            let rest = |at: Option<Upright>, frame: usize| Some(at?.carried(world_from_patch(segment, frame)));
            // Where it rests between two holds as well.
            let put_down = match prop.holds.get(i + 1) {
                None => prop.after,
                Some(next) if hold.end + 1 < next.begin => prop.place(kind, hold.end + 1),
                Some(_) => None,
            };
            let taken_up = if i == 0 { prop.before } else { None };
            let span = [begin, end].map(|frame| segment.frame_of(frame as f32));
            Self { person, prop, span, rests: [rest(taken_up, begin), rest(put_down, end)] }
        })
    }
}

/// How a patch lies in the world for somebody who shows a frame of their fragment.
fn world_from_patch(segment: &Segment, frame: usize) -> crate::geom::Ground {
    let i = frame.min(segment.motion().len() - 2);
    ground_at(segment, i, (frame - i) as f32).then(segment.motion().path.at(frame).inverse())
}

/// The holds of every box, joined where one fragment takes a box along that the next brings.
fn found<'a>(people: &[Vec<Segment<'a>>]) -> Vec<(Key, Vec<Stint<'a>>)> {
    let mut found = Found::default();
    for (person, segments) in people.iter().enumerate() {
        let mut carried = None;
        for (at, segment) in segments.iter().enumerate() {
            let (instance, role, kind) = (segment.placed.instance, segment.placed.role, segment.kind);
            let mine = |p: &PatchProp| p.holds.iter().any(|h| h.role == role);
            for (k, prop) in kind.props.iter().enumerate().filter(|(_, p)| mine(p)) {
                let own = found.number(instance, k, (false, person, at, k));
                found.stints[own].extend(Stint::all(person, segment, prop));
            }
            if let (Some(before), Some(k)) = (carried, kind.carried_in(role)) {
                let own = found.number(instance, k, (false, person, at, k));
                found.join(before, own);
            }
            carried = kind.carried_out(role).map(|k| found.number(instance, k, (false, person, at, k)));
        }
    }
    found.boxes()
}

/// Boxes by their instance and their number in its kind, in the order found.
#[derive(Default)]
struct Found<'a> {
    numbers: BTreeMap<(u32, usize), usize>,
    stints: Vec<Vec<Stint<'a>>>,
    keys: Vec<Key>,
    /// Of boxes that turned out to be one the later refers to the earlier, others to themselves.
    same_as: Vec<usize>,
}

impl<'a> Found<'a> {
    fn number(&mut self, instance: u32, prop: usize, key: Key) -> usize {
        let new = self.stints.len();
        let number = *self.numbers.entry((instance, prop)).or_insert(new);
        if number == new {
            self.stints.push(Vec::new());
            self.keys.push(key);
            self.same_as.push(new);
        }
        number
    }

    fn first(&self, mut number: usize) -> usize {
        while self.same_as[number] != number {
            number = self.same_as[number];
        }
        number
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.first(a), self.first(b));
        self.same_as[a.max(b)] = a.min(b);
    }

    fn boxes(mut self) -> Vec<(Key, Vec<Stint<'a>>)> {
        for number in (0..self.stints.len()).rev() {
            let first = self.first(number);
            if first != number {
                let own = std::mem::take(&mut self.stints[number]);
                self.stints[first].extend(own);
            }
        }
        self.keys.into_iter().zip(self.stints).filter(|(_, s)| !s.is_empty()).collect()
    }
}

/// A box over all its time.
struct Life<'a> {
    prop: &'a PatchProp,
    turns: Vec<Turn>,
    /// Where it rests before the first turn.
    first_rest: Option<Upright>,
}

/// A time over which a person holds a box, over any number of stitched patches.
struct Turn {
    person: usize,
    /// First and last frame of the crowd, with fraction; maybe outside of its time.
    span: [f32; 2],
    /// Frames of the crowd, both included, at which the person is seen with it.
    first: i32,
    last: i32,
    /// Where the palms have the box and where they are, per frame.
    grasps: Vec<(Upright, [Vec3; 2])>,
    /// How much the box is turned against what its holder calls ahead: half turns, since it is taken from the other
    /// side.
    flip: f32,
    /// Where it rests afterwards, as its holder has it.
    put: Option<Upright>,
}

impl Turn {
    fn frame(&self, frame: i32) -> &(Upright, [Vec3; 2]) {
        &self.grasps[(frame.clamp(self.first, self.last) - self.first) as usize]
    }

    /// The box by its own idea of ahead.
    fn place(&self, frame: i32) -> Upright {
        let at = self.frame(frame).0;
        Upright { heading: at.heading + self.flip, ..at }
    }

    fn holds(&self, frame: i32) -> bool {
        self.first <= frame && frame <= self.last
    }

    /// Where it rests afterwards, by its own idea of ahead.
    fn rest(&self) -> Option<Upright> {
        self.put.map(|r| Upright { heading: r.heading + self.flip, ..r })
    }
}

impl<'a> Life<'a> {
    fn new(mut stints: Vec<Stint<'a>>, bodies: &[Body]) -> Self {
        stints.sort_by(|a, b| a.span[0].total_cmp(&b.span[0]).then(a.person.cmp(&b.person)));
        let prop = stints[0].prop;
        let mut spans: Vec<(usize, [f32; 2], Option<Upright>)> = Vec::new();
        for s in &stints {
            match spans.last_mut() {
                Some((person, span, put)) if *person == s.person && put.is_none() => {
                    (span[1], *put) = (s.span[1], s.rests[1]);
                }
                _ => spans.push((s.person, s.span, s.rests[1])),
            }
        }
        let (taken, put) = (stints[0].rests[0], spans[spans.len() - 1].2);
        let mut turns: Vec<Turn> = Vec::new();
        for (person, span, put) in spans {
            let Some(mut turn) = grasp(person, span, prop, &bodies[person]) else { continue };
            turn.put = put;
            if let Some(before) = turns.last() {
                let meet = (before.last + turn.first) / 2;
                let off = wrap_angle(before.place(meet).heading - turn.place(meet).heading);
                turn.flip = (off / PI).round() * PI;
            }
            turns.push(turn);
        }
        // Where nobody is seen with it, it rests all the time.
        let first_rest = if turns.is_empty() { taken.or(put) } else { taken };
        Self { prop, turns, first_rest }
    }

    /// The box at a frame; `None` where it is not there.
    fn place(&self, frame: i32) -> Option<Upright> {
        let Some(next) = self.turns.iter().rposition(|t| t.first <= frame) else { return self.first_rest };
        let (now, before) = (&self.turns[next], next.checked_sub(1).map(|i| &self.turns[i]));
        if frame > now.last {
            return now.rest();
        }
        let mut place = now.place(frame);
        if let Some(before) = before.filter(|b| b.holds(frame)) {
            let share = (frame - now.first) as f32 / (before.last - now.first).max(1) as f32;
            place = before.place(frame).lerp(place, smoothstep(share));
        }
        let at = frame as f32;
        if let Some(rest) = before.map_or(self.first_rest, Turn::rest) {
            place = rest.lerp(place, smoothstep((at - now.span[0]) / LIFT_FRAMES));
        }
        if let Some(rest) = now.rest() {
            place = rest.lerp(place, smoothstep((now.span[1] - at) / LIFT_FRAMES));
        }
        Some(place)
    }

    /// Leads the hands of who holds it onto its faces.
    fn put_hands(&self, turn: &Turn, body: &mut Body) {
        let shifts: Vec<[Vec3; 2]> = (turn.first..=turn.last).map(|f| self.shifts(turn, f)).collect();
        let from = body.begin as i32;
        let to = from + body.root.len() as i32 - 1;
        for frame in (turn.first - FADE_FRAMES).max(from)..=(turn.last + FADE_FRAMES).min(to) {
            let shift = shifts[(frame.clamp(turn.first, turn.last) - turn.first) as usize];
            let weight = fade((turn.first - frame).max(frame - turn.last), FADE_FRAMES);
            for (hand, shift) in HANDS.into_iter().zip(shift) {
                move_hand(body, (frame - from) as usize, hand, (shift * weight).clamp_length_max(MAX_SHIFT));
            }
        }
    }

    /// From the palms to where they hold the box.
    fn shifts(&self, turn: &Turn, frame: i32) -> [Vec3; 2] {
        let (seen, palms) = turn.frame(frame);
        let place = self.place(frame).expect("held");
        let place = Upright { heading: place.heading - turn.flip, ..place };
        let half = 0.5 * Vec3::from_array(self.prop.size);
        palms.map(|palm| {
            let at = seen.seen_from(palm);
            let on_face = Vec3::new((half.x + PALM_DEPTH).copysign(at.x), at.y.clamp(-half.y, half.y), at.z);
            place.apply(on_face) - palm
        })
    }

    /// The box of the crowd; `None` if it is never seen.
    fn prop(&self, last_frame: u32) -> Option<Prop> {
        let (first, last) = (self.turns.first(), self.turns.last());
        let begin = if self.first_rest.is_some() { 0 } else { first.map_or(0, |t| t.first) };
        let end = last.filter(|t| t.put.is_none()).map_or(last_frame as i32, |t| t.last);
        let mut places: Vec<Upright> = (begin..=end).map_while(|f| self.place(f)).collect();
        for i in 1..places.len() {
            places[i].heading += ((places[i - 1].heading - places[i].heading) / TAU).round() * TAU;
        }
        let hold = |t: &Turn| Holding { character: t.person as u32, begin: t.first as u32, end: t.last as u32 };
        (!places.is_empty()).then(|| Prop {
            name: self.prop.name.clone(),
            size: self.prop.size,
            begin: begin as u32,
            places,
            holds: self.turns.iter().map(hold).collect(),
        })
    }
}

/// What a person's palms do over a time; `None` if the person is not seen then.
fn grasp(person: usize, span: [f32; 2], prop: &PatchProp, body: &Body) -> Option<Turn> {
    let begin = body.begin as i32;
    let first = (span[0].ceil() as i32).max(begin);
    let last = (span[1].floor() as i32).min(begin + body.root.len() as i32 - 1);
    let mut globals: Vec<(Vec3, Quat)> = Vec::new();
    let grasps = (first..=last).map(|frame| {
        body.globals((frame - begin) as usize, &mut globals);
        let palms = HANDS.map(|hand| palm(&globals, hand));
        (prop.between(palms[0], palms[1]), palms)
    });
    (first <= last).then(|| Turn { person, span, first, last, grasps: grasps.collect(), flip: 0.0, put: None })
}
