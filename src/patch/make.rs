//! From captures to a patch set: takes are collected, their people imported and retargeted, those that nobody annotated
//! annotate themselves, all are cut, and patches composed by hand are made of them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::annotate::{AnnotateOptions, Annotation, annotate};
use super::connectivity::connectivity;
use super::cut::{CutOptions, Source, cut, load_take};
use super::cut_props::misfit;
use super::mirror::MIRRORED;
use super::{Fragment, PatchKind, PatchSet, compose};
use crate::motion::Motion;
use crate::motion::collection::{Collected, collect};
use crate::{Error, Result};

/// How a set is made.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MakeOptions {
    /// How takes are cut.
    pub cut: CutOptions,
    /// How takes without patches are annotated.
    pub annotate: AnnotateOptions,
    /// Compose files (`*.compose.toml`), or folders of them, besides those in the collections' own folders.
    pub compose: Vec<PathBuf>,
}

/// A set, and how it came about.
#[derive(Clone, Debug)]
pub struct Made {
    /// The set.
    pub set: PatchSet,
    /// All takes with what they were cut by.
    pub takes: Vec<Collected>,
    /// What was found in the takes that nobody had annotated; the takes there are numbered as in `found_in`.
    pub annotation: Option<Annotation>,
    /// Indices into `takes` of those.
    pub found_in: Vec<usize>,
    /// Patches that were found but left out, because they lead where nobody can go on, or nobody comes from: of which take
    /// (index into `takes`), and their names.
    pub left_out: Vec<(usize, String)>,
    /// Props of those takes that are left out, because nobody's hands or hips are on them: of which take (index into
    /// `takes`), and why.
    pub left_out_props: Vec<(usize, String)>,
}

/// What is being done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Captures are read and retargeted, so many takes of so many.
    Read(usize, usize),
    /// Events and boundaries are looked for.
    Find,
    /// Patches are cut.
    Cut,
}

/// The patch set of folders, indexes, take files and captures (see [`collect`]), all together.
///
/// # Errors
/// As [`collect`], [`load_take`], [`cut`] and [`compose::add`]; two takes of one name.
pub fn make<P: AsRef<Path>>(paths: &[P], options: &MakeOptions) -> Result<Made> {
    make_with(paths, options, &|_| true)
}

/// As [`make`]; `report` hears of every step, on any thread, and says whether to go on.
///
/// # Errors
/// As [`make`]; stopped.
pub fn make_with<P: AsRef<Path>>(
    paths: &[P],
    options: &MakeOptions,
    report: &(dyn Fn(Step) -> bool + Sync),
) -> Result<Made> {
    let reach = |step: Step| if report(step) { Ok(()) } else { Err(Error::Stopped) };
    let paths: Vec<&Path> = paths.iter().map(AsRef::as_ref).collect();
    let mut takes = collect_all(&paths)?;
    let done = AtomicUsize::new(0);
    let load = |c: &Collected| {
        let motions = load_take(&c.origin, &c.take, &options.cut)?;
        reach(Step::Read(done.fetch_add(1, Ordering::Relaxed) + 1, takes.len()))?;
        Ok(motions)
    };
    let mut motions = takes.par_iter().map(load).collect::<Result<Vec<Vec<Motion>>>>()?;
    reach(Step::Find)?;
    let bare: Vec<usize> = (0..takes.len()).filter(|&i| takes[i].take.patches.is_empty()).collect();
    let mut left_out_props = Vec::new();
    for &i in &bare {
        takes[i].take.props.retain(|prop| {
            let problem = misfit(prop, &motions[i]);
            left_out_props.extend(problem.iter().map(|p| (i, format!("prop {} is left out: {p}", prop.name))));
            problem.is_none()
        });
    }
    let annotation = (!bare.is_empty()).then(|| {
        let mut files: Vec<_> = bare.iter().map(|&i| takes[i].take.clone()).collect();
        let people: Vec<Vec<Motion>> = bare.iter().map(|&i| std::mem::take(&mut motions[i])).collect();
        let annotation = annotate(&mut files, &people, &options.annotate);
        for ((&i, file), own) in bare.iter().zip(files).zip(people) {
            takes[i].take = file;
            motions[i] = own;
        }
        annotation
    });
    reach(Step::Cut)?;
    let sources: Vec<Source> = takes
        .iter()
        .zip(motions)
        .map(|(c, motions)| Source { origin: c.origin.clone(), take: c.take.clone(), motions })
        .collect();
    let mut set = cut(&sources, &options.cut)?;
    let own = paths.iter().filter(|path| path.is_dir()).map(|path| path.to_path_buf());
    let compositions: Vec<PathBuf> = own.chain(options.compose.iter().cloned()).collect();
    compose::add(&mut set, &compositions, &sources, &options.cut)?;
    let found: BTreeSet<&str> = bare.iter().flat_map(|&i| &takes[i].take.patches).map(|p| p.name.as_str()).collect();
    let names = close(&mut set, |kind| found.contains(kind.name.trim_end_matches(MIRRORED)));
    let mut left_out = Vec::new();
    for &take in &bare {
        takes[take].take.patches.retain(|p| {
            let stays = !names.contains(&p.name);
            left_out.extend((!stays).then(|| (take, p.name.clone())));
            stays
        });
    }
    Ok(Made { set, takes, annotation, found_in: bare, left_out, left_out_props })
}

