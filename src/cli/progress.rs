//! Progress bars on a terminal's stderr, for work that takes long enough to wonder about.

use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::progress::{Progress, UNKNOWN_TOTAL};

/// Work shorter than this shows no bar.
const SHORT: Duration = Duration::from_millis(400);

/// How often a spinner turns.
const TICK: Duration = Duration::from_millis(150);

/// One bar at a time, none where stderr is no terminal.
pub struct Bars {
    terminal: bool,
    stage: Mutex<Option<Stage>>,
}

struct Stage {
    bar: ProgressBar,
    began: Instant,
    shown: bool,
}

impl Bars {
    pub fn new() -> Self {
        Self {
            terminal: std::io::stderr().is_terminal(),
            stage: Mutex::new(None),
        }
    }

    fn stage(&self) -> std::sync::MutexGuard<'_, Option<Stage>> {
        self.stage.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Progress for Bars {
    fn begin(&self, name: &str, total: u64) {
        if !self.terminal {
            return;
        }
        let bar = if total == UNKNOWN_TOTAL {
            spinner()
        } else {
            counting_bar(total)
        };
        bar.set_message(name.to_owned());
        *self.stage() = Some(Stage {
            bar,
            began: Instant::now(),
            shown: false,
        });
    }

    fn advance(&self, units: u64) {
        if !self.terminal {
            return;
        }
        if let Some(stage) = self.stage().as_mut() {
            if !stage.shown && stage.began.elapsed() > SHORT {
                stage.bar.set_draw_target(ProgressDrawTarget::stderr());
                stage.shown = true;
            }
            stage.bar.inc(units);
        }
    }

    fn end(&self) {
        if let Some(stage) = self.stage().take() {
            stage.bar.finish_and_clear();
        }
    }
}

fn counting_bar(total: u64) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden());
    let style = ProgressStyle::with_template("{msg:>12} [{bar:40}] {percent:>3}% {eta}");
    if let Ok(style) = style {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}

/// Turns by itself: nothing advances it.
fn spinner() -> ProgressBar {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{msg:>12} {spinner} {elapsed}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(TICK);
    bar
}

/// Work that failed leaves no bar behind.
impl Drop for Bars {
    fn drop(&mut self) {
        self.end();
    }
}
