//! Flags that every bake has: threads, limits, what is written beside the pack.

use super::values;
use std::path::PathBuf;

/// Flags that every bake has.
#[derive(clap::Args, Clone, Debug)]
#[command(next_help_heading = "Run")]
pub struct RunFlags {
    /// Threads to use [default: one a core]
    ///
    /// The pack is the same for any number.
    #[arg(short = 'j', long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Most bytes to hold for one map, or for the finished pack, as in 512M
    #[arg(long, value_name = "BYTES", default_value = "4G", value_parser = values::bytes)]
    pub max_memory: u64,
    /// Write what glint-info --json prints about the pack
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Write the inputs the pack depends on, in Make's syntax
    #[arg(long, value_name = "FILE")]
    pub depfile: Option<PathBuf>,
    /// Check everything, say what would be done, write nothing
    #[arg(short = 'n', long, conflicts_with = "json")]
    pub dry_run: bool,
    /// Print the report to standard output
    #[arg(long)]
    pub json: bool,
}
