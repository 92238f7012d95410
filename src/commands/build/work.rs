//! Bakes what is stale, a few packs at a time. Each pack's bake is parallel in itself, on the threads that all share.

use crate::cli::Terminal;
use crate::commands::bake;
use crate::exit::{Exit, Failure};
use crate::progress;
use crate::project::freshness::Freshness;
use crate::project::record::Record;
use crate::project::stamp::{Stamp, Stat};
use crate::project::{Project, Target, Work};
use crate::quantities::kib;
use crate::textures;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What became of a target.
pub enum Outcome {
    /// It was up to date.
    Fresh,
    /// It was baked.
    Baked {
        /// Whether that gave other bytes than were there.
        changed: bool,
    },
    /// It could not be built.
    Failed(Failure),
}

/// Builds every stale target; one that fails does not stop the others. Outcomes are in the order of the targets.
pub fn all(
    project: &Project,
    states: Vec<Result<Freshness, Failure>>,
    in_flight: usize,
    terminal: Terminal,
) -> Vec<Outcome> {
    let stale = states.iter().filter(|state| !state.as_ref().is_ok_and(Freshness::is_fresh)).count();
    let bar = progress::overall(terminal, "packs", stale as u64);
    let next = AtomicUsize::new(0);
    let outcomes: Vec<Mutex<Option<Outcome>>> = states.iter().map(|_| Mutex::new(None)).collect();
    let worker = || {
        loop {
            let k = next.fetch_add(1, Ordering::Relaxed);
            let (Some(target), Some(state)) = (project.targets.get(k), states.get(k)) else { return };
            let outcome = one(project, target, state, terminal);
            if !matches!(outcome, Outcome::Fresh) {
                bar.inc(1);
            }
            *outcomes[k].lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = Some(outcome);
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..in_flight.min(stale).max(1) {
            scope.spawn(worker);
        }
    });
    bar.finish_and_clear();
    let taken = |outcome: Mutex<Option<Outcome>>| {
        outcome.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner()).unwrap_or(Outcome::Fresh)
    };
    outcomes.into_iter().map(taken).collect()
}

fn one(project: &Project, target: &Target, state: &Result<Freshness, Failure>, terminal: Terminal) -> Outcome {
    let part = terminal.of_part(&target.name);
    let result = match state {
        Err(failure) => Err(failure.clone()),
        Ok(state) if state.is_fresh() => {
            // The look at the next build is quicker then; without it nothing is lost.
            if let Some(record) = &state.renewed {
                let _ = record.write(&project.records(), &target.name);
            }
            return Outcome::Fresh;
        }
        Ok(state) => baked(project, target, state, part),
    };
    match result {
        Ok((changed, bytes)) => {
            let why = state.as_ref().map_or(String::new(), |state| state.reasons.join("; "));
            let outcome = if changed { "written" } else { "unchanged" };
            terminal.say(&format!("{}: {outcome}, {}: {why}", target.pack.display(), kib(bytes)));
            Outcome::Baked { changed }
        }
        Err(failure) => {
            part.error(&failure.message);
            Outcome::Failed(failure)
        }
    }
}

/// Whether the pack has other bytes than before, and how many.
fn baked(project: &Project, target: &Target, state: &Freshness, part: Terminal) -> Result<(bool, u64), Failure> {
    let before = Stat::of(&target.pack).ok();
    match &target.work {
        Work::Pack { bake, .. } => bake::run(bake.as_ref(), part)?,
        Work::Textures(args) => textures::run(args, part)?,
    }
    let unreadable = |path: &Path| {
        let path = path.to_owned();
        move |e: std::io::Error| Failure::io(&path, "cannot be read", &e)
    };
    let after = Stat::of(&target.pack).map_err(unreadable(&target.pack))?;
    let mut rested = true;
    let mut inputs = Vec::new();
    for (path, seen) in target.inputs.iter().zip(&state.inputs) {
        let now = Stamp::of(path, Some(seen)).map_err(unreadable(path))?;
        rested &= now.xxh3_128 == seen.xxh3_128;
        inputs.push(now);
    }
    if rested {
        let stamp = |path: &Path| Stamp::of(path, None).map_err(unreadable(path));
        let outputs = target.outputs().iter().map(|path| stamp(path)).collect::<Result<_, _>>()?;
        Record::new(target, inputs, outputs).write(&project.records(), &target.name)?;
    } else {
        part.warn("an input changed while it was baked; the next build bakes it again");
    }
    let bytes = target.outputs().iter().filter_map(|path| Stat::of(path).ok()).map(|stat| stat.bytes()).sum();
    Ok((before != Some(after), bytes))
}

/// Says what was done; a failure when targets failed, with the code of the first one and a list of all with theirs.
pub fn summary(project: &Project, outcomes: &[Outcome], terminal: Terminal) -> Result<(), Failure> {
    let count = |is: &dyn Fn(&Outcome) -> bool| outcomes.iter().filter(|outcome| is(outcome)).count();
    let written = count(&|outcome| matches!(outcome, Outcome::Baked { changed: true }));
    let unchanged = count(&|outcome| matches!(outcome, Outcome::Baked { changed: false }));
    let fresh = count(&|outcome| matches!(outcome, Outcome::Fresh));
    let failed = outcomes.len() - written - unchanged - fresh;
    let mut parts = vec![format!("{written} written")];
    for (count, what) in [(unchanged, "baked and unchanged"), (fresh, "up to date"), (failed, "failed")] {
        if count > 0 {
            parts.push(format!("{count} {what}"));
        }
    }
    terminal.say(&parts.join(", "));
    let mut exits = project.targets.iter().zip(outcomes).filter_map(|(target, outcome)| match outcome {
        Outcome::Failed(failure) => Some((target.name.as_str(), failure.exit)),
        _ => None,
    });
    let Some((name, first)) = exits.next() else { return Ok(()) };
    let coded = |(name, exit): (&str, Exit)| format!("{name} (code {})", exit as u8);
    let list: Vec<String> = [(name, first)].into_iter().chain(exits).map(coded).collect();
    let message = format!("{failed} of {} packs could not be built: {}", outcomes.len(), list.join(", "));
    Err(Failure::new(first, message))
}
