//! Contact: bodies that touch, by region, and from when to when.
//!
//! Where capsules touch or nearly touch, there is a contact. That alone would begin too early: hands that come together
//! overlap finger to finger before palms meet, and brush past what they are about to hold. So the contact proper is the
//! time over which the touching parts are as near each other as they get, up to a little, and do not slide.

use glam::Vec3;

use super::body::{Body, gap};
use super::event::{EventKind, Region, Sign, Touching};
use super::options::EpisodeOptions;
use crate::geom::Capsule;
use crate::motion::FPS;

/// People whose hips are farther apart than this cannot touch, metres.
const REACH: f32 = 2.4;
/// Gaps are not told apart beyond this, metres.
const FAR: f32 = 0.3;
/// What slides along another faster than this does not hold it, m/s.
const SLIDES: f32 = 0.35;
/// Frames for which a contact may be lost without ending.
const BRIDGED: usize = 2;
const REGIONS: usize = Region::ALL.len();

/// The smallest gap of every pair of regions.
type Gaps = [[f32; REGIONS]; REGIONS];

/// The contacts between two people: one sign for every time over which anything of them touches; and how near their
/// surfaces are at every frame.
pub(super) fn signs(people: [usize; 2], bodies: [&Body; 2], options: &EpisodeOptions) -> (Vec<Sign>, Vec<f32>) {
    let frames = bodies[0].len().min(bodies[1].len());
    let near = |f: &usize| bodies[0].places[*f].distance(bodies[1].places[*f]) < REACH;
    let gaps: Vec<(usize, Gaps)> = (0..frames).filter(near).map(|f| (f, gaps(bodies, f))).collect();
    let mut found = Vec::new();
    for (i, one) in Region::ALL.into_iter().enumerate() {
        for (j, other) in Region::ALL.into_iter().enumerate() {
            let signal: Vec<(usize, f32)> = gaps.iter().map(|(f, g)| (*f, g[i][j])).collect();
            for (begin, end) in runs(&signal, options.touch_gap, options.touch_gap + options.touch_slack) {
                let (begin, end) = settled(bodies, [one, other], &signal[begin..=end], options.touch_slack);
                let gap = signal.iter().filter(|s| (begin..=end).contains(&s.0)).map(|s| s.1).fold(FAR, f32::min);
                found.push(Touching { a: (people[0], one), b: (people[1], other), begin, end, gap });
            }
        }
    }
    let mut nearest = vec![FAR; frames];
    gaps.iter().for_each(|(f, g)| nearest[*f] = g.iter().flatten().copied().fold(FAR, f32::min));
    (gather(people, found, options.min_seconds), nearest)
}

fn gaps(bodies: [&Body; 2], frame: usize) -> Gaps {
    let mut gaps = [[FAR; REGIONS]; REGIONS];
    for (i, a) in bodies[0].capsules(frame).iter().enumerate() {
        for (j, b) in bodies[1].capsules(frame).iter().enumerate() {
            let least = &mut gaps[Region::of_capsule(i) as usize][Region::of_capsule(j) as usize];
            *least = least.min(gap(a, b, FAR));
        }
    }
    gaps
}

/// First and last indices of the runs of neighbouring frames below `upper` that somewhere are below `lower`.
fn runs(signal: &[(usize, f32)], lower: f32, upper: f32) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let mut at = 0;
    while at < signal.len() {
        if signal[at].1 >= upper {
            at += 1;
            continue;
        }
        let begin = at;
        while at + 1 < signal.len() && signal[at + 1].1 < upper && signal[at + 1].0 == signal[at].0 + 1 {
            at += 1;
        }
        if signal[begin..=at].iter().any(|s| s.1 < lower) {
            found.push((begin, at));
        }
        at += 1;
    }
    found
}

/// The longest stretch of a run over which the regions are as near each other as they are for half of it, up to `slack`
/// (not as near as they ever are: grips of captures give by centimetres), and do not slide; where they always slide, as
/// in a slap, the slowest frames count.
fn settled(bodies: [&Body; 2], regions: [Region; 2], run: &[(usize, f32)], slack: f32) -> (usize, usize) {
    let least = |values: &mut dyn Iterator<Item = f32>| values.fold(f32::INFINITY, f32::min);
    let apart: Vec<f32> = run.iter().map(|&(f, gap)| apart(bodies, regions, f, gap)).collect();
    let near = median(&apart) + slack;
    let slides: Vec<f32> = run.iter().map(|&(f, _)| sliding(bodies, regions, f)).collect();
    let while_near = &mut slides.iter().zip(&apart).filter(|s| *s.1 <= near).map(|s| *s.0);
    let slow = (1.5 * least(while_near)).max(SLIDES);
    let holds: Vec<bool> = apart.iter().zip(&slides).map(|(&gap, &slide)| gap <= near && slide <= slow).collect();
    let (mut first, mut last) = longest(&holds);
    // Hands that clap together, much nearer than they then hold, slide a moment longer: that belongs to the contact.
    let nearest = (0..run.len()).min_by(|&i, &j| apart[i].total_cmp(&apart[j])).unwrap_or(first);
    let claps = apart[nearest] + slack < median(&apart);
    if claps && nearest + BRIDGED + 1 >= first && nearest <= last + BRIDGED + 1 {
        (first, last) = (first.min(nearest), last.max(nearest));
    }
    (run[first].0, run[last].0)
}

