//! Standard error as the user wants it: messages, their colours, and the bars that they make room for.

use super::common::{Colour, Common, ProgressWhen};
use indicatif::MultiProgress;
use std::borrow::Cow;
use std::io::{IsTerminal, Write, stderr};
use std::sync::{LazyLock, OnceLock};

/// Every bar of this process, so that several pieces of work and messages between them share one terminal.
pub fn bars() -> &'static MultiProgress {
    static BARS: LazyLock<MultiProgress> = LazyLock::new(MultiProgress::new);
    &BARS
}

/// What the user wants of standard error.
#[derive(Clone, Copy, Debug)]
pub struct Terminal {
    quiet: bool,
    verbose: bool,
    colour: bool,
    progress: bool,
    /// The part of a larger piece of work that speaks. Labels live as long as the process, so that this stays Copy.
    label: Option<&'static str>,
}

/// The terminal of this process once its flags are known, for messages after the program has returned.
static PROCESS: OnceLock<Terminal> = OnceLock::new();

impl Terminal {
    /// As the flags and the environment ask.
    pub fn new(common: &Common) -> Terminal {
        let is_terminal = stderr().is_terminal();
        let plain = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
        let colour = match common.color {
            Colour::Auto => is_terminal && !plain,
            Colour::Always => true,
            Colour::Never => false,
        };
        let progress = match common.progress {
            ProgressWhen::Auto => is_terminal && !common.quiet,
            ProgressWhen::Never => false,
            ProgressWhen::Always => true,
        };
        let terminal = Terminal { quiet: common.quiet, verbose: common.verbose, colour, progress, label: None };
        *PROCESS.get_or_init(|| terminal)
    }

    /// The one made from this process's flags; plain before they are known.
    pub fn from_process() -> Terminal {
        let plain = Terminal { quiet: false, verbose: false, colour: false, progress: false, label: None };
        PROCESS.get().copied().unwrap_or(plain)
    }

    /// The same for one part of a larger piece of work: messages begin with the part's name, and what was done is a
    /// detail.
    pub fn of_part(&self, name: &str) -> Terminal {
        Terminal { label: Some(String::leak(name.to_owned())), ..*self }
    }

    /// Name of the part that speaks; empty for the whole.
    pub fn label(&self) -> &'static str {
        self.label.unwrap_or_default()
    }

    /// Whether progress is shown.
    pub fn progress(&self) -> bool {
        self.progress
    }

    /// Whether nothing but errors is wanted.
    pub fn is_quiet(&self) -> bool {
        self.quiet
    }

    /// Why the program stops.
    pub fn error(&self, message: &str) {
        self.labelled("error", "31", message);
    }

    /// Something the user should know.
    pub fn warn(&self, message: &str) {
        if !self.quiet {
            self.labelled("warning", "33", message);
        }
    }

    /// What was done.
    pub fn say(&self, message: &str) {
        if self.label.is_some() {
            self.detail(message);
        } else if !self.quiet {
            write_line(message);
        }
    }

    /// A step of progress where no bar can be shown.
    pub fn step(&self, message: &str) {
        if !self.quiet {
            write_line(&self.part_of(message));
        }
    }

    /// What only `--verbose` shows.
    pub fn detail(&self, message: &str) {
        if self.verbose {
            write_line(&self.part_of(message));
        }
    }

    fn part_of<'a>(&self, message: &'a str) -> Cow<'a, str> {
        match self.label {
            Some(label) => Cow::Owned(format!("{label}: {}", message.replace('\n', &format!("\n{label}: ")))),
            None => Cow::Borrowed(message),
        }
    }

    fn labelled(&self, label: &str, ansi: &str, message: &str) {
        let message = self.part_of(message);
        if self.colour {
            write_line(&format!("\x1b[1;{ansi}m{label}:\x1b[0m {message}"));
        } else {
            write_line(&format!("{label}: {message}"));
        }
    }
}

/// A message that nobody can read is not worth a failure. Bars make room for it.
fn write_line(message: &str) {
    let _ = bars().suspend(|| writeln!(stderr(), "{message}"));
}
