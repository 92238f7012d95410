//! `glint-bake plan`: what a scene needs of a project's maps.

use crate::cli::Terminal;
use crate::exit::{Exit, Failure};
use crate::output;
use crate::project::{self, Project, settled};
use crate::quantities::{kib, percent};
use std::path::PathBuf;

/// Lines that the help shows and a test runs.
const EXAMPLES: &str = "\
Examples:
  glint-bake plan scene.toml";

/// Plan what a scene needs: methods, mips and formats in the fewest bytes that keep an error
///
/// PROJECT has a [scene] (image, field-of-view, lights, error, bytes) and materials that say how they are seen (distance,
/// texels-per-metre). Each is baked as a draft with several options, measured at the footprints of the scene, and the
/// smallest within the error is taken. `glint-bake build` makes the same plan and bakes it.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Project file with a scene
    #[arg(value_name = "PROJECT", default_value = "glint.toml")]
    pub project: PathBuf,
    /// Measure the packs that were built for the scene, at other places than the plan was made at
    ///
    /// The exit code is 4 when one exceeds its error.
    #[arg(long)]
    pub measure: bool,
    /// Threads to use; the plan is the same for any number [default: one a core]
    #[arg(short = 'j', long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    #[arg(help_heading = "Run")]
    pub threads: Option<u32>,
}

/// Runs the subcommand.
pub fn run(args: &Args, terminal: Terminal) -> Result<(), Failure> {
    let project = project::load(&args.project)?;
    if args.measure {
        return crate::cli::on_threads(args.threads, || measure(project, terminal))?;
    }
    let plan = crate::cli::on_threads(args.threads, || settled::plan(&project, terminal))??;
    if let Some(scene) = &project.scene {
        output::print(&plan.to_text(scene))?;
    }
    if plan.fits() {
        return Ok(());
    }
    let path = project.path.display();
    Err(Failure::new(
        Exit::BadInput,
        format!(
            "{path}: the budgets cannot be kept; the plan is the nearest to them. Raise error or bytes of the scene, or the nearest distance"
        ),
    ))
}

/// Says how good the packs are; a failure when one is not good enough.
fn measure(mut project: Project, terminal: Terminal) -> Result<(), Failure> {
    settled::settle(&mut project, false, terminal)?;
    let all = settled::measure(&project)?;
    let mut text = String::new();
    for (name, pack) in &all {
        let (error, budget) = (percent(pack.error), percent(pack.budget));
        text += &format!("{name}: {} {error} of {budget}, {}\n", pack.measure, kib(pack.bytes));
    }
    output::print(&text)?;
    match all.iter().filter(|(_, pack)| pack.error > pack.budget).count() {
        0 => Ok(()),
        count => Err(Failure::new(
            Exit::BadInput,
            format!(
                "{count} of {} packs exceed their error; glint-bake build --check says which are stale, and a smaller error in their tables asks for better ones",
                all.len()
            ),
        )),
    }
}
