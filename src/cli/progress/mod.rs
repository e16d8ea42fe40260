//! How far long work is, on stderr: bars on a terminal, else a line every few seconds.

mod bars;
mod lines;

use std::io::IsTerminal;

use crate::progress::Progress;
use bars::TerminalBars;
use lines::Lines;

use super::terminal::is_quiet;

/// Shows the stages of a job, one within another, in the form that stderr takes.
pub struct Bars(Form);

enum Form {
    Terminal(TerminalBars),
    /// A pipe or a file; and where nothing but errors is said, since messages are not.
    Lines(Lines),
}

impl Bars {
    pub fn new() -> Self {
        Self(match std::io::stderr().is_terminal() && !is_quiet() {
            true => Form::Terminal(TerminalBars::new()),
            false => Form::Lines(Lines::to_stderr()),
        })
    }

    fn shown(&self) -> &dyn Progress {
        match &self.0 {
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
