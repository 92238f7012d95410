//! `glint-bake ninja`: a project as a build file of ninja.

use crate::cli::Terminal;
use crate::exit::Failure;
use crate::output;
use crate::project::{self, ninja, settled};
use crate::reading;
use std::path::{Path, PathBuf};

/// Lines that the help shows and a test runs.
const EXAMPLES: &str = "\
Examples:
  glint-bake ninja glint.toml -o build.ninja";

/// Write a project as a build file of ninja
///
/// One edge a pack, with the bake's own command line, so that ninja, or a front end of it that runs commands on other
/// machines, does the building. Without --output the file is printed, and named build.ninja in it.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Project file
    #[arg(value_name = "PROJECT", default_value = "glint.toml")]
    pub project: PathBuf,
    /// Build file to write; ninja writes it anew when the project changes
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// How the build file calls this program
    #[arg(long, value_name = "PROGRAM", default_value = "glint-bake")]
    pub program: String,
}

/// Runs the subcommand.
pub fn run(args: &Args, terminal: Terminal) -> Result<(), Failure> {
    let mut project = project::load(&args.project)?;
    settled::settle(&mut project, true, terminal)?;
    let Some(path) = args.output.as_ref().filter(|path| !reading::is_standard(path)) else {
        return output::print(&ninja::manifest(&project, &args.program, Path::new("build.ninja"))?);
    };
    output::check_distinct(&[path], &[&args.project])?;
    output::check_writable(path)?;
    output::write(path, ninja::manifest(&project, &args.program, path)?.as_bytes())?;
    terminal.say(&format!("{}: written, {} packs", path.display(), project.targets.len()));
    Ok(())
}
