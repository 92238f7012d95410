//! The section kinds this version knows.

use crate::container::{FourCc, KnownKind, SectionEntry};
use crate::issue::{Issue, IssueCode};
use crate::methods::KINDS;

/// Every kind this version reads.
pub fn all() -> impl Iterator<Item = &'static KnownKind> {
    KINDS.iter().copied().flatten()
}

/// What this version knows of a kind.
pub fn known(kind: FourCc) -> Option<&'static KnownKind> {
    all().find(|known| known.kind == kind)
}

/// Says whether an entry is of a kind and version this program reads: an error when it is required, a warning when
/// it can be skipped.
pub(crate) fn check(entry: &SectionEntry) -> Option<Issue> {
    let (code, message) = match known(entry.kind) {
        None if entry.required => {
            (IssueCode::UnknownRequired, String::from("the pack cannot be used without it; use a newer reader"))
        }
        None => (IssueCode::UnknownOptional, String::from("it is skipped; a newer reader may use it")),
        Some(known) if known.version != entry.version => {
            let message = format!("this program reads version {}, found {}", known.version, entry.version);
            (IssueCode::UnsupportedSectionVersion, format!("{message}; use a newer reader"))
        }
        Some(_) => return None,
    };
    let issue = if entry.required { Issue::error(code, message) } else { Issue::warning(code, message) };
    Some(issue.at(entry.offset).of(entry.label()))
}
