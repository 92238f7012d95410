//! `glint-bake dictionary`: a slope dictionary in a verified pack. It has no inputs; everything follows from the flags.

use super::deliver::Delivery;
use crate::cli::{RunFlags, Terminal};
use crate::exit::Failure;
use crate::info::DictionaryInfo;
use crate::pack;
use glint_bake_core::dictionary::{self, DictionaryOptions, quality, sections};
use glint_bake_core::progress::Silent;
use glint_formats::Codec;
use glint_formats::provenance::Provenance;
use std::path::PathBuf;

/// Name of the dictionary in its pack.
const NAME: &str = "dictionary";
/// What makes a dictionary smaller.
const SMALLER: &str = "give fewer --marginals, --levels or --entries";

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
    run: RunFlags,
}

/// Runs the subcommand, on one thread however many are offered: a dictionary takes hundredths of a second.
pub fn run(args: &Args, terminal: Terminal) -> Result<(), Failure> {
    let options = args.options();
    options.validate()?;
    let delivery = Delivery { output: &args.output, inputs: &[], run: &args.run };
    delivery.check()?;
    delivery.check_size(4 * options.tables() * u64::from(options.entries), SMALLER)?;
    if args.run.dry_run {
        terminal.say(&format!(
            "would write {}: {}; dry run, nothing was written",
            args.output.display(),
            DictionaryInfo::size_line(options.marginals, options.levels, options.entries)
        ));
        return Ok(());
    }
    let dictionary = dictionary::bake(&options, &Silent)?;
    let codec = if args.compress { Codec::Zstd } else { Codec::None };
    let sections = sections::to_sections(NAME, &dictionary, quality::measure(&dictionary), codec);
    drop(dictionary);
    let bytes = pack::seal(&args.provenance(), sections)?;
    delivery.write(bytes, SMALLER, terminal)
}

impl Args {
    fn options(&self) -> DictionaryOptions {
        DictionaryOptions {
            marginals: self.marginals,
            levels: self.levels,
            entries: self.entries,
            alpha_dict: self.alpha_dict,
            lobe_std: self.lobe_std,
            seed: self.seed,
        }
    }

    /// Where the pack comes from. Flags that do not change its contents are left out.
    fn provenance(&self) -> Provenance {
        let options = [
            ("marginals", self.marginals.to_string()),
            ("levels", self.levels.to_string()),
            ("entries", self.entries.to_string()),
            ("alpha-dict", self.alpha_dict.to_string()),
            ("lobe-std", self.lobe_std.to_string()),
        ];
        Provenance {
            options: options.into_iter().map(|(name, value)| (name.to_owned(), value)).collect(),
            seed: self.seed,
            ..pack::provenance("dictionary")
        }
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
