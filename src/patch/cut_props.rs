//! The boxes of a patch: which of a take's holds fall into it, and where a box rests before and after.

use std::ops::Range;

use glam::{Vec2, Vec3};

use super::cut::frame;
use super::prop::{at_palms, settled};
use super::{Fragment, PatchKind, PatchProp, PropHold};
use crate::geom::{Ground, Upright};
use crate::motion::contacts::palm;
use crate::motion::joint::{LEFT_HAND, RIGHT_HAND};
use crate::motion::take::{TakeFile, TakeHold, TakePatch, TakeProp};
use crate::motion::{BODY_CAPSULES, Motion};

/// Shortest time over which both hold a box that is passed, frames.
pub(super) const PASS_FRAMES: u32 = 8;
/// A box is taken up at most this far from where it was put down, metres.
const ASTRAY: f32 = 0.1;
/// No hand that holds a box is farther from its face for most of the time, metres: it would not be led there.
const FARTHEST: f32 = 0.15;
/// A sitter's pelvis is this near to the top of the box, metres.
const SEAT: f32 = 0.02;
/// From the hips' joint down to where they touch the seat, metres.
const PELVIS: f32 = BODY_CAPSULES[0].radius;

/// The boxes that somebody holds or sits on in a patch whose clock begins at frame `start` of the take.
///
/// # Errors
/// Somebody takes a box from or hands it to a person who is not there, or takes it up where nobody put it down.
pub(super) fn of_patch(
    take: &TakeFile,
    patch: &TakePatch,
    start: usize,
    fragments: &[Fragment],
) -> Result<Vec<PatchProp>, String> {
    let cutter = Cutter { patch, start: start as u32, fragments };
    let props = take.props.iter().map(|prop| cutter.prop(prop).map_err(|e| format!("prop {}: {e}", prop.name)));
    props.filter_map(Result::transpose).collect()
}

struct Cutter<'a> {
    patch: &'a TakePatch,
    start: u32,
    fragments: &'a [Fragment],
}

/// A hold of a take that falls into a patch.
struct Held {
    /// Its index in the take.
    index: usize,
    /// Cut to the fragment.
    hold: PropHold,
    /// Whether the patch shows its beginning, and its end.
    whole: [bool; 2],
}

