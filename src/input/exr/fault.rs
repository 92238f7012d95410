//! Why an EXR file is not read, before its name is put in front.

use crate::input::error::InputError;
use exr::error::Error;
use std::path::Path;

/// Why a file is not read; one kind for each exit code.
#[derive(Debug)]
pub(super) enum Fault {
    /// Damaged, or without what is asked for.
    Bad(String),
    /// Sound, but of a kind that is not read.
    Unsupported(String),
    /// Needs more memory than it may.
    Limit(String),
}

impl Fault {
    /// The file ends too early.
    pub fn cut_off() -> Fault {
        Fault::Bad("the file is cut off: it ends before the image does; copy or export it again".into())
    }

    /// The file holds what no sound file holds.
    pub fn damaged(what: impl std::fmt::Display) -> Fault {
        Fault::Bad(format!("the EXR is damaged: {what}; copy or export it again"))
    }

    /// What the library says of a part of the file.
    pub fn from_library(error: Error, of: &str) -> Fault {
        match error {
            Error::NotSupported(what) => {
                Fault::Unsupported(format!("{of}: {what}; export it as flat scan lines with ZIP compression"))
            }
            Error::Invalid(what) if what == "reference to missing bytes" => Fault::cut_off(),
            Error::Invalid(what) => Fault::damaged(format_args!("{of}: {what}")),
            other => Fault::damaged(format_args!("{of}: {other}")),
        }
    }

    /// The same with the file's name.
    pub fn of(self, path: &Path) -> InputError {
        match self {
            Fault::Bad(what) => InputError::bad(path, what),
            Fault::Unsupported(what) => InputError::unsupported(path, what),
            Fault::Limit(what) => InputError::limit(path, what),
        }
    }
}
