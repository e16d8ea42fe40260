//! One setting in one scene, measured: its error against the reference, its time beside those of
//! its rivals; and a rival that is another program.

mod counts;
mod family;
mod interleaved;
mod judged;
mod memory;
mod pareto;
mod peer;
mod processor;
mod program;
mod settings;
mod truth;
mod wrongness;

pub use counts::Counts;
pub use family::family;
pub use interleaved::{Times, interleaved, rounds};
pub use judged::{FrameTime, Judged, judge, judge_pixels, judged_planes, scale_of, time};
pub use memory::host_peak_bytes;
pub use pareto::{TIME_NOISE, Tradeoff, front};
pub use peer::{Peer, PeerFrame, PeerScene, PeerTime, Readiness};
pub use program::{hash_kernels, hash_program};
pub use settings::{built_in, grid};
pub use truth::{TrueFrame, Truth};
pub use wrongness::Wrongness;
