//! Episodes against the ground truth of the generated samples, under moves, turns, other orders and in the mirror.
//!
//! Thresholds and rules were settled looking at the samples of seed 1 and one real handshake; seeds 2 and 3 were not
//! looked at. Seeds change how people move in detail, not what they do.

use glam::Vec2;
use proptest::prelude::*;

use super::*;
use crate::geom::Ground;
use crate::motion::take::{TakeFile, TakePatch};
use crate::motion::testing::{standing, walking};
use crate::motion::{FPS, mirror, retarget};
use crate::samples;

struct Sample {
    file: TakeFile,
    motions: Vec<Motion>,
}

fn takes(seed: u64) -> Vec<Sample> {
    let sample = |take: samples::Take| Sample { motions: retarget::take(&take.clips).unwrap(), file: take.file };
    samples::generate(seed).into_iter().filter(|t| !is_hopped(&t.file)).map(sample).collect()
}

/// Upper arms that knock against each other in a hop are no contact that is looked for.
pub(super) fn is_hopped(file: &TakeFile) -> bool {
    file.patches.iter().any(|p| p.labels.iter().any(|l| l == "hop"))
}

fn found(samples: &[Sample]) -> Vec<Detection> {
    let motions: Vec<&[Motion]> = samples.iter().map(|s| s.motions.as_slice()).collect();
    detect_all(&motions, &EpisodeOptions::default())
}

/// A contact event of the ground truth: two people, from when to when in seconds. Annotated contacts that overlap are one.
/// Where a box is handed over, hands meet at it as well, which no contact is annotated for: only a moment is known.
#[derive(Clone, Debug)]
struct Truth {
    people: [usize; 2],
    begin: f32,
    end: f32,
    handover: bool,
}

fn truths(file: &TakeFile) -> Vec<Truth> {
    let mut all: Vec<Truth> = Vec::new();
    for c in &file.contacts {
        let people = [c.a.person.min(c.b.person), c.a.person.max(c.b.person)];
        match all.iter_mut().find(|t| t.people == people && t.begin <= c.end && c.begin <= t.end) {
            Some(t) => (t.begin, t.end) = (t.begin.min(c.begin), t.end.max(c.end)),
            None => all.push(Truth { people, begin: c.begin, end: c.end, handover: false }),
        }
    }
    for pair in file.props.iter().flat_map(|p| p.held.windows(2)) {
        let (a, b) = (pair[0].person, pair[1].person);
        let people = [a.min(b), a.max(b)];
        let middle = 0.5 * (pair[1].begin + pair[0].end);
        all.push(Truth { people, begin: middle, end: middle, handover: true });
    }
    all
}

#[derive(Debug, Default)]
struct Score {
    truths: usize,
    recalled: usize,
    signs: usize,
    right: usize,
    handovers: usize,
    worst: f32,
    parts: usize,
    parts_found: usize,
}

fn meets(sign: &Sign, t: &Truth) -> bool {
    sign.people == t.people && sign.begin as f32 / FPS <= t.end && t.begin <= sign.end as f32 / FPS
}

fn score(samples: &[Sample]) -> Score {
    let mut score = Score::default();
    for (sample, found) in samples.iter().zip(found(samples)) {
        let truths = truths(&sample.file);
        let signs: Vec<&Sign> =
            found.events.iter().flat_map(|e| &e.signs).filter(|s| s.kind == EventKind::Contact).collect();
        score.truths += truths.len();
        score.signs += signs.len();
        score.right += signs.iter().filter(|s| truths.iter().any(|t| meets(s, t))).count();
        for t in &truths {
            let of: Vec<&&Sign> = signs.iter().filter(|s| meets(s, t)).collect();
            // One event each: two halves of one contact are not a contact found.
            score.recalled += usize::from(of.len() == 1);
            score.handovers += usize::from(t.handover);
            for s in of.iter().filter(|_| !t.handover) {
                let off = [s.begin as f32 / FPS - t.begin, s.end as f32 / FPS - t.end].map(f32::abs);
                println!("{} {off:.3?} s off", sample.file.name);
                score.worst = score.worst.max(off[0]).max(off[1]);
            }
        }
        for c in &sample.file.contacts {
            let is = |t: &Touching| {
                let sides = [(t.a.0, t.a.1.part()), (t.b.0, t.b.1.part())];
                let want = [(c.a.person, Some(c.a.part)), (c.b.person, Some(c.b.part))];
                (sides == want || sides == [want[1], want[0]])
                    && t.begin as f32 / FPS <= c.end
                    && c.begin <= t.end as f32 / FPS
            };
            score.parts += 1;
            score.parts_found += usize::from(signs.iter().any(|s| s.touching.iter().any(is)));
        }
    }
    score
}

