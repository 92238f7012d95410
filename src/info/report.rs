//! What a pack holds, as data: the one description that text, JSON, reports and summaries are made from.

use super::parameters::ParametersInfo;
use crate::exit::{Exit, Failure};
use crate::methods;
use crate::methods::contents::{Contents, decode_all};
use crate::reading;
use glint_formats::provenance::{PROVENANCE, Provenance};
use glint_formats::{Issue, IssueCode, Limits, OpenError, Pack, Resource, SectionEntry, Severity};
use serde::Serialize;
use std::path::Path;

/// Where the schema of the JSON lives; its `$id`.
pub const SCHEMA: &str =
    "https://raw.githubusercontent.com/glint-bake/glint-bake/main/docs/schema/glint-info.schema.json";

/// What a pack holds and what is wrong with it.
#[derive(Debug, Serialize)]
pub struct Report {
    #[serde(rename = "$schema")]
    schema: &'static str,
    /// The file as it was named.
    pub file: String,
    /// Why the file could not be read at all.
    pub error: Option<String>,
    /// Size of the file.
    pub bytes: u64,
    /// Pack version, major and minor.
    pub version: Option<(u16, u16)>,
    /// What is wrong.
    pub issues: Vec<Issue>,
    /// The section table.
    pub sections: Vec<SectionEntry>,
    /// What a GPU holds of each material, in the order of the table.
    pub gpu_bytes: Vec<GpuBytes>,
    /// What it holds of each method.
    #[serde(flatten)]
    pub contents: Contents,
    /// Every parameter section, field by field.
    pub parameters: Vec<ParametersInfo>,
    /// Where the pack comes from.
    pub provenance: Vec<Provenance>,
    #[serde(skip)]
    pack: Option<Pack>,
}

/// Bytes of a material's sections on a GPU.
#[derive(Debug, PartialEq, Eq, Serialize)]
pub struct GpuBytes {
    /// Name of the material.
    pub name: String,
    /// Bytes of its textures and buffers once decompressed: of all sections but parameters.
    pub bytes: u64,
}

impl GpuBytes {
    fn all_of(pack: &Pack) -> Vec<GpuBytes> {
        let bytes_of = |name: &str| {
            let own = pack.sections().iter().filter(|entry| entry.name == name);
            own.filter(|entry| entry.resource != Resource::Parameters).map(|entry| entry.raw_len).sum()
        };
        pack.names().into_iter().map(|name| GpuBytes { name: name.to_owned(), bytes: bytes_of(name) }).collect()
    }
}

impl Report {
    /// Looks at a file.
    pub fn of_file(path: &Path, limits: &Limits) -> Report {
        if reading::is_stream(path) {
            // One byte more than is allowed tells that there are too many.
            return match reading::read_at_most(path, limits.max_file_bytes.saturating_add(1)) {
                Ok(bytes) => Report::of_bytes(path, bytes, limits),
                Err(error) => Report { error: Some(format!("cannot be read: {error}")), ..Report::empty(path, 0) },
            };
        }
        let bytes = std::fs::metadata(path).map_or(0, |meta| meta.len());
        match Pack::open(path, limits) {
            Ok(pack) => Report::of_pack(path, pack),
            Err(OpenError::Io(error)) => {
                Report { error: Some(format!("cannot be read: {error}")), ..Report::empty(path, bytes) }
            }
            Err(OpenError::Invalid(issues)) => Report { issues, ..Report::empty(path, bytes) },
        }
    }

    /// Looks at bytes that `path` has or will have.
    pub fn of_bytes(path: &Path, bytes: Vec<u8>, limits: &Limits) -> Report {
        let len = bytes.len() as u64;
        match Pack::from_bytes(bytes, limits) {
            Ok(pack) => Report::of_pack(path, pack),
            Err(issues) => Report { issues, ..Report::empty(path, len) },
        }
    }

    fn empty(path: &Path, bytes: u64) -> Report {
        Report {
            schema: SCHEMA,
            file: path.display().to_string(),
            error: None,
            bytes,
            version: None,
            issues: Vec::new(),
            sections: Vec::new(),
            gpu_bytes: Vec::new(),
            contents: methods::describe(None),
            parameters: Vec::new(),
            provenance: Vec::new(),
            pack: None,
        }
    }

    fn of_pack(path: &Path, pack: Pack) -> Report {
        let mut report = Report::empty(path, pack.file_len());
        report.version = Some(pack.version());
        report.sections = pack.sections().to_vec();
        report.gpu_bytes = GpuBytes::all_of(&pack);
        // Checksums run faster than a disk reads, so every byte is checked even when only a summary is wanted.
        report.issues = pack.verify();
        if !report.is_damaged() {
            report.contents = methods::describe(Some(&pack));
            report.parameters = ParametersInfo::all_of(&pack);
            report.provenance = decode_all(&pack, PROVENANCE).into_iter().map(|(_, provenance)| provenance).collect();
        }
        report.pack = Some(pack);
        report
    }

    /// The pack, when it could be opened.
    pub fn pack(&self) -> Option<&Pack> {
        self.pack.as_ref()
    }

    /// The pack when it is sound; else its first error as a failure.
    pub fn sound(&self) -> Result<&Pack, Failure> {
        let fail = |what: String| Err(Failure::new(self.exit(), format!("{}: {what}", self.file)));
        if let Some(error) = &self.error {
            return fail(error.clone());
        }
        match (self.issues.iter().find(|issue| issue.severity == Severity::Error), &self.pack) {
            (Some(issue), _) => {
                fail(format!("{issue}; bake the pack anew, or see all that is wrong with glint-info --verify"))
            }
            (None, Some(pack)) => Ok(pack),
            (None, None) => fail("cannot be opened".into()),
        }
    }

    /// Whether an issue keeps the pack from being used.
    pub fn is_damaged(&self) -> bool {
        self.issues.iter().any(|issue| issue.severity == Severity::Error)
    }

    /// The code a program ends with for this pack. Damage counts before what is merely newer or larger than allowed.
    pub fn exit(&self) -> Exit {
        if self.error.is_some() {
            return Exit::InputOutput;
        }
        let codes =
            self.issues.iter().filter(|issue| issue.severity == Severity::Error).map(|issue| exit_of(issue.code));
        let rank = |exit: &Exit| {
            [Exit::Success, Exit::LimitExceeded, Exit::Unsupported, Exit::BadInput].iter().position(|e| e == exit)
        };
        codes.max_by_key(rank).unwrap_or(Exit::Success)
    }

    /// As JSON, with a line end.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("reports have string keys only");
        text.push('\n');
        text
    }
}

/// What an issue means to the caller. Header and table carry a checksum, so an unknown version, codec or flag there is
/// the mark of a newer writer, not of damage.
fn exit_of(code: IssueCode) -> Exit {
    use IssueCode::{
        FileTooLarge, RawTooLarge, TooManySections, UnknownCodec, UnknownFlags, UnknownRequired, UnknownResource,
        UnsupportedMajor, UnsupportedSectionVersion,
    };
    match code {
        FileTooLarge | TooManySections | RawTooLarge => Exit::LimitExceeded,
        UnsupportedMajor
        | UnknownFlags
        | UnknownCodec
        | UnknownResource
        | UnknownRequired
        | UnsupportedSectionVersion => Exit::Unsupported,
        _ => Exit::BadInput,
    }
}
