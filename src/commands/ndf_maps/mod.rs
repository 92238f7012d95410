//! `glint-bake ndf-maps`: normal maps in, a verified pack out. First everything is checked, then work begins.

mod args;
mod plan;
mod summary;

pub use args::Args;

use crate::cli::Terminal;
use crate::exit::Failure;
use crate::pack::{self, Baked};
use crate::progress::Stages;
use glint_bake_core::ndf_maps::baked::Material;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use plan::Plan;

/// Runs the subcommand.
pub fn run(args: Args, terminal: Terminal) -> Result<(), Failure> {
    let threads = args.run.threads;
    crate::cli::on_threads(threads, || bake(args, terminal))?
}

/// A bake that is only looked at: maps and materials, and the bytes that the pack would have.
pub(super) fn draft(args: Args) -> Result<(Vec<(NormalMap, Material)>, u64), Failure> {
    let plan = Plan::unwritten(args)?;
    let mut materials = Vec::new();
    for source in &plan.sources {
        let material = pack::bake(&source.loaded.map, &plan.bake, &plan.placement, &Silent)
            .map_err(|e| Failure::bake(&source.path, &e))?;
        plan.check_error(source, &material)?;
        materials.push(Baked { name: source.name.clone(), material });
    }
    let bytes = pack::assemble(&materials, plan.layers.as_ref(), &plan.provenance(), plan.codec())?;
    let made = plan.sources.into_iter().zip(materials).map(|(source, baked)| (source.loaded.map, baked.material));
    Ok((made.collect(), bytes.len() as u64))
}

fn bake(args: Args, terminal: Terminal) -> Result<(), Failure> {
    let plan = Plan::new(args)?;
    for source in &plan.sources {
        for warning in &source.loaded.warnings {
            terminal.warn(&format!("{}: {warning}", source.path.display()));
        }
        terminal.detail(&summary::of_input(source));
    }
    if plan.args.run.dry_run {
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
    plan.delivery().write(bytes, "--max-error", terminal)
}