fn median(values: &[f32]) -> f32 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f32::total_cmp);
    sorted[(sorted.len() - 1) / 2]
}

/// First and last index of the longest stretch that holds, up to pauses of [`BRIDGED`].
fn longest(holds: &[bool]) -> (usize, usize) {
    let mut stretches: Vec<(usize, usize)> = Vec::new();
    for i in (0..holds.len()).filter(|&i| holds[i]) {
        match stretches.last_mut() {
            Some(stretch) if i - stretch.1 <= BRIDGED + 1 => stretch.1 = i,
            _ => stretches.push((i, i)),
        }
    }
    // The first of the longest: max_by_key would take the last.
    stretches.into_iter().rev().max_by_key(|s| s.1 - s.0).unwrap_or((0, holds.len() - 1))
}

/// How fast two regions move past each other at a frame, m/s, before or after it, whichever is slower: a contact begins
/// with the frame after which nothing slides. 0 for limbs, which are long.
fn sliding(bodies: [&Body; 2], regions: [Region; 2], frame: usize) -> f32 {
    let last = bodies[0].len().min(bodies[1].len()) - 1;
    let between = |f: usize| {
        let [a, b] = [0, 1].map(|side| middle(bodies[side], regions[side], f));
        Some(b? - a?)
    };
    let speed = |from: usize, to: usize| match (between(from), between(to)) {
        _ if from == to => f32::INFINITY,
        (Some(p), Some(q)) => p.distance(q) * FPS,
        _ => 0.0,
    };
    let slower = speed(frame.saturating_sub(1), frame).min(speed(frame, (frame + 1).min(last)));
    if slower.is_finite() { slower } else { 0.0 }
}

/// A point that moves with a region.
fn middle(body: &Body, region: Region, frame: usize) -> Option<Vec3> {
    match region {
        Region::Torso => Some(body.chests[frame]),
        Region::Head => Some(body.faces[frame]),
        _ => palm(body, region, frame),
    }
}

/// How far regions are apart where it matters: hands touch with their palms. Metres.
fn apart(bodies: [&Body; 2], regions: [Region; 2], frame: usize, gap: f32) -> f32 {
    match [0, 1].map(|side| palm(bodies[side], regions[side], frame)) {
        [Some(a), Some(b)] => a.distance(b),
        [Some(a), None] => to_surface(a, bodies[1], regions[1], frame),
        [None, Some(b)] => to_surface(b, bodies[0], regions[0], frame),
        [None, None] => gap,
    }
}

fn palm(body: &Body, region: Region, frame: usize) -> Option<Vec3> {
    match region {
        Region::LeftHand => Some(body.palms[frame][0]),
        Region::RightHand => Some(body.palms[frame][1]),
        _ => None,
    }
}

fn to_surface(point: Vec3, body: &Body, region: Region, frame: usize) -> f32 {
    let point = Capsule { a: point, b: point, radius: 0.0 };
    let own = body.capsules(frame).iter().enumerate().filter(|(i, _)| Region::of_capsule(*i) == region);
    own.map(|(_, c)| gap(&point, c, FAR)).fold(FAR, f32::min)
}

/// One sign for touches that overlap in time. Where hands touch, they are what it is about: the sign's time is theirs,
/// and brushing limbs and bodies are only listed. Arms and legs alone must touch for longer than a brush.
fn gather(people: [usize; 2], found: Vec<Touching>, shortest: f32) -> Vec<Sign> {
    let hand = |t: &Touching| [t.a.1, t.b.1].iter().any(|r| matches!(r, Region::LeftHand | Region::RightHand));
    let limb = |t: &Touching| [t.a.1, t.b.1].iter().any(|r| r.part().is_none());
    let (led, mut rest): (Vec<Touching>, Vec<Touching>) = found.into_iter().partition(|t| hand(t) && !limb(t));
    let mut signs = unite(people, led);
    rest.retain(|t| match signs.iter_mut().find(|s| t.begin <= s.end + 1 && s.begin <= t.end + 1) {
        Some(sign) => {
            sign.touching.push(*t);
            false
        }
        None => !limb(t) || (t.end - t.begin) as f32 >= shortest * FPS,
    });
    signs.extend(unite(people, rest));
    signs.iter_mut().for_each(|s| s.touching.sort_by_key(order));
    signs
}

fn order(t: &Touching) -> (usize, usize, Region, Region) {
    (t.begin, t.end, t.a.1, t.b.1)
}

/// Touches that overlap in time are one sign.
fn unite(people: [usize; 2], mut found: Vec<Touching>) -> Vec<Sign> {
    found.sort_by_key(order);
    let mut signs: Vec<Sign> = Vec::new();
    for touching in found {
        let (begin, end) = (touching.begin, touching.end);
        match signs.last_mut() {
            Some(sign) if begin <= sign.end + 1 => {
                sign.end = sign.end.max(end);
                sign.touching.push(touching);
            }
            _ => signs.push(Sign { kind: EventKind::Contact, people, begin, end, touching: vec![touching] }),
        }
    }
    signs
}
