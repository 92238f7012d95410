//! The project file's tables. What they hold is left to `arguments`, so that options are defined once, as flags.
//!
//! ```toml
//! output = "packs"                # folder of the packs, "packs" when it is left out
//! [defaults.ndf-maps]             # options of every material of a method
//! [materials.NAME]                # method, input, and options of the method
//! [environments.NAME]             # the same, with method = "environment"
//! [scene]                         # what tables with a distance or an alpha are planned for
//! ```

use super::arguments::{Methods, OptionError, ProjectOption, folder_join};
use super::entry::{Entry, entries};
use super::model::{PlannedTable, Project, Target, Work};
use super::scene::{self, ENVIRONMENT_KEYS, SURFACE_KEYS};
use crate::exit::Failure;
use crate::methods::ALL;
use crate::methods::method::Method;
use crate::output::folder_of;
use crate::plan::{Alternative, Planned};
use crate::reading;
use crate::scene::{Subject, SubjectKind};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue};

/// Where packs go when the project does not say.
const OUTPUT: &str = "packs";
/// The group of tables that are environments.
const ENVIRONMENTS: &str = "environments";

/// What is wrong, as `file:line: table.key: why`, each once.
struct Problems<'a> {
    path: &'a Path,
    text: &'a str,
    found: Vec<String>,
    /// Those beyond [`MOST_PROBLEMS`].
    more: usize,
}

/// Problems that are said; nobody mends more at a time, and each costs a look through the file.
const MOST_PROBLEMS: usize = 100;

impl Problems<'_> {
    fn push(&mut self, at: usize, key: &str, why: &str) {
        if self.found.len() == MOST_PROBLEMS {
            self.more += 1;
            return;
        }
        let line = 1 + self.text[..at].matches('\n').count();
        let colon = if key.is_empty() { "" } else { ": " };
        let message = format!("{}:{line}: {key}{colon}{why}", self.path.display());
        if !self.found.contains(&message) {
            self.found.push(message);
        }
    }

    /// All of them, and how many more there are.
    fn into_lines(mut self) -> Vec<String> {
        if self.more > 0 {
            self.found.push(format!("{}: and {} more", self.path.display(), self.more));
        }
        self.found
    }

    /// What is wrong with an option of a table, or with the table `name` that begins at `at`.
    fn of_option(&mut self, wrong: &OptionError, options: &[ProjectOption<'_>], at: usize, name: &str) {
        match options.iter().find(|option| Some(option.entry.key) == wrong.key.as_deref()) {
            Some(option) => {
                self.push(option.entry.at, &format!("{}.{}", option.table, option.entry.key), &wrong.why);
            }
            None => self.push(at, name, &wrong.why),
        }
    }
}

/// Reads a project file.
///
/// # Errors
/// A file that cannot be read; usage, when it is not a project or an option is wrong. Every wrong option is named
/// with its line.
pub fn load(path: &Path) -> Result<Project, Failure> {
    let text = reading::text(path, "cannot be read")?;
    parse(path, &text).map_err(|errors| Failure::usage(errors.join("\n")))
}