#[test]
fn contacts_of_the_samples_are_found_at_their_times() {
    for seed in [1, 2, 3] {
        let score = score(&takes(seed));
        println!("seed {seed}: {score:?}");
        assert!(score.truths >= 10);
        assert!(score.recalled as f32 >= 0.95 * score.truths as f32, "seed {seed}: {score:?}");
        assert!(score.right as f32 >= 0.95 * score.signs as f32, "seed {seed}: {score:?}");
        assert!(score.worst <= 0.1, "seed {seed}: {score:?}");
    }
}

#[test]
fn every_meeting_of_the_samples_has_an_event_and_nobody_alone_has_one() {
    for seed in [1, 2] {
        let (samples, mut meetings) = (takes(seed), 0);
        for (sample, found) in samples.iter().zip(found(&samples)) {
            // Rows that bow to each other are too far apart to meet by themselves.
            let meets = |p: &&TakePatch| p.roles.len() > 1 && !p.labels.iter().any(|l| l == "staged");
            for patch in sample.file.patches.iter().filter(meets) {
                let [begin, end] = patch.core.unwrap();
                let inside = |e: &&Event| e.begin as f32 / FPS <= end && begin <= e.end as f32 / FPS;
                assert!(found.events.iter().any(|e| inside(&e)), "{}: {:?}", patch.name, found.why_nothing());
                meetings += 1;
            }
            if sample.motions.len() == 1 {
                assert!(found.why_nothing().unwrap().contains("found one"), "{:?}", found.events);
            }
        }
        assert!(meetings >= 20, "{meetings}");
    }
}

fn sample(name: &str) -> Vec<Motion> {
    let take = samples::generate(1).into_iter().find(|t| t.file.name == name).unwrap();
    retarget::take(&take.clips).unwrap()
}

/// What events say, in an order that does not depend on the people's.
fn summary(events: &[Event], person: impl Fn(usize) -> usize, region: impl Fn(Region) -> Region) -> Vec<String> {
    let side = |(p, r): (usize, Region)| (person(p), region(r));
    let mut lines = Vec::new();
    for e in events {
        let mut people: Vec<usize> = e.people.iter().map(|&p| person(p)).collect();
        people.sort_unstable();
        lines.push(format!("{:?} {people:?} {} {} {}", e.kind, e.begin, e.end, e.signs.len()));
        for t in e.touching() {
            let mut sides = [side(t.a), side(t.b)];
            sides.sort_unstable();
            lines.push(format!("  {sides:?} {} {}", t.begin, t.end));
        }
    }
    lines.sort();
    lines
}

fn placed(motions: &[Motion], by: Ground) -> Vec<Motion> {
    let place = |m: &Motion| {
        let mut moved = m.clone();
        moved.path.points.iter_mut().for_each(|p| *p = by.apply(*p));
        moved.path.headings.iter_mut().for_each(|h| *h += by.heading);
        moved
    };
    motions.iter().map(place).collect()
}

const SAME: fn(usize) -> usize = |p| p;

#[test]
fn where_and_which_way_round_a_take_is_does_not_matter() {
    for name in ["handshake-walk", "hug-stand", "trio-greet-stand"] {
        let motions = sample(name);
        let expected = summary(&detect(&motions, &EpisodeOptions::default()).events, SAME, |r| r);
        assert!(!expected.is_empty());
        for by in [Ground::new(Vec2::new(3.0, -8.0), 0.0), Ground::new(Vec2::new(-2.0, 5.0), 2.2)] {
            let found = detect(&placed(&motions, by), &EpisodeOptions::default());
            assert_eq!(summary(&found.events, SAME, |r| r), expected, "{name} {by:?}");
        }
    }
}

#[test]
fn the_order_of_people_does_not_matter() {
    for name in ["push-stand", "trio-greet-walk"] {
        let motions = sample(name);
        let expected = summary(&detect(&motions, &EpisodeOptions::default()).events, SAME, |r| r);
        let reversed: Vec<Motion> = motions.iter().rev().cloned().collect();
        let found = detect(&reversed, &EpisodeOptions::default());
        assert_eq!(summary(&found.events, |p| motions.len() - 1 - p, |r| r), expected, "{name}");
    }
}

