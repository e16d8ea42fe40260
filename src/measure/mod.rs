//! One setting in one scene, measured: its error against the reference, its time beside those of
//! its rivals.

mod counts;
mod interleaved;
mod pareto;
mod settings;
mod truth;

pub use counts::Counts;
pub use interleaved::{Times, interleaved, rounds};
pub use pareto::{TIME_NOISE, Tradeoff, front};
pub use settings::{built_in, grid};
pub use truth::{TrueFrame, Truth};