/// The project that `text` is.
///
/// # Errors
/// Every problem with its line.
fn parse(path: &Path, text: &str) -> Result<Project, Vec<String>> {
    let mut problems = Problems { path, text, found: Vec::new(), more: 0 };
    let document = match DeTable::parse(text) {
        Ok(document) => document.into_inner(),
        Err(error) => {
            let at = error.span().map_or(0, |span| span.start.min(text.len()));
            problems.push(at, "", error.message());
            return Err(problems.into_lines());
        }
    };
    let folder = folder_of(path);
    let mut output = OUTPUT.to_owned();
    let (mut defaults, mut tables, mut scene) = (Vec::new(), Vec::new(), None);
    for entry in entries(&document) {
        match (entry.key, entry.value) {
            ("output", DeValue::String(value)) if !value.is_empty() => output = value.to_string(),
            ("output", _) => problems.push(entry.at, "output", "expected the name of a folder"),
            ("scene", DeValue::Table(table)) => match scene::scene(entry, &entries(table)) {
                Ok(found) => scene = Some(found),
                Err((wrong, why)) => problems.push(wrong.at, &dotted("scene", wrong.key), why),
            },
            ("defaults", DeValue::Table(table)) => defaults = entries(table),
            ("materials", DeValue::Table(table)) => tables.extend(entries(table).into_iter().map(|e| ("materials", e))),
            (ENVIRONMENTS, DeValue::Table(table)) => {
                tables.extend(entries(table).into_iter().map(|e| (ENVIRONMENTS, e)))
            }
            ("scene" | "defaults" | "materials" | ENVIRONMENTS, _) => {
                problems.push(entry.at, entry.key, "expected tables, as in [materials.NAME]");
            }
            (key, _) => problems.push(entry.at, key, "expected output, defaults, materials, environments or scene"),
        }
    }
    tables.sort_by_key(|(_, entry)| entry.at);
    let output = PathBuf::from(folder_join(folder, &output));
    let mut reader = Reader {
        problems,
        methods: Methods::new(),
        defaults,
        names: HashMap::new(),
        folder,
        project: Project { path: path.to_owned(), output, targets: Vec::new(), scene, planned: Vec::new() },
    };
    reader.check_defaults();
    for (group, entry) in tables {
        reader.table(group, entry);
    }
    if reader.problems.found.is_empty() { Ok(reader.project) } else { Err(reader.problems.into_lines()) }
}

/// Reads one table after another.
struct Reader<'a> {
    problems: Problems<'a>,
    methods: Methods,
    defaults: Vec<Entry<'a>>,
    /// Names that tables have, in lower case.
    names: HashMap<String, &'a str>,
    folder: &'a Path,
    project: Project,
}

impl<'a> Reader<'a> {
    fn known_methods(&self) -> String {
        self.methods.names().collect::<Vec<_>>().join(", ")
    }

    fn check_defaults(&mut self) {
        for entry in &self.defaults {
            let key = format!("defaults.{}", entry.key);
            if !self.methods.names().any(|name| name == entry.key) {
                self.problems.push(entry.at, &key, &format!("expected {}", self.known_methods()));
            } else if entry.value.as_table().is_none() {
                self.problems.push(entry.at, &key, "expected a table of options");
            }
        }
    }

    fn table(&mut self, group: &str, entry: Entry<'a>) {
        let name = format!("{group}.{}", entry.key);
        // Some file systems have no upper and lower case.
        let taken = self.names.insert(entry.key.to_lowercase(), entry.key);
        if let Some(why) = bad_name(entry.key, taken) {
            return self.problems.push(entry.at, &name, &why);
        }
        let DeValue::Table(table) = entry.value else {
            return self.problems.push(entry.at, &name, "expected a table of options");
        };
        let own = entries(table);
        let subject = match (group, self.project.scene.is_some()) {
            (_, false) => Ok(None),
            (ENVIRONMENTS, true) => scene::environment_view(entry, &own).map(|view| view.map(Subject::Environment)),
            (_, true) => scene::surface_view(entry, &own).map(|view| view.map(Subject::Surface)),
        };
        let subject = match subject {
            Ok(subject) => subject,
            Err((wrong, why)) if wrong.at == entry.at => return self.problems.push(entry.at, &name, why),
            Err((wrong, why)) => return self.problems.push(wrong.at, &dotted(&name, wrong.key), why),
        };
        let said = own.iter().find(|own| own.key == "method");
        let method = match said.map(|said| said.value) {
            None if group == ENVIRONMENTS => methods_for(SubjectKind::Environment).next(),
            None if subject.is_some() => None,
            Some(DeValue::String(value)) if self.methods.names().any(|name| name == value) => Some(value.as_ref()),
            _ => {
                let at = said.map_or(entry.at, |said| said.at);
                return self.problems.push(at, &dotted(&name, "method"), &format!("expected {}", self.known_methods()));
            }
        };
        match subject {
            None => {
                if let Some(method) = method {
                    let target = self.target(entry, &name, method, &own, &[]);
                    self.project.targets.extend(target);
                }
            }
            Some(subject) => self.planned(entry, &name, method, subject, &own),
        }
    }

