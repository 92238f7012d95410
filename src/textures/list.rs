//! The JSON beside the textures: what each file is, and where all of them come from.

use super::args::{Args, NormalAlpha};
use super::material::Material;
use crate::cli::OptionList;
use crate::cli::normal_maps::NormalY;
use crate::input::LoadedMap;
use glint_formats::provenance::InputDigest;
use serde::Serialize;
use std::collections::BTreeMap;

/// Where the schema of the JSON lives; its `$id`.
const SCHEMA: &str =
    "https://raw.githubusercontent.com/glint-bake/glint-bake/main/docs/schema/glint-textures.schema.json";

/// What stands in the JSON.
#[derive(Debug, Serialize)]
pub struct List {
    #[serde(rename = "$schema")]
    schema: &'static str,
    /// Version of this program.
    tool_version: &'static str,
    /// Width of level 0 in texels.
    width: u32,
    /// Height of level 0 in texels.
    height: u32,
    /// Which way green points in the files.
    green: String,
    /// How roughness is stored in the files.
    roughness: String,
    /// Files that were read.
    inputs: Vec<InputDigest>,
    /// Options by the names of their flags.
    options: BTreeMap<String, String>,
    /// What was noticed.
    notes: Vec<String>,
    /// Files that were written, in the folder of the JSON.
    files: Vec<FileInfo>,
}

/// One file.
#[derive(Debug, Serialize)]
struct FileInfo {
    file: String,
    bytes: u64,
    xxh3_128: String,
}

impl List {
    /// A list without files yet.
    pub fn new(args: &Args, loaded: &LoadedMap, material: &Material) -> List {
        let green = if args.green_down() { NormalY::Down } else { NormalY::Up };
        let mut inputs = vec![loaded.digest.clone()];
        for digest in &material.digests {
            if !inputs.contains(digest) {
                inputs.push(digest.clone());
            }
        }
        let notes = loaded.warnings.iter().map(|warning| format!("{}: {warning}", loaded.digest.name));
        List {
            schema: SCHEMA,
            tool_version: env!("CARGO_PKG_VERSION"),
            width: loaded.map.width,
            height: loaded.map.height,
            green: crate::cli::values::name_of(&green),
            roughness: crate::cli::values::name_of(&args.stored()),
            inputs,
            options: options(args).into_pairs().into_iter().collect(),
            notes: notes.chain(material.warnings.iter().cloned()).collect(),
            files: Vec::new(),
        }
    }

    /// Adds something that was noticed.
    pub fn note(&mut self, note: String) {
        self.notes.push(note);
    }

    /// Adds a file.
    pub fn add(&mut self, file: String, bytes: &[u8]) {
        let xxh3_128 = InputDigest::of(&file, bytes).xxh3_128;
        self.files.push(FileInfo { file, bytes: bytes.len() as u64, xxh3_128 });
    }

    /// As JSON, with a line end.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("lists have string keys only");
        text.push('\n');
        text
    }
}

/// Options that the files depend on.
fn options(args: &Args) -> OptionList {
    let mut options = OptionList::default();
    if let Some(alpha) = &args.normal_alpha {
        options.push_choice("normal-alpha", alpha);
    }
    if args.roughness_map.is_none() && args.normal_alpha != Some(NormalAlpha::Roughness) {
        options.push("roughness", args.roughness_value());
    }
    options.push_choice("roughness-is", &args.roughness_is);
    let channels = [
        ("roughness-channel", args.roughness_channel),
        ("occlusion-channel", args.occlusion_channel),
        ("metallic-channel", args.metallic_channel),
    ];
    for (flag, channel) in channels {
        if let Some(channel) = channel {
            options.push_choice(flag, &channel);
        }
    }
    options.push_choice("target", &args.target);
    options.push_choice("format", &args.format);
    options.push("bits", args.bits);
    options.push("zstd", args.zstd);
    options.push("blocks", args.blocks);
    options.push("two-channel", args.two_channel);
    if let Some(axes) = &args.anisotropy {
        options.push_choice("anisotropy", axes);
    }
    if let Some(only) = &args.only {
        options.push("only", only);
    }
    options.extend(args.input.option_list());
    options
}
