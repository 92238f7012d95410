//! The plan of a project between builds: drafts take longer than bakes, so a plan is made once for equal maps and scenes.

use crate::cli::{Terminal, git_hash};
use crate::exit::{Exit, Failure};
use crate::plan::plan;
use crate::project::arguments::Methods;
use crate::project::stamp::Stamp;
use crate::project::{Project, Target};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Name of the file in the folder of records; no pack can be named so.
const FILE: &str = ".plan.json";

/// What was planned.
#[derive(Serialize, Deserialize)]
struct Saved {
    /// Scene, tables and program.
    key: String,
    /// The maps.
    inputs: Vec<Stamp>,
    packs: Vec<SavedPack>,
    fits: bool,
    text: String,
}

#[derive(Serialize, Deserialize)]
struct SavedPack {
    /// Name of the pack.
    name: String,
    /// Table that it comes from, by number, and way of that.
    from: (usize, usize),
    options: Vec<(String, String)>,
}

/// Whether every budget is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fit {
    /// It is.
    Kept,
    /// The plan is the nearest that is possible.
    Nearest,
}

/// Makes targets of what is planned, by the plan that was saved or by a new one, which is saved when `save` says so.
///
/// # Errors
/// Those of [`plan`]; a map that cannot be read; two packs of one name.
pub fn settle(project: &mut Project, save: bool, terminal: Terminal) -> Result<Fit, Failure> {
    if project.planned.is_empty() {
        return Ok(Fit::Kept);
    }
    let path = project.records().join(FILE);
    let old: Option<Saved> = std::fs::read(&path).ok().and_then(|bytes| serde_json::from_slice(&bytes).ok());
    let key = key(project);
    let stamps = stamps(project, old.as_ref())?;
    let same = |old: &Saved| {
        let content = |stamps: &[Stamp]| -> Vec<String> { stamps.iter().map(|stamp| stamp.xxh3_128.clone()).collect() };
        old.key == key && content(&old.inputs) == content(&stamps)
    };
    let saved = match old.filter(same) {
        Some(old) => {
            terminal.detail(old.text.trim_end());
            let renewed = old.inputs != stamps;
            let saved = Saved { inputs: stamps, ..old };
            if save && renewed {
                write(&path, &saved)?;
            }
            saved
        }
        None => {
            let new = made(project, key, stamps, terminal)?;
            terminal.say(new.text.trim_end());
            if save {
                write(&path, &new)?;
            }
            new
        }
    };
    let mut methods = Methods::new();
    for pack in &saved.packs {
        let taken = project.targets.iter().find(|target| target.name.to_lowercase() == pack.name.to_lowercase());
        if let Some(taken) = taken {
            return Err(Failure::usage(format!(
                "{}: {:?} is planned, and there is {:?} already; give that another name",
                project.path.display(),
                pack.name,
                taken.name
            )));
        }
        let fault = || Failure::usage(format!("{}: the saved plan does not fit; delete it", path.display()));
        let way =
            project.planned.get(pack.from.0).and_then(|planned| planned.ways.get(pack.from.1)).ok_or_else(fault)?;
        let words = pack.options.iter().fold(way.words.clone(), |words, (key, value)| words.with(key, value));
        let place = project.pack(&pack.name);
        let target = methods.target(&pack.name, &way.method, &words, place).map_err(|_| fault())?;
        project.targets.push(Target { planned: Some(pack.from.0), ..target });
    }
    Ok(if saved.fits { Fit::Kept } else { Fit::Nearest })
}

/// The failure that a plan beyond its budgets is.
pub fn beyond(project: &Project) -> Failure {
    let path = project.path.display();
    Failure::new(Exit::BadInput, format!("{path}: the budgets of the scene cannot be kept; see glint-bake plan"))
}

fn key(project: &Project) -> String {
    let tables: Vec<String> = project.planned.iter().map(|planned| format!("{planned:?}")).collect();
    format!("{} {}\n{:?}\n{}", env!("CARGO_PKG_VERSION"), git_hash(), project.scene, tables.join("\n"))
}

/// Every map that is planned, in the order of the file.
pub fn inputs(project: &Project) -> Vec<PathBuf> {
    let first = project.planned.iter().filter_map(|planned| planned.ways.first());
    first.flat_map(|way| way.words.inputs.iter().map(PathBuf::from)).collect()
}

fn stamps(project: &Project, old: Option<&Saved>) -> Result<Vec<Stamp>, Failure> {
    let stamp = |(k, path): (usize, &PathBuf)| {
        let known = old.and_then(|old| old.inputs.get(k));
        Stamp::of(path, known).map_err(|e| Failure::io(path, "cannot be read", &e))
    };
    inputs(project).iter().enumerate().map(stamp).collect()
}

fn made(project: &Project, key: String, inputs: Vec<Stamp>, terminal: Terminal) -> Result<Saved, Failure> {
    let plan = plan(project, terminal)?;
    let text = project.scene.as_ref().map_or(String::new(), |scene| plan.to_text(scene));
    let packs = plan.packs.iter().map(|chosen| SavedPack {
        name: chosen.candidates.name.clone(),
        from: chosen.candidates.from,
        options: chosen.point().options.clone(),
    });
    Ok(Saved { key, inputs, packs: packs.collect(), fits: plan.fits(), text })
}

fn write(path: &Path, saved: &Saved) -> Result<(), Failure> {
    let fault = |e: std::io::Error| Failure::io(path, "cannot be written", &e);
    std::fs::create_dir_all(crate::output::folder_of(path)).map_err(fault)?;
    let text = serde_json::to_string(saved).map_err(|e| fault(e.into()))?;
    crate::output::write(path, text.as_bytes()).map(|_| ())
}
