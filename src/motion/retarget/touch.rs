//! Hands that touch in the capture touch after retargeting. Bodies of another size, and ways scaled to them, move hands
//! apart; so where hands of two people touch on the bones that were captured, arms are bent until palms and hands are
//! as near each other as they were. Before and after that the correction fades.
//!
//! Hands are never pushed apart: captured arms are often too short (CMU's end some centimetres before the wrist), and
//! hands that were holding each other are then nearer on the canonical body than on their own bones.

use glam::{Quat, Vec3};

use super::build::smooth;
use super::rig::Rig;
use super::{CANONICAL_LEG, Clip};
use crate::geom::Capsule;
use crate::motion::reach::move_palm;
use crate::motion::skeleton::joint::{LEFT_HAND, RIGHT_HAND};
use crate::motion::{FPS, Motion, canonical};

/// Captured hands that are no farther apart than this touch, metres from surface to surface: grips give, and bones
/// are not where the skin is.
const NEAR: f32 = 0.03;
/// Hands may be off by this, metres; nothing is changed for less.
const SLACK: f32 = 0.005;
/// No palm is moved farther than this at a time, metres.
const FARTHEST: f32 = 0.4;
/// How long a correction takes to fade in and out, seconds.
const FADE: f32 = 0.3;
/// Corrections are smoothed by this, frames: a hand may come to touch a second one all at once.
const EASE: f32 = 1.5;
/// A hand that touches several others settles between them; arms that stop short leave the rest to the others.
const PASSES: usize = 5;
/// Half the thickness of a hand of the canonical body, metres.
const THICK: f32 = 0.035;

const HANDS: [usize; 2] = [LEFT_HAND, RIGHT_HAND];

/// How near hands are that touch, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Near {
    /// From the centre of one palm to that of the other.
    pub palms: f32,
    /// From surface to surface; negative where hands are inside each other, as bones know of no bent fingers.
    pub hands: f32,
}

/// Two hands of different people that touch at times.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Touch {
    /// Person and side of each.
    pub hands: [(usize, usize); 2],
    /// By frame, where they touch.
    pub near: Vec<Option<Near>>,
}

impl Near {
    pub(super) fn of(one: &Capsule, other: &Capsule) -> Self {
        let hands = one.between(other).length() - one.radius - other.radius;
        Self { palms: palm(one).distance(palm(other)), hands }
    }
}

fn palm(hand: &Capsule) -> Vec3 {
    hand.a.midpoint(hand.b)
}

/// Which hands touch, as captured. O(people^2 x frames).
pub(super) fn measure(clips: &[Clip], rigs: &[Rig]) -> Vec<Touch> {
    let mut found = Vec::new();
    if clips.len() < 2 {
        return found;
    }
    let hands: Vec<[Vec<Capsule>; 2]> = clips.iter().zip(rigs).map(|(clip, rig)| captured(clip, rig)).collect();
    for a in 0..hands.len() {
        for b in a + 1..hands.len() {
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let near = hands[a][i].iter().zip(&hands[b][j]).map(|(a, b)| Near::of(a, b));
                let near: Vec<Option<Near>> = near.map(|n| (n.hands <= NEAR).then_some(n)).collect();
                if near.iter().any(Option::is_some) {
                    found.push(Touch { hands: [(a, i), (b, j)], near });
                }
            }
        }
    }
    found
}

/// A person's hands at every frame of the motion to be, on the captured bones; their size goes by the legs' length.
fn captured(clip: &Clip, rig: &Rig) -> [Vec<Capsule>; 2] {
    let size = rig.leg / CANONICAL_LEG;
    let mut globals = Vec::new();
    let frames: Vec<[Capsule; 2]> = (0..clip.frames())
        .map(|frame| {
            clip.globals(frame, &mut globals);
            HANDS.map(|joint| {
                let (wrist, turn) = rig.joints[joint].map_or((Vec3::NAN, Quat::IDENTITY), |own| globals[own]);
                hand(joint, wrist, turn * rig.rig_from_canonical[joint], size)
            })
        })
        .collect();
    let sampled = (clip.seconds() * FPS + 1e-3).floor() as usize + 1;
    let at = |k: usize, side: usize| {
        let at = (k as f32 / FPS * clip.fps).clamp(0.0, (frames.len() - 1) as f32);
        let (before, after) = (frames[at.floor() as usize][side], frames[at.ceil() as usize][side]);
        let part = at.fract();
        Capsule { a: before.a.lerp(after.a, part), b: before.b.lerp(after.b, part), radius: before.radius }
    };
    [0, 1].map(|side| (0..sampled).map(|k| at(k, side)).collect())
}

/// A hand from wrist to fingertips.
fn hand(joint: usize, wrist: Vec3, turn: Quat, size: f32) -> Capsule {
    let tip = canonical().joints[joint].tip.expect("hands have tips");
    Capsule { a: wrist, b: wrist + turn * tip * size, radius: THICK * size }
}

