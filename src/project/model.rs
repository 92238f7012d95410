//! What a project file says, once it is read: packs to build, and what has to be planned first.

use crate::cli::{OptionList, typed};
use crate::exit::Failure;
use crate::methods::bake::Bake;
use crate::methods::method::Method;
use crate::plan::Planned;
use crate::scene::Scene;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Folder of what is remembered between builds, in that of the packs.
const RECORDS: &str = ".glint-build";

/// A project, checked as far as it can be without reading its inputs.
#[derive(Clone, Debug)]
pub struct Project {
    /// The project file.
    pub path: PathBuf,
    /// Folder of the packs.
    pub output: PathBuf,
    /// What is to be built, in the order of the file; what was planned comes last.
    pub targets: Vec<Target>,
    /// The scene that the others are planned for.
    pub scene: Option<Scene>,
    /// What has to be planned before it can be built.
    pub planned: Vec<PlannedTable>,
}

/// A table that says how it is seen, so that its options can be planned.
#[derive(Clone, Debug)]
pub struct PlannedTable {
    /// What is planned.
    pub planned: Planned,
    /// Of each alternative, the table as a pack to build, with defaults for all that is not chosen yet.
    pub bases: Vec<Target>,
}

/// A table as options and inputs of a command line.
#[derive(Clone, Debug, Default)]
pub struct CommandLine {
    /// Every flag as it is typed, with the key that it stands for, in the order of the table.
    pub flags: Vec<(String, OsString)>,
    /// What is given without a flag.
    pub inputs: Vec<OsString>,
}

impl CommandLine {
    /// Names of the flags.
    pub fn keys(&self) -> Vec<String> {
        self.flags.iter().map(|(key, _)| key.clone()).collect()
    }

    /// The same with a value, none for a flag that takes none, for an option that the table says nothing of.
    pub fn with(&self, key: &str, value: &str) -> CommandLine {
        let mut line = self.clone();
        if !line.flags.iter().any(|(other, _)| other == key) {
            line.flags.push((key.to_owned(), typed(key, value).into()));
        }
        line
    }

    /// All arguments of a bake into `pack`.
    pub fn arguments(&self, pack: &Path) -> Vec<OsString> {
        let mut output = OsString::from("--output=");
        output.push(pack);
        let mut arguments = vec![output];
        arguments.extend(self.flags.iter().map(|(_, flag)| flag.clone()));
        if !self.inputs.is_empty() {
            arguments.push("--".into());
            arguments.extend(self.inputs.iter().cloned());
        }
        arguments
    }
}

/// One pack to build.
#[derive(Clone, Debug)]
pub struct Target {
    /// Name of the table, and of the pack's file.
    pub name: String,
    /// The pack.
    pub pack: PathBuf,
    /// The bake that makes it.
    pub bake: Arc<dyn Bake>,
    /// Its method.
    pub method: &'static dyn Method,
    /// The options and inputs that the project gives it.
    pub line: CommandLine,
    /// Every option that the pack's bytes may depend on, defaults included: name and values.
    pub options: Vec<(String, Vec<String>)>,
    /// Files that the pack is made from.
    pub inputs: Vec<PathBuf>,
    /// Number of the table among those that are planned, when it is one.
    pub planned: Option<usize>,
    /// The report that is written beside the pack, when one is wanted.
    pub report: Option<PathBuf>,
}

impl Target {
    /// Arguments of the bake on the command line.
    pub fn arguments(&self) -> Vec<OsString> {
        self.line.arguments(&self.pack)
    }

    /// The same table with options that were chosen for it, as the pack `name` at `pack`, which `bake` makes.
    pub fn chosen(&self, name: &str, pack: PathBuf, options: &OptionList, bake: Arc<dyn Bake>) -> Target {
        let mut target = Target { name: name.to_owned(), pack, bake, ..self.clone() };
        for (flag, value) in options.iter() {
            target.line = target.line.with(flag, value);
            // A flag that takes no value is true when it is there.
            let value = if value.is_empty() { "true" } else { value };
            for (name, values) in &mut target.options {
                if name == flag {
                    *values = vec![value.to_owned()];
                }
            }
        }
        target
    }

    /// Every file that is written: the pack first.
    pub fn outputs(&self) -> impl Iterator<Item = &Path> {
        std::iter::once(self.pack.as_path()).chain(self.report.as_deref())
    }
}

impl Project {
    /// Leaves only the targets with these names; all when none are given.
    ///
    /// # Errors
    /// Usage, when there is no target of a name.
    pub fn select(&mut self, names: &[String]) -> Result<(), Failure> {
        for name in names {
            if !self.targets.iter().any(|target| target.name == *name) {
                let known: Vec<&str> = self.targets.iter().map(|target| target.name.as_str()).collect();
                let path = self.path.display();
                return Err(Failure::usage(format!(
                    "--only: {path} has nothing named {name:?}; it has {}",
                    known.join(", ")
                )));
            }
        }
        if !names.is_empty() {
            self.targets.retain(|target| names.contains(&target.name));
        }
        Ok(())
    }

    /// Where a pack lies.
    pub fn pack(&self, name: &str) -> PathBuf {
        self.output.join(format!("{name}.glintpack"))
    }

    /// Folder of what is remembered between builds.
    pub fn records(&self) -> PathBuf {
        self.output.join(RECORDS)
    }
}
