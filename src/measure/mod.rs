//! One setting in one scene, measured: its error against the reference, its time beside those of
//! its rivals; and a rival that is another program.

mod counts;
mod interleaved;
mod pareto;
mod peer;
mod settings;
mod truth;

pub use counts::Counts;
pub use interleaved::{Times, interleaved, rounds};
pub use pareto::{TIME_NOISE, Tradeoff, front};
pub use peer::{Peer, PeerFrame, PeerScene, PeerTime, Readiness};
pub use settings::{built_in, grid};
pub use truth::{TrueFrame, Truth};
