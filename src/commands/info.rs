//! `glint-info`: text, JSON, verification, plots.

use crate::cli::{Terminal, values};
use crate::exit::{Exit, Failure};
use crate::info::{Report, plot};
use crate::output;
use glint_formats::{Limits, Severity};
use std::path::PathBuf;

/// Flags of glint-info.
#[derive(clap::Args, Clone, Debug)]
pub struct Args {
    /// Pack to look at
    #[arg(value_name = "PACK")]
    pub pack: PathBuf,
    /// Print JSON, for a damaged pack too
    #[arg(long)]
    pub json: bool,
    /// Print only what is wrong, or that the pack is intact
    #[arg(long, conflicts_with = "json")]
    pub verify: bool,
    /// Write pictures of NDF maps, normals, placement, error and dictionaries into this folder
    #[arg(long, value_name = "DIR")]
    pub plot: Option<PathBuf>,
    /// Most bytes to read and to decompress, as in 512M
    #[arg(long, value_name = "BYTES", default_value = "4G", value_parser = values::bytes)]
    pub max_memory: u64,
}

/// Runs the program.
pub fn run(args: &Args, terminal: Terminal) -> Result<(), Failure> {
    let limits = Limits { max_file_bytes: args.max_memory, max_raw_bytes: args.max_memory, ..Limits::default() };
    let report = Report::of_file(&args.pack, &limits);
    for issue in report.issues.iter().filter(|_| !args.verify) {
        let message = format!("{}: {issue}", report.file);
        match issue.severity {
            Severity::Error => terminal.error(&message),
            Severity::Warning => terminal.warn(&message),
        }
    }
    if let Some(error) = &report.error {
        terminal.error(&format!("{}: {error}", report.file));
    }
    if args.json {
        output::print(&report.to_json())?;
    } else if args.verify {
        output::print(&verdict(&report, terminal))?;
    } else if report.exit() == Exit::Success && !terminal.is_quiet() {
        output::print(&report.to_text())?;
    }
    if report.exit() != Exit::Success {
        // What is wrong was said above, one line an issue.
        return Err(Failure::new(report.exit(), ""));
    }
    if let (Some(folder), Some(pack)) = (&args.plot, report.pack()) {
        for path in plot::write_all(pack, folder)? {
            terminal.say(&format!("{}: written", path.display()));
        }
    }
    Ok(())
}

/// What `--verify` prints: one line an issue, and a line for a pack that can be used.
fn verdict(report: &Report, terminal: Terminal) -> String {
    let mut text: String = report.issues.iter().map(|issue| format!("{}: {issue}\n", report.file)).collect();
    if report.exit() == Exit::Success && !terminal.is_quiet() {
        text.push_str(&format!("{}: intact\n", report.file));
    }
    text
}
