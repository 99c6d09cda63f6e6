//! Rig files: whoever's rig is not told right says which joint is which, in a small text file (TOML):
//!
//! ```toml
//! hips = "Root_M"
//! left_up_leg = "Hip_L"     # canonical joint = their joint; what is not named is found as ever
//! ```
//!
//! On import the joints named get a name of ours (`crowdquilt:hips`), by which retargeting knows them. One joint may
//! play several canonical ones.

use std::collections::BTreeMap;
use std::path::Path;

use super::names::PINNED;
use crate::motion::{Skeleton, canonical};
use crate::{Error, Result};

/// What a rig file says: their joint for canonical joints.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RigFile {
    /// Canonical name to theirs.
    pub joints: BTreeMap<String, String>,
}

impl RigFile {
    /// Reads a rig file.
    ///
    /// # Errors
    /// The file cannot be read, is no TOML, or names a canonical joint that does not exist.
    pub fn load(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(|e| Error::io(path, e))?;
        Self::parse(&text).map_err(|e| e.in_file(path))
    }

    /// Reads the text of a rig file. See [`load`](Self::load).
    ///
    /// # Errors
    /// As [`load`](Self::load), without the file's name.
    pub fn parse(text: &str) -> Result<Self> {
        let joints: BTreeMap<String, String> = toml::from_str(text).map_err(|e| {
            let line = e.span().map_or(1, |s| text[..s.start.min(text.len())].matches('\n').count() + 1);
            Error::invalid("rig file", format!("line {line}"), e.message().trim().to_owned())
        })?;
        match joints.keys().find(|name| canonical().find(name).is_none()) {
            Some(unknown) => {
                let known: Vec<&str> = canonical().joints.iter().map(|j| j.name.as_str()).collect();
                let problem = format!("expected one of {}, found '{unknown}'", known.join(", "));
                Err(Error::invalid("rig file", unknown.clone(), problem))
            }
            None => Ok(Self { joints }),
        }
    }

    /// Gives the joints named their names of ours.
    ///
    /// # Errors
    /// A joint that the skeleton does not have.
    pub fn apply(&self, skeleton: &mut Skeleton) -> Result<()> {
        let mut roles: BTreeMap<usize, Vec<&str>> = BTreeMap::new();
        for (ours, theirs) in &self.joints {
            let Some(joint) = skeleton.find(theirs) else {
                let names: Vec<&str> = skeleton.joints.iter().take(40).map(|j| j.name.as_str()).collect();
                let problem = format!("expected one of the capture's joints ({}), found '{theirs}'", names.join(", "));
                return Err(Error::invalid("rig file", ours.clone(), problem));
            };
            roles.entry(joint).or_default().push(ours);
        }
        for (joint, names) in roles {
            skeleton.joints[joint].name = format!("{PINNED}{}", names.join("+"));
        }
        Ok(())
    }

    /// The rig file that a capture's options name: beside the capture, or where the path says.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn find(name: &str, capture: &Path) -> Result<Self> {
        let beside = capture.parent().unwrap_or(Path::new("")).join(name);
        Self::load(if beside.is_file() { &beside } else { Path::new(name) })
    }
}
