//! `glint-bake generate`: pages and completions that are there, name what they should, and that shells can parse.

use crate::support::bake;
use glint_bake::commands::programs;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Runs a checker on a file, where it is installed.
fn parses(program: &str, args: &[&str], file: &Path) {
    match Command::new(program).args(args).arg(file).output() {
        Ok(output) => {
            let message =
                String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{program} {}: {message}", file.display());
        }
        Err(error) => eprintln!("skipped: {program} cannot be run: {error}"),
    }
}

#[test]
fn every_subcommand_has_a_manual_page() {
    let folder = tempfile::tempdir().unwrap();
    bake(folder.path(), &["generate", "man", "-o", "man"]).ok();
    let mut names = ["glint-info.1", "glint-bake.1", "glint-view.1"].map(String::from).to_vec();
    for program in programs() {
        names.extend(program.get_subcommands().map(|sub| format!("{}-{}.1", program.get_name(), sub.get_name())));
    }
    assert_eq!(fs::read_dir(folder.path().join("man")).unwrap().count(), names.len());
    for name in names {
        let path = folder.path().join("man").join(&name);
        let page = fs::read_to_string(&path).unwrap();
        assert!(page.contains(&format!(".TH {} 1 \"\" \"glint-bake ", &name[..name.len() - 2])), "{name}: {page}");
        for part in [".SH NAME", ".SH SYNOPSIS", "Examples:"] {
            assert!(page.contains(part), "{name} has no {part}");
        }
        parses("mandoc", &["-Tlint", "-Werror"], &path);
        parses("man", &["-l"], &path);
    }
    let export = fs::read_to_string(folder.path().join("man/glint-bake-export.1")).unwrap();
    assert!(export.contains("\\-\\-section") && export.contains("ktx2"), "{export}");
}

#[test]
fn completions_are_parsed_by_their_shells() {
    let folder = tempfile::tempdir().unwrap();
    for (shell, files, checker) in [
        ("bash", ["glint-bake.bash", "glint-info.bash", "glint-view.bash"], Some("bash")),
        ("zsh", ["_glint-bake", "_glint-info", "_glint-view"], Some("zsh")),
        ("fish", ["glint-bake.fish", "glint-info.fish", "glint-view.fish"], Some("fish")),
        ("powershell", ["_glint-bake.ps1", "_glint-info.ps1", "_glint-view.ps1"], None),
    ] {
        bake(folder.path(), &["generate", shell, "--output", "completions", "-q"]).ok();
        for (file, flag) in files.into_iter().zip(["area-light", "extract", "turntable"]) {
            let path = folder.path().join("completions").join(file);
            let script = fs::read_to_string(&path).unwrap();
            assert!(script.contains(flag), "{file} does not know {flag}");
            if let Some(checker) = checker {
                parses(checker, &["-n"], &path);
            }
        }
        let printed = bake(folder.path(), &["generate", shell]).ok().stdout;
        let written = files.map(|file| fs::read_to_string(folder.path().join("completions").join(file)).unwrap());
        assert_eq!(printed, written.concat());
    }
}

#[test]
fn tables_of_flags_are_a_page_or_parts_of_one() {
    let folder = tempfile::tempdir().unwrap();
    let printed = bake(folder.path(), &["generate", "markdown"]).ok().stdout;
    assert!(printed.contains("## glint-bake area-light\n") && printed.contains("| `--anisotropic` | "), "{printed}");
    bake(folder.path(), &["generate", "markdown", "-o", "docs"]).ok();
    let path = folder.path().join("docs/CLI.md");
    assert_eq!(fs::read_to_string(&path).unwrap(), printed);
    fs::write(&path, "By hand.\n<!-- flags of glint-info -->\nstale row\n<!-- end of flags -->\n").unwrap();
    bake(folder.path(), &["generate", "markdown", "-o", "docs"]).ok();
    let page = fs::read_to_string(&path).unwrap();
    assert!(
        page.starts_with("By hand.\n<!-- flags of glint-info -->\n| flag |") && !page.contains("stale row"),
        "{page}"
    );
    fs::write(&path, "<!-- flags of glint-inform --><!-- end of flags -->").unwrap();
    assert_eq!(bake(folder.path(), &["generate", "markdown", "-o", "docs"]).code, 4);
}

#[test]
fn what_cannot_be_generated_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), b"in the way").unwrap();
    assert_eq!(bake(folder.path(), &["generate", "tcsh"]).code, 2);
    assert_eq!(bake(folder.path(), &["generate", "man", "-o", "file"]).code, 3);
}
