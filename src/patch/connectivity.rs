//! Whether a set can go on: pose groups are where people pass from one patch to the next, so groups are the nodes and
//! kinds the edges of a graph, and what lacks an edge there can never be tiled without a loose end.
//!
//! People who act together come and go alone: in front of and after every patch of several people there must be kinds of
//! one person, however long the crowd plays. So everything here follows the kinds of one person.

mod advice;
mod graph;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};

use self::graph::Graph;
use super::{Fragment, PatchSet};
use crate::motion::FPS;

/// What one can do alone from a pose group: the least and the most over the kinds of one person that begin there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steering {
    /// Turn from entry to exit, degrees; left is positive.
    pub turn_deg: [f32; 2],
    /// Mean speed along the path, m/s.
    pub speed: [f32; 2],
    /// Time from entry to exit, seconds.
    pub secs: [f32; 2],
    /// Way to the left, seen from the entry, metres.
    pub left: [f32; 2],
    /// Way ahead, seen from the entry, metres.
    pub ahead: [f32; 2],
}

/// How many kinds lead to and from a pose group. A kind of several people counts once, however many of them do.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GroupLinks {
    /// Kinds of one person that end here.
    pub in_alone: u32,
    /// Kinds of several people in which somebody ends here.
    pub in_together: u32,
    /// Kinds of one person that begin here.
    pub out_alone: u32,
    /// Kinds of several people in which somebody begins here.
    pub out_together: u32,
    /// Where one can go alone from here; `None` if nowhere.
    pub steering: Option<Steering>,
}

impl GroupLinks {
    /// True if a kind begins or ends here.
    pub fn used(&self) -> bool {
        self.in_alone + self.in_together + self.out_alone + self.out_together > 0
    }
}

/// An edge of the graph: the kinds in which somebody goes from one group to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Group of the entry.
    pub entry: u32,
    /// Group of the exit.
    pub exit: u32,
    /// Kinds of one person.
    pub alone: u32,
    /// Roles of kinds of several people.
    pub together: u32,
}

/// Used groups between which one can go to and fro alone: a strongly connected component.
#[derive(Clone, Debug, PartialEq)]
pub struct Component {
    /// The groups, ascending.
    pub groups: Vec<u32>,
    /// One can go on inside it for ever.
    pub lasting: bool,
    /// One can come in alone from another component.
    pub entered: bool,
    /// One can leave it alone for another component.
    pub left: bool,
    /// There is most to do here: others are to be joined to this one.
    pub main: bool,
}

/// What the graph of a set's pose groups says. Groups and kinds are given by their indices in the set.
#[derive(Clone, Debug, PartialEq)]
pub struct Connectivity {
    /// By pose group.
    pub groups: Vec<GroupLinks>,
    /// All edges, by entry, then exit.
    pub links: Vec<Link>,
    /// The components of the used groups; people pass from earlier to later ones only. One is as it should be: others
    /// that are not left trap people, those that are not entered run dry.
    pub components: Vec<Component>,
    /// Kinds to whose entries no endless chain of kinds of one person leads.
    pub not_entered: Vec<u32>,
    /// Kinds from whose exits no endless chain of kinds of one person leads on.
    pub not_left: Vec<u32>,
    /// Every exit can be followed and every entry led up to, for ever and from anywhere: there is one component, and it
    /// lasts.
    pub closed: bool,
    /// Fewest ways of one person, from group to group, that close the set; empty if it is closed.
    pub missing: Vec<(u32, u32)>,
    /// What to capture, mirror or leave out, in words. A closed set gets advice where steering it is hard.
    pub advice: Vec<String>,
}

/// One person's way through a kind.
#[derive(Clone, Copy)]
struct Way {
    kind: u32,
    alone: bool,
    entry: u32,
    exit: u32,
}

/// Looks at how the kinds of a set follow each other. O(frames + kinds x people).
pub fn connectivity(set: &PatchSet) -> Connectivity {
    let ways = ways(set);
    let count = set.groups.len();
    let graph = alone_graph(count, &ways);
    let groups = group_links(set, &ways);
    let components = components(&graph, &groups);
    let lasting = || components.iter().filter(|c| c.lasting).flat_map(|c| &c.groups).copied();
    let (led_to, goes_on) = (graph.ahead(lasting()), graph.behind(lasting()));
    let not_entered = kinds_where(&ways, |w| !led_to[w.entry as usize]);
    let not_left = kinds_where(&ways, |w| !goes_on[w.exit as usize]);
    let mut found = Connectivity {
        links: links(&ways),
        closed: components.len() == 1 && components[0].lasting,
        groups,
        components,
        not_entered,
        not_left,
        missing: Vec::new(),
        advice: Vec::new(),
    };
    if let Some(main) = advice::main_component(&found) {
        found.components[main].main = true;
    }
    found.missing = advice::missing(&found);
    found.advice = advice::advice(set, &found, &ways);
    found
}

