//! The frame of every bake: the finished pack, its report and its dependency file reach their places.

use crate::cli::{Terminal, on_threads};
use crate::delivery::Delivery;
use crate::depfile;
use crate::exit::{Exit, Failure};
use crate::info::Report;
use crate::methods::bake::{Bake, FinishedPack};
use crate::methods::contents::Item;
use crate::output;
use crate::pack;
use crate::quantities::kib;
use glint_formats::WriteOutcome;
use std::path::Path;

/// Bakes on the threads that were asked for, and writes the pack.
pub fn run(bake: &dyn Bake, terminal: Terminal) -> Result<(), Failure> {
    let delivery = bake.delivery();
    on_threads(delivery.run.threads, || match bake.bake(terminal)? {
        Some(pack) => write(&delivery, pack, terminal),
        None => Ok(()),
    })?
}

/// Writes the pack and what goes with it, and says so. The pack comes last: a build tool that finds it finds the rest.
fn write(delivery: &Delivery<'_>, pack: FinishedPack, terminal: Terminal) -> Result<(), Failure> {
    delivery.check_size(pack.bytes.len() as u64, pack.smaller)?;
    let report = Report::of_bytes(delivery.output, pack.bytes, &pack::UNLIMITED);
    let Some(pack) = report.pack() else {
        let message = format!("the pack cannot be read back: {}; please report this", report.to_json());
        return Err(Failure::new(Exit::Unexpected, message));
    };
    if let Some(path) = &delivery.run.report {
        output::write(path, report.to_json().as_bytes())?;
    }
    if let Some(path) = &delivery.run.depfile {
        output::write(path, depfile::rule(delivery.output, &delivery.inputs())?.as_bytes())?;
    }
    let outcome = output::write(delivery.output, pack.file_bytes())?;
    terminal.say(&summary(delivery.output, &report, outcome));
    if delivery.run.json {
        output::print(&report.to_json())?;
    }
    Ok(())
}

/// The pack that was written.
fn summary(path: &Path, report: &Report, outcome: WriteOutcome) -> String {
    let line = |item: &dyn Item| item.accuracy_line().map(|line| format!("{}: {line}", item.name()));
    let mut lines: Vec<String> = report.contents.items().filter_map(line).collect();
    let outcome = match outcome {
        WriteOutcome::Written => "written",
        WriteOutcome::Unchanged => "unchanged",
    };
    lines.push(format!("{}: {outcome}, {}, verified", output::shown(path), kib(report.bytes)));
    lines.join("\n")
}
