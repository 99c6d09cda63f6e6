//! Patches composed by hand: several people's clips and what is to hold between them, in a small text file
//! (`*.compose.toml`). Many of the patches of "Tiling Motion Patches" were made so.
//!
//! ```toml
//! name = "meet-and-bow"
//! labels = ["friendly"]
//!
//! [clips]                  # pieces of takes; their ends move to the nearest ports
//! stop  = { take = "start-stop", from = 3.2, to = 4.6 }
//! bow   = { patch = "bow-stand", role = 1 }
//! start = { take = "start-stop", person = 0, from = 0.5, to = 2.1 }
//!
//! [[roles]]                # who plays which clips, one after the other
//! name = "ann"
//! plays = ["stop", "bow", "start"]
//!
//! [[roles]]
//! name = "bob"
//! plays = ["stop", "bow", "start"]
//!
//! [[places]]               # all through their bows bob stands 1.3 m in front of ann, face to face
//! who = "bob.bow"
//! seen_from = "ann.bow"
//! ahead = 1.3
//! ```
//!
//! | entry | says |
//! |---|---|
//! | `clips` | `take` (by name), `person` (0), `from` and `to` (seconds of the take; the first and last port); or `patch` (by name) and `role` (0); `mirror`: seen in a mirror; `arms`: which one the other is to mirror; `loop`: ends in the pose in which it begins; `end = { ahead, left, turn_deg }` where it is to end, seen from where it begins |
//! | `roles` | `name`, `plays`, and `start = { x, z, heading_deg, time }` for who is to begin somewhere |
//! | `places` | where `who` stands `seen_from` another: metres `ahead` and to the `left`, turned by `turn_deg` (180: face to face) |
//! | `touches` | `a` and `b` (`"ann.right_hand"`), `from` one moment `to` another: hands are led together |
//! | `props` | a box: `name`, by whom it is `held` or `sat` on, one after the other; `rest` (seconds; 1) where one puts it down and the next takes it up |
//! | `carried` | in an entry of `held`: where they have a box that their clips know nothing of, at some moments: metres `up` from the ground, `ahead` of the hips |
//! | `row` | `roles` of which there are `count`, each beside the one before by `spacing` metres, acting `delay` seconds later |
//! | `limits` | how far clips may be deformed: `"tight"` (the default) or `"published"` |
//!
//! A moment is `"ann@1.2"` (seconds since ann's first clip began) or `"ann.bow@0.2"` (since the bow began); without
//! seconds a place holds all through the clip. Two moments in one place happen at one time.
//!
//! Clips are joined at ports of one pose group (`chain`), everybody is placed, and what is still to hold bends paths
//! and times by the least squares of [`crate::deform::Web`] (`solve`). A clip that is to end somewhere gets there
//! evenly (`sweep`). Boxes tie people together as well (`prop`): who passes a box stands where both have it in their
//! hands, who takes it up where it was put down; while it rests it is solved for as if it were somebody standing
//! there. Where the clips know of none, arms are led onto it first (`carried`), and ports with it in the hands are
//! those of people who carry.

mod carried;
mod chain;
mod clear;
mod clip;
mod edit;
mod hands;
mod moment;
mod prop;
mod prop_text;
mod retime;
mod row;
mod solve;
mod story;
mod sweep;
mod text;

use std::path::{Path, PathBuf};

use super::cut::{CutOptions, Source, centre, round, upright};
use super::mirror::{add_mirrored, find_or_add};
use super::{Contact, Fragment, PatchKind, PatchSet, PoseGroup, Touch};
use crate::{Error, Result};

use chain::Chain;
use solve::{Solved, Tie};
use story::{Composition, Moment};

/// Adds the kinds that compose files (`*.compose.toml`; all in `paths`, and in the folders among them) make of takes to a
/// set cut from them, with mirrored copies as `options` has it.
///
/// # Errors
/// A file cannot be read or is malformed (names its line); clips, roles or moments that do not exist; what cannot hold
/// together, or only by deforming somebody beyond the limits (names the entry, and by how much); two kinds of one name.
pub fn add(set: &mut PatchSet, paths: &[PathBuf], sources: &[Source], options: &CutOptions) -> Result<()> {
    let first = set.kinds.len();
    for path in files(paths)? {
        let text = std::fs::read_to_string(&path).map_err(|e| Error::io(&path, e))?;
        let kind = compose(&text, sources, &mut set.groups).map_err(|e| e.in_file(&path))?;
        if set.kinds.iter().any(|k| k.name == kind.name) {
            let problem = "expected a new name, found a patch of this name before";
            return Err(Error::invalid(path.display().to_string(), format!("patch {}", kind.name), problem));
        }
        set.kinds.push(kind);
    }
    if options.mirror {
        add_mirrored(set, first);
    }
    round(set);
    set.validate().into_iter().next().map_or(Ok(()), Err)
}

