//! Flags of `glint-bake textures`.

use super::encode::{Format, Layout};
use super::files;
use super::gltf_flags::GltfFlags;
use super::target::{AxesArg, Channel, Stored, Target};
use super::tile_names;
use crate::cli::normal_maps::{InputFlags, NormalY, check_name, name_of_file};
use crate::cli::values;
use crate::exit::Failure;
use crate::input::{AlphaUse, Channels};
use clap::ValueEnum;
use std::path::{Path, PathBuf};

/// Lines that `--help` shows and a test runs.
const EXAMPLES: &str = "\
Examples:
  glint-bake textures flakes.png -o textures
  glint-bake textures flakes.png --roughness 0.3 --target unreal --format png -o textures
  glint-bake textures flakes.png --roughness-map flakes.png --roughness-channel b -o textures
  glint-bake textures flakes.png --only normal -o normal.ktx2
  glint-bake textures --gltf model.glb --zstd -o calm.glb";

/// Write a normal map and its roughness as textures whose mips are filtered, for any engine
///
/// Each mip has the normals, and the roughness whose highlight is nearest to that of all normals under a texel, each of the material's
/// own roughness. No shader changes: load them in place of the textures that the engine would make mips of. DIR gets NAME_normal and,
/// by --target, NAME_orm, NAME_mask or NAME_roughness, and NAME.json, which lists them.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Normal map: PNG, TGA, JPEG, TIFF, WebP or EXR
    ///
    /// Where names of maps have UDIM in angle brackets, every tile is filtered, its edges clamped; numbers stay in the names.
    #[arg(value_name = "NORMAL_MAP", required_unless_present = "gltf")]
    pub map: Option<PathBuf>,
    /// Folder to write into; it is created. With --gltf, the file to write
    #[arg(short, long, value_name = "DIR|FILE")]
    pub output: PathBuf,
    /// What names of files begin with [default: the normal map's name]
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,

    /// Roughness of the material, as --roughness-is says, the same everywhere [default: 0.5]
    #[arg(long, value_name = "VALUE", value_parser = unit, conflicts_with = "roughness_map")]
    #[arg(allow_negative_numbers = true, help_heading = "Material")]
    pub roughness: Option<f32>,
    /// Roughness of the material, a map
    #[arg(long, value_name = "MAP", help_heading = "Material")]
    pub roughness_map: Option<PathBuf>,
    /// Channel of --roughness-map to use [default: the only one]
    #[arg(long, value_name = "CHANNEL", requires = "roughness_map", help_heading = "Material")]
    pub roughness_channel: Option<ChannelArg>,
    /// What alpha of the normal map is: nothing, roughness, or opacity or height to keep [default: left out, which is said]
    #[arg(long, value_name = "USE", help_heading = "Material")]
    pub normal_alpha: Option<NormalAlpha>,
    /// What --roughness, --roughness-map and --normal-alpha roughness hold
    #[arg(long, value_name = "KIND", default_value = "perceptual", help_heading = "Material")]
    pub roughness_is: Stored,
    /// Occlusion, a map [default: 1 everywhere]
    #[arg(long, value_name = "MAP", help_heading = "Material")]
    pub occlusion: Option<PathBuf>,
    /// Channel of --occlusion to use [default: the only one]
    #[arg(long, value_name = "CHANNEL", requires = "occlusion", help_heading = "Material")]
    pub occlusion_channel: Option<ChannelArg>,
    /// Metallic, a map [default: 1 everywhere, so that the engine's factor rules]
    #[arg(long, value_name = "MAP", help_heading = "Material")]
    pub metallic: Option<PathBuf>,
    /// Channel of --metallic to use [default: the only one]
    #[arg(long, value_name = "CHANNEL", requires = "metallic", help_heading = "Material")]
    pub metallic_channel: Option<ChannelArg>,

    /// Engine, which says the channels, how roughness is stored, and which way green points
    #[arg(long, value_name = "ENGINE", default_value = "gltf", help_heading = "Output")]
    pub target: Target,
    /// Kind of files
    #[arg(long, value_name = "FORMAT", default_value = "ktx2", help_heading = "Output")]
    pub format: Format,
    /// Bits a channel, 8 or 16; EXR has half floats
    #[arg(long, value_name = "BITS", default_value = "8", value_parser = bits, help_heading = "Output")]
    pub bits: u32,
    /// Compress the levels of KTX2 files with Zstandard
    #[arg(long, help_heading = "Output")]
    pub zstd: bool,
    /// Compress KTX2 and DDS files in blocks that GPUs read: BC5 for normals, x and y only, BC7 for the others, BC4 for one channel
    #[arg(long, help_heading = "Output")]
    pub blocks: bool,
    /// Write only this texture: normal, or what its name ends in, as orm; -o may then be its file
    ///
    /// A file is meant by a name that ends as files of --format do. It has no list beside it.
    #[arg(long, value_name = "TEXTURE", help_heading = "Output")]
    pub only: Option<String>,
    /// Write x and y of normals only, in red and green
    #[arg(long, help_heading = "Output")]
    pub two_channel: bool,
    /// Which way green points in the file [default: as the engine has it]
    #[arg(long, value_name = "AXIS", help_heading = "Output")]
    pub output_y: Option<NormalY>,
    /// How roughness is stored [default: as the engine has it]
    #[arg(long, value_name = "KIND", help_heading = "Output")]
    pub store: Option<Stored>,
    /// Fit anisotropic highlights and write NAME_anisotropy too: direction in red and green, strength in blue, as KHR_materials_anisotropy.
    /// Engines take the axes from the surface or from the normal
    #[arg(long, value_name = "AXES", help_heading = "Output")]
    pub anisotropy: Option<AxesArg>,

    /// Number of the tile of a UDIM set that these are the arguments of.
    #[arg(skip)]
    pub tile: Option<u32>,
    /// A glTF file instead of maps.
    #[command(flatten)]
    pub gltf: GltfFlags,

    /// How the map is read.
    #[command(flatten)]
    pub input: InputFlags,

    /// Threads to use [default: one a core]
    ///
    /// The files are the same for any number.
    #[arg(short = 'j', long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024), help_heading = "Run")]
    pub threads: Option<u32>,
    /// Most bytes to hold for one map, and for one texture, as in 512M
    #[arg(long, value_name = "BYTES", default_value = "4G", value_parser = values::bytes, help_heading = "Run")]
    pub max_memory: u64,
    /// Write the inputs that NAME.json depends on, in Make's syntax
    #[arg(long, value_name = "FILE", help_heading = "Run")]
    pub depfile: Option<PathBuf>,
    /// Check everything, say what would be done, write nothing
    #[arg(short = 'n', long, conflicts_with = "json", help_heading = "Run")]
    pub dry_run: bool,
    /// Print the list of files to standard output
    #[arg(long, help_heading = "Run")]
    pub json: bool,
}