impl Cutter<'_> {
    fn prop(&self, prop: &TakeProp) -> Result<Option<PatchProp>, String> {
        let held: Vec<Held> = (0..prop.held.len()).filter_map(|k| self.held(&prop.held, k)).collect();
        let sat = (0..prop.sat.len()).filter_map(|k| Some(self.held(&prop.sat, k)?.hold)).collect();
        let (name, size, grip) = (prop.name.clone(), prop.size, prop.grip);
        let cut = PatchProp { name, size, grip, holds: vec![], sat, before: None, after: None };
        let (Some(first), Some(last)) = (held.first(), held.last()) else { return self.standing(prop, cut) };
        for pair in held.windows(2) {
            self.check_pass(prop, &cut, &pair[0], &pair[1])?;
        }
        let passed = |k: usize| prop.held[k + 1].begin <= prop.held[k].end;
        if first.whole[0] && first.index > 0 && passed(first.index - 1) {
            return Err(stranger(prop, first.index, first.index - 1, "takes it over from"));
        }
        if last.whole[1] && last.index + 1 < prop.held.len() && passed(last.index) {
            return Err(stranger(prop, last.index, last.index + 1, "hands it to"));
        }
        let mut holds: Vec<PropHold> = held.iter().map(|h| h.hold).collect();
        lengthen(&mut holds, |role| self.span(role));
        let (begin, end) = (holds[0], holds[holds.len() - 1]);
        let before = first.whole[0].then(|| self.rest(&cut, begin.role, begin.begin));
        let after = last.whole[1].then(|| self.rest(&cut, end.role, end.end));
        Ok(Some(PatchProp { holds, before, after, ..cut }))
    }

    /// A box that nobody of the patch moves: it stands under who sits on it.
    fn standing(&self, prop: &TakeProp, cut: PatchProp) -> Result<Option<PatchProp>, String> {
        let Some(seat) = cut.sat.first() else { return Ok(None) };
        let moved = |h: &TakeHold| self.patch.roles.iter().any(|r| r.begin < h.end && h.begin < r.end);
        if let Some(hold) = prop.held.iter().find(|h| moved(h)) {
            return Err(format!(
                "person {} holds it meanwhile: expected that person in the patch as well",
                hold.person
            ));
        }
        let motion = &self.fragments[seat.role as usize].motion;
        let at = under(motion.path.at((seat.begin - self.span(seat.role).0) as usize), prop.seat, prop.size[1]);
        Ok(Some(PatchProp { before: Some(at), after: Some(at), ..cut }))
    }

    /// The part of a hold in the patch; `None` if it has none.
    fn held(&self, holds: &[TakeHold], index: usize) -> Option<Held> {
        let hold = &holds[index];
        let role = self.patch.roles.iter().position(|r| r.person == hold.person)?;
        let (first, last) = self.span(role as u32);
        let (begin, end) = (frame(hold.begin) as u32, frame(hold.end) as u32);
        let (begin, end) = (begin.saturating_sub(self.start), end.checked_sub(self.start)?);
        let starts_here = frame(hold.begin) as u32 > self.start + first;
        let cut = PropHold { role: role as u32, begin: begin.max(first), end: end.min(last) };
        (cut.begin < cut.end).then_some(Held { index, hold: cut, whole: [starts_here, end < last] })
    }

    fn span(&self, role: u32) -> (u32, u32) {
        let f = &self.fragments[role as usize];
        (f.begin, f.begin + f.motion.len() as u32 - 1)
    }

    fn check_pass(&self, prop: &TakeProp, cut: &PatchProp, a: &Held, b: &Held) -> Result<(), String> {
        if b.index != a.index + 1 {
            return Err(stranger(prop, a.index, a.index + 1, "hands it to"));
        }
        let (giver, taker) = (prop.held[a.index].person, prop.held[b.index].person);
        if prop.held[b.index].begin > prop.held[a.index].end {
            let (put, taken) = (self.rest(cut, a.hold.role, a.hold.end), self.rest(cut, b.hold.role, b.hold.begin));
            let apart = put.middle.distance(taken.middle);
            let found = format!("found that place {apart:.2} m away");
            let expected = format!("expected person {taker} to take it up where person {giver} put it down");
            return if apart <= ASTRAY { Ok(()) } else { Err(format!("{expected}, {found}")) };
        }
        if !(a.whole[1] && b.whole[0]) {
            let expected = "expected both to be in the patch while it is passed";
            return Err(format!("person {giver} hands it to person {taker}: {expected}"));
        }
        Ok(())
    }

    /// Where the box is at a frame of the clock at which it is taken up or put down.
    fn rest(&self, prop: &PatchProp, role: u32, clock: u32) -> Upright {
        let kind = PatchKind { fragments: self.fragments.to_vec(), ..PatchKind::default() };
        settled(prop.in_hands(&kind, role, clock), prop.size[1])
    }
}

/// Gives passes that are annotated as a moment the time that hands need; `span` says when a role is there.
pub(super) fn lengthen(holds: &mut [PropHold], span: impl Fn(u32) -> (u32, u32)) {
    for k in 1..holds.len() {
        let (from, to) = (holds[k].begin, holds[k - 1].end);
        if to < from {
            continue;
        }
        let short = PASS_FRAMES.saturating_sub(to - from);
        let (giver, taker) = (span(holds[k - 1].role), span(holds[k].role));
        holds[k].begin = from.saturating_sub(short.div_ceil(2)).max(taker.0).max(holds[k - 1].begin + 1);
        holds[k - 1].end = (to + short.div_ceil(2)).min(giver.1).min(holds[k].end - 1);
    }
}

/// The place of a box of a height on the ground under a sitter, its middle `ahead` of the hips.
pub(super) fn under(sitter: Ground, ahead: f32, height: f32) -> Upright {
    let at = sitter.apply(Vec2::new(0.0, ahead));
    Upright { middle: Vec3::new(at.x, 0.5 * height, at.y), heading: sitter.heading }
}

