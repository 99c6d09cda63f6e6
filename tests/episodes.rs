//! Episodes of real captures (see `mocap`): found without the annotation.

mod mocap;

use std::path::Path;

use crowdquilt::motion::take::TakeFile;
use crowdquilt::motion::{Motion, contacts, joint};
use crowdquilt::patch::episode::{Detection, EpisodeOptions, Event, EventKind, Region, detect, detect_all};
use crowdquilt::patch::{CutOptions, load_take};

/// The people of an example take, as they were captured: contacts that a person annotated are not used.
fn raw(name: &str) -> Option<Vec<Motion>> {
    let folder = mocap::folder()?;
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("examples/cmu/{name}.take.json"));
    let mut take = TakeFile::load(&path).unwrap();
    take.contacts.clear();
    Some(load_take(&path, &take, &CutOptions { captures: Some(folder), ..Default::default() }).unwrap())
}

fn print(name: &str, found: &Detection) {
    println!("{name}: {:?}", found.thresholds);
    for e in &found.events {
        println!("  {:?} of {:?}: {} to {}, {} signs", e.kind, e.people, e.begin, e.end, e.signs.len());
    }
}

/// The frame at which the right palms are nearest.
fn nearest(pair: &[Motion]) -> usize {
    let (mut a, mut b) = (Vec::new(), Vec::new());
    let mut gap = |frame: usize| {
        pair[0].globals(frame, &mut a);
        pair[1].globals(frame, &mut b);
        contacts::palm(&a, joint::RIGHT_HAND).distance(contacts::palm(&b, joint::RIGHT_HAND))
    };
    let gaps: Vec<f32> = (0..pair[0].len()).map(&mut gap).collect();
    (0..gaps.len()).min_by(|&i, &j| gaps[i].total_cmp(&gaps[j])).unwrap()
}

fn is_the_handshake(events: &[Event], moment: usize) {
    assert_eq!(events.len(), 1, "{events:?}");
    let e = &events[0];
    assert_eq!((e.kind, e.people.as_slice()), (EventKind::Contact, [0, 1].as_slice()));
    let hands = e.touching().find(|t| t.a.1 == Region::RightHand && t.b.1 == Region::RightHand).unwrap();
    assert!((hands.begin..=hands.end).contains(&moment), "nearest at {moment}: {hands:?}");
    // Annotated from 0.5 s to 1.8 s, where palms are within 16 cm.
    assert!(hands.begin.abs_diff(15) <= 3 && hands.end.abs_diff(54) <= 6, "{hands:?}");
}

#[test]
fn the_handshake_is_one_event_over_the_moment_when_hands_are_nearest() {
    let Some(pair) = raw("18_01-19_01") else { return };
    let found = detect(&pair, &EpisodeOptions::default());
    print("handshake", &found);
    is_the_handshake(&found.events, nearest(&pair));
}

#[test]
fn among_other_captures_the_handshake_is_still_one_event_and_dancers_hold_hands() {
    let Some(pair) = raw("18_01-19_01") else { return };
    let dances = ["60_03-61_03", "60_05-61_05"].map(|name| raw(name).unwrap());
    let start = std::time::Instant::now();
    let found = detect_all(&[&pair, &dances[0], &dances[1]], &EpisodeOptions::default());
    println!("{:.1} ms", 1e3 * start.elapsed().as_secs_f64());
    ["handshake", "dance", "dance"].iter().zip(&found).for_each(|(name, f)| print(name, f));
    is_the_handshake(&found[0].events, nearest(&pair));
    for dance in &found[1..] {
        let hand = |r: Region| matches!(r, Region::LeftHand | Region::RightHand);
        let held = dance.events.iter().flat_map(Event::touching).filter(|t| hand(t.a.1) && hand(t.b.1));
        assert!(held.count() >= 3, "{:?}", dance.events);
    }
}
