//! What a project file says, once it is read: packs to build, and what has to be planned first.

use crate::cli::{OptionList, typed};
use crate::exit::Failure;
use crate::methods::bake::Bake;
use crate::methods::method::Method;
use crate::plan::Planned;
use crate::scene::Scene;
use crate::textures;
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

    /// The value of a flag, if the table has it.
    pub fn value(&self, key: &str) -> Option<String> {
        let (_, flag) = self.flags.iter().find(|(other, _)| other == key)?;
        flag.to_string_lossy().split_once('=').map(|(_, value)| value.to_owned())
    }

    /// All arguments, those first that say where results go.
    pub fn arguments(&self, destination: &[OsString]) -> Vec<OsString> {
        let mut arguments = destination.to_vec();
        arguments.extend(self.flags.iter().map(|(_, flag)| flag.clone()));
        if !self.inputs.is_empty() {
            arguments.push("--".into());
            arguments.extend(self.inputs.iter().cloned());
        }
        arguments
    }
}

/// The argument that says where a result goes.
pub fn output_flag(path: &Path) -> OsString {
    let mut output = OsString::from("--output=");
    output.push(path);
    output
}

/// What makes a target.
#[derive(Clone, Debug)]
pub enum Work {
    /// A method, which makes a pack.
    Pack {
        /// The bake that makes it.
        bake: Arc<dyn Bake>,
        /// Its method.
        method: &'static dyn Method,
    },
    /// `glint-bake textures`, which makes files for engines.
    Textures(Arc<textures::Args>),
}

/// One pack to build, or textures.
#[derive(Clone, Debug)]
pub struct Target {
    /// Name of the table, and of the pack's file.
    pub name: String,
    /// The pack; of textures their list, or the glTF file, either of which is written last.
    pub pack: PathBuf,
    /// Arguments that say where results go.
    pub destination: Vec<OsString>,
    /// What makes it.
    pub work: Work,
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
        self.line.arguments(&self.destination)
    }

    /// Name of the subcommand that makes it.
    pub fn method(&self) -> &'static str {
        match &self.work {
            Work::Pack { method, .. } => method.name(),
            Work::Textures(_) => textures::NAME,
        }
    }

    /// The same table with options that were chosen for it, as the pack `name` at `pack`, which `bake` makes.
    pub fn chosen(&self, name: &str, pack: PathBuf, options: &OptionList, bake: Arc<dyn Bake>) -> Target {
        let mut target = self.clone();
        target.name = name.to_owned();
        target.destination = vec![output_flag(&pack)];
        target.pack = pack;
        if let Work::Pack { bake: old, .. } = &mut target.work {
            *old = bake;
        }
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

    /// Every file that is written, as far as it is known before: the pack first. Textures have the files that their list names, once
    /// there is one.
    pub fn outputs(&self) -> Vec<PathBuf> {
        let mut outputs = vec![self.pack.clone()];
        outputs.extend(self.report.clone());
        if let Work::Textures(_) = self.work {
            let beside = textures::files_of(&self.pack).into_iter();
            outputs.extend(beside.filter(|file| !self.inputs.contains(file)));
        }
        outputs
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
