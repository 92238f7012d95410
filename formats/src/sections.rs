//! All sections of a pack with their payloads, as the checks of contents see them.

use crate::container::{FourCc, Index, KnownKind, Resource, SectionEntry};
use crate::error::FormatError;
use crate::issue::{Issue, IssueCode};
use crate::params;
use serde::de::DeserializeOwned;
use std::borrow::Cow;

/// All sections of a pack. A payload that could not be read is `None`, which is reported where it was read; checks of contents see
/// no such section.
pub(crate) struct Sections<'a> {
    pub entries: &'a [SectionEntry],
    pub index: &'a Index,
    pub payloads: Vec<Option<Cow<'a, [u8]>>>,
    /// What this version knows of a kind.
    pub known: fn(FourCc) -> Option<&'static KnownKind>,
}

/// One section of a kind and version this program reads, with a payload that its checksum vouches for.
#[derive(Clone, Copy)]
pub(crate) struct Loaded<'a> {
    pub entry: &'a SectionEntry,
    pub payload: &'a [u8],
}

impl Sections<'_> {
    /// Sections of a kind, in the order of the table.
    pub fn of_kind(&self, kind: FourCc) -> impl Iterator<Item = Loaded<'_>> {
        (0..self.entries.len()).filter(move |&i| self.entries[i].kind == kind).filter_map(|i| self.load(i))
    }

    /// The section of a kind and name.
    pub fn get(&self, kind: FourCc, name: &str) -> Option<Loaded<'_>> {
        self.load(self.index.find(self.entries, kind, name)?)
    }

    /// Whether there is a section of a kind and name, of any version.
    pub fn has(&self, kind: FourCc, name: &str) -> bool {
        self.index.find(self.entries, kind, name).is_some()
    }

    /// The section of a kind and name that `owner` needs; reports it when there is none.
    pub fn need(&self, kind: FourCc, owner: Loaded<'_>, issues: &mut Vec<Issue>) -> Option<Loaded<'_>> {
        if !self.has(kind, &owner.entry.name) {
            issues.push(owner.error(IssueCode::MissingSection, format!("expected a section {kind} of the same name")));
        }
        self.get(kind, &owner.entry.name)
    }

    /// Reports sections of `kinds` whose `parent` is not there.
    pub fn report_orphans(&self, kinds: &[FourCc], parent: FourCc, issues: &mut Vec<Issue>) {
        for entry in self.entries {
            if kinds.contains(&entry.kind) && !self.has(parent, &entry.name) {
                let message = format!("expected a section {parent} of the same name");
                issues.push(Issue::error(IssueCode::OrphanSection, message).at(entry.offset).of(entry.label()));
            }
        }
    }

    fn load(&self, i: usize) -> Option<Loaded<'_>> {
        let entry = &self.entries[i];
        let read = (self.known)(entry.kind).is_some_and(|known| known.version == entry.version);
        let payload = self.payloads[i].as_deref()?;
        read.then_some(Loaded { entry, payload })
    }
}

impl<'a> Loaded<'a> {
    /// An error in this section.
    pub fn error(&self, code: IssueCode, message: impl Into<String>) -> Issue {
        Issue::error(code, message).at(self.entry.offset).of(self.entry.label())
    }

    /// Whether the section has the resource its kind asks for; reports it under `code` when it has not.
    pub fn expect(&self, code: IssueCode, expected: Resource, issues: &mut Vec<Issue>) -> bool {
        let right = self.entry.resource == expected;
        if !right {
            issues.push(self.error(code, format!("expected {expected:?}, found {:?}", self.entry.resource)));
        }
        right
    }

    /// Records in a buffer of this stride; reports another resource.
    pub fn buffer_count(&self, stride: u32, issues: &mut Vec<Issue>) -> Option<u64> {
        match self.entry.resource {
            Resource::Buffer { stride: found, count } if found == stride => Some(count),
            found => {
                let message = format!("expected a buffer of stride {stride}, found {found:?}");
                issues.push(self.error(IssueCode::WrongDescriptor, message));
                None
            }
        }
    }

    /// The parameters in this section; reports it when they do not decode.
    pub fn parameters<T: DeserializeOwned>(&self, issues: &mut Vec<Issue>) -> Option<T> {
        if !self.expect(IssueCode::WrongDescriptor, Resource::Parameters, issues) {
            return None;
        }
        match params::decode(self.payload) {
            Ok(value) => Some(value),
            Err(error) => {
                let code = match error {
                    FormatError::ParametersTooLarge { .. } => IssueCode::ParametersTooLarge,
                    FormatError::ParametersTrailing { .. } => IssueCode::ParametersTrailing,
                    _ => IssueCode::ParametersMalformed,
                };
                issues.push(self.error(code, error.to_string()));
                None
            }
        }
    }
}
