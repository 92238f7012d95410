//! `glint-bake dictionary`: a slope dictionary in a verified pack. It has no inputs; everything follows from the flags.

use super::args::Args;
use super::info::DictionaryInfo;
use crate::cli::Terminal;
use crate::exit::Failure;
use crate::methods::bake::FinishedPack;
use crate::methods::method::provenance;
use crate::pack;
use glint_bake_core::dictionary::{self, quality, sections};
use glint_bake_core::error::BakeError;
use glint_bake_core::progress::Silent;
use glint_formats::Codec;
use glint_formats::provenance::Provenance;

/// Name of the dictionary in its pack.
const NAME: &str = "dictionary";
/// What makes a dictionary smaller.
const SMALLER: &str = "give fewer --marginals, --levels or --entries";

/// Checks everything, then bakes, on one thread however many are offered: a dictionary takes hundredths of a second.
pub fn bake(args: &Args, terminal: Terminal) -> Result<Option<FinishedPack>, Failure> {
    let options = args.options();
    options.validate().map_err(|error| {
        let too_large = matches!(error, BakeError::LimitExceeded(_));
        let failure = Failure::from(error);
        if too_large { Failure { message: format!("{}; {SMALLER}", failure.message), ..failure } } else { failure }
    })?;
    let delivery = args.delivery();
    delivery.check()?;
    delivery.check_size(4 * options.tables() * u64::from(options.entries), SMALLER)?;
    if args.run.dry_run {
        terminal.say(&format!(
            "would write {}: {}; dry run, nothing was written",
            args.output.display(),
            DictionaryInfo::size_line(options.marginals, options.levels, options.entries)
        ));
        return Ok(None);
    }
    let dictionary = dictionary::bake(&options, &Silent)?;
    let codec = if args.compress { Codec::Zstd } else { Codec::None };
    let sections = sections::to_sections(NAME, &dictionary, quality::measure(&dictionary), codec);
    drop(dictionary);
    let provenance = Provenance { seed: args.seed, ..provenance::<Args>("dictionary", args.option_list()) };
    let bytes = pack::seal(&provenance, sections)?;
    Ok(Some(FinishedPack { bytes, smaller: SMALLER }))
}
