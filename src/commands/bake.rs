//! The last steps of every bake: the finished pack, its report and its dependency file reach their places.

use crate::cli::{RunFlags, Terminal};
use crate::exit::{Exit, Failure};
use crate::info::Report;
use crate::output;
use crate::quantities::kib;
use glint_formats::WriteOutcome;
use std::path::{Path, PathBuf};

/// Where a bake writes and what it depends on.
pub struct Delivery<'a> {
    /// The pack.
    pub output: &'a Path,
    /// Files the pack depends on.
    pub inputs: &'a [PathBuf],
    /// What is written beside the pack.
    pub run: &'a RunFlags,
}

impl Delivery<'_> {
    /// Says whether all inputs can be read and all outputs written, before any work.
    pub fn check(&self) -> Result<(), Failure> {
        let outputs: Vec<&Path> = [Some(self.output), self.run.report.as_deref(), self.run.depfile.as_deref()]
            .into_iter()
            .flatten()
            .collect();
        output::check_distinct(&outputs, &self.inputs())?;
        for path in self.inputs {
            std::fs::File::open(path).map_err(|e| Failure::io(path, "cannot be read", &e))?;
        }
        outputs.iter().try_for_each(|path| output::check_writable(path))
    }

    /// Refuses a pack above the limit. `smaller` says what makes it smaller.
    pub fn check_size(&self, found: u64, smaller: &str) -> Result<(), Failure> {
        let limit = self.run.max_memory;
        if found <= limit {
            return Ok(());
        }
        let message = format!("the pack has {found} bytes, the limit is {limit}; raise --max-memory or {smaller}");
        Err(Failure::new(Exit::LimitExceeded, message))
    }

    /// Writes the pack and what goes with it, and says so. The pack comes last: a build tool that finds it finds the
    /// rest.
    pub fn write(&self, bytes: Vec<u8>, smaller: &str, terminal: Terminal) -> Result<(), Failure> {
        self.check_size(bytes.len() as u64, smaller)?;
        let report = Report::of_bytes(self.output, bytes);
        let Some(pack) = report.pack() else {
            let message = format!("the pack cannot be read back: {}; please report this", report.to_json());
            return Err(Failure::new(Exit::Unexpected, message));
        };
        if let Some(path) = &self.run.report {
            output::write(path, report.to_json().as_bytes())?;
        }
        if let Some(path) = &self.run.depfile {
            output::write(path, output::depfile(self.output, &self.inputs()).as_bytes())?;
        }
        let outcome = output::write(self.output, pack.file_bytes())?;
        terminal.say(&summary(&report, outcome));
        if self.run.json {
            output::print(&report.to_json())?;
        }
        Ok(())
    }

    fn inputs(&self) -> Vec<&Path> {
        self.inputs.iter().map(PathBuf::as_path).collect()
    }
}

/// The pack that was written.
fn summary(report: &Report, outcome: WriteOutcome) -> String {
    let mut lines = Vec::new();
    for material in &report.materials {
        lines.push(format!("{}: {}", material.name, material.accuracy_line()));
    }
    for dictionary in &report.dictionaries {
        lines.push(format!("{}: {}", dictionary.name, dictionary.accuracy_line()));
    }
    for environment in &report.environments {
        lines.push(format!("{}: {}", environment.name, environment.accuracy_line()));
    }
    for material in &report.area_lights {
        lines.push(format!("{}: {}", material.name, material.accuracy_line()));
    }
    for map in &report.lobes {
        lines.push(format!("{}: {}", map.name, map.accuracy_line()));
    }
    for surface in &report.surfaces {
        lines.push(format!("{}: {}", surface.name, surface.accuracy_line()));
    }
    let outcome = match outcome {
        WriteOutcome::Written => "written",
        WriteOutcome::Unchanged => "unchanged",
    };
    lines.push(format!("{}: {outcome}, {}, verified", report.file, kib(report.bytes)));
    lines.join("\n")
}
