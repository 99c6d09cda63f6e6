//! The one error type: every message names the file, the place in it, what was expected and what was found.

use std::path::{Path, PathBuf};

/// What every fallible function of the crate returns.
pub type Result<T> = std::result::Result<T, Error>;

/// Bad input, or a file system that refuses. A search that found no perfect answer is a status, not an error.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file could not be opened, read or written.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The content of a file, scene or argument is not what it must be.
    #[error("{origin}: {place}: {problem}")]
    Invalid {
        /// The file (or "scene", "patch set", ...) the problem is in.
        origin: String,
        /// The place in it: a line, joint, kind, field.
        place: String,
        /// What was expected and what was found.
        problem: String,
    },
    /// Whoever asked for it did not want it any more.
    #[error("stopped")]
    Stopped,
}

impl Error {
    /// An [`Error::Invalid`].
    pub fn invalid(origin: impl Into<String>, place: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Invalid { origin: origin.into(), place: place.into(), problem: problem.into() }
    }

    /// An [`Error::Io`] for `path`.
    pub fn io(path: &Path, source: std::io::Error) -> Self {
        Self::Io { path: path.to_owned(), source }
    }

    /// The same error with `origin` named as its file: parsers of text know the line but not the file.
    pub fn in_file(self, path: &Path) -> Self {
        match self {
            Self::Invalid { place, problem, .. } => {
                Self::Invalid { origin: path.display().to_string(), place, problem }
            }
            other => other,
        }
    }
}