/// The takes of all paths, in their order; of one name in one path only.
fn collect_all(paths: &[&Path]) -> Result<Vec<Collected>> {
    let mut all: Vec<Collected> = Vec::new();
    for path in paths {
        let more = collect(path)?;
        let twin = |c: &Collected| all.iter().find(|other| other.take.name == c.take.name);
        if let Some((own, other)) = more.iter().find_map(|c| Some((c, twin(c)?))) {
            let problem = format!("expected a name of its own, found it in {} as well", other.origin.display());
            return Err(Error::invalid(own.origin.display().to_string(), format!("take {}", own.take.name), problem));
        }
        all.extend(more);
    }
    Ok(all)
}

/// Leaves kinds out that lead out of, or into, the part of the set in which people can go on for ever, as long as they
/// `may` be left out; their names.
fn close(set: &mut PatchSet, may: impl Fn(&PatchKind) -> bool) -> Vec<String> {
    let mut left_out = Vec::new();
    loop {
        let found = connectivity(set);
        let Some(main) = found.components.iter().find(|c| c.main && c.lasting) else { return left_out };
        let inside = |f: &Fragment| main.groups.contains(&f.entry_group) && main.groups.contains(&f.exit_group);
        let before = set.kinds.len();
        set.kinds.retain(|kind| {
            let stays = kind.fragments.iter().all(inside) || !may(kind);
            left_out.extend((!stays).then(|| kind.name.clone()));
            stays
        });
        if set.kinds.len() == before {
            drop_unused_groups(set);
            return left_out;
        }
    }
}

fn drop_unused_groups(set: &mut PatchSet) {
    let mut used = vec![false; set.groups.len()];
    for f in set.kinds.iter().flat_map(|k| &k.fragments) {
        used[f.entry_group as usize] = true;
        used[f.exit_group as usize] = true;
    }
    let index: Vec<u32> = used.iter().scan(0, |next, &u| Some(std::mem::replace(next, *next + u32::from(u)))).collect();
    for f in set.kinds.iter_mut().flat_map(|k| &mut k.fragments) {
        f.entry_group = index[f.entry_group as usize];
        f.exit_group = index[f.exit_group as usize];
    }
    let mut keep = used.into_iter();
    set.groups.retain(|_| keep.next().unwrap_or(false));
}

impl Made {
    /// How much of a take's time lies within its patches of several people, 0 to 1: from the first entry to the last exit
    /// of each.
    pub fn together(&self, take: usize) -> f32 {
        let Some(k) = self.found_in.iter().position(|&i| i == take) else { return 0.0 };
        let Some(annotation) = &self.annotation else { return 0.0 };
        let frames = annotation.found[k].frames.iter().copied().max().unwrap_or(0);
        let mut covered = vec![false; frames];
        for patch in annotation.boundaries.patches.iter().filter(|p| p.take == k) {
            let first = patch.spans.iter().map(|s| s.entry.frame).min().unwrap_or(0);
            let last = patch.spans.iter().map(|s| s.exit.frame).max().unwrap_or(0);
            covered[first..=last].fill(true);
        }
        covered.iter().filter(|c| **c).count() as f32 / frames.max(1) as f32
    }

    /// Why nothing, or less than everything, came of a take that annotated itself; empty where all went well.
    pub fn notes(&self, take: usize) -> Vec<String> {
        let Some(k) = self.found_in.iter().position(|&i| i == take) else { return Vec::new() };
        let Some(annotation) = &self.annotation else { return Vec::new() };
        let mut notes: Vec<String> = Vec::new();
        let people = self.takes[take].take.people.len();
        notes.extend(annotation.found[k].why_nothing().filter(|_| people > 1));
        for lost in annotation.boundaries.unbounded.iter().filter(|u| u.take == k) {
            let event = &annotation.found[k].events[lost.event];
            notes.push(format!("no patch of the event in frames {} to {}: {}", event.begin, event.end, lost.reason));
        }
        let idle = self.takes[take].take.props.iter().filter(|p| p.held.is_empty() && p.sat.is_empty());
        notes.extend(idle.map(|p| format!("prop {}: expected somebody who holds it, found nobody", p.name)));
        notes.extend(self.left_out_props.iter().filter(|p| p.0 == take).map(|p| p.1.clone()));
        let own = || self.left_out.iter().filter(|l| l.0 == take);
        notes.extend(own().map(|l| format!("{} is left out: nothing leads on from it, or up to it", l.1)));
        if self.takes[take].take.patches.is_empty() && own().count() == 0 {
            notes.push(annotation.why_no_piece(k));
        }
        notes
    }
}

/// The patch set of a folder (see [`make`]); captures are looked up in `captures` if given.
///
/// # Errors
/// As [`make`].
pub fn cut_folder(folder: &Path, captures: Option<&Path>) -> Result<PatchSet> {
    let cut = CutOptions { captures: captures.map(PathBuf::from), ..Default::default() };
    Ok(make(&[folder], &MakeOptions { cut, ..Default::default() })?.set)
}

impl PatchSet {
    /// The set cut from a folder of take files with their captures beside them. See [`make`].
    ///
    /// # Errors
    /// As [`make`].
    pub fn from_folder(folder: &Path) -> Result<Self> {
        cut_folder(folder, None)
    }
}
