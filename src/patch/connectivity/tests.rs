//! A sound set, one fault per test, and brute force as the oracle.

use std::f32::consts::FRAC_PI_2;

use glam::Vec2;
use proptest::prelude::*;

use super::{Component, Connectivity, connectivity};
use crate::motion::{FPS, Motion, MotionPath};
use crate::patch::{Fragment, PatchKind, PatchSet, PoseGroup};

/// Somebody who goes `ahead` metres in `frames` frames and turns by `turn` radians over them.
fn fragment(entry: u32, exit: u32, frames: usize, ahead: f32, turn: f32) -> Fragment {
    let share = |f: usize| f as f32 / (frames - 1) as f32;
    let path = MotionPath {
        points: (0..frames).map(|f| Vec2::new(0.0, ahead * share(f))).collect(),
        headings: (0..frames).map(|f| turn * share(f)).collect(),
    };
    let motion = Motion { path, ..Motion::default() };
    Fragment { motion, begin: 0, entry_group: entry, exit_group: exit }
}

fn kind(name: String, ends: &[(u32, u32)], turn: f32) -> PatchKind {
    PatchKind {
        name,
        fragments: ends.iter().map(|&(a, b)| fragment(a, b, 31, 1.0, turn)).collect(),
        ..PatchKind::default()
    }
}

/// A set of kinds given by their people's groups; odd kinds turn left, even ones right.
fn set(names: &[&str], kinds: &[&[(u32, u32)]]) -> PatchSet {
    let turn = |i: usize| if i.is_multiple_of(2) { -1.0 } else { 1.0 };
    PatchSet {
        groups: names.iter().map(|n| PoseGroup { name: (*n).into() }).collect(),
        kinds: kinds.iter().enumerate().map(|(i, ends)| kind(format!("k{i}"), ends, turn(i))).collect(),
        study: None,
    }
}

const NAMES: [&str; 4] = ["stand", "walk_left", "walk_right", "sit"];
/// Start, step, step, stop, and two people who meet walking and end standing.
const SOUND: [&[(u32, u32)]; 5] = [&[(0, 1)], &[(1, 2)], &[(2, 1)], &[(2, 0)], &[(1, 0), (2, 0)]];

fn sound_and(more: &[&[(u32, u32)]]) -> PatchSet {
    set(&NAMES, &[&SOUND[..], more].concat())
}

fn one_advice(found: &Connectivity) -> &str {
    assert!(!found.closed);
    assert_eq!(found.advice.len(), 1, "{:?}", found.advice);
    &found.advice[0]
}

#[test]
fn a_sound_set_is_closed_and_needs_no_advice() {
    let found = connectivity(&sound_and(&[]));
    assert!(found.closed);
    assert_eq!(found.advice, Vec::<String>::new());
    assert_eq!(found.missing, []);
    assert!(found.not_entered.is_empty() && found.not_left.is_empty());
    let one = Component { groups: vec![0, 1, 2], lasting: true, entered: false, left: false, main: true };
    assert_eq!(found.components, [one]);
    let counts = |g: usize| {
        let g = &found.groups[g];
        [g.in_alone, g.in_together, g.out_alone, g.out_together]
    };
    assert_eq!([counts(0), counts(1), counts(2), counts(3)], [[1, 1, 1, 0], [2, 0, 1, 1], [1, 0, 2, 1], [0; 4]]);
    assert!(found.groups[2].used() && !found.groups[3].used());
    let links: Vec<_> = found.links.iter().map(|l| (l.entry, l.exit, l.alone, l.together)).collect();
    assert_eq!(links, [(0, 1, 1, 0), (1, 0, 0, 1), (1, 2, 1, 0), (2, 0, 1, 1), (2, 1, 1, 0)]);
}

