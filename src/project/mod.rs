//! A project: a TOML file that names materials and environments, each of which becomes a pack.
//!
//! [`file`] reads the tables, [`scene`] what the camera sees of them, [`arguments`] turns each into the command line that it stands for, [`freshness`] says
//! whether its pack is up to date, by the [`record`] that the last build left, and [`ninja`] writes it for another tool.

pub mod arguments;
pub mod file;
pub mod freshness;
pub mod ninja;
pub mod record;
pub mod scene;
pub mod settled;
pub mod stamp;

use crate::exit::Failure;
use crate::methods::Method;
use arguments::Words;
use scene::{Lobes, Scene, View};
use std::path::{Path, PathBuf};

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
    pub planned: Vec<Planned>,
}

/// A table that says how it is seen, so that its options can be planned.
#[derive(Clone, Debug)]
pub struct Planned {
    /// Name of the table.
    pub name: String,
    /// How it is seen.
    pub seen: Seen,
    /// Bakes that may come of it.
    pub ways: Vec<Way>,
}

/// How something is seen.
#[derive(Clone, Debug, PartialEq)]
pub enum Seen {
    /// A surface.
    Surface(View),
    /// An environment.
    Sky(Lobes),
}

/// A bake whose options are not all chosen.
#[derive(Clone, Debug)]
pub struct Way {
    /// Method.
    pub method: String,
    /// Options that are.
    pub words: Words,
}

/// One pack to build.
#[derive(Clone, Debug)]
pub struct Target {
    /// Name of the table, and of the pack's file.
    pub name: String,
    /// The pack.
    pub pack: PathBuf,
    /// The bake that makes it.
    pub bake: Method,
    /// Name of that bake.
    pub method: String,
    /// Its arguments on the command line.
    pub arguments: Vec<String>,
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
    /// Every file that is written: the pack first.
    pub fn outputs(&self) -> impl Iterator<Item = &Path> {
        std::iter::once(self.pack.as_path()).chain(self.report.as_deref())
    }
}

impl Project {
    /// Reads a project file.
    ///
    /// # Errors
    /// A file that cannot be read; usage, when it is not a project or an option is wrong. Every wrong option is named
    /// with its line.
    pub fn load(path: &Path) -> Result<Project, Failure> {
        let text = std::fs::read_to_string(path).map_err(|e| Failure::io(path, "cannot be read", &e))?;
        file::parse(path, &text).map_err(|errors| Failure::usage(errors.join("\n")))
    }

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

    /// Names of all tables that were read.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let targets = self.targets.iter().map(|target| target.name.as_str());
        targets.chain(self.planned.iter().map(|planned| planned.name.as_str()))
    }

    /// Where a pack lies.
    pub fn pack(&self, name: &str) -> PathBuf {
        self.output.join(format!("{name}.glintpack"))
    }

    /// Folder of what is remembered between builds.
    pub fn records(&self) -> PathBuf {
        self.output.join(record::FOLDER)
    }
}
