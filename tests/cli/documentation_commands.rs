//! What the pages of the repository tell a user to type is typed here, and what they say a program prints is what it prints.
//!
//! Every command in a fenced `sh` or `console` block is run by a shell, in the order of its page, in a folder that holds
//! `fixtures/maps`, `fixtures/packs/v1`, `formats/c` and `docs/examples` as the repository does; `console` blocks are compared with
//! what came out as well.
//! `GLINT_BLESS=1 cargo test --all-features --test cli documentation_commands` writes those blocks anew.
//!
//! `cargo run --release … --bin X --` runs the X that was built for the tests. What cannot run is in [`NOT_RUN`], with a reason.
//! A command whose comment begins with `code N` ends with that exit code.

use crate::examples::{can_view, inputs};
use crate::projects::program;
use crate::support::root;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Commands that are not run, as they stand in a page, and why.
const NOT_RUN: [(&str, &str); 7] = [
    ("scripts/test.sh", "runs this test"),
    ("cargo fmt --all --check", "a step of scripts/test.sh"),
    ("cargo clippy --workspace --all-targets --all-features -- -D warnings", "a step of scripts/test.sh"),
    ("cargo test --workspace --all-features", "runs this test"),
    ("GLINT_REQUIRE_ADAPTER=1 cargo test -p glint-view-core -- --nocapture", "runs tests, as scripts/test.sh does"),
    (
        "cargo run --release --features view --bin glint-view -- paint.glintpack",
        "opens a window, as tests/window.rs does",
    ),
    ("ninja", "needs ninja; tests/cli/ninja.rs runs it where it is installed"),
];

/// How `cargo run` begins where it runs a program of this repository.
const CARGO_RUNS: [&str; 2] = ["cargo run --release --features view --bin ", "cargo run --release --bin "];

/// The pages, relative to the repository.
fn pages() -> Vec<PathBuf> {
    let mut pages: Vec<PathBuf> = [
        "README.md",
        "CONTRIBUTING.md",
        "docs/CLI.md",
        "docs/ENGINES.md",
        "docs/FORMAT.md",
        "docs/INPUTS.md",
        "docs/PIPELINES.md",
        "docs/VIEWER.md",
    ]
    .map(PathBuf::from)
    .to_vec();
    let methods = fs::read_dir(root().join("docs/methods")).unwrap();
    pages.extend(methods.map(|entry| Path::new("docs/methods").join(entry.unwrap().file_name())));
    pages.sort();
    pages
}

/// A command of a page and, in a `console` block, what the page says that it prints.
#[derive(Debug)]
struct Example {
    /// Line of the page, from 0, at which the command stands.
    line: usize,
    /// The command, its lines joined, without comment.
    command: String,
    /// The exit code that it ends with.
    code: i32,
    /// Lines of the page with its output, if it is given.
    output: Option<std::ops::Range<usize>>,
}

/// The examples of a page, in order.
fn examples(page: &str) -> Vec<Example> {
    let lines: Vec<&str> = page.lines().collect();
    let mut examples: Vec<Example> = Vec::new();
    let mut at = 0;
    while at < lines.len() {
        let fence = lines[at].trim_start();
        if !fence.starts_with("```") {
            at += 1;
            continue;
        }
        let end = (at + 1..lines.len()).find(|&k| lines[k].trim() == "```").expect("a fence that is not closed");
        let console = fence == "```console";
        if !console && fence != "```sh" {
            at = end + 1;
            continue;
        }
        at += 1;
        while at < end {
            let first = at;
            let mut text = lines[at].trim().to_owned();
            while text.ends_with('\\') && at + 1 < end {
                at += 1;
                text = format!("{} {}", text.trim_end_matches('\\').trim_end(), lines[at].trim());
            }
            at += 1;
            let typed = if console { text.strip_prefix("$ ") } else { Some(text.as_str()) };
            let Some(typed) = typed else { continue };
            let (command, comment) = typed.split_once(" #").unwrap_or((typed, ""));
            let command = command.trim();
            if command.is_empty() || command.starts_with('#') {
                continue;
            }
            let code =
                comment.trim().strip_prefix("code ").and_then(|rest| rest.split([':', ' ']).next()?.parse().ok());
            let output = console.then(|| {
                let next = (at..end).find(|&k| lines[k].starts_with("$ ")).unwrap_or(end);
                at..next
            });
            examples.push(Example { line: first, command: command.to_owned(), code: code.unwrap_or(0), output });
        }
        at = end + 1;
    }
    examples
}

