//! What the press tells while it works: a moving line on a terminal, plain lines elsewhere.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use anyhow::Result;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Announces steps and their times.
#[derive(Clone)]
pub struct Steps {
    live: bool,
    quiet: bool,
}

impl Steps {
    /// Moving lines when a person watches a terminal, plain lines otherwise.
    pub fn new() -> Steps {
        let live = std::io::stderr().is_terminal() && std::env::var_os("CI").is_none();
        Steps { live, quiet: false }
    }

    /// Says nothing: for tests, and for a program that is called by another.
    pub fn quiet() -> Steps {
        Steps { live: false, quiet: true }
    }

    /// Runs a step of unknown length.
    pub fn step<T>(&self, name: &str, work: impl FnOnce() -> Result<T>) -> Result<T> {
        self.counted(name, 0, |_| work())
    }

    /// Runs a step that has `length` parts and calls the given bar after each of them.
    pub fn counted<T>(
        &self,
        name: &str,
        length: u64,
        work: impl FnOnce(&ProgressBar) -> Result<T>,
    ) -> Result<T> {
        let bar = self.bar(name, length);
        let start = Instant::now();
        let result = work(&bar);
        bar.finish_and_clear();
        if !self.quiet {
            let mark = if result.is_ok() { "✓" } else { "✗" };
            eprintln!("{mark} {name:<34} {:>6.1} s", start.elapsed().as_secs_f64());
        }
        result
    }

    /// Says something between two steps.
    pub fn say(&self, text: &str) {
        if !self.quiet {
            eprintln!("{text}");
        }
    }

    fn bar(&self, name: &str, length: u64) -> ProgressBar {
        let (bar, template) = match length {
            0 => (ProgressBar::new_spinner(), "{spinner} {msg} {elapsed}"),
            length => {
                (ProgressBar::new(length), "{spinner} {msg} [{bar:24}] {pos}/{len} {elapsed}")
            }
        };
        if !self.live {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        bar.set_style(
            ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()),
        );
        bar.set_message(name.to_owned());
        bar.enable_steady_tick(Duration::from_millis(100));
        bar
    }
}

impl Default for Steps {
    fn default() -> Self {
        Steps::new()
    }
}
