//! Flags of `glint-bake environment`.

use crate::cli::normal_maps::name_of_file;
use crate::cli::{OptionList, RunFlags, values};
use crate::delivery::Delivery;
use clap::ValueEnum;
use glint_bake_core::environment::EnvironmentOptions;
use glint_bake_core::environment::options::{DEFAULT_MIN_FACE_SIZE, LevelCount};
use glint_formats::environment::{Kernel, LevelChoice};
use std::path::PathBuf;

/// Lines that `--help` shows and a test runs.
const EXAMPLES: &str = "\
Examples:
  glint-bake environment sky.hdr --face-size 64 -o sky.glintpack
  glint-bake environment sky.hdr --face-size 32 --levels auto --coloured -o lamps.glintpack";

/// Bake an HDR environment for image-based lighting of glints
///
/// Radiance and the share of a few radiance levels, filtered with GGX at several roughnesses of each face size, to an error bound;
/// and albedo and look-ups, which depend on view angle and roughness only.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Equirectangular image of linear radiance: Radiance HDR or OpenEXR
    #[arg(value_name = "IMAGE")]
    pub input: PathBuf,
    /// Pack to write
    #[arg(short, long, value_name = "PACK")]
    pub output: PathBuf,

    /// Edge of a face of the mirror in texels, a power of two, 4 to 8192; faces of the least roughnesses are half as large
    #[arg(long, value_name = "N", default_value = "256", allow_negative_numbers = true, help_heading = "Bake")]
    pub face_size: u32,
    /// Edge of the smallest faces, which have roughnesses up to 1 [default: 16, or half of --face-size if smaller]
    ///
    /// A larger one interpolates wide lobes better and leaves fewer roughnesses.
    #[arg(long, value_name = "N", allow_negative_numbers = true, help_heading = "Bake")]
    pub min_face_size: Option<u32>,
    /// Filtered roughnesses of each face size, 1 to 8
    ///
    /// More of them interpolate better between roughnesses.
    #[arg(long, value_name = "N", default_value = "4", allow_negative_numbers = true, help_heading = "Bake")]
    pub roughnesses: u32,
    /// Look-ups that stand for the lobe of a surface seen at an angle, 1 to 3
    ///
    /// A shader fetches radiance and levels once for each. One costs no fetch more than the mirror direction; three are nearer to the lobe.
    #[arg(long, value_name = "N", default_value = "1", allow_negative_numbers = true, help_heading = "Bake")]
    pub look_ups: u32,
    /// Radiance levels, 1 to 16, or auto: the fewest that meet --max-moment-error
    ///
    /// With 1, lit facets reflect the mean.
    #[arg(long, value_name = "K", default_value = "4", value_parser = level_count, help_heading = "Bake")]
    pub levels: u32,
    /// How levels are chosen: optimal, or log-uniform as in the paper
    #[arg(long, value_name = "CHOICE", default_value = "optimal", hide_possible_values = true, help_heading = "Bake")]
    pub level_choice: LevelChoiceArg,
    /// Darkest radiance that log-uniform levels tell apart
    #[arg(
        long,
        value_name = "RADIANCE",
        default_value = "0.001",
        allow_negative_numbers = true,
        help_heading = "Bake"
    )]
    pub floor: f64,
    /// Mean relative error of the second moment that auto levels may have
    #[arg(long, value_name = "E", default_value = "0.1", value_parser = values::positive, allow_negative_numbers = true, help_heading = "Bake")]
    pub max_moment_error: f64,
    /// Give each level a colour of its own, so that red and blue lamps make red and blue glints
    ///
    /// Takes 4 bytes a level and texel more.
    #[arg(long, help_heading = "Bake")]
    pub coloured: bool,
    /// Relative error of what shaders read, root mean square; three times that below roughness 0.04 [default: none is asked]
    ///
    /// When the measured look-ups miss it, nothing is written and the exit code is 6.
    #[arg(long, value_name = "E", allow_negative_numbers = true, help_heading = "Bake")]
    pub max_error: Option<f64>,
    /// Error of filtered texels over the mean, root mean square, 0.0001 to 0.2; four times that below roughness 0.04
    ///
    /// When the measured texels miss it, nothing is written and the exit code is 6.
    #[arg(long, value_name = "E", default_value = "0.005", allow_negative_numbers = true, help_heading = "Bake")]
    pub filter_error: f64,
    /// Filter: ggx-soft (D times a cosine that ends softly), ggx-nl (D times cosine) or ndf (the paper's, D times masking)
    ///
    /// Under ndf a sun at the horizon of a lobe shows as an edge.
    #[arg(long, value_name = "KERNEL", default_value = "ggx-soft", hide_possible_values = true, help_heading = "Bake")]
    pub kernel: KernelArg,
    /// Look-ups that are compared with exact sums, and a sixteenth as many texels of each roughness; 0 for none
    #[arg(long, value_name = "N", default_value = "128", allow_negative_numbers = true, help_heading = "Bake")]
    pub measure: u32,
    /// Compress the pack's sections with Zstandard
    #[arg(long, help_heading = "Bake")]
    pub compress: bool,

    /// Layer of an EXR image to read, by name; '' is the unnamed one [default: the one of colours]
    #[arg(long, value_name = "NAME", help_heading = "Input")]
    pub layer: Option<String>,

    #[command(flatten)]
    pub run: RunFlags,
}

