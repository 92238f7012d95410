//! Formats of exported files, and what a section becomes in each.

use clap::ValueEnum;
use glint_formats::export::Texture;
use glint_formats::{Resource, SectionEntry};
use serde::Serialize;

/// What textures are written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Target {
    /// Khronos Texture 2.0
    Ktx2,
    /// DirectDraw Surface with the DX10 header
    Dds,
    /// OpenEXR, one part an image
    Exr,
    /// The bytes of the pack
    Raw,
}

impl Target {
    /// How names of such files end.
    pub fn extension(self) -> &'static str {
        match self {
            Target::Ktx2 => "ktx2",
            Target::Dds => "dds",
            Target::Exr => "exr",
            Target::Raw => "bin",
        }
    }

    /// What a section becomes, and why when that is not what was asked for.
    pub fn for_section(self, entry: &SectionEntry) -> (Target, Option<&'static str>) {
        let raw = |why| (Target::Raw, (self != Target::Raw).then_some(why));
        match entry.resource {
            Resource::Texture { .. } if self != Target::Raw && Texture::of(&entry.resource).is_some() => (self, None),
            Resource::Texture { .. } => raw("a texture of a format this version has no name for; its bytes"),
            Resource::Buffer { .. } => raw("a buffer, which no texture file holds; its bytes"),
            Resource::Parameters => raw("parameters of a kind this version does not know; their bytes"),
        }
    }
}