/// A command with `cargo run` of a program replaced by the program.
fn without_cargo(command: &str) -> String {
    for run in CARGO_RUNS {
        if let Some(rest) = command.strip_prefix(run) {
            return rest.replacen(" -- ", " ", 1);
        }
    }
    command.to_owned()
}

/// A line without what differs from build to build and run to run: digests, the commit, times, bytes of the section and of the
/// file that hold the commit, and how columns are spaced.
fn normalised(line: &str) -> String {
    let words: Vec<&str> = line.split_whitespace().collect();
    let number = |word: &str| !word.is_empty() && word.chars().all(|c| c.is_ascii_digit() || c == '.' || c == ',');
    let mut out = Vec::new();
    for (k, word) in words.iter().enumerate() {
        let next = words.get(k + 1).map_or("", |next| next.trim_end_matches([',', ';', '.', ')']));
        let digest = word.len() >= 12 && word.chars().all(|c| c.is_ascii_hexdigit());
        let commit = k > 0 && words[k - 1] == "(git";
        let time = number(word.trim_start_matches('(')) && (next == "s" || next == "ms");
        let bytes = next == "bytes" && (words[0] == "PROV" || word.starts_with('('));
        out.push(match () {
            () if commit => "(commit)",
            () if digest => "(digest)",
            () if time => "(time)",
            () if bytes => "(bytes)",
            () => word,
        });
    }
    out.join(" ")
}

