//! Flags of `glint-bake ndf-maps`.

use crate::cli::normal_maps::InputFlags;
use crate::cli::{OptionList, RunFlags, values};
use crate::delivery::Delivery;
use crate::exit::Failure;
use clap::ValueEnum;
use glint_bake_core::ndf_maps::options::{
    FINEST_WINDOW_RANGE, NdfMapsOptions, PlacementOptions, ROUGHNESS_RANGE, StochasticOptions, TransformRanges,
};
use std::path::PathBuf;

/// Lines that `--help` shows and a test runs.
const EXAMPLES: &str = "\
Examples:
  glint-bake ndf-maps flakes.png --placement stochastic -o paint.glintpack
  glint-bake ndf-maps flakes.png scratches.png --layers scratches:flakes -o coated.glintpack";

/// Bake multi-scale NDF maps of small normal maps
///
/// Each MAP becomes one material of the pack. Maps are small examples (up to 128 x 128 texels, or --crop of larger
/// ones) that the placement repeats over a surface of any size.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Normal maps: PNG, TGA, JPEG, TIFF, WebP or EXR
    #[arg(required = true, value_name = "MAP")]
    pub maps: Vec<PathBuf>,
    /// Pack to write
    #[arg(short, long, value_name = "PACK")]
    pub output: PathBuf,
    /// Name of a material, once a map in the same order [default: the file's name]
    #[arg(long, value_name = "NAME")]
    pub name: Vec<String>,

    /// Intrinsic roughness: standard deviation of each normal's lobe in the projected-normal disk, 0.0001 to 1
    #[arg(long, value_name = "SIGMA", default_value = "0.02", value_parser = values::positive, help_heading = "Bake")]
    pub roughness: f64,
    /// Value for --max-error, which wins over it
    #[arg(long, value_name = "PRESET", default_value = "balanced", help_heading = "Bake")]
    pub preset: Preset,
    /// Error E1 asked of nodes on average, three times that of each; given, missing it fails the bake
    /// [default: by preset]
    ///
    /// When it is given and the bake misses it, nothing is written and the exit code is 6.
    #[arg(long, value_name = "E1", value_parser = values::positive, help_heading = "Bake")]
    pub max_error: Option<f64>,
    /// Standard deviation of the finest windows in texels, 0.25 to 8192; larger where no footprint is narrower
    /// [default: 0.85, with --placement stochastic 0.6]
    ///
    /// Narrower footprints see the map's own patches between texels, which cost more than windows. Where every footprint is
    /// as wide, finer windows are never read and only take bytes.
    #[arg(long, value_name = "TEXELS", value_parser = finest_window, help_heading = "Bake")]
    pub finest_window: Option<f64>,
    /// Compress the pack's sections with Zstandard
    #[arg(long, help_heading = "Bake")]
    pub compress: bool,

    /// How the maps are read.
    #[command(flatten)]
    pub input: InputFlags,

    /// How a surface is covered: copies side by side, or placed at random
    #[arg(long, value_name = "KIND", default_value = "tiled", help_heading = "Placement")]
    pub placement: PlacementArg,
    /// Transforms of placed copies: rotate=A..B (degrees), mirror, scale=A..B, stretch=A..B, shear=A..B, or none
    /// [default: none when tiled, rotate=0..360,mirror when stochastic]
    ///
    /// scale is the size on the surface, stretch the width of the normals; a single value stands for both ends. Tiled
    /// copies share one transform, so they take single values only.
    #[arg(long, value_name = "LIST", value_parser = values::transforms, help_heading = "Placement")]
    pub transforms: Option<TransformRanges>,
    /// Different transforms of a stochastic placement, 1 to 16
    #[arg(long, value_name = "N", default_value = "8", value_parser = clap::value_parser!(u32).range(1..=16))]
    #[arg(help_heading = "Placement")]
    pub palette: u32,
    /// Cells along both axes before a stochastic placement repeats, a power of two from 2 to 1024
    #[arg(long, value_name = "N", default_value = "32", value_parser = power_of_two, help_heading = "Placement")]
    pub cells: u32,
    /// Edge of a cell relative to the map's longer edge, 0.25 to 8
    ///
    /// A copy covers about a cell. From 2 on each quarter of a cell shows the whole map, and wide footprints are seen right;
    /// below, copies repeat less and wide footprints are off by more.
    #[arg(long, value_name = "EDGES", default_value = "2.0", value_parser = values::positive, help_heading = "Placement")]
    pub spacing: f64,
    /// Seed of everything random
    #[arg(long, value_name = "SEED", default_value = "1", help_heading = "Placement")]
    pub seed: u64,

    /// Make a two-layer material of two materials of this pack
    #[arg(long, value_name = "COAT:BASE", help_heading = "Layers")]
    pub layers: Option<String>,
    /// Reflectance of the coat at normal incidence
    #[arg(long, value_name = "F0", default_value = "0.04", value_parser = values::reflectance, help_heading = "Layers")]
    pub coat_f0: f32,
    /// Reflectance of the base at normal incidence, linear
    #[arg(long, value_name = "R,G,B", default_value = "0.5,0.5,0.5", value_parser = values::reflectance3)]
    #[arg(help_heading = "Layers")]
    pub base_f0: [f32; 3],

    /// Flags that every bake has.
    #[command(flatten)]
    pub run: RunFlags,
}

