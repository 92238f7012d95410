//! `glint-bake generate`: manual pages, shell completions and tables of flags, from the one definition of the flags.

use crate::cli::Terminal;
use crate::commands::flag_tables;
use crate::exit::{Exit, Failure};
use crate::output;
use crate::reading;
use clap::ValueEnum;
use clap_complete::Shell;
use clap_mangen::Man;
use std::path::{Path, PathBuf};

/// Lines that `--help` shows and a test runs.
const EXAMPLES: &str = "\
Examples:
  glint-bake generate man -o man
  glint-bake generate bash -o completions
  glint-bake generate zsh
  glint-bake generate markdown -o docs";

/// Write manual pages, shell completions or tables of flags of all programs
///
/// With -o one file a page or a program, named as the shell expects: glint-bake.1, glint-bake.bash, _glint-bake,
/// glint-bake.fish, _glint-bake.ps1. Without, all of it to standard output, for the shell to source. Tables go to CLI.md: of
/// one that is there already only the parts between <!-- flags of COMMAND --> and <!-- end of flags --> are written anew.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// What to write
    #[arg(value_name = "WHAT")]
    pub what: What,
    /// Folder to write into; it is created [default: standard output]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

/// What can be generated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum What {
    /// Manual pages, one a subcommand
    Man,
    /// Completions for bash
    Bash,
    /// Completions for zsh
    Zsh,
    /// Completions for fish
    Fish,
    /// Completions for PowerShell
    #[value(name = "powershell")]
    PowerShell,
    /// Tables of flags in Markdown
    Markdown,
}

/// A file to be.
struct Document {
    name: String,
    bytes: Vec<u8>,
}

/// Runs the subcommand; `programs` are all of them, as clap sees them.
pub fn run(args: &Args, programs: [clap::Command; 3], terminal: Terminal) -> Result<(), Failure> {
    let documents = match args.what {
        What::Man => manual(programs)?,
        What::Bash => completions(programs, Shell::Bash),
        What::Zsh => completions(programs, Shell::Zsh),
        What::Fish => completions(programs, Shell::Fish),
        What::PowerShell => completions(programs, Shell::PowerShell),
        What::Markdown => vec![tables(&programs, args.output.as_deref())?],
    };
    let Some(folder) = &args.output else {
        let text: Vec<u8> = documents.into_iter().flat_map(|document| document.bytes).collect();
        return output::print(&String::from_utf8_lossy(&text));
    };
    output::create_folder(folder)?;
    for document in documents {
        let path = folder.join(document.name);
        output::write(&path, &document.bytes)?;
        terminal.say(&format!("{}: written", path.display()));
    }
    Ok(())
}

fn completions(programs: [clap::Command; 3], shell: Shell) -> Vec<Document> {
    let document = |mut program: clap::Command| {
        use clap_complete::Generator;
        let name = program.get_name().to_owned();
        let mut bytes = Vec::new();
        clap_complete::generate(shell, &mut program, &name, &mut bytes);
        Document { name: shell.file_name(&name), bytes }
    };
    programs.map(document).into()
}

/// Tables of flags: in the page that is there already, or a page of nothing else.
fn tables(programs: &[clap::Command], folder: Option<&Path>) -> Result<Document, Failure> {
    let path = folder.map(|folder| folder.join(flag_tables::FILE)).filter(|path| path.exists());
    let text = match path {
        Some(path) => flag_tables::renew(&reading::text(&path, "cannot be read")?, programs)?,
        None => flag_tables::page(programs),
    };
    Ok(Document { name: flag_tables::FILE.to_owned(), bytes: text.into_bytes() })
}

/// A page a program and a page a subcommand.
fn manual(programs: [clap::Command; 3]) -> Result<Vec<Document>, Failure> {
    let mut pages = Vec::new();
    for mut program in programs {
        program.build();
        let subcommands = program.get_subcommands().filter(|command| command.get_name() != "help").cloned();
        for command in std::iter::once(program.clone()).chain(subcommands) {
            let name = format!("{}.1", command.get_display_name().unwrap_or(command.get_name()));
            let mut bytes = Vec::new();
            let man = Man::new(command).source(concat!("glint-bake ", env!("CARGO_PKG_VERSION")));
            man.render(&mut bytes)
                .map_err(|e| Failure::new(Exit::Unexpected, format!("{name} cannot be made: {e}")))?;
            // An empty date loses its quotes, and the version would stand in its place.
            let page = String::from_utf8_lossy(&bytes).replacen(" 1  \"glint-bake", " 1 \"\" \"glint-bake", 1);
            pages.push(Document { name, bytes: page.into_bytes() });
        }
    }
    Ok(pages)
}