/// What messages call the flag of alpha.
const ALPHA_FLAG: &str = "--normal-alpha";

/// What alpha of a normal map is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum NormalAlpha {
    /// nothing that is needed
    Drop,
    /// opacity, height or a mask: its averages are alpha of the normals' mips, and blocks of normals are BC7
    Keep,
    /// the material's roughness
    Roughness,
}

/// A column of a texel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)] // The flag's help says it.
pub enum ChannelArg {
    R,
    G,
    B,
    A,
}

fn unit(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err(format!("expected 0 to 1, found {text}")),
    }
}

fn bits(text: &str) -> Result<u32, String> {
    match text {
        "8" => Ok(8),
        "16" => Ok(16),
        _ => Err(format!("expected 8 or 16, found {text}")),
    }
}

impl Args {
    /// Refuses values that do not go together and that the parser cannot tell.
    ///
    /// # Errors
    /// Usage.
    pub fn check(&self) -> Result<(), Failure> {
        self.gltf.check()?;
        self.check_alpha()?;
        if self.gltf.gltf.is_none() {
            self.layout()?;
        }
        if self.gltf.gltf.is_some() && !matches!(self.target, Target::Gltf | Target::Bevy) {
            return Err(Failure::usage("--target: with --gltf expected gltf or bevy, whose textures glTF can hold"));
        }
        if self.anisotropy.is_some() && self.target.anisotropic(1.0, 1.0).is_none() {
            return Err(Failure::usage(format!(
                "--anisotropy: --target {} makes two widths of roughness and anisotropy in a way of its own, which is not known here; \
                 expected gltf, filament or bevy",
                values::name_of(&self.target)
            )));
        }
        Ok(())
    }

    /// Refuses alpha that is something else already, or has no place to go.
    fn check_alpha(&self) -> Result<(), Failure> {
        let Some(alpha @ (NormalAlpha::Keep | NormalAlpha::Roughness)) = self.normal_alpha else { return Ok(()) };
        let reason = if self.input.channels.is_some_and(|channels| Channels::from(channels).uses_alpha()) {
            "--channels says that alpha is x or y of the normals; leave one of them out"
        } else if alpha == NormalAlpha::Keep && self.two_channel {
            "--two-channel leaves no alpha to keep it in; leave one of them out"
        } else if alpha == NormalAlpha::Roughness && self.gltf.gltf.is_some() {
            "materials of a glTF file have roughness of their own; expected drop or keep"
        } else if alpha == NormalAlpha::Roughness && (self.roughness.is_some() || self.roughness_map.is_some()) {
            "is the roughness already; leave out --roughness and --roughness-map"
        } else {
            return Ok(());
        };
        Err(Failure::usage(format!("{ALPHA_FLAG} {}: {reason}", values::name_of(&alpha))))
    }

