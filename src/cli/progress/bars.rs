//! Progress bars on a terminal, for work that takes long enough to wonder about.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

use super::super::terminal::on_one_line;
use super::COUNTED;
use crate::progress::{Progress, UNKNOWN_TOTAL};

/// Work shorter than this shows no bar.
const SHORT: Duration = Duration::from_millis(400);

/// How often a spinner turns.
const TICK: Duration = Duration::from_millis(150);

/// A bar for each stage that has begun, the outermost on top.
pub struct TerminalBars {
    drawn: MultiProgress,
    stages: Mutex<Vec<Stage>>,
}

struct Stage {
    bar: ProgressBar,
    began: Instant,
    shown: bool,
}

impl TerminalBars {
    pub fn new() -> Self {
        Self {
            drawn: MultiProgress::new(),
            stages: Mutex::default(),
        }
    }

    fn stages(&self) -> MutexGuard<'_, Vec<Stage>> {
        self.stages.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn show(&self, stage: &mut Stage) {
        self.drawn.add(stage.bar.clone());
        stage.shown = true;
    }
}

impl Progress for TerminalBars {
    fn begin(&self, name: &str, total: u64) {
        let unknown = total == UNKNOWN_TOTAL;
        let mut stage = Stage {
            bar: if unknown {
                spinner()
            } else {
                counting_bar(total)
            },
            began: Instant::now(),
            shown: false,
        };
        stage.bar.set_message(on_one_line(name));
        if unknown || total <= COUNTED {
            // Nothing advances it, or seldom: a timer turns it.
            self.show(&mut stage);
            stage.bar.enable_steady_tick(TICK);
        }
        self.stages().push(stage);
    }

    fn advance(&self, units: u64) {
        if let Some(stage) = self.stages().last_mut() {
            if !stage.shown && stage.began.elapsed() > SHORT {
                self.show(stage);
            }
            stage.bar.inc(units);
        }
    }

    fn end(&self) {
        if let Some(stage) = self.stages().pop() {
            stage.bar.finish_and_clear();
            self.drawn.remove(&stage.bar);
        }
    }
}

fn counting_bar(total: u64) -> ProgressBar {
    let bar = ProgressBar::hidden();
    bar.set_length(total);
    let style = ProgressStyle::with_template(match total <= COUNTED {
        true => "{msg:>12} [{bar:40}] {pos} of {len} {spinner} {elapsed}",
        false => "{msg:>12} [{bar:40}] {percent:>3}% {eta}",
    });
    if let Ok(style) = style {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}

fn spinner() -> ProgressBar {
    let bar = ProgressBar::hidden();
    if let Ok(style) = ProgressStyle::with_template("{msg:>12} {spinner} {elapsed}") {
        bar.set_style(style);
    }
    bar
}

/// Work that failed leaves no bar behind.
impl Drop for TerminalBars {
    fn drop(&mut self) {
        while !self.stages().is_empty() {
            self.end();
        }
    }
}
