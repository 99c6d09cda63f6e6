//! Boundaries of patches in raw captures ("Tiling Motion Patches" 2013, section 4.2): few recurring poses at which
//! patches begin and end, for the whole collection at once.
//!
//! 1. Frames at which motion may be cut are gathered, where nothing happens between people (`candidates`).
//! 2. They and their images in a mirror are clustered by pose (`cloud`, `cluster`, `groups`): sets hold mirrored copies.
//! 3. Of the largest groups those are chosen that make few kinds of boundary and small patches (`search`).
//! 4. Patches are bounded as near their events as the chosen groups allow; events that nothing separates share one
//!    (`bound`).

mod bound;
mod candidates;
mod cloud;
mod cluster;
mod groups;
mod search;
#[cfg(test)]
mod tests;

use self::candidates::speeds;
use self::cloud::Cloud;
pub use self::groups::Group;
use self::groups::Pool;
use self::search::{Line, Search};
use super::episode::Detection;
use crate::motion::Motion;

/// How boundaries are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundaryOptions {
    /// Any two poses of a group are nearer than this, metres: root mean square over the body's points and a short window,
    /// arms counting a fifth; default 0.26.
    pub threshold: f32,
    /// How many of the largest groups may be chosen from; default 10, at most 20.
    pub groups: usize,
    /// Most groups that are chosen; default 4.
    pub most: usize,
    /// What a group costs, in frames of motion; by default 2 % of the collection's frames, at most 300 (another kind of
    /// boundary must save as much as ten seconds).
    pub weight: Option<f32>,
    /// Most poses to cluster: of longer collections fewer frames of rests are candidates; default 1500.
    pub max_poses: usize,
}

impl Default for BoundaryOptions {
    fn default() -> Self {
        Self { threshold: 0.26, groups: 10, most: 4, weight: None, max_poses: 1500 }
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

/// A frame at which somebody's motion may be cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Cut {
    /// Which frame.
    pub frame: usize,
    /// Which pose group it belongs to.
    pub group: usize,
}

/// One person's part in a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// Person of the take.
    pub person: usize,
    /// First frame.
    pub entry: Cut,
    /// Last frame.
    pub exit: Cut,
}

/// A patch around one event, or around several that no boundary separates.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bounded {
    /// Which take.
    pub take: usize,
    /// Which of its events.
    pub events: Vec<usize>,
    /// From where to where for each of the events' people, in order.
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
    /// The largest pose groups, the largest first, each followed by its twin; cuts name them by index.
    pub groups: Vec<Group>,
    /// Those that are used.
    pub chosen: Vec<usize>,
    /// Of every person of every take, the frames at which they may be cut, sorted: those of the chosen groups.
    pub cuts: Vec<Vec<Vec<Cut>>>,
    /// The patches.
    pub patches: Vec<Bounded>,
    /// Events without a patch.
    pub unbounded: Vec<Unbounded>,
    /// Number of poses that were clustered, not counting their images.
    pub poses: usize,
    /// Number of subsets of groups that were looked at.
    pub tried: usize,
}

/// The boundaries of all events of a collection: the motions of each take, and what [`super::episode::detect_all`] found.
/// O(poses squared x body points) for the groups, at most `max_poses` of them, then O(subsets x cuts).
pub fn boundaries(takes: &[&[Motion]], found: &[Detection], options: &BoundaryOptions) -> Boundaries {
    let quiet = quiet(takes, found);
    let pool = Pool::new(takes, &quiet, options.max_poses);
    let groups = pool.largest(takes, options);
    let cuts = cuts(takes, &quiet, found, &groups, 0.5 * options.threshold);
    let lines = lines(takes, found, &cuts);
    let twins: Vec<usize> = groups.iter().map(|g| g.twin).collect();
    let frames: usize = lines.iter().map(|l| l.length).sum();
    let weight = options.weight.unwrap_or((0.02 * frames as f32).min(300.0));
    let choice = Search { lines: &lines, twins: &twins, weight, most: options.most }.choose();
    let chosen = |own: Vec<Cut>| own.into_iter().filter(|c| choice.groups.contains(&c.group)).collect();
    let cuts: Vec<Vec<Vec<Cut>>> = cuts.into_iter().map(|take| take.into_iter().map(chosen).collect()).collect();
    let each = found.iter().enumerate().map(|(index, d)| bound::Take { index, events: &d.events, cuts: &cuts[index] });
    let (patches, unbounded): (Vec<Vec<Bounded>>, Vec<Vec<Unbounded>>) = each.map(|take| take.bound()).unzip();
    Boundaries {
        patches: patches.concat(),
        unbounded: unbounded.concat(),
        chosen: choice.groups,
        tried: choice.tried,
        poses: pool.at.len(),
        cuts,
        groups,
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

/// The frames at which people may be cut, by take and person: the groups' members, and of people to whom something
/// happens every quiet frame that is as near to the middle of a group, so that events are surrounded tightly.
fn cuts(
    takes: &[&[Motion]],
    quiet: &[Vec<Vec<bool>>],
    found: &[Detection],
    groups: &[Group],
    radius: f32,
) -> Vec<Vec<Vec<Cut>>> {
    let mut cuts: Vec<Vec<Vec<Cut>>> = takes.iter().map(|t| vec![Vec::new(); t.len()]).collect();
    for (group, g) in groups.iter().enumerate() {
        for m in &g.members {
            cuts[m.take][m.person].push(Cut { frame: m.frame, group });
        }
    }
    for (take, detection) in found.iter().enumerate() {
        for person in (0..takes[take].len()).filter(|p| detection.events.iter().any(|e| e.people.contains(p))) {
            let motion = &takes[take][person];
            let speeds = speeds(motion);
            for frame in (0..motion.len()).filter(|&f| quiet[take][person][f]) {
                let cloud = Cloud::of(motion, frame);
                let near = (0..groups.len()).filter(|&g| groups[g].admits(&cloud, speeds[frame], radius));
                cuts[take][person].extend(near.map(|group| Cut { frame, group }));
            }
        }
    }
    for own in cuts.iter_mut().flatten() {
        own.sort_unstable();
        own.dedup();
    }
    cuts
}

/// Everybody's motion, where it may be cut, and when events are.
fn lines(takes: &[&[Motion]], found: &[Detection], cuts: &[Vec<Vec<Cut>>]) -> Vec<Line> {
    let mut lines = Vec::new();
    for ((people, detection), cuts) in takes.iter().zip(found).zip(cuts) {
        for (person, (motion, cuts)) in people.iter().zip(cuts).enumerate() {
            let own = || detection.events.iter().filter(|e| e.people.contains(&person));
            let events = own().map(|e| e.begin).min().zip(own().map(|e| e.end).max());
            let marks = cuts.iter().map(|c| (c.frame, c.group)).collect();
            lines.push(Line { length: motion.len(), marks, events });
        }
    }
    lines
}
