//! A table of options as the command line that it stands for, parsed by the very parser of that command.
//!
//! So each option is defined once, as a flag: the same name, values, defaults and errors. A key is a flag's long name;
//! `input` is what the command takes without a flag. Paths are relative to the project file.

use super::entry::Entry;
use super::model::{CommandLine, Project, Target, Work, output_flag};
use crate::cli::{RunFlags, typed};
use crate::methods::bake::Bake;
use crate::methods::{MethodCommand, find};
use crate::reading::is_standard;
use crate::textures;
use clap::builder::ValueParser;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches, Subcommand};
use std::any::TypeId;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::de::DeValue;

/// Key of what the command takes without a flag.
const INPUT: &str = "input";
/// Flags about a run that one material may still have for itself.
const OWN_RUN_FLAGS: [&str; 2] = ["max-memory", "report"];

/// An option and the table that says it.
pub struct ProjectOption<'a> {
    /// Key and value.
    pub entry: Entry<'a>,
    /// Name of the table.
    pub table: String,
}

/// What is wrong with a table.
pub struct OptionError {
    /// Key of the option, when it is one.
    pub key: Option<String>,
    /// Why.
    pub why: String,
}

/// The commands that bake, as a project sees them.
pub struct Methods {
    command: Command,
    /// Flags that say how to run, not what to make.
    run_flags: Vec<String>,
}

impl Default for Methods {
    fn default() -> Methods {
        Methods::new()
    }
}

impl Methods {
    /// All methods.
    pub fn new() -> Methods {
        let command = MethodCommand::augment_subcommands(Command::new("glint-bake")).disable_help_subcommand(true);
        let command = command.subcommand(textures::Args::augment_args(Command::new(textures::NAME)));
        let run_flags = RunFlags::augment_args(Command::new("run"));
        Methods {
            command: command.mut_subcommands(|method| method.disable_help_flag(true)),
            run_flags: run_flags.get_arguments().filter_map(|arg| arg.get_long().map(str::to_owned)).collect(),
        }
    }

