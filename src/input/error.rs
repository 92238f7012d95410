//! Why an input file cannot be used; one kind for each exit code.

use crate::exit::{Exit, Failure};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a file cannot be loaded. The message names the file, what was expected and found, and what to do.
#[derive(Debug, Error)]
pub enum InputError {
    /// The file cannot be read (exit code 3).
    #[error("{}: cannot be read: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The content is damaged or is no normal map (exit code 4).
    #[error("{}: {what}", path.display())]
    Bad {
        /// The file.
        path: PathBuf,
        /// What was expected, found, and can be done.
        what: String,
    },
    /// The content is sound but of a kind that is not read (exit code 5).
    #[error("{}: {what}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What was expected, found, and can be done.
        what: String,
    },
    /// The content exceeds a limit (exit code 6).
    #[error("{}: {what}", path.display())]
    Limit {
        /// The file.
        path: PathBuf,
        /// What was expected, found, and can be done.
        what: String,
    },
}

impl InputError {
    /// The exit code of a program that stops for this.
    pub fn exit_code(&self) -> u8 {
        match self {
            InputError::Io { .. } => 3,
            InputError::Bad { .. } => 4,
            InputError::Unsupported { .. } => 5,
            InputError::Limit { .. } => 6,
        }
    }

    pub(super) fn bad(path: &Path, what: impl Into<String>) -> InputError {
        InputError::Bad { path: path.to_owned(), what: what.into() }
    }

    pub(super) fn unsupported(path: &Path, what: impl Into<String>) -> InputError {
        InputError::Unsupported { path: path.to_owned(), what: what.into() }
    }

    pub(super) fn limit(path: &Path, what: impl Into<String>) -> InputError {
        InputError::Limit { path: path.to_owned(), what: what.into() }
    }
}

impl From<InputError> for Failure {
    fn from(error: InputError) -> Failure {
        let exit = match error {
            InputError::Io { .. } => Exit::InputOutput,
            InputError::Bad { .. } => Exit::BadInput,
            InputError::Unsupported { .. } => Exit::Unsupported,
            InputError::Limit { .. } => Exit::LimitExceeded,
        };
        Failure::new(exit, error.to_string())
    }
}
