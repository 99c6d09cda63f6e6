//! Patches of one person: what lies between neighbouring boundaries where nothing happens with others. Captures give many
//! that are much alike; those are kept that differ most in where and when they lead. Rests lead nowhere: of them the
//! quietest are kept, for where it is dense people stand.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3Swizzles};

use super::{Annotation, holds, labels, seconds};
use crate::motion::gait::Phase;
use crate::motion::joint::{HEAD, LEFT_FOOT, LEFT_HAND, RIGHT_FOOT, RIGHT_HAND};
use crate::motion::take::{TakeFile, TakePatch, TakeRole};
use crate::motion::{FPS, Motion, plants};
use crate::patch::boundaries::Cut;
use crate::patch::episode::Event;

/// Which patches of one person are kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AloneOptions {
    /// How many that are no rests, mirrored copies not counted; default 48.
    pub most: usize,
    /// How many rests; default 8.
    pub rests: usize,
    /// Shortest, seconds; default 0.4.
    pub min_seconds: f32,
    /// Longest, seconds; default 5.
    pub max_seconds: f32,
    /// Somebody who turns by more than this is said to turn, radians; default 20 degrees.
    pub turn: f32,
    /// Somebody between two rests acts where a hand, a foot or the head gets faster than this, m/s; default 1.2.
    pub act: f32,
}

impl Default for AloneOptions {
    fn default() -> Self {
        Self { most: 48, rests: 8, min_seconds: 0.4, max_seconds: 5.0, turn: 20f32.to_radians(), act: 1.2 }
    }
}

/// Cuts of one rest are this near to each other, frames.
const ONE_REST: usize = 8;
/// A rest shorter than this has one boundary, else two, frames.
const SHORT_REST: usize = 18;

/// A patch of one person.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Piece {
    pub take: usize,
    person: usize,
    entry: Cut,
    exit: Cut,
    label: &'static str,
    /// Whether hands hold something at the entry and at the exit.
    holds: [bool; 2],
    /// Before, between or after events of the person.
    between: bool,
    /// Of a rest, how far hands, feet and head get from the middle of it, metres; else none.
    reach: Option<f32>,
    /// Where it leads, seen from the entry: metres aside and ahead, and turn and time scaled to metres.
    leads: [f32; 4],
}

impl Piece {
    pub fn patch(&self, take: &TakeFile, number: usize) -> TakePatch {
        let mut words = vec![self.label.to_owned()];
        labels::add_words(&mut words, &take.description);
        TakePatch {
            name: format!("{}-{}-alone-{number}", self.label, take.name),
            labels: words,
            roles: vec![TakeRole {
                person: self.person,
                begin: seconds(self.entry.frame),
                end: seconds(self.exit.frame),
            }],
            core: None,
        }
    }

    fn apart(&self, other: &Self) -> f32 {
        self.leads.iter().zip(other.leads).map(|(a, b)| (a - b).powi(2)).sum::<f32>().sqrt()
    }
}

/// The pieces that are kept, by take, person and time.
pub(super) fn pieces(
    takes: &[TakeFile],
    motions: &[Vec<Motion>],
    found: &Annotation,
    options: &AloneOptions,
) -> Vec<Piece> {
    let mut all = Vec::new();
    for (take, people) in motions.iter().enumerate() {
        for (person, motion) in people.iter().enumerate() {
            let maker = Maker { file: &takes[take], take, person, motion, found, options };
            all.extend(maker.pieces());
        }
    }
    let (rests, ways) = all.into_iter().partition(|p| p.reach.is_some());
    let mut kept = choose(ways, options.most);
    kept.extend(quietest(rests, options.rests));
    kept.sort_by_key(|p| (p.take, p.person, p.entry, p.exit));
    kept
}

struct Maker<'a> {
    file: &'a TakeFile,
    take: usize,
    person: usize,
    motion: &'a Motion,
    found: &'a Annotation,
    options: &'a AloneOptions,
}