#[test]
fn steering_is_what_the_kinds_alone_that_leave_a_group_offer() {
    let mut set = set(&["stand"], &[&[(0, 0)], &[(0, 0)], &[(0, 0), (0, 0)]]);
    set.kinds[0].fragments[0] = fragment(0, 0, 31, 2.0, FRAC_PI_2);
    set.kinds[1].fragments[0] = fragment(0, 0, 61, 1.0, -FRAC_PI_2 / 3.0);
    // The second one faces left (+x) at its entry, so that its way along +z goes to its right.
    set.kinds[1].fragments[0].motion.path.headings.iter_mut().for_each(|h| *h += FRAC_PI_2);
    let steering = connectivity(&set).groups[0].steering.unwrap();
    let near = |a: [f32; 2], b: [f32; 2]| assert!((a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-4, "{a:?} {b:?}");
    near(steering.turn_deg, [-30.0, 90.0]);
    near(steering.speed, [0.5, 2.0]);
    near(steering.secs, [30.0 / FPS, 60.0 / FPS]);
    near(steering.left, [-1.0, 0.0]);
    near(steering.ahead, [0.0, 2.0]);
}

#[test]
fn a_group_that_nobody_leaves() {
    let found = connectivity(&sound_and(&[&[(0, 3)], &[(1, 3), (2, 0)]]));
    assert_eq!((&found.not_left[..], &found.not_entered[..]), (&[5, 6][..], &[][..]));
    assert_eq!(
        one_advice(&found),
        "nobody leaves 'sit': capture somebody who goes from sit to stand, or leave out the 2 kinds that end there \
         (k5 and k6)"
    );
}

#[test]
fn a_group_to_which_nobody_comes() {
    let found = connectivity(&sound_and(&[&[(3, 2)]]));
    assert_eq!((&found.not_left[..], &found.not_entered[..]), (&[][..], &[5][..]));
    assert_eq!(
        one_advice(&found),
        "nobody comes to 'sit': capture somebody who goes from walk_right to sit, or leave out the kind that begins \
         there (k5)"
    );
}

#[test]
fn a_group_that_is_left_only_together() {
    let found = connectivity(&sound_and(&[&[(0, 3)], &[(3, 0), (3, 0)]]));
    assert_eq!(found.not_left, [5]);
    assert!(one_advice(&found).starts_with("nobody leaves 'sit' alone: capture somebody who goes from sit to "));
    assert!(one_advice(&found).ends_with("the 2 kinds that begin or end there (k5 and k6)"));
}

#[test]
fn a_trap_in_which_one_can_go_on() {
    let found = connectivity(&sound_and(&[&[(0, 3)], &[(3, 3)]]));
    assert!(found.not_left.is_empty() && found.not_entered.is_empty());
    let trap = Component { groups: vec![3], lasting: true, entered: true, left: false, main: false };
    assert_eq!(found.components[1], trap);
    assert!(one_advice(&found).starts_with("whoever comes to 'sit' stays there for ever: capture"));
}

#[test]
fn a_source_to_which_nobody_returns() {
    let found = connectivity(&sound_and(&[&[(3, 0)], &[(3, 3)]]));
    assert!(found.not_left.is_empty() && found.not_entered.is_empty());
    assert!(one_advice(&found).starts_with("nobody comes back to 'sit': capture"));
}

#[test]
fn an_island() {
    let found = connectivity(&sound_and(&[&[(3, 3)]]));
    assert_eq!(found.missing, [(3, 1), (1, 3)]);
    assert!(one_advice(&found).starts_with(
        "nobody comes to 'sit' and nobody leaves: capture somebody who goes from sit to walk_left and somebody who goes \
         from walk_left to sit, or leave out the kind that begins or ends there (k5)"
    ));
}

#[test]
fn a_set_of_people_together_only() {
    let found = connectivity(&set(&NAMES, &[&[(0, 0), (0, 3)]]));
    assert_eq!((&found.not_left[..], &found.not_entered[..]), (&[0][..], &[0][..]));
    assert!(one_advice(&found).contains("nobody acts alone"), "{:?}", found.advice);
    assert!(one_advice(&found).ends_with("between 'stand' and 'sit'"), "{:?}", found.advice);
}

#[test]
fn a_set_of_people_together_in_one_pose() {
    let found = connectivity(&set(&NAMES, &[&[(0, 0), (0, 0)]]));
    assert!(one_advice(&found).ends_with("goes from 'stand' back to 'stand'"), "{:?}", found.advice);
}

#[test]
fn a_set_that_mirrored_copies_close() {
    let found = connectivity(&set(&NAMES[1..3], &[&[(0, 1)], &[(0, 1)]]));
    assert!(found.advice[0].contains("mirrored copies"), "{:?}", found.advice);
    assert!(found.advice[1].starts_with("nobody leaves 'walk_right'"), "{:?}", found.advice);
    let mut twins = set(&NAMES[1..3], &[&[(0, 1)], &[(0, 1)]]);
    twins.kinds.iter_mut().for_each(|k| k.labels.push("symmetric".into()));
    assert!(!connectivity(&twins).advice[0].contains("mirror"), "{:?}", connectivity(&twins).advice);
}

#[test]
fn a_set_that_turns_to_one_side_only() {
    let mut set = sound_and(&[]);
    set.kinds.iter_mut().for_each(|k| k.fragments[0].motion.path.headings.iter_mut().for_each(|h| *h = h.abs()));
    let found = connectivity(&set);
    assert!(found.closed);
    assert!(found.advice[0].starts_with("nobody turns right alone"), "{:?}", found.advice);
    assert!(found.advice[0].ends_with("or mirror those who turn left"), "{:?}", found.advice);
}

#[test]
fn an_empty_set_is_not_closed() {
    let found = connectivity(&PatchSet::default());
    assert!(one_advice(&found).starts_with("the set is empty"));
}

#[test]
fn groups_that_do_not_exist_and_motions_without_frames_do_no_harm() {
    let mut set = set(&["stand"], &[&[(0, 7)], &[(0, 0)]]);
    set.kinds[1].fragments[0].motion = Motion::default();
    let found = connectivity(&set);
    assert!(found.closed && found.groups[0].steering.is_none());
}

/// All ends of chains of `length` kinds of one person that begin anywhere, by walking them.
fn chain_ends(set: &PatchSet, length: usize, backwards: bool) -> Vec<bool> {
    let mut here = vec![true; set.groups.len()];
    for _ in 0..length {
        let mut there = vec![false; set.groups.len()];
        for f in set.kinds.iter().filter(|k| k.people() == 1).map(|k| &k.fragments[0]) {
            let (from, to) = if backwards { (f.exit_group, f.entry_group) } else { (f.entry_group, f.exit_group) };
            there[to as usize] |= here[from as usize];
        }
        here = there;
    }
    here
}

/// Whether a chain of 1 to `length` kinds of one person leads from `from` to `to`.
fn leads(set: &PatchSet, from: u32, to: u32, length: usize) -> bool {
    let mut here = vec![false; set.groups.len()];
    here[from as usize] = true;
    (0..length).any(|_| {
        let mut there = vec![false; set.groups.len()];
        for f in set.kinds.iter().filter(|k| k.people() == 1).map(|k| &k.fragments[0]) {
            there[f.exit_group as usize] |= here[f.entry_group as usize];
        }
        here = there;
        here[to as usize]
    })
}

fn some_set() -> impl Strategy<Value = PatchSet> {
    let way = (0u32..6, 0u32..6);
    let kind = prop_oneof![3 => prop::collection::vec(way.clone(), 1), 1 => prop::collection::vec(way, 2..4)];
    prop::collection::vec(kind, 1..9).prop_map(|kinds| {
        let kinds: Vec<&[(u32, u32)]> = kinds.iter().map(Vec::as_slice).collect();
        set(&["a", "b", "c", "d", "e_left", "e_right"], &kinds)
    })
}

fn used(set: &PatchSet) -> Vec<u32> {
    let all = set.kinds.iter().flat_map(|k| &k.fragments).flat_map(|f| [f.entry_group, f.exit_group]);
    all.collect::<std::collections::BTreeSet<u32>>().into_iter().collect()
}

proptest! {
    #[test]
    fn what_is_found_is_what_walking_finds(set in some_set()) {
        let found = connectivity(&set);
        // A chain longer than there are groups goes round in circles, so that it can be as long as one likes.
        let (led_to, goes_on) = (chain_ends(&set, 7, false), chain_ends(&set, 7, true));
        let bad = |ok: &dyn Fn(&Fragment) -> bool| -> Vec<u32> {
            (0..set.kinds.len() as u32).filter(|&k| !set.kinds[k as usize].fragments.iter().all(ok)).collect()
        };
        prop_assert_eq!(&found.not_entered, &bad(&|f| led_to[f.entry_group as usize]));
        prop_assert_eq!(&found.not_left, &bad(&|f| goes_on[f.exit_group as usize]));
        let used = used(&set);
        let all = used.iter().all(|&a| used.iter().all(|&b| leads(&set, a, b, 7)));
        prop_assert_eq!(found.closed, all);
    }

    #[test]
    fn components_are_the_groups_that_lead_to_each_other(set in some_set()) {
        let found = connectivity(&set);
        let all: Vec<u32> = found.components.iter().flat_map(|c| c.groups.clone()).collect();
        prop_assert_eq!(all.len(), used(&set).len());
        let both = |a: u32, b: u32| a == b || (leads(&set, a, b, 7) && leads(&set, b, a, 7));
        for (i, c) in found.components.iter().enumerate() {
            for (j, d) in found.components.iter().enumerate() {
                prop_assert_eq!(both(c.groups[0], d.groups[0]), i == j);
                prop_assert!(i >= j || !leads(&set, d.groups[0], c.groups[0], 7), "from earlier to later ones only");
            }
            prop_assert!(c.groups.iter().all(|&g| both(c.groups[0], g)));
            prop_assert_eq!(c.lasting, leads(&set, c.groups[0], c.groups[0], 7));
            let outside = |g: &u32| !c.groups.contains(g);
            prop_assert_eq!(c.left, all.iter().filter(|g| outside(g)).any(|&g| leads(&set, c.groups[0], g, 7)));
            prop_assert_eq!(c.entered, all.iter().filter(|g| outside(g)).any(|&g| leads(&set, g, c.groups[0], 7)));
        }
    }

    #[test]
    fn what_is_missing_closes_the_set_and_nothing_is_missing_from_a_closed_one(mut set in some_set()) {
        let found = connectivity(&set);
        prop_assert_eq!(found.closed, found.missing.is_empty());
        prop_assert!(found.closed || !found.advice.is_empty());
        for (i, &way) in found.missing.iter().enumerate() {
            set.kinds.push(kind(format!("new{i}"), &[way], 0.0));
        }
        prop_assert!(connectivity(&set).closed, "{:?}", found.missing);
        for leave_out in 0..found.missing.len() {
            let mut fewer = set.clone();
            fewer.kinds.remove(set.kinds.len() - 1 - leave_out);
            prop_assert!(!connectivity(&fewer).closed, "one of {:?} is not needed", found.missing);
        }
    }
}
