//! What a reader knows of a kind of section.

use super::four_cc::FourCc;

/// A section kind this version reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KnownKind {
    /// The kind.
    pub kind: FourCc,
    /// The version of its layout that is read.
    pub version: u16,
    /// What it holds, in a few words.
    pub title: &'static str,
}

impl KnownKind {
    /// Version 1 of a kind.
    pub(crate) const fn first(kind: FourCc, title: &'static str) -> KnownKind {
        KnownKind { kind, version: 1, title }
    }
}
