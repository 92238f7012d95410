//! Flags of `glint-bake dictionary`.

use crate::cli::{OptionList, RunFlags};
use crate::delivery::Delivery;
use glint_bake_core::dictionary::DictionaryOptions;
use std::path::PathBuf;

/// Lines that `--help` shows and a test runs.
const EXAMPLES: &str = "\
Examples:
  glint-bake dictionary -o dictionary.glintpack
  glint-bake dictionary --marginals 64 --levels 12 --compress -o small.glintpack";

/// Bake a slope dictionary for procedural glints, without a normal map
///
/// A table of slope distributions, from a few facets (level 0) to the smooth limit. One dictionary serves every
/// material of a scene, at any roughness and density of facets, Beckmann or GGX. The defaults are the paper's.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Pack to write
    #[arg(short, long, value_name = "PACK")]
    pub output: PathBuf,

    /// Different slope distributions a level
    #[arg(long, value_name = "N", default_value = "192", allow_negative_numbers = true, help_heading = "Bake")]
    pub marginals: u32,
    /// Levels, 1 to 20; level l has 2^(l+1) lobes
    #[arg(long, value_name = "N", default_value = "16", allow_negative_numbers = true, help_heading = "Bake")]
    pub levels: u32,
    /// Entries of one distribution
    #[arg(long, value_name = "N", default_value = "64", allow_negative_numbers = true, help_heading = "Bake")]
    pub entries: u32,
    /// Roughness of the tables' Beckmann target, 0.01 to 10; it does not limit the roughness at run time
    #[arg(long, value_name = "ALPHA", default_value = "0.5", allow_negative_numbers = true, help_heading = "Bake")]
    pub alpha_dict: f64,
    /// Standard deviation of one lobe, in slope
    #[arg(long, value_name = "SLOPE", default_value = "0.02", allow_negative_numbers = true, help_heading = "Bake")]
    pub lobe_std: f64,
    /// Seed of the lobes' places
    #[arg(long, value_name = "SEED", default_value = "0", allow_negative_numbers = true, help_heading = "Bake")]
    pub seed: u64,
    /// Compress the pack's sections with Zstandard
    #[arg(long, help_heading = "Bake")]
    pub compress: bool,

    #[command(flatten)]
    pub run: RunFlags,
}

impl Args {
    /// Options of the bake.
    pub fn options(&self) -> DictionaryOptions {
        DictionaryOptions {
            marginals: self.marginals,
            levels: self.levels,
            entries: self.entries,
            alpha_dict: self.alpha_dict,
            lobe_std: self.lobe_std,
            seed: self.seed,
        }
    }

    /// Where the pack goes.
    pub fn delivery(&self) -> Delivery<'_> {
        Delivery { output: &self.output, inputs: &[], run: &self.run }
    }

    /// Options for provenance. Flags that do not change the pack's contents are left out.
    pub fn option_list(&self) -> OptionList {
        let mut options = OptionList::default();
        options.push("marginals", self.marginals);
        options.push("levels", self.levels);
        options.push("entries", self.entries);
        options.push("alpha-dict", self.alpha_dict);
        options.push("lobe-std", self.lobe_std);
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
        let cli = Cli::parse_from(["dictionary", "-o", "out.glintpack"]);
        assert_eq!(cli.args.options(), DictionaryOptions::default());
    }
}
