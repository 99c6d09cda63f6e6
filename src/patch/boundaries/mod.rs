//! Boundaries of patches around the episodes of raw captures ("Tiling Motion Patches" 2013, section 4.2): few recurring
//! poses at which patches begin and end, for the whole collection at once.
//!
//! Poses in which nothing happens are clustered (`cluster`); of the largest groups those are chosen that make few kinds of
//! boundary and small patches (`search`); every patch then begins and ends as near its event as a chosen pose allows.

mod cluster;
mod search;
#[cfg(test)]
mod tests;

use glam::Vec3;

use self::cluster::{Distances, groups};
use self::search::{Choice, Reach, choose};
use super::episode::{Detection, Event};
use crate::motion::{Motion, pose};

/// How boundaries are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundaryOptions {
    /// Any two poses of a group are nearer than this, metres (see [`pose::window_distance`]); default 0.12.
    pub threshold: f32,
    /// How many of the largest groups may be chosen from; default 10, at most 20.
    pub groups: usize,
    /// What a group costs, in frames of motion; default 60: another kind of boundary must save two seconds.
    pub weight: f32,
    /// Frames on each side of a pose that count as well, so that speeds matter; default 2.
    pub half_window: usize,
    /// Most poses to cluster: of longer collections every second, third, ... frame is a candidate; default 1500.
    pub max_poses: usize,
}

impl Default for BoundaryOptions {
    fn default() -> Self {
        Self { threshold: 0.12, groups: 10, weight: 60.0, half_window: 2, max_poses: 1500 }
    }
}

/// A frame of a collection.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Moment {
    /// Which take.
    pub take: usize,
    /// Which of its people.
    pub person: usize,
    /// Which frame.
    pub frame: usize,
}

/// One person's part in a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// Person of the take.
    pub person: usize,
    /// First frame and its group.
    pub entry: (usize, usize),
    /// Last frame and its group.
    pub exit: (usize, usize),
}

/// A patch around an event.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bounded {
    /// Which take.
    pub take: usize,
    /// Which of its events.
    pub event: usize,
    /// From where to where for each of the event's people, in their order.
    pub spans: Vec<Span>,
}

/// An event that no patch can be made of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unbounded {
    /// Which take.
    pub take: usize,
    /// Which of its events.
    pub event: usize,
    /// Why.
    pub reason: String,
}

/// The boundaries of a collection.
#[derive(Clone, Debug, PartialEq)]
pub struct Boundaries {
    /// The largest pose groups, the largest first; entries and exits name them by index.
    pub groups: Vec<Vec<Moment>>,
    /// Those that are used.
    pub chosen: Vec<usize>,
    /// The patches.
    pub patches: Vec<Bounded>,
    /// Events without a patch.
    pub unbounded: Vec<Unbounded>,
    /// Number of subsets of groups that were looked at.
    pub tried: usize,
}

/// The boundaries of all events of a collection: the motions of each take, and what [`super::episode::detect_all`] found.
/// O(poses squared x body points) for the groups, at most `max_poses` of them, then O(subsets x events).
pub fn boundaries(takes: &[&[Motion]], found: &[Detection], options: &BoundaryOptions) -> Boundaries {
    let quiet = quiet(takes, found);
    let groups = largest_groups(takes, &quiet, options);
    let labels = Labels::new(takes, &quiet, &groups);
    let mut unbounded = Vec::new();
    let mut kept: Vec<(usize, usize, Vec<Reach>)> = Vec::new();
    for (take, detection) in found.iter().enumerate() {
        for (event, e) in detection.events.iter().enumerate() {
            let reaches: Vec<Reach> = e.people.iter().map(|&p| labels.reach(take, p, e, groups.len())).collect();
            match stuck(e, &reaches) {
                Some(reason) => unbounded.push(Unbounded { take, event, reason }),
                None => kept.push((take, event, reaches)),
            }
        }
    }
    let all: Vec<Reach> = kept.iter().flat_map(|k| k.2.iter().cloned()).collect();
    let choice = choose(&all, groups.len(), options.weight).unwrap_or(Choice { groups: vec![], frames: 0, tried: 0 });
    let bounded = |(take, event, reaches): &(usize, usize, Vec<Reach>)| {
        let e = &found[*take].events[*event];
        let spans = e.people.iter().zip(reaches).map(|(&person, r)| span(person, e, r, &choice.groups));
        Bounded { take: *take, event: *event, spans: spans.collect() }
    };
    Boundaries {
        patches: kept.iter().map(bounded).collect(),
        chosen: choice.groups,
        tried: choice.tried,
        groups,
        unbounded,
    }
}

