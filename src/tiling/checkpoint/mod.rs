//! Checkpoints: a tiling as it is kept between runs, so that a killed one goes on where it was.
//!
//! The engine's tiling is perfect after every change, so a checkpoint is nothing but who plays what, where and when, and
//! how far the run was. Bodies are worked out again when it is read. Whoever goes on may wish for more people, or for
//! more company: what is there stays a beginning.

mod file;
mod keep;
mod lay;
mod thaw;

pub use keep::Keep;
pub(super) use keep::Keeper;
pub(super) use thaw::thaw;

use std::path::Path;

use self::lay::Laid;
use super::Scene;
use super::tracks::Tracks;
use crate::container::{Writer, write_whole};
use crate::patch::PatchSet;
use crate::{Error, Result};

/// What the engine does, in order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Puts in what the scene has placed.
    #[default]
    Place,
    /// Puts the teams in their places.
    LineUp,
    /// Lets people in at the sources.
    LetIn,
    /// Adds people who jump.
    Hurdle,
    /// Adds people who meet.
    Gather,
    /// Adds people who stand close together.
    Stand,
    /// Puts in patches of several people while there is room.
    Acquaint,
    /// Adds people who come alone.
    Seed,
    /// Puts in patches of several people wherever they fit.
    Enrich,
    /// Tests final bodies and bridges anew where they are at fault.
    Mend,
}

/// How far a run is, and what it has still to do.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Agenda {
    /// What it does now.
    pub stage: Stage,
    /// True once what the scene has placed is there.
    pub placed: bool,
    /// The teams of people who are still to line up.
    pub lining_up: Vec<usize>,
    /// Source and tick of people who are still to come in.
    pub coming: Vec<(usize, i32)>,
    /// People of teams and sources who are there.
    pub admitted: usize,
    /// Changes worked out so far.
    pub drawn: u64,
    /// Next number for an instance.
    pub next_instance: u32,
}

/// What a run had reached when it was kept.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reached {
    /// People.
    pub people: usize,
    /// Placed patches.
    pub patches: usize,
    /// Share of the people's time in patches of two or more.
    pub multi_person_share: f32,
    /// Seconds of search, of all runs.
    pub secs: f64,
}

/// A tiling as it is kept between runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// What is tiled.
    pub scene: Scene,
    /// The seed of the run.
    pub seed: u64,
    /// What the patch set is called, if that was told.
    pub patches: Option<String>,
    /// How far it had got.
    pub reached: Reached,
    /// Digest of the patch set.
    digest: String,
    agenda: Agenda,
    /// Names of the kinds in use.
    kinds: Vec<String>,
    people: Vec<Vec<Laid>>,
}

impl Checkpoint {
    /// What the run was doing.
    pub fn stage(&self) -> Stage {
        self.agenda.stage
    }

    pub(super) fn agenda(&self) -> &Agenda {
        &self.agenda
    }

    /// Writes the file, whole or not at all.
    ///
    /// # Errors
    /// What the operating system says.
    pub fn save(&self, path: &Path) -> Result<()> {
        write_whole(path, &self.to_bytes())
    }

    /// Reads the file.
    ///
    /// # Errors
    /// It is not there, or not a whole checkpoint.
    pub fn load(path: &Path) -> Result<Self> {
        let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
        Self::from_bytes(&bytes).map_err(|e| e.in_file(path))
    }

    /// The tiling in its present state.
    pub(super) fn of(tracks: &Tracks, agenda: Agenda, about: &About, secs: f64) -> Self {
        let reached = Reached {
            people: tracks.tracks.len(),
            patches: tracks.instances(),
            multi_person_share: tracks.multi_person_share(),
            secs,
        };
        let (kinds, people) = lay::lay(tracks);
        let About { scene, seed, patches, digest } = about.clone();
        Self { scene, seed, patches, reached, digest, agenda, kinds, people }
    }

    /// # Errors
    /// It is of another patch set.
    pub(super) fn expect_set(&self, set: &PatchSet) -> Result<()> {
        let found = digest_of(set);
        if found == self.digest {
            return Ok(());
        }
        let named = self.patches.as_ref().map_or(String::new(), |name| format!(" ({name})"));
        let problem =
            format!("expected the patch set it was made with{named}, of digest {}, found {found}", self.digest);
        Err(Error::invalid("checkpoint", "patch set", problem))
    }
}

/// What all checkpoints of a run have in common.
#[derive(Clone)]
pub(super) struct About {
    pub scene: Scene,
    pub seed: u64,
    pub patches: Option<String>,
    pub digest: String,
}

impl About {
    /// Of a run.
    pub fn new(scene: &Scene, set: &PatchSet, seed: u64, keep: Keep) -> Self {
        let patches = keep.patches.map(str::to_owned);
        Self { scene: scene.clone(), seed, patches, digest: digest_of(set) }
    }
}

/// Tells patch sets apart, whatever has been found out about them.
fn digest_of(set: &PatchSet) -> String {
    let mut writer = Writer::default();
    let header = set.write_into(&mut writer, "");
    format!("{:016x}", fnv(&writer.finish(b"CQPATCH\0", 0, &header)))
}

/// FNV-1a with 64 bits, eight bytes at a time: finds what was damaged by chance, not what was forged.
fn fnv(bytes: &[u8]) -> u64 {
    const PRIME: u64 = 0x0000_0100_0000_01b3;
    let step = |hash: u64, word: u64| {
        let mixed = (hash ^ word).wrapping_mul(PRIME);
        // Multiplication only carries upwards.
        mixed ^ (mixed >> 32)
    };
    let words = bytes.chunks_exact(8);
    let rest = words.remainder().iter().fold(bytes.len() as u64, |word, &b| word << 8 | u64::from(b));
    let hash =
        words.fold(0xcbf2_9ce4_8422_2325, |hash, w| step(hash, u64::from_le_bytes(w.try_into().expect("8 bytes"))));
    step(hash, rest)
}
