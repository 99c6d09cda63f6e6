//! Cuts patch kinds out of takes, where their take files say: patches composed by hand, as many of the paper's are.
//!
//! Every entry of `patches` becomes a kind on its own clock and in its own frame; mirrored copies are added.

use std::path::{Path, PathBuf};

use glam::Vec2;

use super::cut_props as props;
use super::file::filed_rotation;
use super::mirror::{add_mirrored, find_or_add};
use super::{Contact, Fragment, PatchKind, PatchSet, PoseGroup, Touch};
use crate::motion::take::{TakeContact, TakeFile, TakePatch, TakeRole};
use crate::motion::{FPS, Motion, Plant, reach, retarget, together};
use crate::{Error, Result};

/// How takes are cut.
#[derive(Clone, Debug, PartialEq)]
pub struct CutOptions {
    /// Folder that the takes' capture files are looked up in first; else they are relative to their take file.
    pub captures: Option<PathBuf>,
    /// Add the mirrored copy of every kind that is not labelled `symmetric`; default true.
    pub mirror: bool,
    /// A role begins and ends within this many seconds of a port of its person; default 0.02 (half a frame and a bit).
    pub port_tolerance: f32,
}

impl Default for CutOptions {
    fn default() -> Self {
        Self { captures: None, mirror: true, port_tolerance: 0.02 }
    }
}

/// A take and its people's motion.
#[derive(Clone, Debug)]
pub struct Source {
    /// The file that speaks of it, for messages.
    pub origin: PathBuf,
    /// What is to be cut.
    pub take: TakeFile,
    /// See [`load_take`].
    pub motions: Vec<Motion>,
}

/// Cuts the patches of all takes, in their order, into one set.
///
/// # Errors
/// A role outside its capture or without a port; two patches of one name.
pub fn cut(sources: &[Source], options: &CutOptions) -> Result<PatchSet> {
    let mut set = PatchSet::default();
    for Source { origin, take, motions } in sources {
        if let Some((prop, problem)) = take.props.iter().find_map(|p| Some((p, props::misfit(p, motions)?))) {
            return Err(Error::invalid(origin.display().to_string(), format!("prop {}", prop.name), problem));
        }
        for patch in &take.patches {
            let cutter = Cutter { take, motions, patch, options };
            let kind = cutter.kind(&mut set.groups).map_err(|e| e.in_file(origin))?;
            if set.kinds.iter().any(|k| k.name == kind.name) {
                let problem = "expected a new name, found a patch of this name before";
                return Err(Error::invalid(origin.display().to_string(), format!("patch {}", kind.name), problem));
            }
            set.kinds.push(kind);
        }
    }
    if options.mirror {
        add_mirrored(&mut set, 0);
    }
    round(&mut set);
    match set.validate().into_iter().next() {
        Some(problem) => Err(problem),
        None => Ok(set),
    }
}

/// Rounds rotations to what a file keeps, so that a set tiles alike before and after it was saved.
pub(super) fn round(set: &mut PatchSet) {
    for fragment in set.kinds.iter_mut().flat_map(|k| &mut k.fragments) {
        fragment.motion.rotations.iter_mut().for_each(|q| *q = filed_rotation(*q));
    }
}

/// The motion of all people of a take, on its clock, with its foot plants: those of the take file where it has any,
/// else as detected.
///
/// # Errors
/// A capture is bad; names its file.
pub fn load_take(path: &Path, take: &TakeFile, options: &CutOptions) -> Result<Vec<Motion>> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let locate = |file: &str| {
        let elsewhere = options.captures.as_ref().map(|c| c.join(file)).filter(|p| p.exists());
        elsewhere.unwrap_or_else(|| folder.join(file))
    };
    let clips = together::load(take, locate)?;
    let mut motions = retarget::take(&clips).map_err(|e| match e {
        Error::Invalid { origin, place, problem } => {
            Error::invalid(path.display().to_string(), format!("capture {origin}: {place}"), problem)
        }
        other => other,
    })?;
    reach::keep(&mut motions, &take.contacts);
    if !take.plants.is_empty() {
        for (person, motion) in motions.iter_mut().enumerate() {
            let last = motion.len() as u32 - 1;
            let own = take.plants.iter().filter(|p| p.person == person);
            let frames = own.map(|p| Plant { foot: p.foot, begin: frame(p.begin) as u32, end: frame(p.end) as u32 });
            motion.plants = frames.map(|p| Plant { end: p.end.min(last), ..p }).filter(|p| p.begin < p.end).collect();
            motion.plants.sort_by_key(|p| (p.begin, p.foot));
        }
    }
    Ok(motions)
}

/// The frame nearest to a time in seconds.
pub(super) fn frame(time: f32) -> usize {
    (time * FPS).round() as usize
}

/// What one patch is cut from.
struct Cutter<'a> {
    take: &'a TakeFile,
    motions: &'a [Motion],
    patch: &'a TakePatch,
    options: &'a CutOptions,
}

