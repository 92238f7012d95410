//! Drafts of all that a scene shows: which methods its lights want, and what each method makes of a material.

use super::choose::{PackDrafts, Plan};
use crate::cli::Terminal;
use crate::exit::{Exit, Failure};
use crate::methods::bake::{Bake, Candidate};
use crate::methods::method::Method;
use crate::methods::planning::{Planning, Request};
use crate::scene::{Scene, Subject};
use std::path::PathBuf;
use std::sync::Arc;

/// What is seen, so that its options can be planned.
#[derive(Clone, Debug)]
pub struct Planned {
    /// Name of its table.
    pub name: String,
    /// How it is seen.
    pub subject: Subject,
    /// Bakes that may come of it: one a method.
    pub alternatives: Vec<Alternative>,
}

/// A bake whose options are not all chosen.
#[derive(Clone, Debug)]
pub struct Alternative {
    /// Method.
    pub method: &'static dyn Method,
    /// The bake with the project's options and defaults for all others.
    pub bake: Arc<dyn Bake>,
    /// Names of the flags that the project fixes.
    pub fixed: Vec<String>,
}

/// The plan of a scene. `place` says where the pack of a name will lie.
///
/// # Errors
/// What stops a draft.
pub fn plan(
    scene: &Scene,
    planned: &[Planned],
    place: &dyn Fn(&str) -> PathBuf,
    terminal: Terminal,
) -> Result<Plan, Failure> {
    let mut planner = Planner { scene, place, packs: Vec::new(), dropped: Vec::new() };
    for (table, planned) in planned.iter().enumerate() {
        terminal.detail(&format!("{}: drafts", planned.name));
        planner.add(table, planned)?;
    }
    Ok(Plan::new(planner.packs, planner.dropped, scene.bytes))
}

struct Planner<'a> {
    scene: &'a Scene,
    place: &'a dyn Fn(&str) -> PathBuf,
    packs: Vec<PackDrafts>,
    dropped: Vec<String>,
}

impl Planner<'_> {
    /// Of several methods, the scene's lights choose. One that the project names is planned whatever the lights are.
    fn add(&mut self, table: usize, planned: &Planned) -> Result<(), Failure> {
        let lights = self.scene.lights;
        if matches!(planned.subject, Subject::Environment(_)) && !lights.environment {
            self.dropped.push(format!("{}: the scene has no environment light", planned.name));
            return Ok(());
        }
        let name = &planned.name;
        let is_named = planned.alternatives.len() == 1;
        let mut is_made = false;
        let mut beyond = Vec::new();
        for (number, alternative) in planned.alternatives.iter().enumerate() {
            let Some(planning) = alternative.method.planning() else { continue };
            let Planning { product, light, .. } = planning;
            if !is_named && !(planning.is_lit)(lights) {
                self.dropped.push(format!("{product} of {name}: the scene has no {light}"));
                continue;
            }
            let pack = if is_made { format!("{name}-{}", alternative.method.name()) } else { name.clone() };
            match self.drafts(pack, (table, number), planned, planning) {
                Ok(()) => is_made = true,
                Err(failure) if failure.exit == Exit::LimitExceeded => beyond.push((product, failure)),
                Err(failure) => return Err(failure),
            }
        }
        if !is_made && let Some((_, failure)) = beyond.pop() {
            return Err(failure);
        }
        let line = |(product, failure): (&str, Failure)| format!("{product} of {name}: {}", failure.message);
        self.dropped.extend(beyond.into_iter().map(line));
        Ok(())
    }

    /// Drafts of one pack.
    fn drafts(
        &mut self,
        name: String,
        from: (usize, usize),
        planned: &Planned,
        planning: Planning,
    ) -> Result<(), Failure> {
        let alternative = &planned.alternatives[from.1];
        let budget = planned.subject.error().unwrap_or(self.scene.error);
        let output = (self.place)(&name);
        let found = alternative.bake.candidates(&Request {
            scene: self.scene,
            subject: &planned.subject,
            budget,
            output: &output,
            fixed: &alternative.fixed,
        })?;
        self.packs.push(PackDrafts {
            name,
            method: alternative.method.name(),
            from,
            budget,
            measure: planning.measure,
            view: found.view,
            dropped: found.dropped,
            drafts: front(found.drafts),
        });
        Ok(())
    }
}

/// Drafts that no other beats, the smallest first.
fn front(mut drafts: Vec<Candidate>) -> Vec<Candidate> {
    drafts.sort_by(|a, b| a.bytes.cmp(&b.bytes).then(a.error.total_cmp(&b.error)));
    let mut best = f64::INFINITY;
    drafts.retain(|draft| {
        let better = draft.error < best;
        best = best.min(draft.error);
        better
    });
    drafts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::choose::tests::candidate;

    #[test]
    fn beaten_drafts_are_left_out() {
        let all = [(9, 0.1), (5, 0.3), (7, 0.3), (8, 0.2), (9, 0.05)];
        let kept = front(all.into_iter().map(candidate).collect());
        let kept: Vec<(u64, f64)> = kept.iter().map(|draft| (draft.bytes, draft.error)).collect();
        assert_eq!(kept, [(5, 0.3), (8, 0.2), (9, 0.05)]);
    }
}
