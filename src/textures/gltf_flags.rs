//! Flags about glTF files.

use crate::exit::Failure;
use clap::ValueEnum;
use std::path::PathBuf;

/// Flags that say what maps are and how their files are stored, which a glTF file says itself.
const OF_MAPS: [&str; 24] = [
    "map",
    "name",
    "roughness",
    "roughness_map",
    "roughness_channel",
    "roughness_is",
    "occlusion",
    "occlusion_channel",
    "metallic",
    "metallic_channel",
    "format",
    "bits",
    "only",
    "blocks",
    "two_channel",
    "output_y",
    "store",
    "anisotropy",
    "crop",
    "normal_y",
    "wrap",
    "channels",
    "height",
    "json",
];

/// A glTF file instead of maps.
#[derive(clap::Args, Clone, Debug)]
pub struct GltfFlags {
    /// glTF file whose materials get filtered textures: .glb, or .gltf with its files; -o is a file of the same kind
    #[arg(long, value_name = "FILE", conflicts_with_all = OF_MAPS, help_heading = "glTF files")]
    pub gltf: Option<PathBuf>,
    /// How images lie in the file of --gltf [default: ktx2]
    #[arg(long, value_name = "IMAGES", help_heading = "glTF files")]
    pub gltf_images: Option<GltfImages>,
    /// Leave out levels with more texels along an edge; the roughness has what they lose. With --gltf
    #[arg(long, value_name = "TEXELS", value_parser = clap::value_parser!(u32).range(1..=16_384))]
    #[arg(help_heading = "glTF files")]
    pub max_size: Option<u32>,
}

impl GltfFlags {
    /// How images lie in the file.
    pub fn images(&self) -> GltfImages {
        self.gltf_images.unwrap_or(GltfImages::Ktx2)
    }

    /// Refuses flags about a file that is not there.
    ///
    /// # Errors
    /// Usage.
    pub fn check(&self) -> Result<(), Failure> {
        let given = [("--gltf-images", self.gltf_images.is_some()), ("--max-size", self.max_size.is_some())];
        match given.iter().find(|(_, given)| *given) {
            Some((flag, _)) if self.gltf.is_none() => {
                Err(Failure::usage(format!("{flag}: is about the file of --gltf; leave it out")))
            }
            _ => Ok(()),
        }
    }
}

/// How images lie in a glTF file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum GltfImages {
    /// all mips, by KHR_texture_basisu, and PNG of the finest for loaders without it
    Ktx2,
    /// all mips, and loaders have to know KHR_texture_basisu
    Ktx2Only,
    /// the finest level, of which the engine makes the mips
    Png,
}
