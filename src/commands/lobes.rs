//! `glint-bake lobes`: one normal map in, a verified pack out. First everything is checked, then work begins.

use super::deliver::Delivery;
use super::normal_maps::{InputFlags, check_name, digest, unique_name};
use super::surface::SurfaceFlags;
use crate::cli::{RunFlags, Terminal, values};
use crate::exit::{Exit, Failure};
use crate::info::kib;
use crate::input::{LoadedMap, load_normal_map};
use crate::pack;
use crate::progress::Stages;
use clap::ValueEnum;
use glint_bake_core::lobes::options::{LobesOptions, NormalsChoice, default_cell};
use glint_bake_core::lobes::{self, sections};
use glint_bake_core::surface::{self, SurfaceOptions};
use glint_bake_core::synthesis::SynthesisOptions;
use glint_formats::Codec;
use glint_formats::Section;
use glint_formats::lobes::{Filter, FootprintError, LobeStorage, Merge};
use glint_formats::provenance::{InputDigest, Provenance};
use std::path::{Path, PathBuf};

/// What makes a pack smaller.
const SMALLER: &str = "give a larger --cell, fewer lobes with --k, or a part of the map with --crop";

/// Edge of a surface's finest cells in texels.
const SURFACE_CELL: u32 = 8;

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
    run: RunFlags,
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
    #[arg(long)]
    pub nearest: bool,
    /// How lobes are stored
    #[arg(long, value_name = "STORAGE", default_value = "packed")]
    pub storage: StorageArg,
    /// Bits a channel of the stored normals
    #[arg(long, value_name = "BITS", default_value = "auto")]
    pub normals: NormalsArg,
    /// Error E1 asked of every footprint size that the bake measures, on average; missing it fails the bake
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
    /// 2 bytes a texel
    #[value(name = "8")]
    Eight,
    /// 4 bytes a texel
    #[value(name = "16")]
    Sixteen,
}

/// Runs the subcommand.
pub fn run(args: Args, terminal: Terminal) -> Result<(), Failure> {
    let threads = args.run.threads;
    super::on_threads(threads, || bake(&args, terminal))?
}

fn bake(args: &Args, terminal: Terminal) -> Result<(), Failure> {
    args.reduction.options(1, 1).validate()?;
    let synthesis = args.surface.options(args.reduction.seed)?;
    if let Some(synthesis) = &synthesis {
        synthesis.validate()?;
    }
    let name = args.name()?;
    let inputs = [args.map.clone()];
    let delivery = Delivery { output: &args.output, inputs: &inputs, run: &args.run };
    delivery.check()?;
    args.check_normal_map()?;
    let loaded = load_normal_map(&args.map, &args.input.options(args.run.max_memory))?;
    let digest = digest(&args.map, &loaded)?;
    for warning in &loaded.warnings {
        terminal.warn(&format!("{}: {warning}", args.map.display()));
    }
    let (width, height) = (loaded.map.width, loaded.map.height);
    let mut options = args.reduction.options(width, height);
    let bytes = match &synthesis {
        None => {
            options.check(&loaded.map).map_err(|e| Failure::bake(&args.map, &e))?;
            options.most_bytes(width, height)
        }
        Some(synthesis) => {
            options.cell_texels = args.reduction.cell.unwrap_or(SURFACE_CELL);
            let options = SurfaceOptions { lobes: options.clone(), synthesis: *synthesis };
            options.check(&loaded.map).map_err(|e| Failure::bake(&args.map, &e))?;
            options.most_bytes(width, height)
        }
    };
    delivery.check_size(bytes, SMALLER)?;
    let line = format!(
        "{width} × {height} texels, {} lobes a cell of {} texels, {} at most",
        options.lobes_per_cell,
        options.cell_texels,
        kib(bytes)
    );
    let line = match &synthesis {
        None => line,
        Some(_) => format!("{}, sample of {line}", args.surface.size_text()),
    };
    if args.run.dry_run {
        let output = args.output.display();
        terminal.say(&format!("would write {output}: \"{name}\", {line}; dry run, nothing was written"));
        return Ok(());
    }
    terminal.detail(&format!("{}: {line}, {}", args.map.display(), loaded.convention));
    let sections = args.sections(&name, &loaded, &options, synthesis.as_ref(), terminal)?;
    let bytes = pack::seal(&args.provenance(&options, synthesis.as_ref(), &loaded, digest), sections)?;
    delivery.write(bytes, SMALLER, terminal)
}

