//! `glint-bake report`: speed against error of every method, as tables and plots.

use crate::cli::normal_maps::ColourSpaceArg;
use crate::cli::{Terminal, values};
use crate::exit::{Exit, Failure};
use crate::input::{Crop, InputOptions};
use crate::output;
use crate::reading;
use crate::report::{Document, HEADLINE, REPORTS, Report, Settings};
use std::path::{Path, PathBuf};

/// Lines that `--help` shows and a test runs.
const EXAMPLES: &str = "\
Examples:
  glint-bake report --list
  glint-bake report ndf-maps --maps flakes.png --crop 2x2+0+0 --quick -o report";

/// Measure speed against error of the methods
///
/// Writes one Markdown page a method, with plots beside it. Some reports measure maps and environments of a data folder:
/// those in its folders normals, tiny and hdri. A report that cannot be made, for want of data or of a GPU adapter, is left
/// out and said; when it was named, the command fails with code 3 or 5. All reports together take hours; --quick takes
/// minutes and says little.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Reports to make, as --list names them [default: all]
    #[arg(value_name = "METHOD", value_parser = name)]
    pub methods: Vec<String>,
    /// List the reports and whether each can be made here
    #[arg(long)]
    pub list: bool,
    /// Folder of maps and environments [default: the environment's GLINT_DATA]
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Folder for the pages and plots; it is created
    #[arg(short, long, value_name = "DIR", default_value = "glint-report")]
    pub output: PathBuf,
    /// Few samples, for a look at whether all works
    #[arg(long)]
    pub quick: bool,
    /// Put the headline of the dictionary's report in place of the line of this file that starts like it
    #[arg(long, value_name = "FILE")]
    pub readme: Option<PathBuf>,

    /// Measure these small maps in the report of ndf-maps
    #[arg(long, value_name = "MAP", num_args = 1.., help_heading = "Scale")]
    pub maps: Vec<PathBuf>,
    /// Part of each of --maps to use
    #[arg(long, value_name = "WxH+X+Y", value_parser = values::crop, requires = "maps", help_heading = "Scale")]
    pub crop: Option<Crop>,
    /// How the stored values of --maps are decoded: as the data and the file's tag say, not at all, or by the sRGB curve
    #[arg(long, value_name = "SPACE", default_value = "auto", requires = "maps", help_heading = "Scale")]
    pub colour_space: ColourSpaceArg,
    /// The same as --colour-space linear
    #[arg(long, requires = "maps", conflicts_with = "colour_space", help_heading = "Scale")]
    pub assume_linear: bool,
    /// Random footprints of each size, of ndf-maps, lobes and surface [default: by report]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096), help_heading = "Scale")]
    pub footprints: Option<u32>,
    /// Frames of each view, of frames [default: 20]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000), help_heading = "Scale")]
    pub frames: Option<u32>,
    /// Pixels of those frames [default: 1280x720]
    #[arg(long, value_name = "WxH", value_parser = values::size, help_heading = "Scale")]
    pub size: Option<(u32, u32)>,
    /// Use the adapter whose name holds this, for frames
    #[arg(long, value_name = "NAME", help_heading = "Scale")]
    pub adapter: Option<String>,
}

/// The report that measures maps of the user.
const NDF_MAPS: &str = "ndf-maps";

fn name(text: &str) -> Result<String, String> {
    let names: Vec<&str> = REPORTS.iter().map(|report| report.name).collect();
    match names.contains(&text) {
        true => Ok(text.to_owned()),
        false => Err(format!("expected {}, found {text}; maps of your own are given with --maps", names.join(", "))),
    }
}

/// Runs the subcommand.
pub fn run(args: &Args, terminal: Terminal) -> Result<(), Failure> {
    if !args.maps.is_empty() && !args.methods.is_empty() && !args.methods.iter().any(|name| name == NDF_MAPS) {
        return Err(Failure::usage(format!(
            "--maps: is for the report of {NDF_MAPS}; name it too, or leave --maps out"
        )));
    }
    let settings = settings(args, terminal);
    if args.list {
        return output::print(&list(&settings));
    }
    let reports = possible(args, &settings)?;
    if let Some(readme) = &args.readme {
        with_headline(readme, HEADLINE)?;
        output::check_writable(readme)?;
    }
    output::create_folder(&args.output)?;
    for report in &reports {
        output::check_writable(&args.output.join(format!("{}.md", report.name)))?;
    }
    for report in reports {
        terminal.say(&format!("{}: measuring", report.name));
        let document = (report.measure)(&settings)?;
        write(&document, args, terminal)?;
    }
    Ok(())
}

fn settings(args: &Args, terminal: Terminal) -> Settings {
    let environment = std::env::var_os("GLINT_DATA").filter(|value| !value.is_empty()).map(PathBuf::from);
    Settings {
        data: args.data.clone().or(environment),
        output: args.output.clone(),
        quick: args.quick,
        footprints: args.footprints,
        maps: args.maps.clone(),
        input: InputOptions {
            crop: args.crop,
            colour_space: args.colour_space.or_linear(args.assume_linear),
            ..InputOptions::default()
        },
        frames: args.frames,
        size: args.size,
        adapter: args.adapter.clone(),
        terminal,
    }
}

fn list(settings: &Settings) -> String {
    let mut text = String::new();
    for report in &REPORTS {
        text.push_str(&format!("{:<20}{}\n", report.name, report.about));
        if let Err(failure) = (report.check)(settings) {
            text.push_str(&format!("{:<20}cannot be made here: {}\n", "", failure.message));
        }
    }
    text
}

/// The reports that are asked for and can be made. Those that were named have to be; others are left out and said.
fn possible(args: &Args, settings: &Settings) -> Result<Vec<&'static Report>, Failure> {
    let named = |report: &Report| args.methods.iter().any(|name| name == report.name);
    let mut reports = Vec::new();
    for report in &REPORTS {
        if !args.methods.is_empty() && !named(report) {
            continue;
        }
        match (report.check)(settings) {
            Ok(()) => reports.push(report),
            Err(failure) if named(report) => {
                return Err(Failure { message: format!("report {}: {}", report.name, failure.message), ..failure });
            }
            Err(failure) => settings.terminal.warn(&format!("report {} is left out: {}", report.name, failure.message)),
        }
    }
    Ok(reports)
}

fn write(document: &Document, args: &Args, terminal: Terminal) -> Result<(), Failure> {
    for (file, text) in document.files() {
        let path = args.output.join(file);
        output::write(&path, text.as_bytes())?;
        terminal.say(&format!("{}: written", path.display()));
    }
    if let (Some(readme), Some(headline)) = (&args.readme, document.quoted()) {
        output::write(readme, with_headline(readme, headline)?.as_bytes())?;
        terminal.say(&format!("{}: headline written", readme.display()));
    }
    Ok(())
}

/// A file with a headline in place of the line that starts like it.
fn with_headline(path: &Path, headline: &str) -> Result<String, Failure> {
    let old = reading::text(path, "cannot be read")?;
    if !old.lines().any(|line| line.starts_with(HEADLINE)) {
        let message = format!("{}: expected a line that starts with '{HEADLINE}', found none", path.display());
        return Err(Failure::new(Exit::BadInput, message));
    }
    let lines = old.lines().map(|line| if line.starts_with(HEADLINE) { headline } else { line });
    Ok(lines.flat_map(|line| [line, "\n"]).collect())
}
