//! One file (or folder) a subcommand: its flags and what it does.

mod area_light;
mod deliver;
mod demo;
mod dictionary;
mod environment;
mod info;
mod lobes;
mod ndf_maps;
mod preview;
mod report;
mod surface;

use crate::cli::{Common, LONG_VERSION, Terminal};
use crate::exit::{Failure, HELP};
use clap::{CommandFactory, Parser, Subcommand};

/// The command line of glint-bake.
#[derive(Parser, Debug)]
#[command(name = "glint-bake", version, long_version = LONG_VERSION, after_help = HELP, max_term_width = 100)]
#[command(about = "Bakes data for real-time glints")]
#[command(after_long_help = HELP)]
pub struct Bake {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    common: Common,
}

#[derive(Subcommand, Debug)]
enum Command {
    NdfMaps(Box<ndf_maps::Args>),
    Lobes(Box<lobes::Args>),
    Dictionary(dictionary::Args),
    Environment(environment::Args),
    AreaLight(Box<area_light::Args>),
    Preview(preview::Args),
    Report(report::Args),
    Demo(demo::Args),
}

/// Runs glint-bake.
pub fn bake(cli: Bake) -> Result<(), Failure> {
    let terminal = Terminal::new(&cli.common);
    match cli.command {
        Command::NdfMaps(args) => ndf_maps::run(*args, terminal),
        Command::Lobes(args) => lobes::run(*args, terminal),
        Command::Dictionary(args) => dictionary::run(&args, terminal),
        Command::Environment(args) => environment::run(&args, terminal),
        Command::AreaLight(args) => area_light::run(*args, terminal),
        Command::Preview(args) => preview::run(&args, terminal),
        Command::Report(args) => report::run(&args, terminal),
        Command::Demo(args) => demo::run(&args, terminal),
    }
}

/// The command line of glint-info.
#[derive(Parser, Debug)]
#[command(name = "glint-info", version, long_version = LONG_VERSION, after_help = HELP, max_term_width = 100)]
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

/// Both programs as clap sees them, for the test that compares flags and documentation.
pub fn programs() -> [clap::Command; 2] {
    [Bake::command(), Info::command()]
}

/// Runs `work` on `threads` threads; as many as there are cores when it is not said.
fn on_threads<T: Send>(threads: Option<u32>, work: impl FnOnce() -> T + Send) -> Result<T, Failure> {
    let Some(threads) = threads else { return Ok(work()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads as usize).build();
    let pool = pool.map_err(|e| {
        Failure::new(crate::exit::Exit::Unexpected, format!("{threads} threads cannot be started: {e}; give fewer"))
    })?;
    Ok(pool.install(work))
}
