//! Some cells of a build, solved: what workers send, and what a build that may be killed keeps in files (`*.shard`, magic
//! `CQSHARD`, a [container](crate::container)).
//!
//! The header names round and cells; the one array `patches` holds the patches in the encoding of postcard, which keeps every bit
//! of every number. Shards are read by the version that wrote them: they are not made to be kept longer than a build takes.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::{CrowdPatch, Port, Site, WorldScene};
use crate::container::{Reader, Writer};
use crate::{Error, Result};

const MAGIC: &[u8; 8] = b"CQSHARD\0";
const VERSION: u32 = 1;

/// Solved cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Shard {
    /// The round they were solved in.
    pub round: usize,
    /// Which cells.
    pub cells: Vec<usize>,
    /// Their patches; none where no way was found.
    pub patches: Vec<Option<CrowdPatch>>,
}

#[derive(serde::Serialize, serde::Deserialize)]
struct Header {
    round: usize,
    cells: Vec<usize>,
}

impl Shard {
    /// Solves some cells of a site on so many threads, 0 for all cores; `go_on` is told how many are done, and stops the work by
    /// returning false.
    ///
    /// # Errors
    /// As [`Site::solve`], and if it was stopped.
    pub fn solve(site: &Site, cells: &[usize], threads: usize, go_on: &(dyn Fn(usize) -> bool + Sync)) -> Result<Self> {
        let done = AtomicUsize::new(0);
        let one = |&cell: &usize| {
            let patch = site.solve(cell)?;
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            if go_on(done) { Ok(patch) } else { Err(Error::Stopped) }
        };
        let all = || cells.par_iter().map(one).collect::<Result<Vec<_>>>();
        let patches = if threads == 0 { all()? } else { pool(threads)?.install(all)? };
        Ok(Self { round: site.round(), cells: cells.to_vec(), patches })
    }

    /// The bytes of a shard file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut writer = Writer::default();
        writer.array("patches", &postcard::to_stdvec(&self.patches).expect("plain data"));
        writer.finish(MAGIC, VERSION, &Header { round: self.round, cells: self.cells.clone() })
    }

    /// A shard from the bytes of its file.
    ///
    /// # Errors
    /// Names the place: magic, version, header, patches.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let reader = Reader::open(bytes, MAGIC, VERSION..=VERSION)?;
        let Header { round, cells } = reader.header()?;
        let numbers: Vec<u8> = reader.array("patches")?;
        let patches: Vec<Option<CrowdPatch>> =
            postcard::from_bytes(&numbers).map_err(|e| Error::invalid("shard", "patches", e.to_string()))?;
        if patches.len() != cells.len() {
            let problem = format!("expected {} of them, found {}", cells.len(), patches.len());
            return Err(Error::invalid("shard", "patches", problem));
        }
        Ok(Self { round, cells, patches })
    }

    /// Whether it is of this round of this site, and nothing in it leads astray.
    pub(super) fn check(&self, site: &Site) -> Result<()> {
        if self.round != site.round() {
            let problem = format!("expected cells of round {}, found round {}", site.round(), self.round);
            return Err(Error::invalid("shard", "header", problem));
        }
        for (cell, patch) in self.cells.iter().zip(&self.patches) {
            let problem = check_cell(site, *cell, patch.as_ref())?;
            if let Some(problem) = problem {
                return Err(Error::invalid("shard", format!("cell {cell}"), problem));
            }
        }
        Ok(())
    }
}

fn pool(threads: usize) -> Result<rayon::ThreadPool> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|e| Error::invalid("build", "threads", e.to_string()))
}

/// What is wrong with a cell's patch, if anything.
fn check_cell(site: &Site, cell: usize, patch: Option<&CrowdPatch>) -> Result<Option<String>> {
    if site.left().binary_search(&cell).is_err() {
        return Ok(Some("expected a cell of this round, found another".into()));
    }
    let Some(patch) = patch else { return Ok(None) };
    let frame = site.frame(cell)?;
    if patch.frame.outline != frame.outline || patch.frame.patterns != frame.patterns {
        return Ok(Some("expected outline and patterns of the scene, found others".into()));
    }
    let inputs: Vec<Port> = frame.inputs().collect();
    let outputs: Vec<Port> = frame.outputs().collect();
    let fits = patch.walkers.len() == inputs.len()
        && patch.walkers.iter().zip(&inputs).all(|(w, input)| w.input == *input && outputs.contains(&w.output))
        && patch.walkers.iter().all(|w| w.path.points.len() >= 4 && w.path.step > 0.0);
    Ok((!fits).then(|| "expected a way from every input to an output, found another".into()))
}

impl WorldScene {
    /// The scene as bytes, with all that its files said: for somebody on another machine.
    pub fn to_bytes(&self) -> Vec<u8> {
        postcard::to_stdvec(self).expect("plain data")
    }

    /// A scene from such bytes.
    ///
    /// # Errors
    /// If they are not of a scene.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        postcard::from_bytes(bytes).map_err(|e| Error::invalid("world scene", "bytes", e.to_string()))
    }
}
