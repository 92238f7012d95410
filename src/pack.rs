//! From sections to the bytes of a pack that was verified.

use crate::cli::git_hash;
use crate::exit::{Exit, Failure};
use glint_formats::provenance::{PROVENANCE, Provenance};
use glint_formats::{Limits, PackBuilder, Section, Severity, validate};

/// The bytes of a pack. They pass verification, or there is a failure: a bake never ships a pack that does not verify.
pub fn seal(provenance: &Provenance, sections: Vec<Section>) -> Result<Vec<u8>, Failure> {
    let fault =
        |what: String| Failure::new(Exit::Unexpected, format!("the pack cannot be built: {what}; please report this"));
    let mut builder = PackBuilder::new();
    let mut push = |section| builder.push(section).map_err(|e| fault(e.to_string()));
    push(Section::parameters(PROVENANCE, "", provenance).optional())?;
    sections.into_iter().try_for_each(push)?;
    let bytes = builder.finish().map_err(|e| fault(e.to_string()))?;
    match validate(&bytes, &Limits::default()).iter().find(|issue| issue.severity == Severity::Error) {
        Some(issue) => Err(fault(issue.to_string())),
        None => Ok(bytes),
    }
}

/// Provenance with what is known of this program.
pub fn provenance(method: &str) -> Provenance {
    Provenance {
        tool_version: env!("CARGO_PKG_VERSION").to_owned(),
        git_hash: git_hash().to_owned(),
        method: method.to_owned(),
        ..Provenance::default()
    }
}
