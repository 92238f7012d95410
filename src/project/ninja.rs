//! A project as a build file of ninja: an edge a pack, and one that writes the build file anew.
//!
//! The command of an edge is the bake itself with all its options. Ninja then sees by itself which options changed, and
//! a front end that runs commands on other machines needs nothing but the program and the inputs there.

use super::model::Project;
use super::settled::inputs;
use std::path::Path;

/// The build file. `program` is how glint-bake is called; `manifest` is where the file will lie.
pub fn manifest(project: &Project, program: &str, manifest: &Path) -> String {
    let mut text = format!(
        "# Written by glint-bake ninja; edit {} instead.\n\
         ninja_required_version = 1.5\n\
         glint_bake = {}\n\n\
         rule bake\n  command = $glint_bake --quiet $method --depfile=$out.d $arguments\n  description = bake $out\n  \
         depfile = $out.d\n  deps = gcc\n  restat = 1\n\n\
         rule manifest\n  command = $glint_bake --quiet ninja $arguments\n  description = write $out\n  \
         generator = 1\n  restat = 1\n\n",
        comment(&path_text(&project.path)),
        value(&shell(program)),
    );
    // What is planned depends on what the maps hold.
    let planned: String = inputs(project).iter().map(|input| format!(" {}", path(input))).collect();
    let own = [path_text(&project.path), format!("--output={}", path_text(manifest)), format!("--program={program}")];
    text += &format!(
        "build {}: manifest {}{planned}\n  arguments = {}\n\n",
        path(manifest),
        path(&project.path),
        value(&command(&own))
    );
    for target in &project.targets {
        let inputs: String = target.inputs.iter().map(|input| format!(" {}", path(input))).collect();
        let beside: String = target.report.iter().map(|report| format!(" {}", path(report))).collect();
        let beside = if beside.is_empty() { beside } else { format!(" |{beside}") };
        text += &format!(
            "build {}{beside}: bake{inputs}\n  method = {}\n  arguments = {}\n",
            path(&target.pack),
            value(target.method.name()),
            value(&command(&target.arguments())),
        );
    }
    if !project.targets.is_empty() {
        let all: String = project.targets.iter().map(|target| format!(" {}", path(&target.pack))).collect();
        text += &format!("\nbuild all: phony{all}\ndefault all\n");
    }
    text
}

fn path_text(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

/// Words for the shell.
fn command(words: &[String]) -> String {
    words.iter().map(|word| shell(word)).collect::<Vec<_>>().join(" ")
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

/// Text as the value of a variable.
fn value(text: &str) -> String {
    text.replace('$', "$$")
}

/// Text as a path of a build line.
fn path(path: &Path) -> String {
    path_text(path).replace('$', "$$").replace(' ', "$ ").replace(':', "$:")
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
        assert_eq!(value(&command(&["a b".into(), "it's".into(), "$1".into()])), "'a b' 'it'\\''s' '$$1'");
        assert_eq!(path(Path::new("two words:$.png")), "two$ words$:$$.png");
    }
}