impl Reduction {
    /// Options for a map of this size.
    fn options(&self, width: u32, height: u32) -> LobesOptions {
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
    fn name(&self) -> Result<String, Failure> {
        let Some(name) = &self.name else { return Ok(unique_name(&self.map, &[])) };
        check_name(name)?;
        Ok(name.clone())
    }

    /// Says whether the surface's normal map can be written beside the other outputs.
    fn check_normal_map(&self) -> Result<(), Failure> {
        let outputs = [Some(&self.output), self.run.report.as_ref(), self.run.depfile.as_ref()];
        let outputs: Vec<&Path> = outputs.into_iter().flatten().map(PathBuf::as_path).collect();
        self.surface.check_writable(&outputs, &[&self.map])
    }

    /// Bakes the map, or the surface that is made of it. The surface's normal map is written on the way.
    fn sections(
        &self,
        name: &str,
        loaded: &LoadedMap,
        options: &LobesOptions,
        synthesis: Option<&SynthesisOptions>,
        terminal: Terminal,
    ) -> Result<Vec<Section>, Failure> {
        let codec = if self.compress { Codec::Zstd } else { Codec::None };
        let (map, progress) = (&loaded.map, Stages::new(terminal));
        let Some(synthesis) = synthesis else {
            let baked = lobes::bake(map, options, &progress).map_err(|e| Failure::bake(&self.map, &e))?;
            self.check_error(&baked.params.measured)?;
            return Ok(sections::to_sections(name, &baked, codec));
        };
        let options = SurfaceOptions { lobes: options.clone(), synthesis: *synthesis };
        let baked = surface::bake(map, &options, &progress).map_err(|e| Failure::bake(&self.map, &e))?;
        self.check_error(&baked.lobes.params.measured)?;
        self.surface.write_normal_map(&baked, map)?;
        Ok(surface::sections::to_sections(name, &baked, codec))
    }

    /// When the user named an error, missing it at any size is a failure.
    fn check_error(&self, measured: &[FootprintError]) -> Result<(), Failure> {
        let Some(asked) = self.reduction.max_error else { return Ok(()) };
        let Some(missed) = measured.iter().find(|row| f64::from(row.mean) > asked) else { return Ok(()) };
        let message = format!(
            "{}: expected E1 of {asked} on average at every footprint size, found {:.5} at {} texels; nothing was written. \
             Raise --max-error, --k or --roughness, or give --storage f16",
            self.map.display(),
            missed.mean,
            missed.sigma_texels
        );
        Err(Failure::new(Exit::LimitExceeded, message))
    }

    /// Where the pack comes from. Flags that do not change its bytes are left out.
    fn provenance(
        &self,
        used: &LobesOptions,
        synthesis: Option<&SynthesisOptions>,
        loaded: &LoadedMap,
        digest: InputDigest,
    ) -> Provenance {
        let debug = |value: &dyn std::fmt::Debug| format!("{value:?}").to_ascii_lowercase();
        let of = &self.reduction;
        let mut options = vec![
            ("roughness", of.roughness.to_string()),
            ("k", of.k.to_string()),
            ("cell", used.cell_texels.to_string()),
            ("merge", debug(&of.merge)),
            ("seeds", of.seeds.to_string()),
            ("nearest", of.nearest.to_string()),
            ("storage", debug(&of.storage)),
            ("normals", of.normals.to_possible_value().map_or_else(String::new, |v| v.get_name().to_owned())),
        ];
        options.extend(self.input.provenance());
        if let Some(synthesis) = synthesis {
            options.extend(self.surface.provenance(synthesis));
        }
        if let Some(error) = of.max_error {
            options.push(("max-error", error.to_string()));
        }
        let notes = loaded.warnings.iter().map(|warning| format!("{}: {warning}", digest.name)).collect();
        Provenance {
            options: options.into_iter().map(|(name, value)| (name.to_owned(), value)).collect(),
            seed: of.seed,
            inputs: vec![digest],
            normal_convention: self.input.normal_convention(),
            notes,
            ..pack::provenance("lobes")
        }
    }
}