    /// Their names.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.command.get_subcommands().map(Command::get_name)
    }

    /// A table of options as those of a command line.
    ///
    /// # Errors
    /// The first key whose value no flag can have.
    pub fn line(&self, method: &str, options: &[ProjectOption<'_>], folder: &Path) -> Result<CommandLine, OptionError> {
        let mut line = CommandLine::default();
        for option in options {
            let key = option.entry.key;
            let refuse = |why: String| OptionError { key: Some(key.to_owned()), why };
            for value in self.values(method, option.entry, folder).map_err(refuse)? {
                match (key, value) {
                    (INPUT, Value::Text(text)) => line.inputs.push(text),
                    (_, Value::Text(text)) => line.flags.push((key.to_owned(), flag(key, &text))),
                    (_, Value::Flag) => line.flags.push((key.to_owned(), typed(key, "").into())),
                }
            }
        }
        let is_file = line.value("gltf").is_some();
        if line.inputs.is_empty() && self.positional(method).is_some() && !is_file {
            return Err(OptionError {
                key: None,
                why: "expected the files to bake as input = \"FILE\", found no input".into(),
            });
        }
        Ok(line)
    }

    /// The pack, or the textures, that a table describes.
    ///
    /// # Errors
    /// The first option that is wrong, as the command itself would say it.
    pub fn target(
        &mut self,
        name: &str,
        method: &str,
        line: CommandLine,
        project: &Project,
    ) -> Result<Target, OptionError> {
        let (pack, destination) = destination(name, method, &line, project);
        let (matches, work) = self.parse(method, &line, &destination)?;
        let (_, flags) = matches.subcommand().unwrap_or((method, &matches));
        let mut inputs = self.inputs(method, flags);
        if let Work::Textures(args) = &work {
            args.check_in_project().map_err(|why| OptionError { key: None, why: why.message })?;
            inputs.extend(args.files_beside());
        }
        Ok(Target {
            name: name.to_owned(),
            options: self.options(method, flags),
            inputs,
            report: flags.try_get_one::<PathBuf>("report").ok().flatten().cloned(),
            pack,
            destination,
            planned: None,
            work,
            line,
        })
    }

    /// The bake that a command line stands for.
    ///
    /// # Errors
    /// The first option that is wrong, as the command itself would say it.
    pub fn bake(&mut self, method: &str, line: &CommandLine, pack: &Path) -> Result<Arc<dyn Bake>, OptionError> {
        match self.parse(method, line, &[output_flag(pack)])?.1 {
            Work::Pack { bake, .. } => Ok(bake),
            Work::Textures(_) => Err(OptionError { key: None, why: format!("{method} makes no pack") }),
        }
    }

    fn parse(
        &mut self,
        method: &str,
        line: &CommandLine,
        destination: &[OsString],
    ) -> Result<(ArgMatches, Work), OptionError> {
        let command = ["glint-bake", method].into_iter().map(OsString::from).chain(line.arguments(destination));
        let parsed = self.command.try_get_matches_from_mut(command);
        let fault = |error: &clap::Error| {
            let why = reason(error);
            let named = |key: &str| why.contains(&format!("--{key} ")) || why.contains(&format!("--{key}'"));
            OptionError { key: line.flags.iter().map(|(key, _)| key).find(|key| named(key)).cloned(), why }
        };
        let matches = parsed.map_err(|error| fault(&error))?;
        if let Some((textures::NAME, flags)) = matches.subcommand() {
            let args = textures::Args::from_arg_matches(flags).map_err(|error| fault(&error))?;
            return Ok((matches, Work::Textures(Arc::new(args))));
        }
        let MethodCommand(bake) = MethodCommand::from_arg_matches(&matches).map_err(|error| fault(&error))?;
        let Some(method) = find(method) else {
            return Err(OptionError { key: None, why: format!("there is no method {method}") });
        };
        Ok((matches, Work::Pack { bake, method }))
    }

    /// What a key adds to the command line.
    fn values(&self, method: &str, entry: Entry<'_>, folder: &Path) -> Result<Vec<Value>, String> {
        let key = entry.key;
        let arg = if key == INPUT { self.positional(method) } else { self.flag(method, key) };
        if key == INPUT && arg.is_none() {
            return Err(format!("{method} has no input; leave it out"));
        }
        if find(method).is_some_and(|method| method.picture_flags().contains(&key)) {
            return Err(format!(
                "a picture to look at is written by glint-bake {method}, not by a project; leave it out"
            ));
        }
        if key == "output" {
            return Err(
                "the pack is named after its table and lies in the project's output folder; leave it out".into()
            );
        }
        if method == textures::NAME && key == "name" {
            return Err("textures are named after their table; leave it out".into());
        }
        if self.run_flags.iter().any(|flag| flag == key) && !OWN_RUN_FLAGS.contains(&key) {
            return Err(format!("--{key} is given to glint-bake build, not to one material; leave it out"));
        }
        // The parser itself says that there is no such flag, and which one may be meant.
        let Some(arg) = arg else { return Ok(vec![Value::Flag]) };
        if matches!(arg.get_action(), ArgAction::SetTrue) {
            return match entry.value {
                DeValue::Boolean(true) => Ok(vec![Value::Flag]),
                DeValue::Boolean(false) => Ok(Vec::new()),
                _ => Err("expected true or false".into()),
            };
        }
        let mut texts = match entry.value {
            DeValue::Array(array) => array.iter().map(|value| text_of(value.get_ref())).collect::<Result<_, _>>()?,
            value => vec![text_of(value)?],
        };
        let repeats =
            matches!(arg.get_action(), ArgAction::Append) || arg.get_num_args().is_some_and(|n| n.max_values() > 1);
        if !repeats && key == INPUT && texts.len() != 1 {
            return Err(format!("{method} takes one file, found {}", texts.len()));
        }
        if !repeats {
            texts = vec![texts.join(",")];
        }
        if !is_path(arg) {
            return Ok(texts.into_iter().map(|text| Value::Text(text.into())).collect());
        }
        if texts.iter().any(|text| is_standard(Path::new(text))) {
            return Err("a project has no standard input or output, which - is; a file of this name is ./-".into());
        }
        Ok(texts.iter().map(|text| Value::Text(folder_join(folder, text))).collect())
    }

    /// Whether a key is one of a method's; `method` and `input` are everybody's.
    pub fn knows(&self, method: &str, key: &str) -> bool {
        key == INPUT || key == "method" || self.flag(method, key).is_some()
    }

    fn args(&self, method: &str) -> impl Iterator<Item = &Arg> {
        self.command.find_subcommand(method).into_iter().flat_map(Command::get_arguments)
    }

    fn positional(&self, method: &str) -> Option<&Arg> {
        self.args(method).find(|arg| arg.is_positional())
    }

    fn flag(&self, method: &str, key: &str) -> Option<&Arg> {
        self.args(method).find(|arg| arg.get_long() == Some(key))
    }

    /// Whether an argument says what to make, in words that are no path.
    fn is_option(&self, arg: &Arg) -> bool {
        let runs = arg.get_long().is_some_and(|long| self.run_flags.iter().any(|flag| flag == long));
        !runs && !is_path(arg)
    }

    fn options(&self, method: &str, matches: &ArgMatches) -> Vec<(String, Vec<String>)> {
        let mut options = Vec::new();
        for arg in self.args(method).filter(|arg| self.is_option(arg)) {
            let id = arg.get_id().as_str();
            let values = if matches!(arg.get_action(), ArgAction::SetTrue) {
                vec![matches.get_flag(id).to_string()]
            } else {
                let raw = matches.get_raw(id).into_iter().flatten();
                raw.map(|value| value.to_string_lossy().into_owned()).collect()
            };
            options.push((arg.get_long().unwrap_or(id).to_owned(), values));
        }
        options
    }

    /// Every file that is read: what is given without a flag, and flags that name files.
    fn inputs(&self, method: &str, matches: &ArgMatches) -> Vec<PathBuf> {
        let written = |arg: &&Arg| {
            let long = arg.get_long().unwrap_or_default();
            long == "output" || self.run_flags.iter().any(|flag| flag == long)
        };
        let files = self.args(method).filter(|arg| is_path(arg)).filter(|arg| !written(arg));
        let paths = files.flat_map(|arg| matches.get_raw(arg.get_id().as_str()).into_iter().flatten());
        paths.map(PathBuf::from).collect()
    }
}

