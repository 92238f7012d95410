//! What is wrong with a glTF file.

use crate::exit::{Exit, Failure};
use std::path::Path;

/// Why a file can't be used, and the code for it. Who knows the path adds it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    exit: Exit,
    what: String,
}

impl Fault {
    /// The file is damaged or contradicts itself.
    pub fn bad(what: impl Into<String>) -> Fault {
        Fault { exit: Exit::BadInput, what: what.into() }
    }

    /// The file is in order, and asks for something that is not read.
    pub fn unsupported(what: impl Into<String>) -> Fault {
        Fault { exit: Exit::Unsupported, what: what.into() }
    }

    /// More than a limit allows.
    pub fn limit(what: impl Into<String>) -> Fault {
        Fault { exit: Exit::LimitExceeded, what: what.into() }
    }

    /// A file that can't be read.
    pub fn io(path: &Path, error: &std::io::Error) -> Fault {
        Fault { exit: Exit::InputOutput, what: format!("{} cannot be read: {error}", path.display()) }
    }

    /// The same, of this part of the file.
    pub fn of(self, part: &str) -> Fault {
        Fault { what: format!("{part}: {}", self.what), ..self }
    }

    /// The failure that it is for the file at `path`.
    pub fn at(self, path: &Path) -> Failure {
        Failure::new(self.exit, format!("{}: {}", path.display(), self.what))
    }
}
