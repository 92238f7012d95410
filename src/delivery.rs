//! Where a pack goes: what is checked of outputs and inputs before a bake, and of its size after it.

use crate::cli::RunFlags;
use crate::depfile;
use crate::exit::{Exit, Failure};
use crate::output;
use crate::reading;
use std::collections::HashSet;
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
        self.check_standard()?;
        let outputs: Vec<&Path> = [Some(self.output), self.run.report.as_deref(), self.run.depfile.as_deref()]
            .into_iter()
            .flatten()
            .collect();
        output::check_distinct(&outputs, &self.inputs())?;
        if self.run.depfile.is_some() {
            depfile::rule(self.output, &self.inputs())?;
        }
        for path in self.inputs {
            reading::check_readable(path).map_err(|e| Failure::io(path, "cannot be read", &e))?;
        }
        outputs.iter().try_for_each(|path| output::check_writable(path))
    }

    /// Standard input and pipes are read once; standard output takes one thing, and no file depends on either.
    fn check_standard(&self) -> Result<(), Failure> {
        let streams: Vec<&PathBuf> = self.inputs.iter().filter(|path| reading::is_stream(path)).collect();
        let mut seen = HashSet::new();
        for path in &streams {
            if !seen.insert(if path.as_path() == Path::new("/dev/stdin") { Path::new("-") } else { path }) {
                return Err(Failure::usage(format!(
                    "{}: is given twice, and can be read once only; save it as a file first",
                    path.display()
                )));
            }
        }
        for (flag, path) in [("--report", &self.run.report), ("--depfile", &self.run.depfile)] {
            if path.as_deref().is_some_and(reading::is_standard) {
                let advice = if flag == "--report" { "for standard output give --json" } else { "name a file" };
                return Err(Failure::usage(format!("{flag}: - is not taken; {advice}")));
            }
        }
        let to_standard = reading::is_standard(self.output);
        if to_standard && self.run.json {
            return Err(Failure::usage("--json: standard output takes the pack already; give --report FILE"));
        }
        if self.run.depfile.is_some() && (to_standard || !streams.is_empty()) {
            return Err(Failure::usage(
                "--depfile: nothing can depend on a pipe or on standard input or output; name files",
            ));
        }
        Ok(())
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

    /// What the pack depends on.
    pub fn inputs(&self) -> Vec<&Path> {
        self.inputs.iter().map(PathBuf::as_path).collect()
    }
}