/// A value on the command line.
enum Value {
    /// A flag that takes none.
    Flag,
    /// The text of one. A path may lie in a folder whose name is no UTF-8.
    Text(OsString),
}

/// A flag with its value as it is typed; an empty text is a value too.
fn flag(key: &str, value: &OsStr) -> OsString {
    let mut text = OsString::from(typed(key, ""));
    text.push("=");
    text.push(value);
    text
}

fn is_path(arg: &Arg) -> bool {
    let parser: &ValueParser = arg.get_value_parser();
    parser.type_id() == TypeId::of::<PathBuf>()
}

/// What is written last, and the arguments that say where results go.
fn destination(name: &str, method: &str, line: &CommandLine, project: &Project) -> (PathBuf, Vec<OsString>) {
    if method != textures::NAME {
        let pack = project.pack(name);
        let flag = output_flag(&pack);
        return (pack, vec![flag]);
    }
    match line.value("gltf") {
        Some(file) => {
            let extension = Path::new(&file).extension().and_then(OsStr::to_str).unwrap_or("glb").to_owned();
            let file = project.output.join(format!("{name}.{extension}"));
            let flag = output_flag(&file);
            (file, vec![flag])
        }
        None => {
            let list = project.output.join(format!("{name}.json"));
            (list, vec![output_flag(&project.output), typed("name", name).into()])
        }
    }
}

/// A path of the project file as the process sees it.
pub(super) fn folder_join(folder: &Path, text: &str) -> OsString {
    if folder == Path::new(".") { text.into() } else { folder.join(text).into_os_string() }
}

/// A value as it would be typed.
fn text_of(value: &DeValue<'_>) -> Result<String, String> {
    match value {
        DeValue::String(text) => Ok(text.to_string()),
        DeValue::Integer(number) if number.radix() == 10 => Ok(number.as_str().to_owned()),
        DeValue::Integer(number) => i128::from_str_radix(number.as_str(), number.radix())
            .map(|number| number.to_string())
            .map_err(|e| format!("expected a number: {e}")),
        DeValue::Float(number) => Ok(number.as_str().to_owned()),
        DeValue::Boolean(_) => Err("expected a value, found true or false".into()),
        DeValue::Datetime(_) | DeValue::Array(_) | DeValue::Table(_) => {
            Err(format!("expected text or a number, found a {}", value.type_str()))
        }
    }
}

/// What the parser says, in one line.
fn reason(error: &clap::Error) -> String {
    let text = error.to_string();
    let text = text.strip_prefix("error: ").unwrap_or(&text);
    let end = ["\n\nUsage", "\n\nFor more"].iter().filter_map(|mark| text.find(mark)).min().unwrap_or(text.len());
    text[..end].split_whitespace().collect::<Vec<_>>().join(" ")
}
