//! The plan of a project between builds: drafts take longer than bakes, so a plan is made once for equal maps and scenes.

use super::arguments::Methods;
use super::model::{Project, Target, Work};
use super::stamp::Stamp;
use crate::cli::{OptionList, Terminal, git_hash};
use crate::exit::{Exit, Failure};
use crate::methods::bake::Bake;
use crate::output;
use crate::plan::{self, Measured, Plan, Planned};
use crate::reading;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::Arc;

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
    /// Table that it comes from, by number, and alternative of that.
    from: (usize, usize),
    /// Options that were chosen.
    options: OptionList,
    /// The bake that was chosen, when the plan was made just now.
    #[serde(skip)]
    bake: Option<Arc<dyn Bake>>,
}

/// Whether every budget is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fit {
    /// It is.
    Kept,
    /// The plan is the nearest that is possible.
    Nearest,
}

/// The plan of a project's scene.
///
/// # Errors
/// Usage, when there is nothing to plan; otherwise what stops a draft.
pub fn plan(project: &Project, terminal: Terminal) -> Result<Plan, Failure> {
    let Some(scene) = project.scene.as_ref().filter(|_| !project.planned.is_empty()) else {
        return Err(Failure::usage(format!(
            "{}: nothing to plan; expected [scene], and a distance or an alpha in what is seen in it",
            project.path.display()
        )));
    };
    for path in inputs(project) {
        // Every draft reads them again.
        let meta = std::fs::metadata(&path);
        let looked = meta.and_then(|meta| reading::check_regular(&meta));
        looked.map_err(|e| Failure::io(&path, "cannot be read", &e))?;
    }
    let planned: Vec<Planned> = project.planned.iter().map(|table| table.planned.clone()).collect();
    plan::plan(scene, &planned, &|name| project.pack(name), terminal)
}

/// Measures every pack that was planned, each with its name.
///
/// # Errors
/// A pack that is not built or does not verify; inputs that cannot be read.
pub fn measure(project: &Project) -> Result<Vec<(&str, Measured)>, Failure> {
    let Some(scene) = &project.scene else { return Ok(Vec::new()) };
    let mut all = Vec::new();
    for target in &project.targets {
        let Some(table) = target.planned.and_then(|at| project.planned.get(at)) else { continue };
        let Work::Pack { bake, method } = &target.work else { continue };
        let measured = plan::measure(&target.pack, bake.as_ref(), method.planning(), scene, &table.planned.subject)?;
        all.push((target.name.as_str(), measured));
    }
    Ok(all)
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
        let table = project.planned.get(pack.from.0).ok_or_else(fault)?;
        let base = table.bases.get(pack.from.1).ok_or_else(fault)?;
        let place = project.pack(&pack.name);
        let bake = match &pack.bake {
            Some(bake) => bake.clone(),
            None => {
                let line = pack.options.iter().fold(base.line.clone(), |line, (key, value)| line.with(key, value));
                methods.bake(base.method(), &line, &place).map_err(|_| fault())?
            }
        };
        let target = base.chosen(&pack.name, place, &pack.options, bake);
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
    let tables: Vec<String> = project.planned.iter().map(|table| format!("{:?}", table.planned)).collect();
    format!("{} {}\n{:?}\n{}", env!("CARGO_PKG_VERSION"), git_hash(), project.scene, tables.join("\n"))
}

/// Every map that is planned, in the order of the file.
pub fn inputs(project: &Project) -> Vec<PathBuf> {
    let first = project.planned.iter().filter_map(|table| table.bases.first());
    first.flat_map(|base| base.line.inputs.iter().map(PathBuf::from)).collect()
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
        name: chosen.pack.name.clone(),
        from: chosen.pack.from,
        options: chosen.draft().options.clone(),
        bake: Some(chosen.draft().bake.clone()),
    });
    Ok(Saved { key, inputs, packs: packs.collect(), fits: plan.fits(), text })
}

fn write(path: &Path, saved: &Saved) -> Result<(), Failure> {
    let fault = |e: std::io::Error| Failure::io(path, "cannot be written", &e);
    std::fs::create_dir_all(output::folder_of(path)).map_err(fault)?;
    let text = serde_json::to_string(saved).map_err(|e| fault(e.into()))?;
    output::write(path, text.as_bytes()).map(|_| ())
}
