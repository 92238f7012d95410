//! What differs between two packs: fields of parameters and provenance, sections, texels, records.

mod fields;
mod payloads;
mod text;

pub use fields::FieldChange;
pub use payloads::{RecordDifference, TexelDifference};

use super::report::Report;
use crate::exit::{Exit, Failure};
use glint_formats::{Codec, FourCc, Issue, Pack, Resource, SectionEntry};
use serde::Serialize;
use std::collections::HashSet;

/// Where the schema of the JSON lives; its `$id`.
const SCHEMA: &str = "https://raw.githubusercontent.com/glint-bake/glint-bake/main/docs/schema/glint-diff.schema.json";

/// Two packs compared.
#[derive(Debug, Serialize)]
pub struct Diff {
    #[serde(rename = "$schema")]
    schema: &'static str,
    /// The first pack.
    pub a: Side,
    /// The second pack.
    pub b: Side,
    /// Whether they are the same; not known when one of them cannot be used.
    pub equal: Option<bool>,
    /// Fields of parameters and provenance that differ.
    pub fields: Vec<FieldChange>,
    /// Sections that differ, or that one pack has alone.
    pub sections: Vec<SectionChange>,
    /// What else differs.
    pub notes: Vec<String>,
}

/// One pack.
#[derive(Debug, Serialize)]
pub struct Side {
    /// The file as it was named.
    pub file: String,
    /// Why it could not be read.
    pub error: Option<String>,
    /// What is wrong with it.
    pub issues: Vec<Issue>,
    /// Its size.
    pub bytes: u64,
    /// Pack version.
    pub version: Option<(u16, u16)>,
}

/// One section that is not the same in both packs.
#[derive(Debug, Serialize)]
pub struct SectionChange {
    /// What it is.
    pub kind: FourCc,
    /// Name in the pack.
    pub name: String,
    /// As the first pack has it.
    pub a: Option<SectionSide>,
    /// As the second pack has it.
    pub b: Option<SectionSide>,
    /// What differs when both have it: `version`, `required`, `codec`, `resource`, `payload`.
    pub differs: Vec<&'static str>,
    /// How far texels are apart, for two textures of the same descriptor.
    pub texels: Option<TexelDifference>,
    /// Which records differ, for two buffers of the same descriptor.
    pub records: Option<RecordDifference>,
}

/// A section of one pack.
#[derive(Debug, PartialEq, Serialize)]
pub struct SectionSide {
    /// Version of its layout.
    pub version: u16,
    /// Whether a reader must know it.
    pub required: bool,
    /// How it is stored.
    pub codec: Codec,
    /// What it is to a GPU.
    pub resource: Resource,
    /// Bytes once decompressed.
    pub raw_len: u64,
    /// XXH3-128 of those.
    pub xxh3_128: String,
}

impl Diff {
    /// Compares two packs. When one cannot be used, that is all it says.
    pub fn of(a: &Report, b: &Report) -> Result<Diff, Failure> {
        let mut diff = Diff {
            schema: SCHEMA,
            a: Side::of(a),
            b: Side::of(b),
            equal: None,
            fields: Vec::new(),
            sections: Vec::new(),
            notes: Vec::new(),
        };
        let (Ok(pack_a), Ok(pack_b)) = (a.sound(), b.sound()) else { return Ok(diff) };
        diff.fields = fields::compare(a, b);
        diff.sections = sections(pack_a, pack_b)?;
        if pack_a.version() != pack_b.version() {
            diff.notes.push("the packs have different versions".into());
        }
        let order = |pack: &Pack| pack.sections().iter().map(SectionEntry::label).collect::<Vec<_>>();
        let same_set = diff.sections.iter().all(|change| change.a.is_some() && change.b.is_some());
        if same_set && order(pack_a) != order(pack_b) {
            diff.notes.push("the sections are in another order".into());
        }
        let found = !diff.fields.is_empty() || !diff.sections.is_empty() || !diff.notes.is_empty();
        if !found && pack_a.file_bytes() != pack_b.file_bytes() {
            diff.notes.push("the same contents are compressed to other bytes".into());
        }
        diff.equal = Some(pack_a.file_bytes() == pack_b.file_bytes());
        Ok(diff)
    }

    /// The code a program ends with: that of a pack that cannot be used, else whether they differ.
    pub fn exit(&self, a: &Report, b: &Report) -> Exit {
        match (self.equal, a.exit(), b.exit()) {
            (Some(true), ..) => Exit::Success,
            (Some(false), ..) => Exit::Differs,
            (None, Exit::Success, exit) | (None, exit, _) => exit,
        }
    }

    /// As JSON, with a line end.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("differences have string keys only");
        text.push('\n');
        text
    }
}

impl Side {
    fn of(report: &Report) -> Side {
        Side {
            file: report.file.clone(),
            error: report.error.clone(),
            issues: report.issues.clone(),
            bytes: report.bytes,
            version: report.version,
        }
    }
}

impl SectionSide {
    fn of(entry: &SectionEntry, payload: &[u8]) -> SectionSide {
        SectionSide {
            version: entry.version,
            required: entry.required,
            codec: entry.codec,
            resource: entry.resource,
            raw_len: entry.raw_len,
            xxh3_128: glint_formats::provenance::InputDigest::of("", payload).xxh3_128,
        }
    }

    fn differs(&self, other: &SectionSide) -> Vec<&'static str> {
        let rows = [
            ("version", self.version == other.version),
            ("required", self.required == other.required),
            ("codec", self.codec == other.codec),
            ("resource", self.resource == other.resource),
            ("payload", self.xxh3_128 == other.xxh3_128 && self.raw_len == other.raw_len),
        ];
        rows.into_iter().filter(|(_, same)| !same).map(|(what, _)| what).collect()
    }
}

/// Sections in the order of the first pack, then those that only the second has.
fn sections(a: &Pack, b: &Pack) -> Result<Vec<SectionChange>, Failure> {
    let mut changes = Vec::new();
    let mut seen = HashSet::new();
    for entry in a.sections().iter().chain(b.sections()) {
        if !seen.insert((entry.kind, entry.name.as_str())) {
            continue;
        }
        let read = |pack: &Pack| match pack.find(entry.kind, &entry.name) {
            None => Ok(None),
            Some(found) => match pack.payload(found) {
                Ok(payload) => Ok(Some((SectionSide::of(found, &payload), payload.into_owned()))),
                Err(issue) => Err(Failure::new(Exit::BadInput, issue.to_string())),
            },
        };
        let change = |a, b, differs| SectionChange {
            kind: entry.kind,
            name: entry.name.clone(),
            a,
            b,
            differs,
            texels: None,
            records: None,
        };
        match (read(a)?, read(b)?) {
            (Some((side_a, payload_a)), Some((side_b, payload_b))) => {
                let differs = side_a.differs(&side_b);
                if differs.is_empty() {
                    continue;
                }
                let (mut texels, mut records) = (None, None);
                if side_a.resource == side_b.resource && payload_a != payload_b {
                    texels = TexelDifference::of(&side_a.resource, &payload_a, &payload_b);
                    records = RecordDifference::of(&side_a.resource, &payload_a, &payload_b);
                }
                changes.push(SectionChange { texels, records, ..change(Some(side_a), Some(side_b), differs) });
            }
            (a, b) => changes.push(change(a.map(|of| of.0), b.map(|of| of.0), Vec::new())),
        }
    }
    Ok(changes)
}