/// `--levels` for the fewest that keep an error.
pub const LEVELS_AUTO: &str = "auto";

/// A number of levels; 0 for `auto`.
fn level_count(text: &str) -> Result<u32, String> {
    match text {
        LEVELS_AUTO => Ok(0),
        _ => text
            .parse()
            .ok()
            .filter(|count| *count > 0)
            .ok_or_else(|| format!("--levels: expected 1 to 16, or auto, found {text}")),
    }
}

/// `--kernel`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum KernelArg {
    /// The paper's: D · G₁.
    Ndf,
    /// The usual one: D · cosine.
    GgxNl,
    /// D · a cosine that ends softly.
    GgxSoft,
}

/// `--level-choice`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LevelChoiceArg {
    /// Least error of the second moment.
    Optimal,
    /// The paper's.
    LogUniform,
}

impl Args {
    /// Edge of the smallest faces in texels.
    fn min_face_size(&self) -> u32 {
        self.min_face_size.unwrap_or(DEFAULT_MIN_FACE_SIZE.min(self.face_size / 2))
    }

    /// Options of the bake.
    pub fn options(&self) -> EnvironmentOptions {
        EnvironmentOptions {
            face_size: self.face_size,
            min_face_size: self.min_face_size(),
            per_size: self.roughnesses,
            look_ups: self.look_ups,
            levels: match self.levels {
                0 => LevelCount::Fewest(self.max_moment_error),
                count => LevelCount::Exactly(count),
            },
            level_choice: match self.level_choice {
                LevelChoiceArg::Optimal => LevelChoice::Optimal,
                LevelChoiceArg::LogUniform => LevelChoice::LogUniform,
            },
            floor: self.floor,
            coloured: self.coloured,
            filter_error: self.filter_error,
            max_error: self.max_error,
            kernel: match self.kernel {
                KernelArg::Ndf => Kernel::Ndf,
                KernelArg::GgxNl => Kernel::GgxNl,
                KernelArg::GgxSoft => Kernel::GgxSoft,
            },
            measured_reads: self.measure,
        }
    }

    /// Name of the environment in its pack: the file's, without what a section name cannot hold.
    pub fn name(&self) -> String {
        name_of_file(&self.input)
    }

    /// Where the pack goes.
    pub fn delivery(&self) -> Delivery<'_> {
        Delivery { output: &self.output, inputs: std::slice::from_ref(&self.input), run: &self.run }
    }

    /// Options for provenance, as they were used. Flags that do not change the pack's contents are left out.
    pub fn option_list(&self) -> OptionList {
        let mut options = OptionList::default();
        options.push("face-size", self.face_size);
        options.push("min-face-size", self.min_face_size());
        options.push("roughnesses", self.roughnesses);
        options.push("look-ups", self.look_ups);
        match self.levels {
            0 => options.push("levels", LEVELS_AUTO),
            count => options.push("levels", count),
        }
        options.push_choice("level-choice", &self.level_choice);
        options.push("floor", self.floor);
        options.push("max-moment-error", self.max_moment_error);
        options.push("coloured", self.coloured);
        if let Some(error) = self.max_error {
            options.push("max-error", error);
        }
        options.push("filter-error", self.filter_error);
        options.push_choice("kernel", &self.kernel);
        options.push("measure", self.measure);
        if let Some(layer) = &self.layer {
            options.push("layer", layer);
        }
        options
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Cli {
        #[command(flatten)]
        args: Args,
    }

    #[test]
    fn the_flags_and_the_bake_have_the_same_defaults() {
        let cli = Cli::parse_from(["environment", "sky.hdr", "-o", "out.glintpack"]);
        assert_eq!(cli.args.options(), EnvironmentOptions::default());
    }
}