    /// A table that is planned for the scene: every bake that may come of it.
    fn planned(&mut self, entry: Entry<'a>, table: &str, method: Option<&str>, subject: Subject, own: &[Entry<'a>]) {
        let keys: &[&str] = match subject {
            Subject::Surface(_) => &SURFACE_KEYS,
            Subject::Environment(_) => &ENVIRONMENT_KEYS,
        };
        let is_meant = |name: &&str| method.is_none_or(|method| method == *name);
        let methods: Vec<&str> = methods_for(subject.kind()).filter(is_meant).collect();
        if methods.is_empty() {
            let why = "nothing to plan for this method; leave out what says how it is seen";
            return self.problems.push(entry.at, table, why);
        }
        let mut bases = Vec::new();
        for method in &methods {
            // Of several methods, each takes the options that it knows; what none knows is a mistake of the first.
            let knows = |own: &&Entry<'a>| self.methods.knows(method, own.key);
            let foreign = |own: &&Entry<'a>| methods.iter().any(|other| self.methods.knows(other, own.key));
            let own: Vec<Entry<'a>> = own.iter().filter(|own| knows(own) || !foreign(own)).copied().collect();
            let Some(base) = self.target(entry, table, method, &own, keys) else { return };
            bases.push(base);
        }
        // Scenes plan methods that make packs.
        let alternative = |base: &Target| match &base.work {
            Work::Pack { bake, method } => {
                Some(Alternative { method: *method, bake: bake.clone(), fixed: base.line.keys() })
            }
            Work::Textures(_) => None,
        };
        let alternatives = bases.iter().filter_map(alternative).collect();
        let planned = Planned { name: entry.key.to_owned(), subject, alternatives };
        self.project.planned.push(PlannedTable { planned, bases });
    }

    /// A table, without `skipped` keys, as a bake of one method.
    fn target(
        &mut self,
        entry: Entry<'a>,
        table: &str,
        method: &str,
        own: &[Entry<'a>],
        skipped: &[&str],
    ) -> Option<Target> {
        let mut options: Vec<ProjectOption<'_>> = Vec::new();
        for default in self.defaults.iter().filter(|default| default.key == method) {
            let Some(table) = default.value.as_table() else { continue };
            let others = entries(table).into_iter().filter(|other| own.iter().all(|own| own.key != other.key));
            options.extend(others.map(|entry| ProjectOption { entry, table: format!("defaults.{method}") }));
        }
        let own = own.iter().filter(|own| own.key != "method" && !skipped.contains(&own.key));
        options.extend(own.map(|entry| ProjectOption { entry: *entry, table: table.to_owned() }));
        let name = entry.key;
        let line = self.methods.line(method, &options, self.folder);
        match line.and_then(|line| self.methods.target(name, method, line, &self.project)) {
            Ok(target) => Some(target),
            Err(wrong) => {
                self.problems.of_option(&wrong, &options, entry.at, table);
                None
            }
        }
    }
}

/// Names of the methods that scenes plan for what is seen.
fn methods_for(subject: SubjectKind) -> impl Iterator<Item = &'static str> {
    let plans = move |method: &&&dyn Method| method.planning().is_some_and(|planning| planning.subject == subject);
    ALL.iter().filter(plans).map(|method| method.name())
}

fn dotted(table: &str, key: &str) -> String {
    if table == key { key.to_owned() } else { format!("{table}.{key}") }
}

/// Why a name cannot be that of a file beside the others.
fn bad_name(name: &str, taken: Option<&str>) -> Option<String> {
    const FORBIDDEN: &[char] = &['/', '\\', ':', '*', '?', '"', '<', '>', '|'];
    if name.is_empty() || name.starts_with('.') || name.chars().any(|c| c.is_control() || FORBIDDEN.contains(&c)) {
        return Some(
            "a pack is named after it; expected a name without folders or characters that files cannot have".into(),
        );
    }
    taken.map(|other| format!("a pack is named after it, and {other:?} is there already; give each a name of its own"))
}
