//! Flags of `glint-bake area-light`.

use crate::cli::normal_maps::{InputFlags, check_name, name_of_file};
use crate::cli::{OptionList, RunFlags};
use crate::delivery::Delivery;
use crate::exit::Failure;
use clap::ValueEnum;
use glint_bake_core::area_light::AreaLightOptions;
use glint_formats::area_light::NormalStorage;
use std::path::PathBuf;

/// Lines that `--help` shows and a test runs.
const EXAMPLES: &str = "\
Examples:
  glint-bake area-light scratches.png -o light.glintpack
  glint-bake area-light scratches.png --anisotropic --base-roughness 0.05 -o brushed.glintpack";

/// Bake a normal map for rectangle lights at any distance
///
/// A mip chain of averaged normals that keep their length, with the roughness of the normals under each texel, and the LTC
/// tables of GGX. Highlights of area lights then stay as wide and bright as the map makes them, however far away.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Normal map: PNG, TGA, JPEG, TIFF, WebP or EXR
    #[arg(value_name = "NORMAL_MAP")]
    pub map: PathBuf,
    /// Pack to write
    #[arg(short, long, value_name = "PACK")]
    pub output: PathBuf,
    /// Name of the material [default: the file's name]
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,

    /// GGX roughness α of the surface itself, 0.001 to 1; a default for the renderer, no texture depends on it
    #[arg(long, value_name = "ALPHA", default_value = "0.1", allow_negative_numbers = true, help_heading = "Bake")]
    pub base_roughness: f64,
    /// Store roughness by direction too, for brushed metal and the like; twice the bytes
    #[arg(long, help_heading = "Bake")]
    pub anisotropic: bool,
    /// How normals and roughness are stored
    #[arg(long, value_name = "FORMAT", default_value = "f16", help_heading = "Bake")]
    pub format: Format,
    /// Leave out so many of the finest mips, 0 to 14, for maps that are never seen closer
    ///
    /// The pack is then of a map smaller by 2^N.
    #[arg(long, value_name = "N", default_value = "0", value_parser = clap::value_parser!(u32).range(0..=14))]
    #[arg(help_heading = "Bake")]
    pub skip_mips: u32,
    /// Compress the pack's sections with Zstandard
    #[arg(long, help_heading = "Bake")]
    pub compress: bool,

    /// How the map is read.
    #[command(flatten)]
    pub input: InputFlags,
    #[command(flatten)]
    pub run: RunFlags,
}

/// How normals and roughness are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// half floats, 8 bytes a texel
    F16,
    /// signed bytes, 4 bytes a texel
    Snorm8,
}

impl Args {
    /// Options of the bake.
    pub fn options(&self) -> AreaLightOptions {
        AreaLightOptions {
            base_roughness: self.base_roughness,
            anisotropic: self.anisotropic,
            storage: match self.format {
                Format::F16 => NormalStorage::F16,
                Format::Snorm8 => NormalStorage::Snorm8,
            },
            skip_mips: self.skip_mips,
            max_memory: self.run.max_memory,
        }
    }

    /// Name of the material.
    ///
    /// # Errors
    /// Usage, when it cannot be one.
    pub fn name(&self) -> Result<String, Failure> {
        let Some(name) = &self.name else { return Ok(name_of_file(&self.map)) };
        check_name(name)?;
        Ok(name.clone())
    }

    /// Where the pack goes.
    pub fn delivery(&self) -> Delivery<'_> {
        Delivery { output: &self.output, inputs: std::slice::from_ref(&self.map), run: &self.run }
    }

    /// Options for provenance. Flags that do not change the pack's bytes are left out.
    pub fn option_list(&self) -> OptionList {
        let mut options = OptionList::default();
        options.push("base-roughness", self.base_roughness);
        options.push("anisotropic", self.anisotropic);
        options.push_choice("format", &self.format);
        if self.skip_mips > 0 {
            options.push("skip-mips", self.skip_mips);
        }
        options.extend(self.input.option_list());
        options
    }
}
