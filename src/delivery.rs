//! Where a pack goes: what is checked of outputs and inputs before a bake, and of its size after it.

use crate::cli::RunFlags;
use crate::exit::{Exit, Failure};
use crate::output;
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

    /// What the pack depends on.
    pub fn inputs(&self) -> Vec<&Path> {
        self.inputs.iter().map(PathBuf::as_path).collect()
    }
}
