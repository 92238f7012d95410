//! A project as a build file of ninja: an edge a pack, and one that writes the build file anew.
//!
//! The command of an edge is the bake itself with all its options. Ninja then sees by itself which options changed, and
//! a front end that runs commands on other machines needs nothing but the program and the inputs there. Edges name all
//! inputs, so they need no dependency files, whose syntax takes fewer names.

use super::model::Project;
use super::settled::inputs;
use crate::exit::Failure;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

/// The build file. `program` is how glint-bake is called; `manifest` is where the file will lie.
///
/// # Errors
/// Usage, for a path that ninja's syntax cannot express.
pub fn manifest(project: &Project, program: &str, manifest: &Path) -> Result<String, Failure> {
    let mut text = format!(
        "# Written by glint-bake ninja; edit {} instead.\n\
         ninja_required_version = 1.5\n\
         glint_bake = {}\n\n\
         rule bake\n  command = $glint_bake --quiet $method $arguments\n  description = bake $out\n  restat = 1\n\n\
         rule manifest\n  command = $glint_bake --quiet ninja $arguments\n  description = write $out\n  \
         generator = 1\n  restat = 1\n\n",
        comment(&project.path.to_string_lossy()),
        value(&shell(program))?,
    );
    // What is planned depends on what the maps hold.
    let planned = paths(inputs(project).iter().map(PathBuf::as_path))?;
    let option = |name: &str, value: &OsStr| {
        let mut text = OsString::from(name);
        text.push(value);
        text
    };
    let own = [
        project.path.as_os_str().to_owned(),
        option("--output=", manifest.as_os_str()),
        option("--program=", OsStr::new(program)),
    ];
    text += &format!(
        "build {}: manifest {}{planned}\n  arguments = {}\n\n",
        path(manifest)?,
        path(&project.path)?,
        command(&own)?
    );
    for target in &project.targets {
        let inputs = paths(target.inputs.iter().map(PathBuf::as_path))?;
        let beside = paths(target.report.iter().map(PathBuf::as_path))?;
        let beside = if beside.is_empty() { beside } else { format!(" |{beside}") };
        text += &format!(
            "build {}{beside}: bake{inputs}\n  method = {}\n  arguments = {}\n",
            path(&target.pack)?,
            value(target.method())?,
            command(&target.arguments())?,
        );
    }
    if !project.targets.is_empty() {
        let all = paths(project.targets.iter().map(|target| target.pack.as_path()))?;
        text += &format!("\nbuild all: phony{all}\ndefault all\n");
    }
    Ok(text)
}

/// Words for the shell, as the value of a variable.
fn command(words: &[OsString]) -> Result<String, Failure> {
    let mut text = Vec::new();
    for word in words {
        text.push(shell(word.to_str().ok_or_else(|| refusal(word, "bytes that are no UTF-8"))?));
    }
    value(&text.join(" "))
}

/// One word for the shell.
fn shell(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_=+./,:@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

/// Text as the value of a variable, which ends with its line.
fn value(text: &str) -> Result<String, Failure> {
    match text.chars().find(|c| "\n\r\0".contains(*c)) {
        Some(c) => Err(refusal(text.as_ref(), &format!("the character {c:?}"))),
        None => Ok(text.replace('$', "$$")),
    }
}

/// Paths of a build line, each after a space.
fn paths<'a>(all: impl Iterator<Item = &'a Path>) -> Result<String, Failure> {
    all.map(|one| path(one).map(|text| format!(" {text}"))).collect()
}

/// Text as a path of a build line. There is an escape for spaces, colons and dollars, and none for what else ends a path.
fn path(path: &Path) -> Result<String, Failure> {
    let text = path.to_str().ok_or_else(|| refusal(path.as_os_str(), "bytes that are no UTF-8"))?;
    match text.chars().find(|c| "|\n\r\0".contains(*c)) {
        Some(c) => Err(refusal(text.as_ref(), &format!("the character {c:?}"))),
        None => Ok(text.replace('$', "$$").replace(' ', "$ ").replace(':', "$:")),
    }
}

fn refusal(text: &OsStr, what: &str) -> Failure {
    Failure::usage(format!("{text:?} has {what}, which a build file of ninja cannot express; rename it"))
}

/// Text in a comment.
fn comment(text: &str) -> String {
    text.replace(['\n', '\r'], " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_survive_ninja_and_the_shell() {
        assert_eq!(command(&["a b".into(), "it's".into(), "$1".into()]).unwrap(), "'a b' 'it'\\''s' '$$1'");
        assert_eq!(path(Path::new("two words:$.png")).unwrap(), "two$ words$:$$.png");
    }

    #[test]
    fn what_ends_a_path_or_a_line_is_refused_by_name() {
        for (name, part) in [("pi|pe.png", "'|'"), ("two\nlines.png", "'\\n'"), ("a\rb", "'\\r'")] {
            let failure = path(Path::new(name)).unwrap_err();
            assert!(failure.message.contains(part) && failure.message.contains("rename it"), "{failure:?}");
        }
        assert!(value("a|b").is_ok() && value("a\nb").is_err());
    }
}
