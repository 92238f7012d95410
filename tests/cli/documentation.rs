//! The command line and docs/CLI.md say the same: every flag, every exit code, and the help itself.

use crate::support::root;
use glint_bake::commands::{flag_tables, programs};
use glint_bake::exit::Exit;
use std::fs;

fn page() -> String {
    fs::read_to_string(root().join("docs/CLI.md")).unwrap()
}

/// The part of the page under a heading, up to the next one of its kind.
fn chapter<'a>(page: &'a str, name: &str) -> &'a str {
    let start = page.find(&format!("\n## {name}\n")).unwrap_or_else(|| panic!("docs/CLI.md has no chapter {name}"));
    let rest = &page[start + 4..];
    &rest[..rest.find("\n## ").unwrap_or(rest.len())]
}

fn check_flags(command: &clap::Command, chapter: &str, name: &str) {
    for arg in command.get_arguments().filter(|arg| !["help", "version"].contains(&arg.get_id().as_str())) {
        if let Some(long) = arg.get_long() {
            assert!(
                chapter.contains(&format!("`--{long}")) || chapter.contains(&format!(", --{long}")),
                "{name}: --{long}"
            );
        }
        if let Some(short) = arg.get_short() {
            assert!(chapter.contains(&format!("`-{short}")), "{name}: -{short}");
        }
        assert!(arg.get_help().is_some(), "{name}: {} has no help", arg.get_id());
    }
}

#[test]
fn every_flag_is_documented() {
    let page = page();
    let common = chapter(&page, "Common flags");
    for program in programs() {
        for subcommand in program.get_subcommands() {
            let name = format!("{} {}", program.get_name(), subcommand.get_name());
            check_flags(subcommand, chapter(&page, &name), &name);
        }
        let mut own = chapter(&page, program.get_name()).to_owned();
        own.push_str(common);
        check_flags(&program, &own, program.get_name());
    }
}

/// The tables of flags are made from the flags. GLINT_BLESS=1 writes them anew, as `glint-bake generate markdown -o docs`.
#[test]
fn tables_of_flags_are_those_of_the_flags() {
    let page = page();
    let commands = programs().into_iter().flat_map(|program| {
        let name = program.get_name().to_owned();
        let subcommands: Vec<String> =
            program.get_subcommands().map(|command| format!("{name} {}", command.get_name())).collect();
        [name].into_iter().chain(subcommands).filter(|name| name != "glint-bake")
    });
    for command in commands.chain(["all programs".to_owned()]) {
        let mark = format!("<!-- flags of {command} -->");
        assert_eq!(page.matches(&mark).count(), 1, "docs/CLI.md has the mark {mark} once");
    }
    let renewed = flag_tables::renew(&page, &programs()).unwrap();
    if std::env::var_os("GLINT_BLESS").is_some() {
        fs::write(root().join("docs/CLI.md"), &renewed).unwrap();
    }
    let recorded = fs::read_to_string(root().join("docs/CLI.md")).unwrap();
    assert!(recorded == renewed, "docs/CLI.md has other tables than the flags; run with GLINT_BLESS=1\n{renewed}");
}

#[test]
fn every_exit_code_is_documented() {
    let page = page();
    let chapter = chapter(&page, "Exit codes");
    for (exit, meaning) in Exit::ALL {
        let row = format!("| {} | {meaning} |", *exit as u8);
        assert!(chapter.contains(&row), "docs/CLI.md lacks the row {row}");
    }
}

/// The help as it is, so that a change of it is seen in review. GLINT_BLESS=1 writes it anew.
#[test]
fn help_is_as_recorded() {
    let mut text = String::new();
    for program in programs() {
        let mut program = program.term_width(100);
        program.build();
        let help = program.render_help();
        text.push_str(&format!("$ {} --help\n{help}\n", program.get_name()));
        for subcommand in program.get_subcommands_mut().filter(|command| command.get_name() != "help") {
            let mut subcommand = subcommand.clone().term_width(100);
            let help = subcommand.render_help();
            text.push_str(&format!("$ {} --help\n{help}\n", subcommand.get_bin_name().unwrap()));
        }
    }
    let path = root().join("tests/cli/help.txt");
    if std::env::var_os("GLINT_BLESS").is_some() {
        fs::write(&path, &text).unwrap();
    }
    let recorded = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        recorded == text,
        "the help differs from tests/cli/help.txt; look at it and run with GLINT_BLESS=1\n{text}"
    );
}

#[test]
fn the_readme_shows_the_headline_of_the_dictionary_report() {
    let report = fs::read_to_string(root().join("docs/reports/dictionary.md")).unwrap();
    let headline = report.lines().find(|line| line.starts_with("Default dictionary (")).unwrap();
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    assert!(readme.lines().any(|line| line == headline), "run `just report`, which writes both");
}
