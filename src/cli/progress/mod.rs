//! How far long work is, on stderr: bars on a terminal, else a line every few seconds.

mod bars;
mod lines;

use std::io::IsTerminal;
use std::sync::{Arc, Mutex, PoisonError, Weak};

use crate::progress::Progress;
use bars::TerminalBars;
use lines::Lines;

use super::terminal::is_quiet;

/// Shows the stages of a job, one within another, in the form that stderr takes. All that are alive at a
/// time are one: what the device reports lies within what the command does.
pub struct Bars(Arc<Form>);

enum Form {
    Terminal(TerminalBars),
    /// A pipe or a file; also where only errors are printed, since messages are not.
    Lines(Lines),
}

/// The most units of a stage that are counted; with more of them the share is shown.
const COUNTED: u64 = 99;

/// The ones that are alive.
static SHOWN: Mutex<Weak<Form>> = Mutex::new(Weak::new());

impl Bars {
    pub fn new() -> Self {
        let mut shown = SHOWN.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(form) = shown.upgrade() {
            return Self(form);
        }
        let form = Arc::new(match std::io::stderr().is_terminal() && !is_quiet() {
            true => Form::Terminal(TerminalBars::new()),
            false => Form::Lines(Lines::to_stderr()),
        });
        *shown = Arc::downgrade(&form);
        Self(form)
    }

    fn shown(&self) -> &dyn Progress {
        match &*self.0 {
            Form::Terminal(bars) => bars,
            Form::Lines(lines) => lines,
        }
    }
}

impl Progress for Bars {
    fn begin(&self, name: &str, total: u64) {
        self.shown().begin(name, total);
    }

    fn advance(&self, units: u64) {
        self.shown().advance(units);
    }

    fn end(&self) {
        self.shown().end();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_that_are_alive_at_a_time_are_one() {
        let (command, device) = (Bars::new(), Bars::new());
        assert!(Arc::ptr_eq(&command.0, &device.0));
        let first = Arc::downgrade(&command.0);
        drop((command, device));
        assert!(first.upgrade().is_none());
    }
}
