//! Signs that are near each other in space and time make one event, also among more than two people.

use glam::Vec2;

use super::body::Body;
use super::event::{Event, Sign};
use super::options::EpisodeOptions;
use crate::motion::FPS;

/// Merges signs into events, sorted by begin. O(signs squared) where all are at one time.
pub(super) fn events(mut signs: Vec<Sign>, bodies: &[Body], options: &EpisodeOptions) -> Vec<Event> {
    signs.sort_by_key(|s| (s.begin, s.end, s.kind, s.people));
    let slack = (options.merge_seconds * FPS).round() as usize;
    let mut group: Vec<usize> = (0..signs.len()).collect();
    let mut running: Vec<usize> = Vec::new();
    for i in 0..signs.len() {
        running.retain(|&j| signs[j].end + slack >= signs[i].begin);
        for &j in &running {
            if near(&signs[i], &signs[j], bodies, options.merge_metres) {
                let (a, b) = (root(&mut group, i), root(&mut group, j));
                group[a.max(b)] = a.min(b);
            }
        }
        running.push(i);
    }
    let mut members: Vec<Vec<Sign>> = vec![Vec::new(); signs.len()];
    for (i, sign) in signs.into_iter().enumerate() {
        members[root(&mut group, i)].push(sign);
    }
    let mut events: Vec<Event> = members.into_iter().filter(|m| !m.is_empty()).map(Event::of).collect();
    events.sort_by(|a, b| (a.begin, a.end, &a.people).cmp(&(b.begin, b.end, &b.people)));
    events
}

/// Somebody in common, or not far from each other.
fn near(a: &Sign, b: &Sign, bodies: &[Body], metres: f32) -> bool {
    let shared = a.people.iter().any(|p| b.people.contains(p));
    shared || middle(a, bodies).distance(middle(b, bodies)) <= metres
}

/// Half-way between the two people, at half of the time.
fn middle(sign: &Sign, bodies: &[Body]) -> Vec2 {
    let [a, b] = sign.people.map(|p| bodies[p].places[(sign.begin + sign.end) / 2]);
    a.midpoint(b)
}

fn root(group: &mut [usize], mut i: usize) -> usize {
    while group[i] != i {
        group[i] = group[group[i]];
        i = group[i];
    }
    i
}
