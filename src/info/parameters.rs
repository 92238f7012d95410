//! Parameter sections as data, field by field.

use crate::methods::contents::Parameters;
use crate::methods::parameter_kind;
use glint_formats::{FourCc, Pack, SectionEntry};
use serde::Serialize;
use std::fmt::{self, Debug, Formatter};

/// One parameter section.
#[derive(Serialize)]
pub struct ParametersInfo {
    /// What the section is.
    pub kind: FourCc,
    /// Name in the pack.
    pub name: String,
    /// Its value.
    pub value: Parameters,
}

impl ParametersInfo {
    /// Every parameter section of a sound pack whose kind is known, but for provenance, which stands by itself.
    pub fn all_of(pack: &Pack) -> Vec<ParametersInfo> {
        let decode = |entry: &SectionEntry| {
            let value = (parameter_kind(entry.kind)?.decode)(&pack.payload(entry).ok()?)?;
            Some(ParametersInfo { kind: entry.kind, name: entry.name.clone(), value })
        };
        pack.sections().iter().filter_map(decode).collect()
    }
}

impl Debug for ParametersInfo {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.kind, self.name)
    }
}
