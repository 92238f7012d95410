//! `glint-bake glints`: a material of counted facets in a verified pack. It has no inputs; everything follows from the flags.

use super::args::Args;
use crate::cli::Terminal;
use crate::exit::Failure;
use crate::methods::bake::FinishedPack;
use crate::methods::method::provenance;
use crate::pack;
use glint_bake_core::glints::{self, sections};
use glint_bake_core::progress::Silent;
use glint_formats::Codec;
use glint_formats::provenance::Provenance;

/// What makes such a pack smaller.
const SMALLER: &str = "give --compress";
/// Bytes of both tables.
const TABLE_BYTES: u64 = 2 * 64 * 64 * 8;

/// Checks everything, then bakes.
pub fn bake(args: &Args, terminal: Terminal) -> Result<Option<FinishedPack>, Failure> {
    let options = args.options();
    options.validate().map_err(Failure::from)?;
    let delivery = args.delivery();
    delivery.check()?;
    delivery.check_size(TABLE_BYTES, SMALLER)?;
    if args.run.dry_run {
        let output = args.output.display();
        terminal.say(&format!("would write {output}: 64 KiB of tables; dry run, nothing was written"));
        return Ok(None);
    }
    let facets = glints::bake(&options, &Silent)?;
    let codec = if args.compress { Codec::Zstd } else { Codec::None };
    let sections = sections::to_sections(&args.name, &facets, codec);
    let provenance = Provenance { seed: u64::from(args.seed), ..provenance::<Args>("glints", args.option_list()) };
    let bytes = pack::seal(&provenance, sections)?;
    Ok(Some(FinishedPack { bytes, smaller: SMALLER }))
}
