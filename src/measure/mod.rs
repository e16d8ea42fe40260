//! One setting in one scene, measured: its error against the reference, its time beside those of
//! its rivals.

mod interleaved;
mod pareto;
mod settings;
mod truth;

pub use interleaved::{Times, interleaved};
pub use pareto::{TIME_NOISE, Tradeoff, front};
pub use settings::{built_in, grid};
pub use truth::{TrueFrame, Truth};