/// Both hands of a person at every frame.
pub(super) fn hands(motion: &Motion) -> [Vec<Capsule>; 2] {
    let mut found = [Vec::with_capacity(motion.len()), Vec::with_capacity(motion.len())];
    let mut globals = Vec::new();
    for frame in 0..motion.len() {
        motion.globals(frame, &mut globals);
        for (hands, joint) in found.iter_mut().zip(HANDS) {
            hands.push(hand(joint, globals[joint].0, globals[joint].1, 1.0));
        }
    }
    found
}

/// Bends arms so that hands that touch are as near each other as captured; each goes half of the way. O(frames).
pub(super) fn restore(motions: &mut [Motion], touches: &[Touch]) {
    for _ in 0..PASSES {
        let needs = needs(motions, touches);
        let worst = needs.iter().flatten().flatten().flatten().map(|need| need.length()).fold(0.0, f32::max);
        if worst < 1e-3 {
            return;
        }
        for (motion, both) in motions.iter_mut().zip(&needs) {
            for (hand, known) in HANDS.into_iter().zip(both) {
                for (frame, by) in eased(known).into_iter().enumerate() {
                    move_palm(motion, frame, hand, by.clamp_length_max(FARTHEST));
                }
            }
        }
    }
}

/// What a hand lacks at the frames in which it touches others.
type Needs = Vec<Option<Vec3>>;

/// How every person's hands have to move: the mean of what each touch asks for.
fn needs(motions: &[Motion], touches: &[Touch]) -> Vec<[Needs; 2]> {
    let found: Vec<[Vec<Capsule>; 2]> = motions.iter().map(hands).collect();
    let mut sums: Vec<[Vec<(Vec3, f32)>; 2]> =
        motions.iter().map(|m| [0, 1].map(|_| vec![(Vec3::ZERO, 0.0); m.len()])).collect();
    for touch in touches {
        let [(a, i), (b, j)] = touch.hands;
        let frames = touch.near.iter().zip(found[a][i].iter().zip(&found[b][j])).enumerate();
        for (frame, near, one, other) in frames.filter_map(|(f, (near, (p, q)))| Some((f, (*near)?, p, q))) {
            let half = 0.5 * need(one, other, near);
            for ((person, side), half) in [((a, i), half), ((b, j), -half)] {
                let sum = &mut sums[person][side][frame];
                *sum = (sum.0 + half, sum.1 + 1.0);
            }
        }
    }
    let mean = |(sum, count): (Vec3, f32)| (count > 0.0).then(|| sum / count);
    sums.into_iter().map(|both| both.map(|sums| sums.into_iter().map(mean).collect())).collect()
}

/// How the first hand has to move, if the other stays, to be as near it as asked for: first the palm, then what is left
/// for the whole hand. Nothing if it is off by less than [`SLACK`].
fn need(one: &Capsule, other: &Capsule, near: Near) -> Vec3 {
    let beyond = |way: Vec3, may: f32| way - way.clamp_length_max(may.max(0.0) + SLACK);
    let palms = beyond(palm(other) - palm(one), near.palms);
    let moved = Capsule { a: one.a + palms, b: one.b + palms, ..*one };
    palms + beyond(moved.between(other), near.hands + one.radius + other.radius)
}

/// Moves for all frames: as known where they are; between, from one known frame to the next, fading on the way if it
/// is long.
fn eased(known: &Needs) -> Vec<Vec3> {
    let mut moves = vec![Vec3::ZERO; known.len()];
    if known.iter().flatten().all(|need| *need == Vec3::ZERO) {
        return moves;
    }
    let fade = FADE * FPS;
    let ease = |t: f32| t * t * (3.0 - 2.0 * t);
    let frames: Vec<usize> = (0..known.len()).filter(|&f| known[f].is_some()).collect();
    for (frame, out) in moves.iter_mut().enumerate() {
        let next = frames.partition_point(|&f| f < frame);
        let side = |at: Option<&usize>| at.map(|&f| (known[f].unwrap_or_default(), frame.abs_diff(f) as f32));
        *out = match (side(next.checked_sub(1).and_then(|n| frames.get(n))), side(frames.get(next))) {
            (_, Some((after, 0.0))) => after,
            (Some((before, since)), Some((after, until))) if since + until < fade => {
                before.lerp(after, ease(since / (since + until)))
            }
            (before, after) => {
                let faded = |(need, away): (Vec3, f32)| need * (1.0 - ease((away / fade).min(1.0)));
                before.map_or(Vec3::ZERO, faded) + after.map_or(Vec3::ZERO, faded)
            }
        };
    }
    let axis = |k: usize| smooth(&moves.iter().map(|m| m[k]).collect::<Vec<f32>>(), EASE);
    let [x, y, z] = [0, 1, 2].map(axis);
    x.into_iter().zip(y).zip(z).map(|((x, y), z)| Vec3::new(x, y, z)).collect()
}
