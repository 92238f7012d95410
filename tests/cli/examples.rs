//! Every help has examples, and every example runs; every flag has a test.

use crate::projects::PROJECT;
use crate::support::{packs, root};
use assert_cmd::Command;
use glint_bake::commands::programs;
use std::fs;

/// Every command with the words that call it: both programs and all subcommands.
fn commands() -> Vec<(String, clap::Command)> {
    let mut all = Vec::new();
    for mut program in programs() {
        program.build();
        let subcommands = program.get_subcommands().filter(|sub| sub.get_name() != "help");
        all.extend(subcommands.map(|sub| (format!("{} {}", program.get_name(), sub.get_name()), sub.clone())));
        all.push((program.get_name().to_owned(), program));
    }
    all
}

/// The examples in a help: the indented lines under `Examples:`.
fn examples(command: &clap::Command) -> Vec<String> {
    let help = command.clone().render_long_help().to_string();
    let lines = help.lines().skip_while(|line| *line != "Examples:").skip(1);
    lines.take_while(|line| line.starts_with("  ")).map(|line| line.trim().to_owned()).collect()
}

/// A scene that is planned in a moment.
const SCENE: &str = r#"
[scene]
lights = ["point"]
error = 1

[materials.far]
input = "flakes.png"
roughness = 0.2
distance = [9, 9]
texels-per-metre = 900
"#;

/// Whether glint-view was built and has an adapter.
#[cfg(feature = "view")]
pub fn can_view() -> bool {
    crate::view::folder().is_some()
}

#[cfg(not(feature = "view"))]
pub fn can_view() -> bool {
    false
}

/// A folder in which everything that the examples name is laid out under those names.
pub fn inputs() -> tempfile::TempDir {
    let (inputs, _) = packs();
    for (from, to) in [("layered", "paint"), ("sky", "old"), ("sky", "new")] {
        let path = |name: &str| inputs.path().join(format!("{name}.glintpack"));
        fs::copy(path(from), path(to)).unwrap();
    }
    fs::write(inputs.path().join("glint.toml"), PROJECT).unwrap();
    fs::write(inputs.path().join("scene.toml"), SCENE).unwrap();
    let material = r#"[{"normalTexture": {"index": 0}}]"#;
    fs::write(inputs.path().join("model.glb"), crate::gltf_file::quad(material)).unwrap();
    inputs
}

#[test]
fn every_help_has_examples_and_every_example_runs() {
    let inputs = inputs();
    let mut seen = 0;
    for (name, command) in commands() {
        let examples = examples(&command);
        assert!(!examples.is_empty(), "{name} --help has no example");
        for example in examples {
            assert!(example.starts_with(&name) || name == "glint-bake", "{example} stands in the help of {name}");
            if name == "glint-view" && !can_view() {
                continue;
            }
            let words: Vec<&str> = example.split(' ').collect();
            let run = Command::cargo_bin(words[0]).unwrap().current_dir(inputs.path()).args(&words[1..]).output();
            let output = run.unwrap();
            assert!(output.status.success(), "{example}: {}", String::from_utf8_lossy(&output.stderr));
            seen += 1;
        }
    }
    assert!(seen >= 20, "only {seen} examples");
}

/// A flag has a test when a test file that runs its command names it, long or short. Flags of all commands count where
/// any test names them. That a test checks the right thing is for people to see; that there is none is found here.
#[test]
fn every_flag_has_a_test() {
    let files: Vec<String> = fs::read_dir(root().join("tests/cli"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "rs"))
        .map(|path| fs::read_to_string(path).unwrap())
        .collect();
    let mut untested = Vec::new();
    for (name, command) in commands() {
        let call = match name.split_once(' ') {
            Some((_, subcommand)) => format!("\"{subcommand}\""),
            None if name == "glint-info" => "info(".to_owned(),
            None if name == "glint-view" => "view(".to_owned(),
            None => String::new(),
        };
        for arg in command.get_arguments().filter(|arg| arg.get_id() != "help") {
            let mut spellings: Vec<String> = arg.get_long().map(|long| format!("\"--{long}\"")).into_iter().collect();
            spellings.extend(arg.get_short().map(|short| format!("\"-{short}\"")));
            let call = if arg.is_global_set() { "" } else { call.as_str() };
            let tested = files.iter().any(|file| file.contains(call) && spellings.iter().any(|s| file.contains(s)));
            if !spellings.is_empty() && !tested {
                untested.push(format!("{name} {}", spellings[0]));
            }
        }
    }
    assert!(untested.is_empty(), "flags that no test of their command names:\n{}", untested.join("\n"));
}