/// A folder with the files of the repository that pages name, and a mesh; for the page of flags also with what the examples of helps
/// name.
fn folder(page: &Path) -> tempfile::TempDir {
    let folder = if page == Path::new("docs/CLI.md") { inputs() } else { tempfile::tempdir().unwrap() };
    let model = crate::gltf_file::quad(r#"[{"normalTexture": {"index": 0}}]"#);
    fs::write(folder.path().join("model.glb"), model).unwrap();
    for part in ["fixtures/maps", "fixtures/packs/v1", "formats/c", "docs/examples"] {
        fs::create_dir_all(folder.path().join(part)).unwrap();
        for entry in fs::read_dir(root().join(part)).unwrap() {
            let path = entry.unwrap().path();
            fs::copy(&path, folder.path().join(part).join(path.file_name().unwrap())).unwrap();
        }
    }
    folder
}

/// A shell that keeps its folder from command to command.
struct Shell {
    root: tempfile::TempDir,
    here: PathBuf,
}

impl Shell {
    fn new(page: &Path) -> Shell {
        let root = folder(page);
        let here = root.path().to_owned();
        Shell { root, here }
    }

    /// Runs a command: its exit code and all that it printed.
    fn run(&mut self, command: &str) -> (i32, String) {
        let mut path = program("glint-bake").parent().unwrap().as_os_str().to_owned();
        path.push(":");
        path.push(std::env::var_os("PATH").unwrap_or_default());
        let place = self.root.path().join(".here");
        let script = format!("exec 2>&1\n{command}\ncode=$?\npwd > '{}'\nexit $code\n", place.display());
        let output = Command::new("sh")
            .args(["-c", &script])
            .current_dir(&self.here)
            .env("PATH", path)
            .env("NO_COLOR", "1")
            .output()
            .unwrap();
        if let Ok(here) = fs::read_to_string(place) {
            self.here = PathBuf::from(here.trim_end());
        }
        (output.status.code().unwrap_or(-1), String::from_utf8_lossy(&output.stdout).into_owned())
    }
}

/// Runs a page; what is wrong with it, and the page as it should be.
fn run(path: &Path) -> (Vec<String>, String) {
    let page = fs::read_to_string(root().join(path)).unwrap();
    if examples(&page).is_empty() {
        return (Vec::new(), page);
    }
    let lines: Vec<&str> = page.lines().collect();
    let mut wrong = Vec::new();
    let mut blessed = String::new();
    let mut copied = 0;
    let mut shell = Shell::new(path);
    for example in examples(&page) {
        if NOT_RUN.iter().any(|(command, _)| *command == example.command) {
            continue;
        }
        let command = without_cargo(&example.command);
        if command.starts_with("glint-view") && !can_view() {
            eprintln!("skipped, as there is no viewer or no adapter: {command}");
            continue;
        }
        let at = format!("{}:{}: {}", path.display(), example.line + 1, example.command);
        let (code, printed) = shell.run(&command);
        if code != example.code {
            wrong.push(format!("{at}\n  ended with {code}, expected {}:\n{printed}", example.code));
            continue;
        }
        let Some(range) = example.output else { continue };
        let said = &lines[range.clone()];
        let (old, new) = (said.iter().map(|l| normalised(l)), printed.lines().map(normalised));
        if !blessing() && old.ne(new) {
            wrong.push(format!("{at}\n  printed:\n{printed}  but the page says:\n{}", said.join("\n")));
        }
        lines[copied..range.start].iter().for_each(|line| blessed.push_str(&format!("{line}\n")));
        for line in printed.lines() {
            // A line that differs in what may differ stays as it is.
            let same = said.iter().find(|old| normalised(old) == normalised(line));
            blessed.push_str(&format!("{}\n", same.unwrap_or(&line).trim_end()));
        }
        copied = range.end;
    }
    lines[copied..].iter().for_each(|line| blessed.push_str(&format!("{line}\n")));
    (wrong, blessed)
}

/// Whether pages are written anew.
fn blessing() -> bool {
    std::env::var_os("GLINT_BLESS").is_some()
}

/// Runs the pages that `chosen` chooses.
#[track_caller]
fn check(chosen: impl Fn(&str) -> bool) {
    let mut wrong = Vec::new();
    for page in pages().iter().filter(|page| chosen(page.to_str().unwrap())) {
        let (found, blessed) = run(page);
        if blessing() {
            fs::write(root().join(page), blessed).unwrap();
        }
        wrong.extend(found);
    }
    assert!(wrong.is_empty(), "look at it, and if it is right run with GLINT_BLESS=1\n{}", wrong.join("\n"));
}

#[test]
fn commands_of_the_readme_run() {
    check(|page| page == "README.md");
}

#[test]
fn commands_of_the_viewer_s_page_run() {
    check(|page| page == "docs/VIEWER.md");
}

#[test]
fn commands_of_the_methods_pages_run() {
    check(|page| page.starts_with("docs/methods/"));
}

#[test]
fn commands_of_the_other_pages_run() {
    check(|page| page != "README.md" && page != "docs/VIEWER.md" && !page.starts_with("docs/methods/"));
}

#[test]
fn what_is_not_run_stands_in_a_page() {
    let mut commands = Vec::new();
    for page in pages() {
        commands.extend(examples(&fs::read_to_string(root().join(page)).unwrap()).into_iter().map(|e| e.command));
    }
    for (command, reason) in NOT_RUN {
        assert!(commands.iter().any(|found| found == command), "no page has `{command}` ({reason}) any more");
    }
    assert!(commands.len() > 40, "{} commands", commands.len());
}

/// What makes a figure stands in the paragraph before it, in its own or in the one after it.
#[test]
fn every_figure_has_its_command() {
    let commands = ["`just ", "`scripts/", "`cargo ", "`glint-", "$ ", "```sh"];
    for page in pages() {
        let text = fs::read_to_string(root().join(&page)).unwrap();
        let paragraphs: Vec<&str> = text.split("\n\n").collect();
        for (k, paragraph) in paragraphs.iter().enumerate().filter(|(_, text)| text.contains("![")) {
            let near = &paragraphs[k.saturating_sub(1)..(k + 2).min(paragraphs.len())];
            let found = near.iter().any(|text| commands.iter().any(|command| text.contains(command)));
            assert!(found, "{}: no command makes {paragraph}", page.display());
        }
    }
}

/// The anchor that a renderer gives to a heading.
fn anchor(heading: &str) -> String {
    let kept = heading.trim().chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect::<String>().to_lowercase()
}

fn markdown_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            markdown_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "md") {
            found.push(path);
        }
    }
}