/// Of every person of every take, the frames at which nothing happens to them.
fn quiet(takes: &[&[Motion]], found: &[Detection]) -> Vec<Vec<Vec<bool>>> {
    let mut quiet: Vec<Vec<Vec<bool>>> =
        takes.iter().map(|t| t.iter().map(|m| vec![true; m.len()]).collect()).collect();
    for (take, detection) in quiet.iter_mut().zip(found) {
        for e in &detection.events {
            for &person in &e.people {
                take[person][e.begin..=e.end].fill(false);
            }
        }
    }
    quiet
}

fn largest_groups(takes: &[&[Motion]], quiet: &[Vec<Vec<bool>>], options: &BoundaryOptions) -> Vec<Vec<Moment>> {
    let mut moments = Vec::new();
    for (take, people) in quiet.iter().enumerate() {
        for (person, frames) in people.iter().enumerate() {
            let of = (0..frames.len()).filter(|&f| frames[f]).map(|frame| Moment { take, person, frame });
            moments.extend(of);
        }
    }
    let step = moments.len().div_ceil(options.max_poses.max(1)).max(1);
    moments.retain(|m| m.frame % step == 0);
    // Short stretches can each keep one frame more than their share.
    moments.truncate(2 * options.max_poses.max(1));
    let cloud = |m: &Moment| pose::window(&takes[m.take][m.person], m.frame, options.half_window);
    let clouds: Vec<Vec<Vec3>> = moments.iter().map(cloud).collect();
    let distances = Distances::measure(clouds.len(), |i, j| pose::cloud_distance(&clouds[i], &clouds[j]));
    let all = groups(distances, options.threshold).into_iter().take(options.groups);
    all.map(|members| members.into_iter().map(|i| moments[i]).collect()).collect()
}

/// The group of every frame that is in one, and where events are.
struct Labels<'a> {
    groups: Vec<Vec<Vec<Option<usize>>>>,
    quiet: &'a [Vec<Vec<bool>>],
}

impl<'a> Labels<'a> {
    fn new(takes: &[&[Motion]], quiet: &'a [Vec<Vec<bool>>], groups: &[Vec<Moment>]) -> Self {
        let mut labels: Vec<Vec<Vec<Option<usize>>>> =
            takes.iter().map(|t| t.iter().map(|m| vec![None; m.len()]).collect()).collect();
        for (group, members) in groups.iter().enumerate() {
            for m in members {
                labels[m.take][m.person][m.frame] = Some(group);
            }
        }
        Self { groups: labels, quiet }
    }

    /// How far a person's nearest frames of each group are from an event, up to their next one on either side.
    fn reach(&self, take: usize, person: usize, event: &Event, count: usize) -> Reach {
        let (labels, quiet) = (&self.groups[take][person], &self.quiet[take][person]);
        let nearest = |frames: &mut dyn Iterator<Item = usize>| {
            let mut first = vec![None; count];
            for (away, frame) in frames.take_while(|&f| quiet[f]).enumerate() {
                if let Some(group) = labels[frame] {
                    first[group].get_or_insert(away + 1);
                }
            }
            first
        };
        Reach { before: nearest(&mut (0..event.begin).rev()), after: nearest(&mut (event.end + 1..labels.len())) }
    }
}

/// Why an event cannot be bounded by any group; `None` if it can.
fn stuck(event: &Event, reaches: &[Reach]) -> Option<String> {
    event.people.iter().zip(reaches).find_map(|(person, r)| {
        let none = |side: &[Option<usize>]| side.iter().all(Option::is_none);
        let (side, frame) = match (none(&r.before), none(&r.after)) {
            (true, _) => ("before", event.begin),
            (false, true) => ("after", event.end),
            (false, false) => return None,
        };
        Some(format!(
            "person {person}: expected a recurring pose {side} frame {frame}, found none up to the next event"
        ))
    })
}

/// From where to where one person's part goes with the chosen groups.
fn span(person: usize, event: &Event, reach: &Reach, chosen: &[usize]) -> Span {
    let nearest = |side: &[Option<usize>]| {
        let all = chosen.iter().filter_map(|&g| Some((side[g]?, g)));
        all.min().expect("the chosen groups bound every event that is kept")
    };
    let ((before, entry), (after, exit)) = (nearest(&reach.before), nearest(&reach.after));
    Span { person, entry: (event.begin - before, entry), exit: (event.end + after, exit) }
}
