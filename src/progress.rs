//! Progress on standard error, for people only: a bar on a terminal, one line a stage elsewhere when it is asked for.

use crate::cli::{Terminal, bars};
use glint_bake_core::progress::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, stderr};
use std::sync::Mutex;

/// A bar below all others for `total` parts of a larger piece of work; hidden where no bars are wanted.
pub fn overall(terminal: Terminal, what: &str, total: u64) -> ProgressBar {
    if !terminal.progress() || !stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    bars()
        .add(ProgressBar::new(total).with_style(style("{msg:25} {wide_bar} {pos}/{len} {elapsed:>4}")))
        .with_message(what.to_owned())
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}

/// Shows one stage after another.
pub struct Stages {
    terminal: Terminal,
    bar: Mutex<Option<ProgressBar>>,
}

impl Stages {
    /// Shown as the user wants.
    pub fn new(terminal: Terminal) -> Stages {
        Stages { terminal, bar: Mutex::new(None) }
    }

    fn with_bar(&self, act: impl FnOnce(&mut Option<ProgressBar>)) {
        // A bar is only ever replaced whole, so one that a panicking thread left behind is still good.
        act(&mut self.bar.lock().unwrap_or_else(|poisoned| poisoned.into_inner()));
    }
}

impl Progress for Stages {
    fn begin(&self, stage: &str, total: u64) {
        if !self.terminal.progress() {
            return;
        }
        if !stderr().is_terminal() {
            return self.terminal.step(&format!("{stage}: {total} steps"));
        }
        let template = match self.terminal.label() {
            "" => "{msg:12} {wide_bar} {pos}/{len} {eta:>4}",
            _ => "{prefix:12.12} {msg:12} {wide_bar} {pos}/{len} {eta:>4}",
        };
        let new = ProgressBar::new(total).with_style(style(template)).with_prefix(self.terminal.label());
        // The bar of the whole stays below.
        let new = bars().insert_from_back(1, new.with_message(stage.to_owned()));
        self.with_bar(|bar| *bar = Some(new));
    }

    fn advance(&self, steps: u64) {
        self.with_bar(|bar| {
            if let Some(bar) = bar {
                bar.inc(steps);
            }
        });
    }

    fn end(&self) {
        self.with_bar(|bar| {
            if let Some(bar) = bar.take() {
                bar.finish_and_clear();
                bars().remove(&bar);
            }
        });
    }
}
