//! How to close a set that is not, in words.

use std::collections::{BTreeMap, BTreeSet};

use super::{Component, Connectivity, Way, alone_graph};
use crate::motion::mirror;
use crate::patch::PatchSet;
use crate::patch::mirror::SYMMETRIC;

/// Kinds named at most in one sentence.
const NAMED: usize = 3;
/// People who act alone should be able to turn by this much to either side, degrees.
const TURN_DEG: f32 = 15.0;

/// The ways that close a set: from every component that nobody leaves to the main one, and from there to every component
/// that nobody enters. What lies between is on such a way already.
pub(super) fn missing(found: &Connectivity) -> Vec<(u32, u32)> {
    let homes = homes(found);
    let Some(main) = found.components.iter().position(|c| c.main) else { return Vec::new() };
    if found.components.len() == 1 {
        let hub = nearest(found, &homes, main, main);
        return if found.closed { Vec::new() } else { vec![(hub, hub)] };
    }
    let others = found.components.iter().enumerate().filter(|(_, c)| !c.main);
    let ways = others.flat_map(|(i, component)| {
        let (hub, own) = (nearest(found, &homes, main, i), nearest(found, &homes, i, main));
        let back = (!component.left).then_some((own, hub));
        [back, (!component.entered).then_some((hub, own))].into_iter().flatten()
    });
    ways.collect()
}

/// The component of each group; none for those that are not used.
fn homes(found: &Connectivity) -> Vec<Option<usize>> {
    let mut homes = vec![None; found.groups.len()];
    for (i, component) in found.components.iter().enumerate() {
        component.groups.iter().for_each(|&g| homes[g as usize] = Some(i));
    }
    homes
}

/// The component in which there is most to do alone, then most at all.
pub(super) fn main_component(found: &Connectivity) -> Option<usize> {
    let homes = homes(found);
    let mut alone = vec![0; found.components.len()];
    for link in &found.links {
        let home = homes[link.entry as usize];
        if let Some(i) = home.filter(|_| home == homes[link.exit as usize]) {
            alone[i] += link.alone;
        }
    }
    let all = |c: &Component| c.groups.iter().map(|&g| traffic(found, g)).sum::<u32>();
    let size = |i: &usize| (found.components[*i].lasting, alone[*i], all(&found.components[*i]));
    (0..found.components.len()).rev().max_by_key(size)
}

/// The group of a component that has most to do with another one already, then most to do at all.
fn nearest(found: &Connectivity, homes: &[Option<usize>], of: usize, to: usize) -> u32 {
    let mut ways = BTreeMap::<u32, u32>::new();
    for link in &found.links {
        for (own, other) in [(link.entry, link.exit), (link.exit, link.entry)] {
            if homes[own as usize] == Some(of) && homes[other as usize] == Some(to) {
                *ways.entry(own).or_default() += link.alone + link.together;
            }
        }
    }
    let most = |g: &&u32| (ways.get(g).copied().unwrap_or(0), traffic(found, **g));
    *found.components[of].groups.iter().rev().max_by_key(most).expect("components have groups")
}

fn traffic(found: &Connectivity, group: u32) -> u32 {
    let g = &found.groups[group as usize];
    g.in_alone + g.in_together + g.out_alone + g.out_together
}

pub(super) fn advice(set: &PatchSet, found: &Connectivity, ways: &[Way]) -> Vec<String> {
    if set.kinds.is_empty() {
        return vec!["the set is empty: capture somebody who walks, starts and stops".into()];
    }
    let writer = Writer { set, found, ways };
    if found.closed {
        return writer.steering().into_iter().collect();
    }
    if !ways.iter().any(|w| w.alone) {
        return vec![writer.nobody_alone()];
    }
    let mut advice: Vec<String> = writer.mirrored().into_iter().collect();
    if found.components.len() == 1 {
        let hub = writer.name(found.missing[0].0);
        advice.push(format!("nobody goes on from '{hub}': capture somebody who goes from {hub} back to {hub}"));
    }
    let others = found.components.iter().filter(|c| !c.main);
    advice.extend(others.filter_map(|component| writer.trap(component)));
    advice.extend(writer.steering());
    advice
}

struct Writer<'a> {
    set: &'a PatchSet,
    found: &'a Connectivity,
    ways: &'a [Way],
}

