//! The JSON beside exported files: what each file is, the parameters that a renderer needs, where the pack comes from.

use super::format::Target;
use crate::info::ParametersInfo;
use glint_formats::provenance::{InputDigest, Provenance};
use glint_formats::{FourCc, Resource};
use serde::Serialize;

/// Where the schema of the JSON lives; its `$id`.
const SCHEMA: &str =
    "https://raw.githubusercontent.com/glint-bake/glint-bake/main/docs/schema/glint-export.schema.json";

/// What stands in the JSON.
#[derive(Debug, Serialize)]
pub struct Sidecar<'a> {
    #[serde(rename = "$schema")]
    schema: &'static str,
    /// Version of this program.
    tool_version: &'static str,
    /// The pack, without folders.
    pack: InputDigest,
    /// What was asked for.
    target: Target,
    /// One entry a file.
    pub files: Vec<FileInfo<'a>>,
    /// Parameters of the selected materials.
    pub parameters: Vec<&'a ParametersInfo>,
    /// Where the pack comes from.
    pub provenance: &'a [Provenance],
}

/// One file.
#[derive(Debug, Serialize)]
pub struct FileInfo<'a> {
    /// Its name, in the folder of the JSON.
    pub file: String,
    /// What it is.
    pub format: Target,
    /// Its size.
    pub bytes: u64,
    /// XXH3-128 of it.
    pub xxh3_128: String,
    /// Kind of the section.
    pub kind: FourCc,
    /// What that kind holds, when it is known.
    pub title: Option<&'static str>,
    /// Name of the section.
    pub name: &'a str,
    /// Version of the section.
    pub version: u16,
    /// What the payload is to a GPU.
    pub resource: Resource,
    /// Name of the texture's format.
    pub vk_format_name: Option<&'static str>,
    /// Bytes of the payload.
    pub payload_bytes: u64,
    /// Why this is not of the format that was asked for.
    pub note: Option<&'static str>,
}

impl<'a> Sidecar<'a> {
    /// One without files yet.
    pub fn new(pack: InputDigest, target: Target, provenance: &'a [Provenance]) -> Sidecar<'a> {
        let tool_version = env!("CARGO_PKG_VERSION");
        Sidecar { schema: SCHEMA, tool_version, pack, target, files: Vec::new(), parameters: Vec::new(), provenance }
    }

    /// As JSON, with a line end.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("sidecars have string keys only");
        text.push('\n');
        text
    }
}
