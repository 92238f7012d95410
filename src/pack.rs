//! From sections to the bytes of a pack that was verified.

use crate::cli::git_hash;
use crate::exit::{Exit, Failure};
use glint_formats::provenance::{PROVENANCE, Provenance};
use glint_formats::{FormatError, Limits, PackBuilder, Section, Severity, validate};

/// No limit but that of sections, for packs of our own: `--max-memory` bounds their bytes, and a user may raise it.
pub const UNLIMITED: Limits = Limits { max_file_bytes: u64::MAX, max_sections: u32::MAX, max_raw_bytes: u64::MAX };

/// The bytes of a pack. They pass verification, or there is a failure: a bake never ships a pack that does not verify.
pub fn seal(provenance: &Provenance, sections: Vec<Section>) -> Result<Vec<u8>, Failure> {
    let fault =
        |what: String| Failure::new(Exit::Unexpected, format!("the pack cannot be built: {what}; please report this"));
    let refused = |error: FormatError| match error {
        FormatError::TooManySections { .. } | FormatError::ParametersTooLarge { .. } => {
            Failure::new(Exit::LimitExceeded, format!("{error}; bake fewer maps into one pack"))
        }
        error => fault(error.to_string()),
    };
    let mut builder = PackBuilder::new();
    let mut push = |section| builder.push(section).map_err(refused);
    push(Section::parameters(PROVENANCE, "", provenance).optional())?;
    sections.into_iter().try_for_each(push)?;
    let bytes = builder.finish().map_err(refused)?;
    match validate(&bytes, &UNLIMITED).iter().find(|issue| issue.severity == Severity::Error) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use glint_formats::FourCc;

    #[test]
    fn a_pack_of_too_much_is_a_limit_and_no_fault_of_the_program() {
        let section = |k: u32| Section::parameters(FourCc(*b"TEST"), &k.to_string(), &k).optional();
        let most = Limits::default().max_sections;
        let failure = seal(&provenance("test"), (0..most).map(section).collect()).unwrap_err();
        assert!(failure.exit == Exit::LimitExceeded && failure.message.contains("sections"), "{failure:?}");
        let notes = vec!["n".repeat(1 << 20); 17];
        let failure = seal(&Provenance { notes, ..provenance("test") }, Vec::new()).unwrap_err();
        assert!(failure.exit == Exit::LimitExceeded && failure.message.contains("fewer maps"), "{failure:?}");
    }
}