#[test]
fn every_link_leads_to_a_file_and_a_heading() {
    let mut files = vec![root().join("README.md"), root().join("CONTRIBUTING.md"), root().join("CHANGELOG.md")];
    markdown_files(&root().join("docs"), &mut files);
    markdown_files(&root().join("fixtures"), &mut files);
    let mut wrong = Vec::new();
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            if link.contains("://") || link.contains(char::is_whitespace) {
                continue;
            }
            let (path, heading) = link.split_once('#').unwrap_or((link, ""));
            let target = if path.is_empty() { file.clone() } else { file.parent().unwrap().join(path) };
            if !target.exists() {
                wrong.push(format!("{}: {link}: there is no such file", file.display()));
            } else if !heading.is_empty() {
                let page = fs::read_to_string(&target).unwrap_or_default();
                let headings = page.lines().filter(|line| line.starts_with('#'));
                if !headings.map(|line| anchor(line.trim_start_matches('#'))).any(|found| found == heading) {
                    wrong.push(format!("{}: {link}: there is no such heading", file.display()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs" || extension == "wgsl") {
            found.push(path);
        }
    }
}

/// `docs/….md` in the sources are pages that are there.
#[test]
fn every_page_that_a_source_names_is_there() {
    let mut files = Vec::new();
    for folder in ["bake", "examples", "formats", "src", "tests"] {
        sources(&root().join(folder), &mut files);
    }
    let mut wrong = Vec::new();
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        for rest in text.split("docs/").skip(1) {
            let page: String = rest.chars().take_while(|c| c.is_alphanumeric() || "-_/.".contains(*c)).collect();
            let page = page.trim_end_matches('.');
            if page.ends_with(".md") && !root().join("docs").join(page).exists() {
                wrong.push(format!("{}: docs/{page}", file.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "there is no such page:\n{}", wrong.join("\n"));
}

#[test]
fn blocks_are_read_as_a_user_reads_them() {
    let page =
        "```sh\na b \\\n  c   # code 7: x\n\n# only a comment\nd\n```\n```toml\ne\n```\n```console\n$ f\ng\n$ h\n```\n";
    let found = examples(page);
    let commands: Vec<(&str, i32)> = found.iter().map(|e| (e.command.as_str(), e.code)).collect();
    assert_eq!(commands, [("a b c", 7), ("d", 0), ("f", 0), ("h", 0)]);
    assert_eq!(found[2].output, Some(12..13));
    assert_eq!(found[3].output, Some(14..14));
    assert_eq!(without_cargo("cargo run --release --bin glint-bake -- demo -o x"), "glint-bake demo -o x");
    assert_eq!(normalised("baked in 0.5 s,  (git 0123)"), normalised("baked in 12 s, (git ab)"));
    assert_eq!(normalised("  PROV  x 728 bytes"), normalised("PROV x 9 bytes"));
    assert_ne!(normalised("NMDE x 728 bytes"), normalised("NMDE x 9 bytes"));
}

/// The last column of a method's table of symbols names items of `bake` and `formats`.
#[test]
fn every_name_of_a_symbol_is_in_the_sources() {
    let mut files = Vec::new();
    ["bake/src", "formats/src"].iter().for_each(|folder| sources(&root().join(folder), &mut files));
    let sources: String = files.iter().map(|file| fs::read_to_string(file).unwrap()).collect();
    let words: std::collections::HashSet<&str> =
        sources.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty()).collect();
    let mut wrong = Vec::new();
    for page in pages().iter().filter(|page| page.starts_with("docs/methods")) {
        let text = fs::read_to_string(root().join(page)).unwrap();
        let table = text.split("\n## Symbols\n").nth(1).unwrap_or_else(|| panic!("{}: no symbols", page.display()));
        let rows = table.lines().take_while(|line| !line.starts_with("## ")).filter(|line| line.starts_with("| "));
        for row in rows {
            let names = row.trim_end_matches(" |").rsplit(" | ").next().unwrap();
            for name in names.split('`').skip(1).step_by(2).filter(|name| !words.contains(name)) {
                wrong.push(format!("{}: `{name}` of {row}", page.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "no source has\n{}", wrong.join("\n"));
}

/// All pages of methods have the same chapters in the same order.
#[test]
fn pages_of_methods_have_one_layout() {
    const CHAPTERS: [&str; 8] =
        ["Idea", "Symbols", "Definition", "Bake", "Run time", "Deviations from the paper", "Limits", "Measured"];
    for page in pages().iter().filter(|page| page.starts_with("docs/methods")) {
        let text = fs::read_to_string(root().join(page)).unwrap();
        let chapters: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("## ")).collect();
        assert_eq!(chapters, CHAPTERS, "{}", page.display());
    }
}