fn finest_window(text: &str) -> Result<f64, String> {
    let (low, high) = FINEST_WINDOW_RANGE;
    let number = text.parse::<f64>().ok().filter(|window| (low..=high).contains(window));
    number.ok_or_else(|| format!("expected a number from {low} to {high}"))
}

fn power_of_two(text: &str) -> Result<u32, String> {
    let number = text.parse::<u32>().ok().filter(|n| n.is_power_of_two() && (2..=1024).contains(n));
    number.ok_or_else(|| "expected a power of two from 2 to 1024".into())
}

/// Values for several flags at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Preset {
    /// --max-error 0.08
    Draft,
    /// --max-error 0.03
    Balanced,
    /// --max-error 0.01
    Accurate,
}

/// How a surface is covered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)] // The flag's help says it.
pub enum PlacementArg {
    Tiled,
    Stochastic,
}

impl Args {
    /// Where the pack goes.
    pub fn delivery(&self) -> Delivery<'_> {
        Delivery { output: &self.output, inputs: &self.maps, run: &self.run }
    }

    /// Error asked of nodes.
    fn wanted_error(&self) -> f64 {
        self.max_error.unwrap_or(match self.preset {
            Preset::Draft => 0.08,
            Preset::Balanced => 0.03,
            Preset::Accurate => 0.01,
        })
    }

    /// Options of every map's bake.
    ///
    /// # Errors
    /// Usage, which names the flag.
    pub fn options(&self) -> Result<NdfMapsOptions, Failure> {
        let (low, high) = ROUGHNESS_RANGE;
        if !(low..=high).contains(&self.roughness) {
            return Err(Failure::usage(format!("--roughness: expected {low} to {high}, found {}", self.roughness)));
        }
        Ok(NdfMapsOptions {
            roughness: self.roughness,
            max_error: self.wanted_error(),
            finest_window: self.finest_window.unwrap_or(self.default_window()),
        })
    }

    /// Finest window where no flag says one. A place of a random placement shows several copies, each with all patches under a footprint, so
    /// finer windows pay there.
    pub fn default_window(&self) -> f64 {
        match self.placement {
            PlacementArg::Tiled => NdfMapsOptions::default().finest_window,
            PlacementArg::Stochastic => 0.6,
        }
    }

    /// Options of every map's placement.
    ///
    /// # Errors
    /// Usage, which names the flag.
    pub fn placement_options(&self) -> Result<PlacementOptions, Failure> {
        if self.placement == PlacementArg::Tiled {
            let ranges = self.transforms.unwrap_or_default();
            // One transform serves every copy, so a range would silently become its lower end.
            let varies =
                [ranges.rotate_degrees, ranges.scale, ranges.stretch, ranges.shear].iter().any(|(a, b)| a != b);
            if varies || ranges.mirror {
                return Err(Failure::usage(
                    "--transforms: a tiled placement has one transform for all copies; expected single values such as \
                 rotate=30, found a range or mirror. Give --placement stochastic for different ones",
                ));
            }
            return Ok(PlacementOptions::Tiled(ranges));
        }
        if !(0.25..=8.0).contains(&self.spacing) {
            return Err(Failure::usage(format!("--spacing: expected 0.25 to 8, found {}", self.spacing)));
        }
        Ok(PlacementOptions::Stochastic(StochasticOptions {
            ranges: self.transforms.unwrap_or(StochasticOptions::default().ranges),
            palette: self.palette,
            cells: self.cells,
            spacing: self.spacing,
            seed: self.seed,
        }))
    }

    /// Options for provenance, as they were used. Flags that do not change the pack's bytes are left out.
    pub fn option_list(&self, used: &NdfMapsOptions, placement: &PlacementOptions) -> OptionList {
        let mut options = OptionList::default();
        options.push("roughness", self.roughness);
        options.push("max-error", used.max_error);
        options.extend(self.input.option_list());
        options.push_choice("placement", &self.placement);
        let ranges = match placement {
            PlacementOptions::Tiled(ranges) => ranges,
            PlacementOptions::Stochastic(options) => &options.ranges,
        };
        options.push("transforms", values::transforms_text(ranges));
        if self.placement == PlacementArg::Stochastic {
            options.push("palette", self.palette);
            options.push("cells", self.cells);
            options.push("spacing", self.spacing);
        }
        if let Some(window) = self.finest_window {
            options.push("finest-window", window);
        }
        options
    }
}
