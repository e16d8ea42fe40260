//! How far long work is: bars on a terminal's stderr, and a line every few seconds where stderr is none.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::progress::{Progress, UNKNOWN_TOTAL};

use super::terminal::message;

/// Work shorter than this shows no bar.
const SHORT: Duration = Duration::from_millis(400);

/// How often bars are drawn.
const TICK: Duration = Duration::from_millis(150);

/// From line to line where there is no terminal.
const LINES: Duration = Duration::from_secs(5);

/// Of more units than these the share is said, not the number.
const COUNTED: u64 = 9999;

/// The stages at work, the innermost last, whoever began them: there is one terminal.
static STAGES: Mutex<Stages> = Mutex::new(Stages {
    stages: Vec::new(),
    is_watched: false,
});

struct Stages {
    stages: Vec<Stage>,
    /// Whether a thread draws them.
    is_watched: bool,
}

fn stages() -> MutexGuard<'static, Stages> {
    STAGES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Shows the innermost stage: on a terminal as a bar, else by lines.
pub struct Bars {
    terminal: bool,
    /// What is begun and not ended here, as places in [`NEXT`]'s count.
    begun: Mutex<Vec<u64>>,
}

static NEXT: AtomicU64 = AtomicU64::new(0);

struct Stage {
    id: u64,
    name: String,
    total: u64,
    done: u64,
    began: Instant,
    /// Lines that were said.
    lines: u32,
    terminal: bool,
    /// On the terminal now.
    bar: Option<ProgressBar>,
}

impl Bars {
    pub fn new() -> Self {
        Self {
            terminal: std::io::stderr().is_terminal(),
            begun: Mutex::default(),
        }
    }

    fn begun(&self) -> MutexGuard<'_, Vec<u64>> {
        self.begun.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Progress for Bars {
    fn begin(&self, name: &str, total: u64) {
        let id = NEXT.fetch_add(1, Ordering::Relaxed);
        let mut all = stages();
        all.hide();
        all.stages.push(Stage {
            id,
            name: name.to_owned(),
            total,
            done: 0,
            began: Instant::now(),
            lines: 0,
            terminal: self.terminal,
            bar: None,
        });
        if !all.is_watched {
            all.is_watched = true;
            std::thread::spawn(watch);
        }
        drop(all);
        self.begun().push(id);
    }

    fn advance(&self, units: u64) {
        let Some(&id) = self.begun().last() else {
            return;
        };
        let mut all = stages();
        if let Some(stage) = all.stages.iter_mut().find(|stage| stage.id == id) {
            stage.done += units;
        }
    }

    fn end(&self) {
        let Some(id) = self.begun().pop() else {
            return;
        };
        let mut all = stages();
        all.hide();
        all.stages.retain(|stage| stage.id != id);
    }
}

impl Stages {
    /// Takes the innermost bar off the terminal: another follows, or its work is over.
    fn hide(&mut self) {
        if let Some(bar) = self.stages.last_mut().and_then(|stage| stage.bar.take()) {
            bar.finish_and_clear();
        }
    }
}

/// Shows stages for as long as there are any.
fn watch() {
    loop {
        std::thread::sleep(TICK);
        let mut all = stages();
        match all.stages.last_mut() {
            Some(stage) => stage.show(),
            None => {
                all.is_watched = false;
                return;
            }
        }
    }
}

impl Stage {
    fn show(&mut self) {
        let elapsed = self.began.elapsed();
        if !self.terminal {
            if let Some(line) = self.line_due(elapsed) {
                message(line);
            }
        } else if elapsed > SHORT {
            let new = || shown_bar(&self.name, self.total, elapsed);
            let bar = self.bar.get_or_insert_with(new);
            bar.set_position(self.done);
            bar.tick();
        }
    }

    /// What is said where there is no terminal, a line every [`LINES`].
    fn line_due(&mut self, elapsed: Duration) -> Option<String> {
        if elapsed < LINES * (self.lines + 1) {
            return None;
        }
        self.lines = (elapsed.as_secs() / LINES.as_secs()) as u32;
        let seconds = elapsed.as_secs();
        let (name, total, done) = (&self.name, self.total, self.done.min(self.total));
        Some(match total {
            UNKNOWN_TOTAL => format!("{name}: {seconds} s"),
            1..=COUNTED => format!("{name}: {done} of {total}, {seconds} s"),
            _ => {
                let percent = 100.0 * done as f64 / total as f64;
                format!("{name}: {percent:.0} %, {seconds} s")
            }
        })
    }
}

/// A bar of a stage that began so long ago.
fn shown_bar(name: &str, total: u64, elapsed: Duration) -> ProgressBar {
    let (length, template) = match total {
        UNKNOWN_TOTAL => (None, "{msg:>12} {spinner} {elapsed}"),
        1..=COUNTED => (
            Some(total),
            "{msg:>12} [{bar:40}] {pos} of {len} {spinner} {elapsed}",
        ),
        _ => (Some(total), "{msg:>12} [{bar:40}] {percent:>3}% {eta}"),
    };
    let bar = ProgressBar::with_draw_target(length, ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.with_message(name.to_owned()).with_elapsed(elapsed)
}

/// Work that failed leaves no bar behind.
impl Drop for Bars {
    fn drop(&mut self) {
        while !self.begun().is_empty() {
            self.end();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stage(total: u64, done: u64) -> Stage {
        Stage {
            id: 0,
            name: "building kernels".into(),
            total,
            done,
            began: Instant::now(),
            lines: 0,
            terminal: false,
            bar: None,
        }
    }

    #[test]
    fn without_a_terminal_a_line_is_said_every_few_seconds() {
        let mut kernels = stage(5, 2);
        let mut at = |seconds| kernels.line_due(Duration::from_secs_f64(seconds));
        assert_eq!(at(4.9), None);
        assert_eq!(at(5.1).unwrap(), "building kernels: 2 of 5, 5 s");
        assert_eq!(at(5.2), None);
        assert_eq!(at(9.9), None);
        // Lines that were missed are not made up for.
        assert_eq!(at(21.0).unwrap(), "building kernels: 2 of 5, 21 s");
        assert_eq!(at(24.9), None);
        assert!(at(25.0).is_some());
    }

    #[test]
    fn large_totals_are_shares_and_unknown_ones_times() {
        let line = |total, done| stage(total, done).line_due(Duration::from_secs(7)).unwrap();
        assert_eq!(line(1 << 20, 1 << 19), "building kernels: 50 %, 7 s");
        assert_eq!(line(UNKNOWN_TOTAL, 3), "building kernels: 7 s");
        assert_eq!(line(5, 9), "building kernels: 5 of 5, 7 s");
    }

    #[test]
    fn a_stage_within_another_is_shown_in_its_place() {
        let shown = || stages().stages.last().map(|stage| (stage.name.clone(), stage.done));
        let (outer, inner) = (Bars::new(), Bars::new());
        outer.begin("outer stage", 10);
        inner.begin("inner stage", 3);
        inner.advance(2);
        outer.advance(4);
        assert_eq!(shown(), Some(("inner stage".to_owned(), 2)));
        inner.end();
        assert_eq!(shown(), Some(("outer stage".to_owned(), 4)));
        // What failed ends its stages.
        inner.begin("inner stage", 3);
        drop(inner);
        assert_eq!(shown(), Some(("outer stage".to_owned(), 4)));
        outer.end();
    }
}