impl Writer<'_> {
    fn name(&self, group: u32) -> &str {
        &self.set.groups[group as usize].name
    }

    fn names(&self, component: &Component) -> String {
        listed(&component.groups.iter().map(|&g| format!("'{}'", self.name(g))).collect::<Vec<_>>())
    }

    /// No kind of one person at all.
    fn nobody_alone(&self) -> String {
        let used = (0..self.set.groups.len()).filter(|&g| self.found.groups[g].used());
        let used: Vec<String> = used.map(|g| format!("'{}'", self.name(g as u32))).collect();
        let between = match &used[..] {
            [one] => format!("from {one} back to {one}"),
            _ => format!("to and fro between {}", listed(&used)),
        };
        format!(
            "nobody acts alone, and only people alone lead from patch to patch: capture somebody who goes {between}"
        )
    }

    /// What is wrong with a component beside the main one; `None` for one that is on a way between others.
    fn trap(&self, component: &Component) -> Option<String> {
        let what = self.names(component);
        let fault = match (component.entered, component.left, component.lasting) {
            (true, true, _) => return None,
            (false, false, _) => format!("nobody comes to {what} and nobody leaves"),
            (true, false, true) => format!("whoever comes to {what} stays there for ever"),
            (true, false, false) => format!("nobody leaves {what}"),
            (false, true, true) => format!("nobody comes back to {what}"),
            (false, true, false) => format!("nobody comes to {what}"),
        };
        let own = |way: &&(u32, u32)| component.groups.contains(&way.0) || component.groups.contains(&way.1);
        let go = |w: &(u32, u32)| format!("somebody who goes from {} to {}", self.name(w.0), self.name(w.1));
        let capture: Vec<String> = self.found.missing.iter().filter(own).map(go).collect();
        let alone = if self.only_together(component) { " alone" } else { "" };
        Some(format!("{fault}{alone}: capture {}, or leave out {}", listed(&capture), self.kinds_at(component)))
    }

    /// Some do come or leave, but only with others.
    fn only_together(&self, component: &Component) -> bool {
        let inside = |group: u32| component.groups.contains(&group);
        let passes = |w: &Way| !w.alone && inside(w.entry) != inside(w.exit);
        self.ways.iter().any(|w| passes(w) && if inside(w.entry) { !component.left } else { !component.entered })
    }

    /// The kinds that begin or end in a component.
    fn kinds_at(&self, component: &Component) -> String {
        let inside = |group: u32| component.groups.contains(&group);
        let begins = self.ways.iter().any(|w| inside(w.entry));
        let ends = self.ways.iter().any(|w| inside(w.exit));
        let kinds = super::kinds_where(self.ways, |w| inside(w.entry) || inside(w.exit));
        let mut names: Vec<String> =
            kinds.iter().take(NAMED).map(|&k| self.set.kinds[k as usize].name.clone()).collect();
        if kinds.len() > NAMED {
            names.push(format!("{} more", kinds.len() - NAMED));
        }
        let one = kinds.len() == 1;
        let verb = match (begins, ends) {
            (true, true) => ["begin or end", "begins or ends"],
            (true, false) => ["begin", "begins"],
            _ => ["end", "ends"],
        }[usize::from(one)];
        let which = if one { "the kind".into() } else { format!("the {} kinds", kinds.len()) };
        format!("{which} that {verb} there ({})", listed(&names))
    }

    /// Mirrored copies, if the set lacks them and they close it.
    fn mirrored(&self) -> Option<String> {
        let mut names: Vec<String> = self.set.groups.iter().map(|g| g.name.clone()).collect();
        let mut ways = self.ways.to_vec();
        let mut twin = |group: u32| {
            let name = mirror::group(&self.set.groups[group as usize].name);
            names.iter().position(|n| *n == name).unwrap_or_else(|| {
                names.push(name);
                names.len() - 1
            }) as u32
        };
        for way in self.ways.iter().filter(|w| self.lacks_mirrored(w.kind)) {
            ways.push(Way { entry: twin(way.entry), exit: twin(way.exit), ..*way });
        }
        let graph = alone_graph(names.len(), &ways);
        let parts = graph.components();
        let used: BTreeSet<u32> = ways.iter().flat_map(|w| [w.entry, w.exit]).collect();
        let closed = parts.iter().filter(|c| c.iter().any(|g| used.contains(g))).count() == 1;
        let text = "add the mirrored copies of its kinds: with them the set is closed, without any new capture";
        (closed && ways.len() > self.ways.len()).then(|| text.into())
    }

    fn lacks_mirrored(&self, kind: u32) -> bool {
        let kind = &self.set.kinds[kind as usize];
        let twin = format!("{}-mirror", kind.name);
        !kind.mirrored && !kind.labels.iter().any(|l| l == SYMMETRIC) && !self.set.kinds.iter().any(|k| k.name == twin)
    }

    /// The sides to which nobody turns alone.
    fn steering(&self) -> Option<String> {
        let turns = || self.found.groups.iter().filter_map(|g| g.steering).map(|s| s.turn_deg);
        let right = turns().any(|t| t[0] < -TURN_DEG);
        let left = turns().any(|t| t[1] > TURN_DEG);
        let (lacks, other) = match (left, right) {
            (true, true) => return None,
            (true, false) => ("right", Some("left")),
            (false, true) => ("left", Some("right")),
            (false, false) => ("left or right", None),
        };
        let mirror = other.map_or(String::new(), |o| format!(", or mirror those who turn {o}"));
        Some(format!("nobody turns {lacks} alone by more than {TURN_DEG} degrees: capture somebody who does{mirror}"))
    }
}

/// `a, b and c`.
fn listed(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}