/// The compose files among `paths` and in the folders among them, sorted within each folder.
fn files(paths: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for path in paths {
        if !path.is_dir() {
            files.push(path.clone());
            continue;
        }
        let entries = std::fs::read_dir(path).map_err(|e| Error::io(path, e))?;
        let entries = entries.map(|entry| entry.map(|e| e.path()).map_err(|e| Error::io(path, e)));
        let mut own = entries.filter(|e| e.as_ref().map_or(true, |p| is_compose(p))).collect::<Result<Vec<_>>>()?;
        own.sort();
        files.extend(own);
    }
    Ok(files)
}

fn is_compose(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().ends_with(".compose.toml"))
}

/// The kind that the text of a compose file makes of takes.
///
/// # Errors
/// As [`add`], without the file's name.
pub fn compose(text: &str, sources: &[Source], groups: &mut Vec<PoseGroup>) -> Result<PatchKind> {
    let story = Composition::parse(text)?;
    let clips = story.clips.iter().map(|c| clip::cut(c, sources, &story.limits)).collect::<Result<Vec<_>>>()?;
    let mut chains =
        story.roles.iter().map(|role| Chain::new(role, &story.clips, &clips)).collect::<Result<Vec<_>>>()?;
    let people = chains.len();
    let props = prop::find(&story, &chains)?;
    carried::lead(&story, &props, &mut chains)?;
    let mut ties = solve::ties(&story, &chains)?;
    let (story, mut chains) = prop::tie(&story, chains, &props, &mut ties)?;
    let solved = solve::solve(&story, &chains, &ties)?;
    let core = core(&story, &chains, &solved, &ties, people);
    chains.truncate(people);
    let mut fragments: Vec<Fragment> = Vec::new();
    for (role, chain) in chains.iter().enumerate() {
        let (motion, begin) = retime::play(&chain.motion, &solved.paths[role], &solved.ticks[role]);
        let (entry, exit) = (find_or_add(groups, &chain.entry), find_or_add(groups, &chain.exit));
        fragments.push(Fragment { motion: upright(motion), begin, entry_group: entry, exit_group: exit });
    }
    centre(&mut fragments);
    let contacts = contacts(&story, &chains, &solved)?;
    hands::lead(&story, &contacts, &mut fragments)?;
    clear::check(&story, &contacts, &fragments)?;
    let mut kind = PatchKind {
        name: story.name.clone(),
        labels: story.labels.clone(),
        core,
        contacts,
        fragments,
        ..PatchKind::default()
    };
    kind.props = prop::of_kind(&story, &props, &kind, &solved)?;
    clear::check_boxes(&story, &kind)?;
    Ok(kind)
}

fn contacts(story: &Composition, chains: &[Chain], solved: &Solved) -> Result<Vec<Contact>> {
    let contact = |touch: &story::Touches| {
        let tick = |at: &Moment| Ok::<_, Error>(solved.tick(at.role, chains[at.role].frame(at, touch.line)?));
        let (begin, end) = (tick(&touch.from)?, tick(&touch.to)?);
        let [a, b] = touch.sides.map(|(role, part)| Touch { role: role as u32, part });
        for (role, _) in touch.sides {
            let (first, last) = solved.span(role);
            if begin > end || begin < first || last < end {
                let name = &story.roles[role].name;
                let found = format!("{:.2} s to {:.2} s", seconds(begin), seconds(end));
                let expected =
                    format!("expected a time while {name} is there, {:.2} s to {:.2} s", seconds(first), seconds(last));
                return Err(story::bad(touch.line, format!("{expected}, found {found}")));
            }
        }
        Ok(Contact { a, b, begin, end })
    };
    story.touches.iter().map(contact).collect()
}

/// From the first moment at which anything holds to the last, as long as everybody is there.
fn core(story: &Composition, chains: &[Chain], solved: &Solved, ties: &[Tie], people: usize) -> Option<(u32, u32)> {
    let held = solve::held(story, chains, ties).into_iter().filter(|h| h.0 < people);
    let ticks = held.map(|(role, frame)| solved.tick(role, frame));
    let (first, last) = ticks.fold((u32::MAX, 0), |(first, last), tick| (first.min(tick), last.max(tick)));
    let spans = (0..people).map(|role| solved.span(role));
    let (first, last) = spans.fold((first, last), |(first, last), span| (first.max(span.0), last.min(span.1)));
    (first <= last).then_some((first, last))
}

fn seconds(tick: u32) -> f32 {
    tick as f32 / crate::motion::FPS
}
