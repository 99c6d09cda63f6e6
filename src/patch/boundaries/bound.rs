//! Patches around events, once it is known where motion may be cut.

use super::{Bounded, Cut, Span, Unbounded};
use crate::patch::episode::Event;

/// The events of one take and where its people may be cut.
pub(super) struct Take<'a> {
    pub index: usize,
    pub events: &'a [Event],
    /// Of every person, sorted by frame.
    pub cuts: &'a [Vec<Cut>],
}

/// Two events of one person with nothing but quiet between them; `None` is the capture's begin or end.
struct Link {
    person: usize,
    before: Option<usize>,
    after: Option<usize>,
}

impl Take<'_> {
    /// A patch around every event, or around several that nothing separates; and the events that are lost because
    /// nothing bounds them towards the capture's begin or end.
    pub fn bound(&self) -> (Vec<Bounded>, Vec<Unbounded>) {
        let links = self.links();
        let lost = self.lost(&links);
        let group = self.together(&links, &lost);
        let kept = (0..self.events.len()).filter(|&e| lost[e].is_none());
        let mut members: Vec<Vec<usize>> = vec![Vec::new(); self.events.len()];
        kept.for_each(|e| members[root(&group, e)].push(e));
        let patches = members.into_iter().filter(|m| !m.is_empty()).map(|events| self.patch(events)).collect();
        let reason =
            |(event, reason): (usize, Option<String>)| Some(Unbounded { take: self.index, event, reason: reason? });
        (patches, lost.into_iter().enumerate().filter_map(reason).collect())
    }

    fn links(&self) -> Vec<Link> {
        let mut links = Vec::new();
        for person in 0..self.cuts.len() {
            let own = (0..self.events.len()).filter(|&e| self.events[e].people.contains(&person));
            let chain: Vec<Option<usize>> = [None].into_iter().chain(own.map(Some)).chain([None]).collect();
            links.extend(chain.windows(2).map(|w| Link { person, before: w[0], after: w[1] }));
        }
        links
    }

    /// The cuts between the two events of a link.
    fn between(&self, link: &Link) -> &[Cut] {
        let cuts = &self.cuts[link.person];
        let from = link.before.map_or(0, |e| cuts.partition_point(|c| c.frame <= self.events[e].end));
        let to = link.after.map_or(cuts.len(), |e| cuts.partition_point(|c| c.frame < self.events[e].begin));
        &cuts[from..to.max(from)]
    }

    /// Why each event is lost, if it is: nothing bounds it towards an end of the capture, or towards another lost one.
    fn lost(&self, links: &[Link]) -> Vec<Option<String>> {
        let mut lost: Vec<Option<String>> = vec![None; self.events.len()];
        loop {
            let open = |e: Option<usize>| e.is_none_or(|e| lost[e].is_some());
            let stuck = links.iter().filter(|l| self.between(l).is_empty()).find_map(|l| {
                let event = match (open(l.before), open(l.after)) {
                    (true, false) => (l.after?, "before frame", self.events[l.after?].begin),
                    (false, true) => (l.before?, "after frame", self.events[l.before?].end),
                    _ => return None,
                };
                Some((l.person, event))
            });
            let Some((person, (event, side, frame))) = stuck else { return lost };
            let problem = format!("expected a recurring pose {side} {frame}, found none up to the next event");
            lost[event] = Some(format!("person {person}: {problem}"));
        }
    }

    /// Of every event the first one of its patch: events that nothing separates, and all between two of a patch.
    fn together(&self, links: &[Link], lost: &[Option<String>]) -> Vec<usize> {
        let mut group: Vec<usize> = (0..self.events.len()).collect();
        for link in links.iter().filter(|l| self.between(l).is_empty()) {
            if let (Some(a), Some(b)) = (link.before, link.after)
                && lost[a].is_none()
                && lost[b].is_none()
            {
                join(&mut group, a, b);
            }
        }
        for person in 0..self.cuts.len() {
            let kept = |e: &usize| self.events[*e].people.contains(&person) && lost[*e].is_none();
            let own: Vec<usize> = (0..self.events.len()).filter(kept).collect();
            for (i, &first) in own.iter().enumerate() {
                let last = own.iter().rposition(|&e| root(&group, e) == root(&group, first)).unwrap_or(i);
                own[i..=last].iter().for_each(|&e| join(&mut group, first, e));
            }
        }
        group
    }

    fn patch(&self, events: Vec<usize>) -> Bounded {
        let mut people: Vec<usize> = events.iter().flat_map(|&e| self.events[e].people.clone()).collect();
        people.sort_unstable();
        people.dedup();
        let span = |person: usize| {
            let own = || events.iter().map(|&e| &self.events[e]).filter(|e| e.people.contains(&person));
            let begin = own().map(|e| e.begin).min().expect("people of events");
            let end = own().map(|e| e.end).max().expect("people of events");
            let cuts = &self.cuts[person];
            let entry = cuts[cuts.partition_point(|c| c.frame < begin) - 1];
            Span { person, entry, exit: cuts[cuts.partition_point(|c| c.frame <= end)] }
        };
        Bounded { take: self.index, spans: people.into_iter().map(span).collect(), events }
    }
}

fn join(group: &mut [usize], a: usize, b: usize) {
    let (a, b) = (root(group, a), root(group, b));
    group[a.max(b)] = a.min(b);
}

fn root(group: &[usize], mut i: usize) -> usize {
    while group[i] != i {
        i = group[i];
    }
    i
}
