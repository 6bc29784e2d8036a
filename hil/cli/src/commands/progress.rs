//! The progress on standard error: an updated line on a terminal, plain lines elsewhere.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use mesh_damper_output::terminal::{tell, visible};

/// Plain lines are at least this far apart, so that short work prints none.
const BETWEEN_LINES: Duration = Duration::from_secs(2);

/// The progress of one command. It disappears when dropped.
pub struct Progress {
    bar: ProgressBar,
    last_line: Mutex<Instant>,
}

impl Progress {
    /// Work of unknown length.
    pub fn steps() -> Self {
        Self::new(
            ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr()),
            "{spinner} {elapsed} {msg}",
        )
    }

    /// Work of `total` parts.
    pub fn of(total: u64) -> Self {
        Self::new(
            ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr()),
            "{bar:30} {percent:>3} % {msg}",
        )
    }

    fn new(bar: ProgressBar, template: &str) -> Self {
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(150));
        Self {
            bar,
            last_line: Mutex::new(Instant::now()),
        }
    }

    /// Shows the current work.
    pub fn step(&self, what: &str) {
        self.bar.set_message(visible(what).into_owned());
        self.plain(|| what.to_owned());
    }

    /// Prints a warning above the progress.
    pub fn warn(&self, text: &str) {
        self.bar.suspend(|| super::warn(text));
    }

    /// Shows the number of finished parts.
    pub fn done(&self, parts: u64) {
        self.bar.set_position(parts);
        self.part(parts);
    }

    /// Counts another finished part, from any thread.
    pub fn one_more(&self) {
        self.bar.inc(1);
        self.part(self.bar.position());
    }

    fn part(&self, parts: u64) {
        self.plain(|| {
            let total = self.bar.length().unwrap_or(parts).max(1);
            format!("{} {} %", self.bar.message(), 100 * parts / total)
        });
    }

    fn plain(&self, line: impl FnOnce() -> String) {
        if !self.bar.is_hidden() {
            return;
        }
        let Ok(mut last) = self.last_line.lock() else {
            return;
        };
        if last.elapsed() >= BETWEEN_LINES {
            *last = Instant::now();
            tell(&line());
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
