//! `glint-bake report`: speed against error of the NDF maps of given examples, as tables and plots.
//!
//! Timings are of the machine that runs the command, on one thread, beside the error that they buy.

mod measure;
mod plot;
mod tables;

use crate::cli::{Terminal, values};
use crate::exit::{Exit, Failure};
use crate::input::{Crop, InputOptions, load_normal_map};
use crate::output;
use std::path::PathBuf;

/// Lines that `--help` shows and a test runs.
const EXAMPLES: &str = "\
Examples:
  glint-bake report flakes.png --crop 2x2+0+0 --footprints 1 -o .";

/// Measure speed against error on examples
///
/// Bakes every example with several settings, holds tiles and footprints against the exact integral, and writes
/// ACCURACY.md and one plot an example. Takes minutes an example; --footprints makes it shorter or more certain.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Examples: normal maps, whole or with --crop
    #[arg(value_name = "MAP", required = true)]
    pub maps: Vec<PathBuf>,
    /// Folder for ACCURACY.md and the plots
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Part of every map to use
    #[arg(long, value_name = "WxH+X+Y", value_parser = values::crop)]
    pub crop: Option<Crop>,
    /// Random footprints of each size
    #[arg(long, value_name = "N", default_value = "64", value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub footprints: u32,
    /// Take the values of files tagged as sRGB as they are
    #[arg(long)]
    pub assume_linear: bool,
}

/// Runs the subcommand.
pub fn run(args: &Args, terminal: Terminal) -> Result<(), Failure> {
    if !args.output.is_dir() {
        let path = args.output.display();
        return Err(Failure::new(Exit::InputOutput, format!("{path}: is not a folder; make it, or name another")));
    }
    let input = InputOptions { crop: args.crop, assume_linear: args.assume_linear, ..InputOptions::default() };
    let mut loaded = Vec::new();
    for path in &args.maps {
        loaded.push(load_normal_map(path, &input)?);
    }
    let mut text = tables::introduction(args.footprints);
    for (path, map) in args.maps.iter().zip(&loaded) {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        terminal.say(&format!("{name}: measuring"));
        let measured = measure::example(&map.map, args.footprints).map_err(|e| Failure::bake(path, &e))?;
        let plot = format!("accuracy-{name}.svg");
        output::write(&args.output.join(&plot), plot::bytes_against_error(&name, &measured.settings).as_bytes())?;
        text += &tables::example(&name, &map.map, &measured, &plot);
    }
    let path = args.output.join("ACCURACY.md");
    output::write(&path, text.as_bytes())?;
    terminal.say(&format!("{}: written", path.display()));
    Ok(())
}
