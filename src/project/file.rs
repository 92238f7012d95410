//! The project file's tables. What they hold is left to [`super::arguments`], so that options are defined once, as flags.
//!
//! ```toml
//! output = "packs"                # folder of the packs, "packs" when it is left out
//! [defaults.ndf-maps]             # options of every material of a method
//! [materials.NAME]                # method, input, and options of the method
//! [environments.NAME]             # the same, with method = "environment"
//! ```

use super::arguments::{Given, Methods, folder_join};
use super::{Project, Target};
use crate::output::folder_of;
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Where packs go when the project does not say.
const OUTPUT: &str = "packs";
/// Method of what stands under `environments`.
const ENVIRONMENT: &str = "environment";

/// A key with its value and its place in the file.
#[derive(Clone, Copy)]
pub struct Entry<'a> {
    /// The key.
    pub key: &'a str,
    /// The value.
    pub value: &'a DeValue<'a>,
    /// Byte at which the key begins.
    pub at: usize,
}

/// What is wrong, as `file:line: table.key: why`, each once.
struct Problems<'a> {
    path: &'a Path,
    text: &'a str,
    found: Vec<String>,
}

impl Problems<'_> {
    fn push(&mut self, at: usize, key: &str, why: &str) {
        let line = 1 + self.text[..at].matches('\n').count();
        let colon = if key.is_empty() { "" } else { ": " };
        let message = format!("{}:{line}: {key}{colon}{why}", self.path.display());
        if !self.found.contains(&message) {
            self.found.push(message);
        }
    }
}

/// The project that `text` is.
///
/// # Errors
/// Every problem with its line.
pub fn parse(path: &Path, text: &str) -> Result<Project, Vec<String>> {
    let mut problems = Problems { path, text, found: Vec::new() };
    let document = match DeTable::parse(text) {
        Ok(document) => document.into_inner(),
        Err(error) => {
            let at = error.span().map_or(0, |span| span.start.min(text.len()));
            problems.push(at, "", error.message());
            return Err(problems.found);
        }
    };
    let folder = folder_of(path);
    let mut output = OUTPUT.to_owned();
    let mut groups: [Vec<Entry<'_>>; 3] = Default::default();
    for entry in entries(&document) {
        match (entry.key, entry.value) {
            ("output", DeValue::String(value)) if !value.is_empty() => output = value.to_string(),
            ("output", _) => problems.push(entry.at, "output", "expected the name of a folder"),
            ("defaults", DeValue::Table(table)) => groups[0] = entries(table),
            ("materials", DeValue::Table(table)) => groups[1] = entries(table),
            ("environments", DeValue::Table(table)) => groups[2] = entries(table),
            ("defaults" | "materials" | "environments", _) => {
                problems.push(entry.at, entry.key, "expected tables, as in [materials.NAME]");
            }
            (key, _) => problems.push(entry.at, key, "expected output, defaults, materials or environments"),
        }
    }
    let output = PathBuf::from(folder_join(folder, &output));
    let mut methods = Methods::new();
    let [defaults, materials, environments] = groups;
    for entry in &defaults {
        if !methods.names().any(|name| name == entry.key) {
            let known: Vec<&str> = methods.names().collect();
            problems.push(entry.at, &format!("defaults.{}", entry.key), &format!("expected {}", known.join(", ")));
        } else if entry.value.as_table().is_none() {
            problems.push(entry.at, &format!("defaults.{}", entry.key), "expected a table of options");
        }
    }
    let mut all: Vec<(&str, Entry<'_>)> = Vec::new();
    all.extend(materials.into_iter().map(|entry| ("materials", entry)));
    all.extend(environments.into_iter().map(|entry| ("environments", entry)));
    all.sort_by_key(|(_, entry)| entry.at);

    let mut targets: Vec<Target> = Vec::new();
    for (group, entry) in all {
        let table_name = format!("{group}.{}", entry.key);
        let taken = targets.iter().find(|target| target.name.to_lowercase() == entry.key.to_lowercase());
        if let Some(why) = bad_name(entry.key, taken) {
            problems.push(entry.at, &table_name, &why);
            continue;
        }
        let DeValue::Table(table) = entry.value else {
            problems.push(entry.at, &table_name, "expected a table of options");
            continue;
        };
        let own = entries(table);
        let method = match own.iter().find(|own| own.key == "method").map(|own| (own, own.value)) {
            None if group == "environments" => ENVIRONMENT,
            Some((_, DeValue::String(value))) if methods.names().any(|name| name == value) => value.as_ref(),
            found => {
                let known: Vec<&str> = methods.names().collect();
                let at = found.map_or(entry.at, |(own, _)| own.at);
                problems.push(at, &format!("{table_name}.method"), &format!("expected {}", known.join(", ")));
                continue;
            }
        };
        let mut given: Vec<Given<'_>> = Vec::new();
        for default in defaults.iter().filter(|default| default.key == method) {
            let Some(table) = default.value.as_table() else { continue };
            let others = entries(table).into_iter().filter(|other| own.iter().all(|own| own.key != other.key));
            given.extend(others.map(|entry| Given { entry, table: format!("defaults.{method}") }));
        }
        let own = own.into_iter().filter(|own| own.key != "method");
        given.extend(own.map(|entry| Given { entry, table: table_name.clone() }));
        let pack = output.join(format!("{}.glintpack", entry.key));
        match methods.target(entry.key, method, &given, folder, pack) {
            Ok(target) => targets.push(target),
            Err(wrong) => match wrong.at {
                Some(given) => {
                    problems.push(given.entry.at, &format!("{}.{}", given.table, given.entry.key), &wrong.why);
                }
                None => problems.push(entry.at, &table_name, &wrong.why),
            },
        }
    }
    if !problems.found.is_empty() {
        return Err(problems.found);
    }
    Ok(Project { path: path.to_owned(), output, targets })
}

/// Keys of a table in the order of the file.
fn entries<'a>(table: &'a DeTable<'a>) -> Vec<Entry<'a>> {
    let entry = |(key, value): (&'a Spanned<_>, &'a Spanned<DeValue<'a>>)| {
        let name: &'a std::borrow::Cow<'a, str> = key.get_ref();
        Entry { key: name.as_ref(), value: value.get_ref(), at: key.span().start }
    };
    let mut all: Vec<Entry<'a>> = table.iter().map(entry).collect();
    all.sort_by_key(|entry| entry.at);
    all
}

/// Why a name cannot be that of a file beside the others.
fn bad_name(name: &str, taken: Option<&Target>) -> Option<String> {
    const FORBIDDEN: &[char] = &['/', '\\', ':', '*', '?', '"', '<', '>', '|'];
    if name.is_empty() || name.starts_with('.') || name.chars().any(|c| c.is_control() || FORBIDDEN.contains(&c)) {
        return Some(
            "a pack is named after it; expected a name without folders or characters that files cannot have".into(),
        );
    }
    taken.map(|other| {
        format!("a pack is named after it, and {:?} is there already; give each a name of its own", other.name)
    })
}
