//! Flags of `glint-bake lobes`.

use super::surface::SurfaceFlags;
use crate::cli::normal_maps::{InputFlags, check_name, name_of_file};
use crate::cli::{OptionList, RunFlags, values};
use crate::delivery::Delivery;
use crate::exit::Failure;
use clap::ValueEnum;
use glint_bake_core::lobes::options::{LobesOptions, NormalsChoice, default_cell};
use glint_bake_core::synthesis::SynthesisOptions;
use glint_formats::lobes::{Filter, LobeStorage, Merge};
use std::path::PathBuf;

/// Lines that `--help` shows and a test runs.
const EXAMPLES: &str = "\
Examples:
  glint-bake lobes scratches.png -o scratches.glintpack
  glint-bake lobes worn.png --synthesize 96x64 --patch 32 --overlap 4 -o surface.glintpack";

/// Bake a normal map as MIP-mapped position-normal lobes
///
/// For maps with structure: scratches, leather, brushed metal. Texels become 4D Gaussians over position and normal, and the
/// lobes of each cell of a MIP are reduced to a fixed number, so that a footprint of any size reads a few hundred.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Normal map: PNG, TGA, JPEG, TIFF, WebP or EXR
    #[arg(value_name = "MAP")]
    pub map: PathBuf,
    /// Pack to write
    #[arg(short, long, value_name = "PACK")]
    pub output: PathBuf,
    /// Name of the material [default: the file's name]
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,

    #[command(flatten)]
    pub reduction: Reduction,
    #[command(flatten)]
    pub surface: SurfaceFlags,
    /// Compress the pack's sections with Zstandard
    #[arg(long, help_heading = "Bake")]
    pub compress: bool,

    /// How the map is read.
    #[command(flatten)]
    pub input: InputFlags,
    #[command(flatten)]
    pub run: RunFlags,
}

/// How the map becomes lobes.
#[derive(clap::Args, Clone, Debug)]
#[command(next_help_heading = "Bake")]
pub struct Reduction {
    /// Intrinsic roughness that lobes are merged for, 0.0001 to 1: standard deviation of each normal's lobe in the
    /// projected-normal disk. A default for the renderer, nothing stored contains it
    #[arg(long, value_name = "SIGMA", default_value = "0.02", value_parser = values::positive)]
    pub roughness: f64,
    /// Lobes a cell, 1 to 256
    #[arg(long, value_name = "LOBES", default_value = "32")]
    pub k: u32,
    /// Edge of the finest cells in texels: 4, 8, 16, 32 or 64 [default: 8, for maps above 512 x 512 texels 16]; 16 at
    /// most with --synthesize, where it is 8
    #[arg(long, value_name = "TEXELS")]
    pub cell: Option<u32>,
    /// How the lobes of a cell are reduced
    #[arg(long, value_name = "MERGE", default_value = "runnalls")]
    pub merge: MergeArg,
    /// Lobes a texel to begin with: 1 or 4
    #[arg(long, value_name = "N", default_value = "4")]
    pub seeds: u32,
    /// Take each texel's normal as it is, without filtering: for maps of flakes
    ///
    /// Neighbours of flakes have nothing between them.
    #[arg(long)]
    pub nearest: bool,
    /// How lobes are stored
    #[arg(long, value_name = "STORAGE", default_value = "packed")]
    pub storage: StorageArg,
    /// Bits a channel that stored normals are rounded to; 8 make smaller compressed packs
    ///
    /// Auto is 8 where rounding stays below 0.03 of the roughness, root mean square.
    #[arg(long, value_name = "BITS", default_value = "auto")]
    pub normals: NormalsArg,
    /// Error E1 asked of every footprint size that the bake measures, on average; missing it fails the bake
    ///
    /// Sizes are standard deviations of 2 to 32 texels, up to a quarter of the map's edge. When the bake misses it,
    /// nothing is written and the exit code is 6.
    #[arg(long, value_name = "E1", value_parser = values::positive)]
    pub max_error: Option<f64>,
    /// Seed of random numbers, for k-means and for the choice of patches
    #[arg(long, value_name = "SEED", default_value = "1")]
    pub seed: u64,
}

/// How the lobes of a cell are reduced.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MergeArg {
    /// k-means with averaged parameters, as in the paper; a baseline
    Kmeans,
    /// k-means; lobes of the clusters' own mean and covariance
    Moments,
    /// the cheapest pair again and again (Runnalls); lobes of the pair's mean and covariance
    Runnalls,
}

/// How lobes are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum StorageArg {
    /// 16 bytes a lobe
    Packed,
    /// half floats, 32 bytes a lobe
    F16,
}

/// How normals are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum NormalsArg {
    /// 8 where rounding does not show at the roughness, else 16
    Auto,
    /// steps of 1/127
    #[value(name = "8")]
    Eight,
    /// steps of 1/32767
    #[value(name = "16")]
    Sixteen,
}

impl Reduction {
    /// Options for a map of this size.
    pub fn options(&self, width: u32, height: u32) -> LobesOptions {
        LobesOptions {
            roughness: self.roughness,
            lobes_per_cell: self.k,
            cell_texels: self.cell.unwrap_or_else(|| default_cell(width, height)),
            merge: match self.merge {
                MergeArg::Kmeans => Merge::KMeans,
                MergeArg::Moments => Merge::Moments,
                MergeArg::Runnalls => Merge::Runnalls,
            },
            seeds: self.seeds,
            filter: if self.nearest { Filter::Nearest } else { Filter::Linear },
            storage: match self.storage {
                StorageArg::Packed => LobeStorage::Packed,
                StorageArg::F16 => LobeStorage::Half,
            },
            normals: match self.normals {
                NormalsArg::Auto => NormalsChoice::Auto,
                NormalsArg::Eight => NormalsChoice::Unorm8,
                NormalsArg::Sixteen => NormalsChoice::Snorm16,
            },
            seed: self.seed,
            ..LobesOptions::default()
        }
    }
}

impl Args {
    /// Where the pack goes.
    pub fn delivery(&self) -> Delivery<'_> {
        Delivery { output: &self.output, inputs: std::slice::from_ref(&self.map), run: &self.run }
    }

    /// Name of the map or surface.
    ///
    /// # Errors
    /// Usage, when it cannot be one.
    pub fn name(&self) -> Result<String, Failure> {
        let Some(name) = &self.name else { return Ok(name_of_file(&self.map)) };
        check_name(name)?;
        Ok(name.clone())
    }

    /// Options for provenance, as they were used. Flags that do not change the pack's bytes are left out.
    pub fn option_list(&self, used: &LobesOptions, synthesis: Option<&SynthesisOptions>) -> OptionList {
        let given = &self.reduction;
        let mut options = OptionList::default();
        options.push("roughness", given.roughness);
        options.push("k", given.k);
        options.push("cell", used.cell_texels);
        options.push_choice("merge", &given.merge);
        options.push("seeds", given.seeds);
        options.push("nearest", given.nearest);
        options.push_choice("storage", &given.storage);
        options.push_choice("normals", &given.normals);
        options.extend(self.input.option_list());
        if let Some(synthesis) = synthesis {
            options.extend(self.surface.option_list(synthesis));
        }
        if let Some(error) = given.max_error {
            options.push("max-error", error);
        }
        options
    }
}
