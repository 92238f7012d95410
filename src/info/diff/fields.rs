//! Fields of parameters and provenance that differ, by their names.

use crate::info::parameters::ParametersInfo;
use crate::info::report::Report;
use glint_formats::FourCc;
use glint_formats::provenance::{PROVENANCE, Provenance};
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

/// A field that is not the same in both packs.
#[derive(Debug, Serialize)]
pub struct FieldChange {
    /// Kind of the section.
    pub kind: FourCc,
    /// Its name.
    pub name: String,
    /// The field, as in `measured.mean` or `levels[2].tiles_x`.
    pub field: String,
    /// In the first pack; null where there is none.
    pub a: Value,
    /// In the second pack.
    pub b: Value,
}

/// Every field that differs in the parameter sections that both packs have, and in their provenance.
pub fn compare(a: &Report, b: &Report) -> Vec<FieldChange> {
    let mut changes = Vec::new();
    for (name, of_a) in named_provenance(a) {
        if let Some((_, of_b)) = named_provenance(b).find(|(other, _)| *other == name) {
            walk(PROVENANCE, name, "", &provenance(of_a), &provenance(of_b), &mut changes);
        }
    }
    for of_a in &a.parameters {
        let same = |of: &&ParametersInfo| of.kind == of_a.kind && of.name == of_a.name;
        if let Some(of_b) = b.parameters.iter().find(same) {
            walk(of_a.kind, &of_a.name, "", &tree(&of_a.value), &tree(&of_b.value), &mut changes);
        }
    }
    changes
}

/// Each provenance with its section's name.
fn named_provenance(report: &Report) -> impl Iterator<Item = (&str, &Provenance)> {
    let entries = report.sections.iter().filter(|entry| entry.kind == PROVENANCE);
    entries.map(|entry| entry.name.as_str()).zip(&report.provenance)
}

/// A value as JSON by way of its text, which writes a single float as it was given: 0.02, not 0.0199999996.
fn tree(value: &impl Serialize) -> Value {
    let text = serde_json::to_string(value).expect("parameters have string keys only");
    serde_json::from_str(&text).expect("JSON reads back")
}

/// Provenance with options and inputs under their names, so that one more of them does not shift the rest.
fn provenance(of: &Provenance) -> Value {
    let mut value = tree(of);
    let options = of.options.iter().map(|(name, value)| (name.clone(), json!(value)));
    let inputs = of.inputs.iter().map(|of| (of.name.clone(), json!({ "xxh3_128": of.xxh3_128, "bytes": of.bytes })));
    value["options"] = Value::Object(options.collect::<Map<_, _>>());
    value["inputs"] = Value::Object(inputs.collect::<Map<_, _>>());
    value
}

fn walk(kind: FourCc, name: &str, path: &str, a: &Value, b: &Value, changes: &mut Vec<FieldChange>) {
    match (a, b) {
        (Value::Object(of_a), Value::Object(of_b)) => {
            let keys: BTreeSet<&String> = of_a.keys().chain(of_b.keys()).collect();
            for key in keys {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                let at = |of: &Map<String, Value>| of.get(key).cloned().unwrap_or(Value::Null);
                walk(kind, name, &path, &at(of_a), &at(of_b), changes);
            }
        }
        (Value::Array(of_a), Value::Array(of_b)) if of_a.len() == of_b.len() => {
            for (index, (a, b)) in of_a.iter().zip(of_b).enumerate() {
                walk(kind, name, &format!("{path}[{index}]"), a, b, changes);
            }
        }
        _ if a == b => {}
        _ => changes.push(FieldChange {
            kind,
            name: name.to_owned(),
            field: path.to_owned(),
            a: a.clone(),
            b: b.clone(),
        }),
    }
}
