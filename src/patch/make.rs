//! From captures to a patch set: takes are collected, their people imported and retargeted, those that nobody annotated
//! annotate themselves, and all are cut.

use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::PatchSet;
use super::annotate::{AnnotateOptions, Annotation, annotate};
use super::cut::{CutOptions, Source, cut, load_take};
use crate::Result;
use crate::motion::Motion;
use crate::motion::collection::{Collected, collect};

/// How a set is made.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MakeOptions {
    /// How takes are cut.
    pub cut: CutOptions,
    /// How takes without patches are annotated.
    pub annotate: AnnotateOptions,
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
}

/// The patch set of a folder, an index, a take file or a capture (see [`collect`]).
///
/// # Errors
/// As [`collect`], [`load_take`] and [`cut`].
pub fn make(path: &Path, options: &MakeOptions) -> Result<Made> {
    let mut takes = collect(path)?;
    let load = |c: &Collected| load_take(&c.origin, &c.take, &options.cut);
    let mut motions = takes.par_iter().map(load).collect::<Result<Vec<Vec<Motion>>>>()?;
    let bare: Vec<usize> = (0..takes.len()).filter(|&i| takes[i].take.patches.is_empty()).collect();
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
    let sources: Vec<Source> = takes
        .iter()
        .zip(motions)
        .map(|(c, motions)| Source { origin: c.origin.clone(), take: c.take.clone(), motions })
        .collect();
    let set = cut(&sources, &options.cut)?;
    Ok(Made { set, takes, annotation, found_in: bare })
}

/// The patch set of a folder (see [`make`]); captures are looked up in `captures` if given.
///
/// # Errors
/// As [`make`].
pub fn cut_folder(folder: &Path, captures: Option<&Path>) -> Result<PatchSet> {
    let cut = CutOptions { captures: captures.map(PathBuf::from), ..Default::default() };
    Ok(make(folder, &MakeOptions { cut, ..Default::default() })?.set)
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
