//! Progress on standard error, for people only: a bar on a terminal, one line a stage elsewhere when it is asked for.

use crate::cli::Terminal;
use glint_bake_core::progress::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, stderr};
use std::sync::Mutex;

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
            return self.terminal.say(&format!("{stage}: {total} steps"));
        }
        let style = ProgressStyle::with_template("{msg:12} {wide_bar} {pos}/{len} {eta:>4}")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        let new = ProgressBar::new(total).with_style(style).with_message(stage.to_owned());
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
            }
        });
    }
}
