//! Progress in a pipe or a file: a line every few seconds that says what is being done.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use super::super::terminal::message;
use super::COUNTED;
use crate::progress::{Progress, UNKNOWN_TOTAL};

/// Time between two lines, and before the first.
const PAUSE: Duration = Duration::from_secs(5);

/// Writes lines from a thread of its own, so that work which says nothing for long is not silent.
pub struct Lines {
    shared: Arc<Shared>,
    writer: Option<JoinHandle<()>>,
}

struct Shared {
    state: Mutex<State>,
    /// The first stage has begun, or all work is over.
    changed: Condvar,
}

struct State {
    /// The stages in work, the outermost first.
    stages: Vec<Stage>,
    /// When the last line was written; before the first, when there was something to say.
    last: Option<Instant>,
    over: bool,
}

struct Stage {
    name: String,
    began: Instant,
    done: u64,
    total: u64,
}

impl Lines {
    pub fn to_stderr() -> Self {
        Self::every(PAUSE, message)
    }

    fn every(pause: Duration, write: impl Fn(String) + Send + 'static) -> Self {
        let shared = Arc::new(Shared {
            state: Mutex::new(State {
                stages: Vec::new(),
                last: None,
                over: false,
            }),
            changed: Condvar::new(),
        });
        let watched = Arc::clone(&shared);
        let writer = thread::Builder::new().name("progress".into());
        Self {
            shared,
            // Where no thread can be had the work is done without.
            writer: writer.spawn(move || watched.report(pause, write)).ok(),
        }
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes lines until all is over.
    fn report(&self, pause: Duration, write: impl Fn(String)) {
        let mut state = self.lock();
        while !state.over {
            let idle = state.stages.is_empty();
            let last = *state.last.get_or_insert_with(Instant::now);
            let left = pause.saturating_sub(last.elapsed());
            if left.is_zero() && !idle {
                let line = state.line();
                state.last = Some(Instant::now());
                drop(state);
                write(line);
                state = self.lock();
                continue;
            }
            let wait = if idle { pause } else { left };
            let waited = self.changed.wait_timeout(state, wait);
            (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        }
    }
}

impl State {
    /// All stages, the outermost first: `iso: timing 45 %, building kernels 2 of 5`.
    fn line(&self) -> String {
        let stages: Vec<String> = self.stages.iter().map(Stage::text).collect();
        stages.join(", ")
    }
}

impl Stage {
    fn text(&self) -> String {
        if self.total == UNKNOWN_TOTAL {
            return format!("{} {} s", self.name, self.began.elapsed().as_secs());
        }
        if self.total <= COUNTED {
            let done = self.done.min(self.total);
            return format!("{} {done} of {}", self.name, self.total);
        }
        // In 128 bits, where no product of two totals overflows.
        let percent = 100 * u128::from(self.done.min(self.total)) / u128::from(self.total);
        format!("{} {percent} %", self.name)
    }
}

impl Progress for Lines {
    fn begin(&self, name: &str, total: u64) {
        let mut state = self.shared.lock();
        state.stages.push(Stage {
            name: name.to_owned(),
            began: Instant::now(),
            done: 0,
            total,
        });
        if state.stages.len() == 1 {
            self.shared.changed.notify_all();
        }
    }

    fn advance(&self, units: u64) {
        if let Some(stage) = self.shared.lock().stages.last_mut() {
            stage.done = stage.done.saturating_add(units);
        }
    }

    fn end(&self) {
        self.shared.lock().stages.pop();
    }
}

impl Drop for Lines {
    fn drop(&mut self) {
        self.shared.lock().over = true;
        self.shared.changed.notify_all();
        if let Some(writer) = self.writer.take() {
            // It only writes lines; one that it could not write does not matter.
            let _ = writer.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, channel};

    use super::*;

    fn lines(pause: Duration) -> (Lines, Receiver<String>) {
        let (writes, written) = channel();
        let lines = Lines::every(pause, move |line| {
            // Once the test has read what it wanted.
            let _ = writes.send(line);
        });
        (lines, written)
    }

    /// Longer than any test: a line that does not come is a failure, not a hang.
    const PATIENCE: Duration = Duration::from_secs(60);

    #[test]
    fn a_stage_without_progress_is_reported_again_and_again() {
        let (lines, written) = lines(Duration::from_millis(1));
        lines.begin("building kernels", UNKNOWN_TOTAL);
        for _ in 0..3 {
            let line = written.recv_timeout(PATIENCE).unwrap();
            assert!(line.starts_with("building kernels "), "{line}");
            assert!(line.ends_with(" s"), "{line}");
        }
    }

    #[test]
    fn stages_within_stages_are_named_from_outside_in() {
        let (lines, written) = lines(Duration::from_millis(1));
        lines.begin("iso: pictures", 8);
        lines.advance(2);
        lines.begin("reference", 200);
        lines.advance(150);
        let both = "iso: pictures 2 of 8, reference 75 %";
        assert!(written.iter().any(|line| line == both));
        lines.end();
        lines.advance(1);
        assert!(written.iter().any(|line| line == "iso: pictures 3 of 8"));
        // Further than the total there is nothing.
        lines.advance(u64::MAX);
        assert!(written.iter().any(|line| line == "iso: pictures 8 of 8"));
    }

    #[test]
    fn between_stages_and_in_short_ones_nothing_is_printed() {
        let (quick, written) = lines(PATIENCE);
        quick.begin("reading", 5);
        quick.advance(5);
        quick.end();
        // The end does not wait for the pause.
        drop(quick);
        assert_eq!(written.iter().count(), 0);

        let (idle, written) = lines(Duration::from_millis(1));
        idle.begin("a", UNKNOWN_TOTAL);
        written.recv_timeout(PATIENCE).unwrap();
        idle.end();
        // One may have been under way.
        while written.recv_timeout(Duration::from_millis(30)).is_ok() {}
        assert!(written.recv_timeout(Duration::from_millis(30)).is_err());
    }
}
