//! Boundaries of the samples' episodes.

use super::*;
use crate::motion::retarget;
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
    let options = BoundaryOptions { max_poses: 700, ..Default::default() };
    let (found, b) = bounded(&takes, &options);
    assert!(b.patches.len() >= 4, "{:?} {:?}", b.patches, b.unbounded);
    let events: usize = found.iter().map(|d| d.events.len()).sum();
    assert_eq!(b.patches.len() + b.unbounded.len(), events);
    for p in &b.patches {
        let event = &found[p.take].events[p.event];
        assert_eq!(p.spans.iter().map(|s| s.person).collect::<Vec<_>>(), event.people);
        for s in &p.spans {
            assert!(s.entry.0 < event.begin && event.end < s.exit.0, "{s:?} {} {}", event.begin, event.end);
            for (frame, group) in [s.entry, s.exit] {
                let here = Moment { take: p.take, person: s.person, frame };
                assert!(b.chosen.contains(&group) && b.groups[group].contains(&here), "{here:?}");
            }
            let others = found[p.take].events.iter().enumerate().filter(|o| o.0 != p.event);
            for (_, other) in others.filter(|o| o.1.people.contains(&s.person)) {
                assert!(other.end < s.entry.0 || s.exit.0 < other.begin, "{s:?} {other:?}");
            }
        }
    }
}

#[test]
fn poses_of_a_group_are_nearer_than_the_threshold() {
    let takes = collection(&["handshake-walk"]);
    let options = BoundaryOptions { max_poses: 250, ..Default::default() };
    let (_, b) = bounded(&takes, &options);
    assert!(b.groups.len() > 1 && b.groups.windows(2).all(|g| g[0].len() >= g[1].len()));
    for group in &b.groups {
        for (i, p) in group.iter().enumerate() {
            for q in &group[i + 1..] {
                let (a, c) = (&takes[p.take][p.person], &takes[q.take][q.person]);
                assert!(pose::window_distance(a, p.frame, c, q.frame, options.half_window) < options.threshold);
            }
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
