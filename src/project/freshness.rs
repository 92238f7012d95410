//! Whether a pack is what its table, its inputs and this program would give, and if not, why.

use super::model::{Project, Target};
use super::record::{Record, file_name};
use super::stamp::Stamp;
use crate::exit::Failure;
use std::path::Path;

/// State of one target.
#[derive(Clone, Debug)]
pub struct Freshness {
    /// Why it has to be baked; empty when it is up to date.
    pub reasons: Vec<String>,
    /// The inputs as they were seen.
    pub inputs: Vec<Stamp>,
    /// The record to write so that the next look is quicker: the content is as recorded, the files' times are not.
    pub renewed: Option<Record>,
}

impl Freshness {
    /// Looks at a target's inputs and outputs.
    ///
    /// # Errors
    /// An input that cannot be read.
    pub fn of(project: &Project, target: &Target) -> Result<Freshness, Failure> {
        let old = Record::read(&project.records(), &target.name);
        let mut inputs = Vec::new();
        for (k, path) in target.inputs.iter().enumerate() {
            let known = old.as_ref().and_then(|old| old.inputs.get(k)).map(|(_, stamp)| stamp);
            inputs.push(Stamp::of(path, known).map_err(|e| Failure::io(path, "cannot be read", &e))?);
        }
        let missing = |path: &Path| !path.is_file();
        let Some(old) = old else {
            let reason = if missing(&target.pack) { "not built yet" } else { "no record of how it was built" };
            return Ok(Freshness { reasons: vec![reason.into()], inputs, renewed: None });
        };
        let mut outputs = Vec::new();
        let mut reasons = Vec::new();
        for (k, path) in target.outputs().iter().enumerate() {
            let known = old.outputs.get(k).map(|(_, stamp)| stamp);
            let name = file_name(path);
            match Stamp::of(path, known) {
                Err(_) => reasons.push(format!("{name} is missing")),
                Ok(now) if known.is_none_or(|known| known.xxh3_128 != now.xxh3_128) => {
                    reasons.push(format!("{name} is not what was built"));
                    outputs.push(now);
                }
                Ok(now) => outputs.push(now),
            }
        }
        let new = Record::new(target, inputs.clone(), outputs);
        reasons.extend(differences(&old, &new));
        let renewed = (reasons.is_empty() && new != old).then_some(new);
        Ok(Freshness { reasons, inputs, renewed })
    }

    /// Whether nothing has to be done.
    pub fn is_fresh(&self) -> bool {
        self.reasons.is_empty()
    }
}

/// What else has changed since.
fn differences(old: &Record, new: &Record) -> Vec<String> {
    let mut reasons = Vec::new();
    if old.tool != new.tool {
        reasons.push(format!("built by version {}", old.tool));
    }
    if old.format != new.format {
        reasons.push(format!("its format is {}", old.format));
    }
    if old.method != new.method {
        return vec![format!("method {} instead of {}", new.method, old.method)];
    }
    let found = |record: &Record, name: &str| {
        record.options.iter().find(|(other, _)| other == name).map_or("nothing".into(), |(_, values)| values.join(" "))
    };
    let mut names: Vec<&str> = old.options.iter().chain(&new.options).map(|(name, _)| name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    for name in names {
        let (before, now) = (found(old, name), found(new, name));
        if before != now {
            let text = |value: String| if value.is_empty() { "nothing".into() } else { value };
            reasons.push(format!("{name} is {} instead of {}", text(now), text(before)));
        }
    }
    for (name, stamp) in &new.inputs {
        if !old.inputs.iter().any(|(other, _)| other == name) {
            reasons.push(format!("{name} is a new input"));
        } else if !old.inputs.iter().any(|(other, before)| other == name && before.xxh3_128 == stamp.xxh3_128) {
            reasons.push(format!("{name} changed"));
        }
    }
    let content = |record: &Record| -> Vec<(String, String)> {
        record.inputs.iter().map(|(name, stamp)| (name.clone(), stamp.xxh3_128.clone())).collect()
    };
    if reasons.is_empty() && content(old) != content(new) {
        reasons.push("the inputs are others, or in another order".into());
    }
    reasons
}