    /// What the reader of the normal map does with alpha.
    pub fn alpha_use(&self) -> AlphaUse {
        match self.normal_alpha {
            None => AlphaUse::Ignored { flag: Some(ALPHA_FLAG) },
            Some(NormalAlpha::Drop) => AlphaUse::Dropped,
            // Of a file's materials some may have none.
            Some(_) => AlphaUse::Taken { flag: Some(ALPHA_FLAG).filter(|_| self.gltf.gltf.is_none()) },
        }
    }

    /// Whether the normals' texture has alpha.
    pub fn keeps_alpha(&self) -> bool {
        self.normal_alpha == Some(NormalAlpha::Keep)
    }

    /// Channels of the normals' texture: BC5 has two, and no alpha.
    pub fn normal_channels(&self) -> usize {
        if self.two_channel || (self.blocks && !self.keeps_alpha()) { 2 } else { 4 }
    }

    /// The same for a table of a project, each of which is one map or one file.
    ///
    /// # Errors
    /// Usage.
    pub fn check_in_project(&self) -> Result<(), Failure> {
        self.check()?;
        if self.inputs().iter().any(|path| tile_names::is_set(path)) {
            let what = "stands for all tiles on a command line; in a project give each tile a table";
            return Err(Failure::usage(format!("{} {what}", tile_names::MARK)));
        }
        Ok(())
    }

    /// Files that the glTF file has beside it, as far as it can be read.
    pub fn files_beside(&self) -> Vec<PathBuf> {
        self.gltf.gltf.as_deref().map_or(Vec::new(), files::beside)
    }

    /// The constant roughness.
    pub fn roughness_value(&self) -> f32 {
        self.roughness.unwrap_or(0.5)
    }

    /// What names of files begin with.
    ///
    /// # Errors
    /// Usage, when it cannot be part of a file's name.
    pub fn stem(&self, map: &Path) -> Result<String, Failure> {
        let Some(name) = &self.name else { return Ok(name_of_file(map)) };
        check_name(name)?;
        if name.contains(['/', '\\']) || name.starts_with('.') {
            return Err(Failure::usage(format!(
                "--name: expected a part of a file's name, found {name:?}; folders go to -o"
            )));
        }
        Ok(name.clone())
    }

    /// The number of the tile as names have it last; empty without one.
    pub fn number(&self) -> String {
        self.tile.map_or(String::new(), |number| format!(".{number}"))
    }

    /// How files are stored.
    ///
    /// # Errors
    /// Usage, for flags that the format has no use for.
    pub fn layout(&self) -> Result<Layout, Failure> {
        if self.zstd && self.format != Format::Ktx2 {
            return Err(Failure::usage("--zstd: is for --format ktx2; leave it out"));
        }
        if self.bits == 16 && self.format == Format::Exr {
            return Err(Failure::usage("--bits: EXR files have half floats; leave it out"));
        }
        if self.blocks && !matches!(self.format, Format::Ktx2 | Format::Dds) {
            return Err(Failure::usage("--blocks: is for --format ktx2 and dds; leave it out"));
        }
        if self.blocks && self.bits == 16 {
            return Err(Failure::usage("--blocks: holds 8 bits a channel; leave out --bits 16"));
        }
        Ok(Layout { format: self.format, bits: self.bits, zstd: self.zstd, blocks: self.blocks })
    }

    /// Whether green points down in the files.
    pub fn green_down(&self) -> bool {
        self.output_y.map_or(self.target.green_down(), |axis| axis == NormalY::Down)
    }

    /// How roughness is stored in the files.
    pub fn stored(&self) -> Stored {
        self.store.unwrap_or(self.target.stored())
    }

    /// All files that are read.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let maps = [self.map.as_ref(), self.roughness_map.as_ref(), self.occlusion.as_ref(), self.metallic.as_ref()];
        let mut inputs: Vec<PathBuf> = Vec::new();
        for path in maps.into_iter().flatten() {
            // One file may hold several of them, in its channels.
            if !inputs.contains(path) {
                inputs.push(path.clone());
            }
        }
        inputs
    }

    /// Textures beside the normals; generic targets have none for what is 1 everywhere.
    pub fn companions(&self) -> Vec<(&'static str, &'static [Channel])> {
        let is_given = |channels: &[Channel]| match channels {
            [Channel::Occlusion] => self.occlusion.is_some(),
            [Channel::Metallic] => self.metallic.is_some(),
            _ => true,
        };
        const ANISOTROPY: (&str, &[Channel]) =
            ("anisotropy", &[Channel::Along, Channel::Up, Channel::Strength, Channel::One]);
        let files = self.target.files().iter().copied().filter(|(_, channels)| is_given(channels));
        files.chain(self.anisotropy.map(|_| ANISOTROPY)).collect()
    }
}
