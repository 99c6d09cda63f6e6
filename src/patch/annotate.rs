//! Takes annotate themselves: events are found, boundaries chosen, and written where a person would have written them, as
//! the ports, contacts and patches of take files, which [`super::cut`] then cuts. They may be kept, edited or thrown away.
//!
//! Patches of several people surround events (paper section 4); those of one person lie between neighbouring boundaries,
//! so that whatever is entered or left by a pose group can be followed and led up to.

mod alone;
mod labels;

use super::boundaries::{Boundaries, BoundaryOptions, Bounded, Cut, boundaries};
use super::cut;
use super::episode::{Detection, EpisodeOptions, detect_all};
use crate::motion::gait::Phase;
use crate::motion::take::{TakeFile, TakePatch, TakePort, TakeRole};
use crate::motion::{FPS, Motion, contacts, mirror};

pub use alone::AloneOptions;

/// How takes are annotated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AnnotateOptions {
    /// What counts as an event.
    pub episodes: EpisodeOptions,
    /// Where patches begin and end.
    pub boundaries: BoundaryOptions,
    /// Which patches of one person are kept.
    pub alone: AloneOptions,
}

/// What was found on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct Annotation {
    /// The events of every take.
    pub found: Vec<Detection>,
    /// Where motion is cut.
    pub boundaries: Boundaries,
    /// Names of the pose groups, by the index in `boundaries.groups`; empty for those that are not used.
    pub names: Vec<String>,
}

/// Sets the ports, contacts and patches of takes, whose people's motions are `motions`. O(frames) for the events, and as
/// [`boundaries`] for the rest.
pub fn annotate(takes: &mut [TakeFile], motions: &[Vec<Motion>], options: &AnnotateOptions) -> Annotation {
    let people: Vec<&[Motion]> = motions.iter().map(Vec::as_slice).collect();
    let found = detect_all(&people, &options.episodes);
    let boundaries = boundaries(&people, &found, &options.boundaries);
    let names = names(&boundaries);
    let annotation = Annotation { found, boundaries, names };
    let alone = alone::pieces(takes, motions, &annotation, &options.alone);
    for (index, take) in takes.iter_mut().enumerate() {
        take.ports.clear();
        take.patches.clear();
        let together = annotation.boundaries.patches.iter().filter(|b| b.take == index);
        let mut patches: Vec<TakePatch> =
            together.enumerate().map(|(i, b)| annotation.together(take, b, i + 1)).collect();
        let own = alone.iter().filter(|p| p.take == index);
        patches.extend(own.enumerate().map(|(i, p)| p.patch(take, i + 1)));
        take.patches = patches;
        if take.people.len() > 1 {
            take.contacts = touches(&motions[index]);
        }
        annotation.add_ports(take, index);
    }
    annotation
}

/// Hands that touch, to the millisecond.
fn touches(motions: &[Motion]) -> Vec<crate::motion::take::TakeContact> {
    let mut touches = contacts::detect(motions, &contacts::ContactOptions::default());
    for contact in &mut touches {
        (contact.begin, contact.end) = (millis(contact.begin), millis(contact.end));
    }
    touches
}

impl Annotation {
    /// The patch around an event.
    fn together(&self, take: &TakeFile, bounded: &Bounded, number: usize) -> TakePatch {
        let events = bounded.events.iter().map(|&e| &self.found[bounded.take].events[e]);
        let kind = events.clone().map(|e| e.kind).min().expect("patches have events");
        let first = events.clone().map(|e| e.begin).min().expect("patches have events");
        let last = events.map(|e| e.end).max().expect("patches have events");
        let role = |s: &super::boundaries::Span| TakeRole {
            person: s.person,
            begin: seconds(s.entry.frame),
            end: seconds(s.exit.frame),
        };
        let mut labels = vec![labels::of_event(kind).to_owned()];
        labels::add_words(&mut labels, &take.description);
        TakePatch {
            name: format!("{}-{}-{number}", labels[0], take.name),
            labels,
            roles: bounded.spans.iter().map(role).collect(),
            core: Some([seconds(first), seconds(last)]),
        }
    }

    /// Why no patch of one person was cut from a take.
    pub(super) fn why_no_piece(&self, take: usize) -> String {
        let cuts: usize = self.boundaries.cuts[take].iter().map(Vec::len).sum();
        let frames = self.found[take].frames.iter().copied().max().unwrap_or(0);
        match (frames, cuts) {
            (0 | 1, _) => format!("nothing to cut: expected motion, found {frames} frame"),
            (_, 0 | 1) => format!(
                "no patch of one person: expected two moments in a recurring pose (a step's mid-stance, or a rest on both \
                 feet), found {cuts} in {frames} frames"
            ),
            _ => "no patch was kept: others lead to the same places, or its recurring poses lie too far apart".into(),
        }
    }

    /// The ports that the take's patches use.
    fn add_ports(&self, take: &mut TakeFile, index: usize) {
        let mut used: Vec<(usize, Cut)> = Vec::new();
        for role in take.patches.iter().flat_map(|p| &p.roles) {
            let cuts = &self.boundaries.cuts[index][role.person];
            let ends = [role.begin, role.end].map(|t| (t * FPS).round() as usize);
            used.extend(cuts.iter().filter(|c| ends.contains(&c.frame)).map(|&c| (role.person, c)));
        }
        used.sort_unstable();
        used.dedup();
        let port = |(person, cut): (usize, Cut)| {
            let (time, name) = (seconds(cut.frame), &self.names[cut.group]);
            // Poses do not tell what hands hold, and only who holds the same may go on.
            let pose = if holds(take, person, cut.frame) { format!("carry_{name}") } else { name.clone() };
            TakePort { person, time, pose }
        };
        take.ports = used.into_iter().map(port).collect();
    }
}

/// Names of the chosen groups by what most of their poses are: `stand`, `stand2`, `walk_left`; the image of a group that
/// is not its own has the other side's name.
fn names(boundaries: &Boundaries) -> Vec<String> {
    let mut names = vec![String::new(); boundaries.groups.len()];
    let (mut stands, mut steps) = (0, 0);
    for &g in &boundaries.chosen {
        let group = &boundaries.groups[g];
        if !names[g].is_empty() {
            continue;
        }
        let stands_still = group.phase == Phase::Stand || group.twin == g;
        let (count, stem) = if stands_still { (&mut stands, "stand") } else { (&mut steps, "walk") };
        *count += 1;
        let numbered = if *count > 1 { format!("{stem}{count}") } else { stem.to_owned() };
        names[g] = match (group.twin == g, group.phase) {
            (true, _) => numbered,
            (false, Phase::WalkRight) => format!("{numbered}_right"),
            (false, _) => format!("{numbered}_left"),
        };
        names[group.twin] = mirror::group(&names[g]);
    }
    names
}

/// Whether somebody has a prop in the hands at a frame.
fn holds(take: &TakeFile, person: usize, frame: usize) -> bool {
    // By frames, as props are cut: a hold to the end of a take holds at the last frame.
    let mut held = take.props.iter().flat_map(|p| &p.held).filter(|h| h.person == person);
    held.any(|h| (cut::frame(h.begin)..=cut::frame(h.end)).contains(&frame))
}

fn seconds(frame: usize) -> f32 {
    millis(frame as f32 / FPS)
}

fn millis(seconds: f32) -> f32 {
    (seconds * 1000.0).round() / 1000.0
}
