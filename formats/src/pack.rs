//! A pack that was opened: its sections, found by kind and name, and their payloads without a copy where possible.

use crate::container::{Bytes, FourCc, Limits, SectionEntry, Structure, read_payload};
use crate::error::OpenError;
use crate::issue::Issue;
use crate::kinds;
use crate::verify;
use std::borrow::Cow;
use std::collections::HashSet;
use std::path::Path;

/// A pack that was opened. Header, table, layout and padding are right; payloads are checked when they are read.
#[derive(Debug)]
pub struct Pack {
    bytes: Bytes,
    structure: Structure,
}

impl Pack {
    /// Maps a file and checks its structure. Payloads are not read yet.
    pub fn open(path: impl AsRef<Path>, limits: &Limits) -> Result<Pack, OpenError> {
        let bytes = Bytes::open(path.as_ref()).map_err(OpenError::Io)?;
        Pack::new(bytes, limits).map_err(OpenError::Invalid)
    }

    /// The same for bytes in memory.
    pub fn from_bytes(bytes: Vec<u8>, limits: &Limits) -> Result<Pack, Vec<Issue>> {
        Pack::new(Bytes::Owned(bytes), limits)
    }

    fn new(bytes: Bytes, limits: &Limits) -> Result<Pack, Vec<Issue>> {
        let structure = Structure::read(&bytes, limits, kinds::check)?;
        Ok(Pack { bytes, structure })
    }

    /// Version of the file: (major, minor).
    pub fn version(&self) -> (u16, u16) {
        self.structure.version
    }

    /// Bytes of the file.
    pub fn file_len(&self) -> u64 {
        self.bytes.len() as u64
    }

    /// The whole file.
    pub fn file_bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// All sections in the order of the table, those of unknown kinds too.
    pub fn sections(&self) -> &[SectionEntry] {
        &self.structure.entries
    }

    /// The section with this kind and name.
    pub fn find(&self, kind: FourCc, name: &str) -> Option<&SectionEntry> {
        let entries = &self.structure.entries;
        self.structure.index.find(entries, kind, name).map(|i| &entries[i])
    }

    /// Names in the order in which they first appear, without the empty name of sections of the whole pack.
    pub fn names(&self) -> Vec<&str> {
        let mut seen = HashSet::new();
        let mut names = Vec::new();
        for entry in &self.structure.entries {
            if !entry.name.is_empty() && seen.insert(entry.name.as_str()) {
                names.push(entry.name.as_str());
            }
        }
        names
    }

    /// Payload of a section of this pack: borrowed when it is stored as it is, decompressed otherwise. The checksum is
    /// checked on every call.
    pub fn payload(&self, entry: &SectionEntry) -> Result<Cow<'_, [u8]>, Issue> {
        read_payload(&self.bytes, entry)
    }

    /// Checks everything that opening did not: checksums, compression and the contents of known sections.
    pub fn verify(&self) -> Vec<Issue> {
        verify::verify(&self.bytes, &self.structure)
    }
}