impl Maker<'_> {
    fn pieces(&self) -> Vec<Piece> {
        let ports = self.ports();
        let mut pieces = Vec::new();
        for (i, &entry) in ports.iter().enumerate() {
            for (skipped, &exit) in ports[i + 1..].iter().take(2).enumerate() {
                // Two steps bend more gracefully than one.
                let steps = ports[i..=i + 1 + skipped].iter().all(|c| self.phase(*c) != Phase::Stand);
                if (skipped == 0 || steps) && self.sound(entry, exit) {
                    pieces.push(self.piece(entry, exit));
                }
            }
        }
        pieces
    }

    fn phase(&self, cut: Cut) -> Phase {
        self.found.boundaries.groups[cut.group].phase
    }

    /// The person's cuts; of a rest only both ends, of a short one the middle.
    fn ports(&self) -> Vec<Cut> {
        let cuts = &self.found.boundaries.cuts[self.take][self.person];
        let one = |a: &Cut, b: &Cut| {
            a.group == b.group && self.phase(*a) == Phase::Stand && b.frame - a.frame <= ONE_REST && self.quiet(*a, *b)
        };
        let mut ports = Vec::new();
        for rest in cuts.chunk_by(one) {
            let (first, last) = (rest[0], rest[rest.len() - 1]);
            match last.frame - first.frame < SHORT_REST {
                true => ports.push(rest[rest.len() / 2]),
                false => ports.extend([first, last]),
            }
        }
        ports
    }

    fn quiet(&self, from: Cut, to: Cut) -> bool {
        self.own_events().all(|e| e.end < from.frame || to.frame < e.begin)
    }

    fn own_events(&self) -> impl Iterator<Item = &Event> {
        self.found.found[self.take].events.iter().filter(|e| e.people.contains(&self.person))
    }

    fn sound(&self, from: Cut, to: Cut) -> bool {
        let seconds = (to.frame - from.frame) as f32 / FPS;
        (self.options.min_seconds..=self.options.max_seconds).contains(&seconds) && self.quiet(from, to)
    }

    fn piece(&self, entry: Cut, exit: Cut) -> Piece {
        let path = &self.motion.path;
        let turned = path.headings[exit.frame] - path.headings[entry.frame];
        let way = path.at(entry.frame).inverse().then(path.at(exit.frame)).position;
        let time = (exit.frame - entry.frame) as f32 / FPS;
        let acts = self.fastest(entry.frame, exit.frame) > self.options.act;
        let label = labels::of_motion(self.phase(entry), self.phase(exit), turned.abs() > self.options.turn, acts);
        let rests = label == labels::REST && entry.group == exit.group;
        Piece {
            take: self.take,
            person: self.person,
            entry,
            exit,
            holds: [entry, exit].map(|cut| holds(self.file, self.person, cut.frame)),
            between: self.own_events().next().is_some(),
            label,
            reach: rests.then(|| self.reach(entry.frame, exit.frame)),
            leads: [way.x, way.y, 0.5 * turned, 0.5 * time],
        }
    }

    /// The fastest of hands, feet and head between two frames, m/s.
    fn fastest(&self, first: usize, last: usize) -> f32 {
        let own = self.motion.slice(first, last);
        let of = |joint| plants::speeds(&plants::trajectory(&own, joint), FPS);
        ENDS.into_iter().flat_map(of).fold(0.0, f32::max)
    }

    /// How far hands, feet and head get from the middle of the way between two frames, metres along the ground.
    fn reach(&self, first: usize, last: usize) -> f32 {
        let own = self.motion.slice(first, last);
        let middle = own.path.points.iter().sum::<Vec2>() / own.path.points.len() as f32;
        let of = |joint| plants::trajectory(&own, joint).into_iter().map(|p| p.xz().distance(middle));
        ENDS.into_iter().flat_map(of).fold(0.0, f32::max)
    }
}

/// Where a body ends.
const ENDS: [usize; 5] = [HEAD, LEFT_FOOT, LEFT_HAND, RIGHT_FOOT, RIGHT_HAND];

/// At most `most` pieces, taken in turn from all pairs of entry and exit group, with and without something in the hands: of
/// each pair first the most typical, then always the one that differs most from those taken. What people do between two events (dancers keep their arms up)
/// serves only where nobody who is alone leads from the one group to the other.
fn choose(all: Vec<Piece>, most: usize) -> Vec<Piece> {
    let mut ways: BTreeMap<(usize, usize, [bool; 2]), Vec<Piece>> = BTreeMap::new();
    for piece in all {
        ways.entry((piece.entry.group, piece.exit.group, piece.holds)).or_default().push(piece);
    }
    for own in ways.values_mut().filter(|own| own.iter().any(|p| !p.between)) {
        own.retain(|p| !p.between);
    }
    let ordered: Vec<Vec<Piece>> = ways.into_values().map(by_difference).collect();
    let longest = ordered.iter().map(Vec::len).max().unwrap_or(0);
    let in_turn = (0..longest).flat_map(|rank| ordered.iter().filter_map(move |own| own.get(rank)));
    in_turn.take(most).cloned().collect()
}

/// The `most` rests that need the least room.
fn quietest(mut rests: Vec<Piece>, most: usize) -> Vec<Piece> {
    rests.sort_by(|a, b| a.reach.unwrap_or_default().total_cmp(&b.reach.unwrap_or_default()));
    rests.truncate(most);
    rests
}

fn by_difference(mut rest: Vec<Piece>) -> Vec<Piece> {
    let sum = |p: &Piece| rest.iter().map(|o| p.apart(o)).sum::<f32>();
    let first = (0..rest.len()).min_by(|&a, &b| sum(&rest[a]).total_cmp(&sum(&rest[b])));
    let Some(first) = first else { return rest };
    let mut taken = vec![rest.remove(first)];
    while !rest.is_empty() {
        let apart = |p: &Piece| taken.iter().map(|t| p.apart(t)).fold(f32::INFINITY, f32::min);
        let next = (0..rest.len()).rev().max_by(|&a, &b| apart(&rest[a]).total_cmp(&apart(&rest[b])));
        taken.push(rest.remove(next.expect("not empty")));
    }
    taken
}
