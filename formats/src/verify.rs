//! Checks a pack whole: structure, checksums, compression, and the contents of known sections.

use crate::container::{Limits, Structure, read_payload};
use crate::issue::Issue;
use crate::kinds;
use crate::methods::CHECKS;
use crate::sections::Sections;

/// Everything that is wrong with `bytes`; nothing when it is a good pack. Never panics, whatever the bytes.
pub fn validate(bytes: &[u8], limits: &Limits) -> Vec<Issue> {
    match Structure::read(bytes, limits, kinds::check) {
        Ok(structure) => verify(bytes, &structure),
        Err(issues) => issues,
    }
}

/// The part of [`validate`] that follows the structure. Decompressed payloads are kept until the end, so each is
/// made once; the limit on their total was checked with the structure.
pub(crate) fn verify(bytes: &[u8], structure: &Structure) -> Vec<Issue> {
    let mut issues = structure.warnings.clone();
    let mut payloads = Vec::new();
    for entry in &structure.entries {
        match read_payload(bytes, entry) {
            Ok(payload) => payloads.push(Some(payload)),
            Err(issue) => {
                issues.push(issue);
                payloads.push(None);
            }
        }
    }
    let sections = Sections { entries: &structure.entries, index: &structure.index, payloads, known: kinds::known };
    for check in CHECKS {
        check(&sections, &mut issues);
    }
    issues
}
