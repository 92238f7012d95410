//! Checks provenance sections: file names without folders, digests that are digests.

use crate::issue::{Issue, IssueCode};
use crate::provenance::{InputDigest, PROVENANCE, Provenance};
use crate::sections::Sections;

/// Checks every provenance section.
pub(crate) fn check(sections: &Sections<'_>, issues: &mut Vec<Issue>) {
    for section in sections.of_kind(PROVENANCE) {
        let Some(provenance) = section.parameters::<Provenance>(issues) else { continue };
        for input in &provenance.inputs {
            if let Err(why) = check_input(input) {
                issues.push(section.error(IssueCode::BadProvenance, why));
            }
        }
    }
}

fn check_input(input: &InputDigest) -> Result<(), String> {
    if input.name.contains(['/', '\\']) {
        return Err(format!("expected a file name without folders, found {:?}", input.name));
    }
    let is_digit = |byte: u8| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte);
    if input.xxh3_128.len() != 32 || !input.xxh3_128.bytes().all(is_digit) {
        return Err(format!("expected a digest of 32 lower-case hex digits, found {:?}", input.xxh3_128));
    }
    Ok(())
}
