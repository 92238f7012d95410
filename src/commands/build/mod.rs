//! `glint-bake build`: the packs of a project that are not up to date.

mod work;

use crate::cli::Terminal;
use crate::depfile;
use crate::exit::{Exit, Failure};
use crate::output;
use crate::project::freshness::Freshness;
use crate::project::settled::{self, Fit};
use crate::project::{self, Project, Target};
use clap::builder::RangedU64ValueParser;
use glint_formats::container::{TEMPORARY_PREFIX, TEMPORARY_SUFFIX};
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Lines that the help shows and a test runs.
const EXAMPLES: &str = "\
Examples:
  glint-bake build glint.toml
  glint-bake build glint.toml --check";

/// Build the packs of a project that are not up to date
///
/// PROJECT is a TOML file with a table a pack: its method, its input, and the method's options under the names that
/// they have on the command line. A pack is baked again when its inputs, its options or this program have changed.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Project file
    #[arg(value_name = "PROJECT", default_value = "glint.toml")]
    pub project: PathBuf,
    /// Build only the pack of this name; may be given several times
    #[arg(long, value_name = "NAME")]
    pub only: Vec<String>,
    /// Do nothing; end with code 7 when a pack is not up to date
    ///
    /// What is not up to date is said, and why.
    #[arg(long, conflicts_with_all = ["dry_run", "depfile"])]
    pub check: bool,
    /// Threads to use [default: one a core]
    #[arg(short = 'j', long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    #[arg(help_heading = "Run")]
    pub threads: Option<u32>,
    /// Packs to work on at a time; memory grows with it [default: as many as threads, at most 4]
    ///
    /// It does not grow with the number of packs.
    #[arg(long, value_name = "N", value_parser = RangedU64ValueParser::<usize>::new().range(1..=1024))]
    #[arg(help_heading = "Run")]
    pub in_flight: Option<usize>,
    /// Write the inputs that the packs depend on, in Make's syntax
    #[arg(long, value_name = "FILE", help_heading = "Run")]
    pub depfile: Option<PathBuf>,
    /// Say what would be done and why, write nothing
    #[arg(short = 'n', long, help_heading = "Run")]
    pub dry_run: bool,
}

/// Packs that are worked on at a time when it is not said.
const MOST_IN_FLIGHT: usize = 4;

/// Runs the subcommand.
pub fn run(args: &Args, terminal: Terminal) -> Result<(), Failure> {
    let mut project = project::load(&args.project)?;
    if let Some(threads) = args.threads {
        // Bakes run on the pool of the whole process, so that all packs share its threads.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads as usize).build_global();
        pool.map_err(|e| {
            Failure::new(Exit::Unexpected, format!("{threads} threads cannot be started: {e}; give fewer"))
        })?;
    }
    let fit = settled::settle(&mut project, !args.check && !args.dry_run, terminal)?;
    project.select(&args.only)?;
    let states: Vec<_> = project.targets.par_iter().map(|target| Freshness::of(&project, target)).collect();
    if args.check {
        return check(&project, &states, terminal);
    }
    if args.dry_run {
        return dry_run(&project, &states, terminal);
    }
    let dependencies = match &args.depfile {
        Some(path) => Some((path, depfile(&project)?)),
        None => None,
    };
    prepare(&project, args.depfile.as_deref())?;
    let in_flight = args.in_flight.unwrap_or(rayon::current_num_threads().min(MOST_IN_FLIGHT));
    let outcomes = work::all(&project, states, in_flight, terminal);
    work::summary(&project, &outcomes, terminal)?;
    if let Some((path, text)) = dependencies {
        output::write(path, text.as_bytes())?;
    }
    match fit {
        Fit::Kept => Ok(()),
        Fit::Nearest => Err(settled::beyond(&project)),
    }
}

/// Makes the folders, and finds out whether they take files.
fn prepare(project: &Project, depfile: Option<&Path>) -> Result<(), Failure> {
    let records = project.records();
    std::fs::create_dir_all(&records).map_err(|e| Failure::io(&records, "cannot be made", &e))?;
    remove_remains(&project.output);
    let outputs: Vec<PathBuf> = project.targets.iter().flat_map(Target::outputs).collect();
    let outputs: Vec<&Path> = outputs.iter().map(PathBuf::as_path).chain(depfile).collect();
    let inputs = project.targets.iter().flat_map(|target| target.inputs.iter().map(PathBuf::as_path));
    let inputs: Vec<&Path> = inputs.chain([project.path.as_path()]).collect();
    output::check_distinct(&outputs, &inputs)?;
    depfile.map_or(Ok(()), output::check_writable)
}

/// Removes the temporary files of builds that were killed. Those of another build that still runs are younger; what
/// cannot be removed does no harm.
fn remove_remains(folder: &Path) {
    const OLD: Duration = Duration::from_secs(3600);
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let is_ours = name.starts_with(TEMPORARY_PREFIX) && name.ends_with(TEMPORARY_SUFFIX);
        let age = entry.metadata().ok().and_then(|meta| meta.modified().ok()?.elapsed().ok());
        if is_ours && age.is_some_and(|age| age > OLD) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// A rule a pack: it depends on the project file and its inputs.
fn depfile(project: &Project) -> Result<String, Failure> {
    let rule = |target: &Target| {
        let inputs: Vec<&Path> =
            [project.path.as_path()].into_iter().chain(target.inputs.iter().map(PathBuf::as_path)).collect();
        depfile::rule(&target.pack, &inputs)
    };
    project.targets.iter().map(rule).collect()
}

type States = [Result<Freshness, Failure>];

/// Says what is stale; a failure when something is.
fn check(project: &Project, states: &States, terminal: Terminal) -> Result<(), Failure> {
    let stale = list(project, states, terminal, |target, why| format!("{}: stale, {why}", target.name))?;
    if stale == 0 {
        terminal.say(&format!("{} up to date", states.len()));
        return Ok(());
    }
    let path = project.path.display();
    Err(Failure::new(Exit::Differs, format!("{path}: {stale} of {} packs are not up to date", states.len())))
}

/// Says what would be done.
fn dry_run(project: &Project, states: &States, terminal: Terminal) -> Result<(), Failure> {
    let stale = list(project, states, terminal, |target, why| {
        format!("{}: would write {}: {why}", target.name, target.pack.display())
    })?;
    terminal.say(&format!("{stale} to bake, {} up to date; dry run, nothing was written", states.len() - stale));
    Ok(())
}

/// Says `line` of every stale target and counts them. The first target that cannot be looked at is the failure.
fn list(
    project: &Project,
    states: &States,
    terminal: Terminal,
    line: impl Fn(&Target, &str) -> String,
) -> Result<usize, Failure> {
    let mut stale = 0;
    let mut failure = None;
    for (target, state) in project.targets.iter().zip(states) {
        match state {
            Ok(state) if state.is_fresh() => terminal.detail(&format!("{}: up to date", target.name)),
            Ok(state) => {
                stale += 1;
                terminal.say(&line(target, &state.reasons.join("; ")));
            }
            Err(why) => {
                terminal.of_part(&target.name).error(&why.message);
                failure.get_or_insert(Failure::new(why.exit, ""));
            }
        }
    }
    failure.map_or(Ok(stale), Err)
}
