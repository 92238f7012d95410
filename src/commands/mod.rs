//! One file (or folder) a subcommand: its flags and what it does.

mod bake;
mod build;
mod demo;
mod export;
pub mod flag_tables;
mod generate;
mod info;
mod ninja;
mod plan;
mod preview;
mod report;
mod shaders;
mod view;

use crate::cli::{Common, LONG_VERSION, Terminal};
use crate::exit::{Failure, HELP};
use crate::methods::MethodCommand;
use crate::textures;
use clap::{CommandFactory, Parser, Subcommand};

/// Lines that `glint-bake --help` shows and a test runs.
const EXAMPLES: &str = "\
Examples:
  glint-bake ndf-maps flakes.png -o paint.glintpack
  glint-bake dictionary -o dictionary.glintpack";

/// Lines that `glint-info --help` shows and a test runs.
const INFO_EXAMPLES: &str = "\
Examples:
  glint-info paint.glintpack
  glint-info paint.glintpack --verify
  glint-info sky.glintpack --plot pictures
  glint-info sky.glintpack --extract ENRA -o radiance.bin
  glint-info --diff old.glintpack new.glintpack";

/// The command line of glint-bake.
#[derive(Parser, Debug)]
#[command(name = "glint-bake", version, long_version = LONG_VERSION, max_term_width = 100)]
#[command(about = "Bakes data for real-time glints")]
#[command(after_help = format!("{EXAMPLES}\n\n{HELP}"))]
pub struct Bake {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    common: Common,
}

#[derive(Subcommand, Debug)]
enum Command {
    #[command(flatten)]
    Method(MethodCommand),
    Build(build::Args),
    Ninja(ninja::Args),
    Plan(plan::Args),
    Preview(preview::Args),
    Export(export::Args),
    Textures(Box<textures::Args>),
    Generate(generate::Args),
    Shaders(shaders::Args),
    Report(report::Args),
    Demo(demo::Args),
}

/// Runs glint-bake.
pub fn bake(cli: Bake) -> Result<(), Failure> {
    let terminal = Terminal::new(&cli.common);
    match cli.command {
        Command::Method(MethodCommand(method)) => bake::run(method.as_ref(), terminal),
        Command::Build(args) => build::run(&args, terminal),
        Command::Ninja(args) => ninja::run(&args, terminal),
        Command::Plan(args) => plan::run(&args, terminal),
        Command::Preview(args) => preview::run(&args, terminal),
        Command::Export(args) => export::run(&args, terminal),
        Command::Textures(args) => textures::run(&args, terminal),
        Command::Generate(args) => generate::run(&args, programs(), terminal),
        Command::Shaders(args) => shaders::run(&args, terminal),
        Command::Report(args) => report::run(&args, terminal),
        Command::Demo(args) => demo::run(&args, terminal),
    }
}

/// The command line of glint-info.
#[derive(Parser, Debug)]
#[command(name = "glint-info", version, long_version = LONG_VERSION, max_term_width = 100)]
#[command(after_help = format!("{INFO_EXAMPLES}\n\n{HELP}"))]
#[command(about = "Says what a pack holds and whether it is intact")]
pub struct Info {
    #[command(flatten)]
    args: info::Args,
    #[command(flatten)]
    common: Common,
}

/// Runs glint-info.
pub fn info(cli: Info) -> Result<(), Failure> {
    let terminal = Terminal::new(&cli.common);
    info::run(&cli.args, terminal)
}

/// Lines that `glint-view --help` shows and a test runs.
const VIEW_EXAMPLES: &str = "\
Examples:
  glint-view dictionary.glintpack --headless glints.png
  glint-view paint.glintpack --shape sphere --headless paint.png --samples 16
  glint-view paint.glintpack --list";

/// The command line of glint-view.
#[derive(Parser, Debug)]
#[command(name = "glint-view", version, long_version = LONG_VERSION, max_term_width = 100)]
#[command(after_help = format!("{VIEW_EXAMPLES}\n\n{HELP}"))]
#[command(about = "Shows packs in a window, or as pictures without one")]
pub struct View {
    #[command(flatten)]
    args: view::Args,
    #[command(flatten)]
    common: Common,
}

/// Runs glint-view.
#[cfg(feature = "view")]
pub fn view(cli: View) -> Result<(), Failure> {
    let terminal = Terminal::new(&cli.common);
    view::run(&cli.args, terminal)
}

/// All programs as clap sees them, for manual pages, completions, and the tests that compare flags and
/// documentation.
pub fn programs() -> [clap::Command; 3] {
    [Bake::command(), Info::command(), View::command()]
}
