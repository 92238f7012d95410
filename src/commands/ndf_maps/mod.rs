//! `glint-bake ndf-maps`: normal maps in, a verified pack out. First everything is checked, then work begins.

mod args;
mod plan;
mod summary;

pub use args::Args;

use crate::cli::Terminal;
use crate::exit::{Exit, Failure};
use crate::info::Report;
use crate::output;
use crate::pack::{self, Baked};
use crate::progress::Stages;
use plan::Plan;

/// Runs the subcommand.
pub fn run(args: Args, terminal: Terminal) -> Result<(), Failure> {
    let threads = args.threads;
    super::on_threads(threads, || bake(args, terminal))?
}

fn bake(args: Args, terminal: Terminal) -> Result<(), Failure> {
    let plan = Plan::new(args)?;
    for source in &plan.sources {
        for warning in &source.loaded.warnings {
            terminal.warn(&format!("{}: {warning}", source.path.display()));
        }
        terminal.detail(&summary::of_input(source));
    }
    if plan.args.dry_run {
        terminal.say(&summary::of_plan(&plan));
        return Ok(());
    }
    let stages = Stages::new(terminal);
    let mut materials = Vec::new();
    for source in &plan.sources {
        let material = pack::bake(&source.loaded.map, &plan.bake, &plan.placement, &stages)
            .map_err(|e| Failure::bake(&source.path, &e))?;
        plan.check_error(source, &material)?;
        materials.push(Baked { name: source.name.clone(), material });
    }
    let bytes = pack::assemble(&materials, plan.layers.as_ref(), &plan.provenance(), plan.codec())?;
    if bytes.len() as u64 > plan.args.max_memory {
        let (found, limit) = (bytes.len(), plan.args.max_memory);
        let message = format!("the pack has {found} bytes, the limit is {limit}; raise --max-memory or --max-error");
        return Err(Failure::new(Exit::LimitExceeded, message));
    }
    write(&plan, bytes, terminal)
}

/// Writes the pack and what goes with it. The pack comes last: a build tool that finds it finds the rest.
fn write(plan: &Plan, bytes: Vec<u8>, terminal: Terminal) -> Result<(), Failure> {
    let args = &plan.args;
    let report = Report::of_bytes(&args.output, bytes.clone());
    if let Some(path) = &args.report {
        output::write(path, report.to_json().as_bytes())?;
    }
    if let Some(path) = &args.depfile {
        output::write(path, output::depfile(&args.output, &plan.inputs()).as_bytes())?;
    }
    let outcome = output::write(&args.output, &bytes)?;
    terminal.say(&summary::of_pack(&report, outcome));
    if args.json {
        output::print(&report.to_json())?;
    }
    Ok(())
}