impl Cutter<'_> {
    fn kind(&self, groups: &mut Vec<PoseGroup>) -> Result<PatchKind> {
        let start = self.patch.roles.iter().map(|r| frame(r.begin)).min().unwrap_or(0);
        let fragments = self.patch.roles.iter().map(|role| self.fragment(role, start, groups));
        let mut fragments = fragments.collect::<Result<Vec<Fragment>>>()?;
        centre(&mut fragments);
        let contacts = self.take.contacts.iter().filter_map(|c| self.contact(c, start, &fragments));
        Ok(PatchKind {
            name: self.patch.name.clone(),
            labels: self.patch.labels.clone(),
            contacts: contacts.collect(),
            core: self.core(start, &fragments)?,
            props: props::of_patch(self.take, self.patch, start, &fragments).map_err(|problem| self.bad(problem))?,
            fragments,
            mirrored: false,
        })
    }

    fn bad(&self, problem: String) -> Error {
        Error::invalid("take", format!("patch {}", self.patch.name), problem)
    }

    fn fragment(&self, role: &TakeRole, start: usize, groups: &mut Vec<PoseGroup>) -> Result<Fragment> {
        let motion = &self.motions[role.person];
        let (begin, end) = (frame(role.begin), frame(role.end));
        if end >= motion.len() || begin >= end {
            let seconds = (motion.len() - 1) as f32 / FPS;
            let found = format!("{} s to {} s", role.begin, role.end);
            let expected = format!("expected a begin before its end, within the capture's {seconds:.3} s");
            return Err(self.bad(format!("person {}: {expected}, found {found}", role.person)));
        }
        Ok(Fragment {
            motion: upright(motion.slice(begin, end)),
            begin: (begin - start) as u32,
            entry_group: find_or_add(groups, self.pose(role.person, role.begin)?),
            exit_group: find_or_add(groups, self.pose(role.person, role.end)?),
        })
    }

    /// The pose group of a person's port at a time.
    fn pose(&self, person: usize, time: f32) -> Result<&str> {
        let ports = self.take.ports.iter().filter(|p| p.person == person);
        let nearest = ports.min_by(|a, b| (a.time - time).abs().total_cmp(&(b.time - time).abs()));
        match nearest {
            Some(port) if (port.time - time).abs() <= self.options.port_tolerance => Ok(&port.pose),
            other => {
                let found = other.map_or("none at all".into(), |p| format!("the nearest at {} s", p.time));
                Err(self.bad(format!("person {person}: expected a port at {time} s, found {found}")))
            }
        }
    }

    /// The part of a contact that lies in this patch.
    fn contact(&self, c: &TakeContact, start: usize, fragments: &[Fragment]) -> Option<Contact> {
        let role = |person: usize| self.patch.roles.iter().position(|r| r.person == person);
        let (a, b) = (role(c.a.person)?, role(c.b.person)?);
        let (mut begin, mut end) = (frame(c.begin), frame(c.end));
        for f in [&fragments[a], &fragments[b]] {
            begin = begin.max(start + f.begin as usize);
            end = end.min(start + f.begin as usize + f.motion.len() - 1);
        }
        let touch = |role: usize, part| Touch { role: role as u32, part };
        (begin <= end).then(|| Contact {
            a: touch(a, c.a.part),
            b: touch(b, c.b.part),
            begin: (begin - start) as u32,
            end: (end - start) as u32,
        })
    }

    fn core(&self, start: usize, fragments: &[Fragment]) -> Result<Option<(u32, u32)>> {
        let Some([begin, end]) = self.patch.core else { return Ok(None) };
        let last = fragments.iter().map(|f| f.begin as usize + f.motion.len() - 1).max().unwrap_or(0);
        if frame(begin) < start || frame(end) > start + last {
            let span = format!("{:.3} s to {:.3} s", start as f32 / FPS, (start + last) as f32 / FPS);
            return Err(self.bad(format!("expected a core within {span}, found {begin} s to {end} s")));
        }
        Ok(Some(((frame(begin) - start) as u32, (frame(end) - start) as u32)))
    }
}

/// The motion with its first heading within half a turn.
pub(super) fn upright(mut motion: Motion) -> Motion {
    let first = motion.path.headings[0];
    let turns = first - crate::geom::wrap_angle(first);
    motion.path.headings.iter_mut().for_each(|h| *h -= turns);
    motion
}

/// Moves the patch so that the mean of all path points is the origin.
pub(super) fn centre(fragments: &mut [Fragment]) {
    let points = || fragments.iter().flat_map(|f| &f.motion.path.points);
    let mean = points().sum::<Vec2>() / points().count().max(1) as f32;
    fragments.iter_mut().flat_map(|f| &mut f.motion.path.points).for_each(|p| *p -= mean);
}