/// All people's ways. Those whose groups do not exist, in a set that is not valid, are left out.
fn ways(set: &PatchSet) -> Vec<Way> {
    let count = set.groups.len() as u32;
    let of = |(k, kind): (usize, &super::PatchKind)| {
        let (kind_index, alone) = (k as u32, kind.people() == 1);
        let way = move |f: &Fragment| Way { kind: kind_index, alone, entry: f.entry_group, exit: f.exit_group };
        kind.fragments.iter().map(way).collect::<Vec<_>>()
    };
    set.kinds.iter().enumerate().flat_map(of).filter(|w| w.entry.max(w.exit) < count).collect()
}

fn alone_graph(groups: usize, ways: &[Way]) -> Graph {
    Graph::new(groups, ways.iter().filter(|w| w.alone).map(|w| (w.entry, w.exit)))
}

fn links(ways: &[Way]) -> Vec<Link> {
    let mut counts = BTreeMap::<(u32, u32), (u32, u32)>::new();
    for way in ways {
        let (alone, together) = counts.entry((way.entry, way.exit)).or_default();
        *(if way.alone { alone } else { together }) += 1;
    }
    counts.into_iter().map(|((entry, exit), (alone, together))| Link { entry, exit, alone, together }).collect()
}

fn group_links(set: &PatchSet, ways: &[Way]) -> Vec<GroupLinks> {
    let mut groups = vec![GroupLinks::default(); set.groups.len()];
    for of_kind in ways.chunk_by(|a, b| a.kind == b.kind) {
        let alone = of_kind[0].alone;
        for entry in of_kind.iter().map(|w| w.entry).collect::<BTreeSet<u32>>() {
            let links = &mut groups[entry as usize];
            *(if alone { &mut links.out_alone } else { &mut links.out_together }) += 1;
        }
        for exit in of_kind.iter().map(|w| w.exit).collect::<BTreeSet<u32>>() {
            let links = &mut groups[exit as usize];
            *(if alone { &mut links.in_alone } else { &mut links.in_together }) += 1;
        }
    }
    for way in ways.iter().filter(|w| w.alone) {
        let steering = &mut groups[way.entry as usize].steering;
        if let Some(one) = Steering::of(&set.kinds[way.kind as usize].fragments[0]) {
            *steering = Some(steering.map_or(one, |s| s.or(one)));
        }
    }
    groups
}

impl Steering {
    /// That of one fragment; `None` if it has no two frames.
    fn of(fragment: &Fragment) -> Option<Self> {
        let path = &fragment.motion.path;
        let last = path.len().checked_sub(1).filter(|&last| last > 0)?;
        let way: f32 = path.points.windows(2).map(|p| p[0].distance(p[1])).sum();
        let secs = last as f32 / FPS;
        let exit = path.at(0).inverse().then(path.at(last));
        let both = |value: f32| [value; 2];
        Some(Self {
            turn_deg: both(exit.heading.to_degrees()),
            speed: both(way / secs),
            secs: both(secs),
            left: both(exit.position.x),
            ahead: both(exit.position.y),
        })
    }

    /// That of whoever has both choices.
    fn or(self, other: Self) -> Self {
        let wider = |a: [f32; 2], b: [f32; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        Self {
            turn_deg: wider(self.turn_deg, other.turn_deg),
            speed: wider(self.speed, other.speed),
            secs: wider(self.secs, other.secs),
            left: wider(self.left, other.left),
            ahead: wider(self.ahead, other.ahead),
        }
    }
}

fn components(graph: &Graph, groups: &[GroupLinks]) -> Vec<Component> {
    let mut components = graph.components();
    components.retain(|c| c.iter().any(|&g| groups[g as usize].used()));
    let describe = |groups: Vec<u32>| {
        let outside = |neighbours: &[u32]| neighbours.iter().any(|n| groups.binary_search(n).is_err());
        Component {
            lasting: groups.len() > 1 || graph.next(groups[0]).contains(&groups[0]),
            entered: groups.iter().any(|&g| outside(graph.previous(g))),
            left: groups.iter().any(|&g| outside(graph.next(g))),
            main: false,
            groups,
        }
    };
    components.into_iter().map(describe).collect()
}

/// The kinds in which somebody's way is such, ascending.
fn kinds_where(ways: &[Way], such: impl Fn(&Way) -> bool) -> Vec<u32> {
    let mut kinds: Vec<u32> = ways.iter().filter(|w| such(w)).map(|w| w.kind).collect();
    kinds.dedup();
    kinds
}
