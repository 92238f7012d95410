//! `glint-bake dictionary`: a slope dictionary in a verified pack. It has no inputs; everything follows from the flags.

use super::args::Args;
use super::info::DictionaryInfo;
use crate::cli::Terminal;
use crate::commands::bake::Delivery;
use crate::exit::Failure;
use crate::pack;
use glint_bake_core::dictionary::{self, quality, sections};
use glint_bake_core::progress::Silent;
use glint_formats::Codec;
use glint_formats::provenance::Provenance;

/// Name of the dictionary in its pack.
const NAME: &str = "dictionary";
/// What makes a dictionary smaller.
const SMALLER: &str = "give fewer --marginals, --levels or --entries";

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