/// Why a take's prop cannot be where the take says: hands that are not on it, or a sitter who is not. `None` if all is
/// well. O(frames held).
pub(super) fn misfit(prop: &TakeProp, motions: &[Motion]) -> Option<String> {
    let frames = |h: &TakeHold| frame(h.begin)..(frame(h.end) + 1).min(motions[h.person].len());
    let told = |h: &TakeHold, problem| format!("person {}, {:.2} s to {:.2} s: {problem}", h.person, h.begin, h.end);
    let hands = |h: &TakeHold| Some(told(h, hands_off(&motions[h.person], frames(h), prop.size, prop.grip)?));
    let hips = |s: &TakeHold| Some(told(s, hips_off(&motions[s.person], frames(s), prop.size[1])?));
    prop.held.iter().find_map(hands).or_else(|| prop.sat.iter().find_map(hips))
}

/// The same of a patch's prop, and whose hands or hips they are.
pub(super) fn far_from(prop: &PatchProp, kind: &PatchKind) -> Option<(u32, String)> {
    let shown = |h: &PropHold| {
        let fragment = &kind.fragments[h.role as usize];
        let frames = (h.begin - fragment.begin) as usize..(h.end + 1 - fragment.begin) as usize;
        (&fragment.motion, frames)
    };
    let hands = |h: &PropHold| {
        let (motion, frames) = shown(h);
        Some((h.role, hands_off(motion, frames, prop.size, prop.grip)?))
    };
    let hips = |s: &PropHold| {
        let (motion, frames) = shown(s);
        Some((s.role, hips_off(motion, frames, prop.size[1])?))
    };
    prop.holds.iter().find_map(hands).or_else(|| prop.sat.iter().find_map(hips))
}

/// What is wrong with hands that should hold a box: for most of the time they are too far from its faces to be led there.
fn hands_off(motion: &Motion, frames: Range<usize>, size: [f32; 3], grip: [f32; 2]) -> Option<String> {
    let mut globals = Vec::new();
    let mut away = |f: usize| {
        motion.globals(f, &mut globals);
        off_faces([palm(&globals, LEFT_HAND), palm(&globals, RIGHT_HAND)], size, grip)
    };
    let away: Vec<f32> = frames.map(&mut away).collect();
    let far = away.iter().filter(|&&d| d > FARTHEST).count();
    let nearest = away.iter().copied().fold(f32::INFINITY, f32::min);
    let expected = format!("expected hands on both faces of a box {:.2} m wide", size[0]);
    (2 * far > away.len()).then(|| format!("{expected}, found one {nearest:.2} m off at best"))
}

/// What is wrong with hips that should be on a box of a height.
fn hips_off(motion: &Motion, frames: Range<usize>, height: f32) -> Option<String> {
    let over = frames.map(|f| motion.heights[f] - PELVIS - height);
    let worst = over.max_by(|a, b| a.abs().total_cmp(&b.abs())).filter(|o| o.abs() > SEAT)?;
    Some(format!("expected a seat {height:.2} m high, as the box is; found one {:.2} m high", height + worst))
}

/// How far the worse of two palms is from the face that it should be on, metres.
fn off_faces([left, right]: [Vec3; 2], size: [f32; 3], grip: [f32; 2]) -> f32 {
    let place = at_palms(left, right, grip);
    let half = 0.5 * Vec3::from_array(size);
    let off = |palm: Vec3| {
        let at = place.seen_from(palm);
        at.distance(Vec3::new(half.x.copysign(at.x), at.y.clamp(-half.y, half.y), at.z.clamp(-half.z, half.z)))
    };
    off(left).max(off(right))
}

fn stranger(prop: &TakeProp, index: usize, other: usize, what: &str) -> String {
    let (person, stranger) = (prop.held[index].person, prop.held[other].person);
    format!("person {person} {what} person {stranger}: expected both in the patch while it is passed")
}
