//! `glint-info`: text, JSON, verification, comparison, extraction, plots.

use crate::cli::{Terminal, values};
use crate::exit::{Exit, Failure};
use crate::info::diff::Diff;
use crate::info::{Report, plot};
use crate::output;
use glint_formats::{Limits, Pack, SectionEntry, Severity};
use std::path::{Path, PathBuf};

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
    /// Say what differs between pack A and PACK; the exit code is 7 when something does
    #[arg(long, value_name = "A", conflicts_with_all = ["verify", "plot", "extract"])]
    pub diff: Option<PathBuf>,
    /// Write the bytes of a section, decompressed, to the file of --output: its kind, as in ENRA, or kind and name
    ///
    /// The name is needed where there are several of the kind, as in NMDE:rock.
    #[arg(long, value_name = "SECTION[:NAME]", requires = "output", conflicts_with_all = ["json", "verify", "plot"])]
    pub extract: Option<String>,
    /// File for --extract
    #[arg(short, long, value_name = "FILE", requires = "extract")]
    pub output: Option<PathBuf>,
    /// Write pictures of all that the pack holds into this folder
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
    if let Some(other) = &args.diff {
        return diff(&Report::of_file(other, &limits), &report, args, terminal);
    }
    if let (Some(section), Some(path)) = (&args.extract, &args.output) {
        return extract(&report, &args.pack, section, path, terminal);
    }
    say_problems(&report, args, terminal);
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

/// What is wrong, on standard error; with --verify the issues go to standard output instead.
fn say_problems(report: &Report, args: &Args, terminal: Terminal) {
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
}

/// Compares two packs.
fn diff(a: &Report, b: &Report, args: &Args, terminal: Terminal) -> Result<(), Failure> {
    say_problems(a, args, terminal);
    say_problems(b, args, terminal);
    let found = Diff::of(a, b)?;
    if args.json {
        output::print(&found.to_json())?;
    } else if found.equal.is_some() && !terminal.is_quiet() {
        output::print(&found.to_text())?;
    }
    match found.exit(a, b) {
        Exit::Success => Ok(()),
        // What differs, or what is wrong, was said above.
        exit => Err(Failure::new(exit, "")),
    }
}

/// Writes the bytes of one section.
fn extract(report: &Report, pack_path: &Path, section: &str, path: &Path, terminal: Terminal) -> Result<(), Failure> {
    let pack = report.sound()?;
    let entry = find(pack, section)?;
    output::check_distinct(&[path], &[pack_path])?;
    output::check_writable(path)?;
    let payload =
        pack.payload(entry).map_err(|issue| Failure::new(Exit::BadInput, format!("{}: {issue}", report.file)))?;
    output::write(path, &payload)?;
    terminal.say(&format!("{}: written, {} bytes of {}", output::shown(path), payload.len(), entry.label()));
    Ok(())
}

/// The section that `KIND` or `KIND:NAME` means. Without a name there must be no doubt.
fn find<'a>(pack: &'a Pack, section: &str) -> Result<&'a SectionEntry, Failure> {
    let (kind, name) = section.split_once(':').map_or((section, None), |(kind, name)| (kind, Some(name)));
    let is_it = |entry: &&SectionEntry| entry.kind.to_string() == kind && name.is_none_or(|name| entry.name == name);
    let found: Vec<&SectionEntry> = pack.sections().iter().filter(is_it).collect();
    match found[..] {
        [entry] => Ok(entry),
        [] => {
            let all: Vec<String> = pack.sections().iter().map(as_flag).collect();
            Err(Failure::usage(format!("--extract: expected one of {}, found {section}", all.join(", "))))
        }
        _ => {
            let several: Vec<String> = found.into_iter().map(as_flag).collect();
            Err(Failure::usage(format!("--extract: {section} is one of {}; say which", several.join(", "))))
        }
    }
}

fn as_flag(entry: &SectionEntry) -> String {
    if entry.name.is_empty() { entry.kind.to_string() } else { format!("{}:{}", entry.kind, entry.name) }
}

/// What `--verify` prints: one line an issue, and a line for a pack that can be used.
fn verdict(report: &Report, terminal: Terminal) -> String {
    let mut text: String = report.issues.iter().map(|issue| format!("{}: {issue}\n", report.file)).collect();
    if report.exit() == Exit::Success && !terminal.is_quiet() {
        text.push_str(&format!("{}: intact\n", report.file));
    }
    text
}