#[test]
fn in_the_mirror_the_other_hands_touch() {
    for name in ["handshake-stand", "hug-walk"] {
        let motions = sample(name);
        let expected = summary(&detect(&motions, &EpisodeOptions::default()).events, SAME, |r| r);
        let mirrored: Vec<Motion> = motions.iter().map(mirror).collect();
        let found = detect(&mirrored, &EpisodeOptions::default());
        assert_eq!(summary(&found.events, SAME, Region::mirrored), expected, "{name}");
    }
}

#[test]
fn nothing_is_explained() {
    let why = |motions: &[Motion]| detect(motions, &EpisodeOptions::default()).why_nothing().unwrap();
    let away = |m: &Motion, metres: f32| placed(std::slice::from_ref(m), Ground::new(Vec2::new(metres, 0.0), 0.0));
    let (stand, walk) = (standing(2.0), walking(2.0));
    assert_eq!(why(&[]), "no event: expected people, found none");
    assert_eq!(why(std::slice::from_ref(&stand)), "no event: expected at least two people, found one (61 frames)");
    let one = standing(0.0);
    let alone = why(&[one.clone(), away(&one, 1.0).remove(0)]);
    assert!(alone.contains("expected at least two frames, found 1"), "{alone}");
    let never = why(&[walk.clone(), away(&walk, 6.0).remove(0)]);
    assert!(never.contains("nearest 6.00 m apart") && never.contains("they never meet"), "{never}");
    let idle = why(&[stand.clone(), away(&stand, 1.0).remove(0)]);
    assert!(idle.contains("nobody reacts noticeably while near (0 % of the threshold)"), "{idle}");
    let empty = why(&[Motion::default(), stand.clone()]);
    assert!(empty.contains("they share no frame"), "{empty}");
    // Side by side at one pace there is nothing to see either.
    let abreast = why(&[walk.clone(), away(&walk, 1.0).remove(0)]);
    assert!(abreast.contains("nobody reacts noticeably"), "{abreast}");
}

#[test]
fn events_keep_relative_placement_and_know_their_contacts() {
    let motions = sample("handshake-stand");
    let found = detect(&motions, &EpisodeOptions::default());
    let event = found.events.iter().find(|e| e.kind == EventKind::Contact).unwrap();
    let asked = event.constraints(&motions, event.begin);
    assert_eq!(asked.core, (0, (event.end - event.begin) as u32));
    let parts: Vec<_> = asked.contacts.iter().map(|c| (c.a.part, c.b.part)).collect();
    let hand = crate::motion::BodyPart::RightHand;
    assert_eq!(parts, [(hand, hand)]);
    for p in &asked.placements {
        for (i, first_from_second) in p.first_from_second.iter().enumerate() {
            let [a, b] = p.roles.map(|r| motions[event.people[r as usize]].path.at(p.begin + i));
            assert!(a.then(*first_from_second).position.distance(b.position) < 1e-4);
        }
    }
}

#[test]
fn who_does_not_share_anybody_merges_only_nearby() {
    let pair = sample("handshake-stand");
    let beside = |metres: f32| {
        let mut four = pair.clone();
        four.extend(placed(&pair, Ground::new(Vec2::new(metres, 0.0), 0.0)));
        detect(&four, &EpisodeOptions::default()).events
    };
    let contacts = |events: &[Event]| events.iter().filter(|e| e.kind == EventKind::Contact).count();
    assert_eq!(beside(1.5).iter().map(|e| e.people.clone()).collect::<Vec<_>>(), [[0, 1, 2, 3]]);
    // Beyond sight of each other.
    assert_eq!(contacts(&beside(30.0)), 2);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn events_are_well_formed(apart in 0.2f32..3.0, heading in -3.2f32..3.2, seconds in 0.0f32..3.0) {
        let other = placed(&[walking(seconds)], Ground::new(Vec2::new(apart, 1.0), heading)).remove(0);
        let motions = [walking(2.0), other];
        let found = detect(&motions, &EpisodeOptions::default());
        prop_assert_eq!(found.events.is_empty(), found.why_nothing().is_some());
        let frames = motions[0].len().min(motions[1].len());
        for e in &found.events {
            prop_assert!(e.begin <= e.end && e.end < frames && e.people == [0, 1], "{:?}", e);
            prop_assert!(e.signs.iter().all(|s| e.begin <= s.begin && s.begin <= s.end && s.end <= e.end));
            prop_assert!(e.signs.iter().all(|s| s.touching.is_empty() == (s.kind != EventKind::Contact)));
        }
    }
}
