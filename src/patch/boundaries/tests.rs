//! Boundaries of the samples' episodes.

use super::*;
use crate::motion::{mirror, retarget};
use crate::patch::episode::{EpisodeOptions, detect_all};
use crate::samples;

fn collection(names: &[&str]) -> Vec<Vec<Motion>> {
    let takes = samples::generate(1).into_iter().filter(|t| names.contains(&t.file.name.as_str()));
    takes.map(|t| retarget::take(&t.clips).unwrap()).collect()
}

fn bounded(takes: &[Vec<Motion>], options: &BoundaryOptions) -> (Vec<Detection>, Boundaries) {
    let takes: Vec<&[Motion]> = takes.iter().map(Vec::as_slice).collect();
    let found = detect_all(&takes, &EpisodeOptions::default());
    let boundaries = boundaries(&takes, &found, options);
    (found, boundaries)
}

#[test]
fn patches_surround_their_events_at_poses_of_the_chosen_groups_and_hold_no_other_event() {
    let takes = collection(&["handshake-walk", "high-five-walk", "push-walk", "talk-walk"]);
    let (found, b) = bounded(&takes, &BoundaryOptions::default());
    assert!(b.patches.len() >= 4, "{:?} {:?}", b.patches, b.unbounded);
    let events: usize = found.iter().map(|d| d.events.len()).sum();
    let in_patches: usize = b.patches.iter().map(|p| p.events.len()).sum();
    assert_eq!(in_patches + b.unbounded.len(), events);
    for p in &b.patches {
        let own: Vec<_> = p.events.iter().map(|&e| &found[p.take].events[e]).collect();
        for s in &p.spans {
            let mine = || own.iter().filter(|e| e.people.contains(&s.person));
            assert!(mine().all(|e| s.entry.frame < e.begin && e.end < s.exit.frame) && mine().count() > 0, "{s:?}");
            for cut in [s.entry, s.exit] {
                assert!(b.chosen.contains(&cut.group) && b.cuts[p.take][s.person].contains(&cut), "{cut:?}");
            }
            let others = (0..found[p.take].events.len()).filter(|e| !p.events.contains(e));
            for other in others.map(|e| &found[p.take].events[e]).filter(|e| e.people.contains(&s.person)) {
                assert!(other.end < s.entry.frame || s.exit.frame < other.begin, "{s:?} {other:?}");
            }
        }
    }
}

#[test]
fn poses_of_a_group_are_nearer_than_the_threshold() {
    let takes = collection(&["handshake-walk"]);
    let options = BoundaryOptions { max_poses: 250, ..Default::default() };
    let (_, b) = bounded(&takes, &options);
    assert!(b.groups.len() > 1 && b.poses <= 250);
    for group in &b.groups {
        let cloud = |m: &Moment| Cloud::of(&takes[m.take][m.person], m.frame);
        for (i, p) in group.members.iter().enumerate() {
            for q in &group.members[i + 1..] {
                assert!(cloud(p).distance(&cloud(q)) < options.threshold);
            }
        }
    }
}

#[test]
fn a_group_and_its_twin_are_images_of_each_other() {
    let takes = collection(&["handshake-walk", "speeds"]);
    let images: Vec<Vec<Motion>> = takes.iter().map(|t| t.iter().map(mirror::motion).collect()).collect();
    let (_, own) = bounded(&takes, &BoundaryOptions::default());
    let (_, other) = bounded(&images, &BoundaryOptions::default());
    for group in &own.groups {
        let twin = &own.groups[group.twin];
        assert_eq!((own.groups[twin.twin].phase, twin.phase), (group.phase, group.phase.mirrored()));
    }
    // Seen in a mirror everything is the same but for the names of the groups.
    assert_eq!(own.patches.len(), other.patches.len());
    for (p, q) in own.patches.iter().zip(&other.patches) {
        for (s, t) in p.spans.iter().zip(&q.spans) {
            assert_eq!((s.entry.frame, s.exit.frame), (t.entry.frame, t.exit.frame));
            assert_eq!(own.groups[s.entry.group].phase, other.groups[t.entry.group].phase.mirrored());
        }
    }
}

#[test]
fn without_quiet_frames_or_events_nothing_is_made_up() {
    let (_, none) = bounded(&[], &BoundaryOptions::default());
    assert!(none.groups.is_empty() && none.patches.is_empty() && none.unbounded.is_empty());
    // From the first to the last frame they shake hands.
    let whole = collection(&["handshake-stand"]).remove(0);
    let cut: Vec<Motion> = whole.iter().map(|m| m.slice(40, 60)).collect();
    let (found, b) = bounded(&[cut], &BoundaryOptions::default());
    assert_eq!((found[0].events.len(), b.patches.len(), b.unbounded.len()), (1, 0, 1));
    assert!(b.unbounded[0].reason.contains("person 0: expected a recurring pose before frame"), "{:?}", b.unbounded);
}
