//! One setting in one scene, measured: its error against the reference, its time beside that of
//! others; and another program, measured as a setting is.

mod banding;
mod borderline;
mod bound_reached;
mod counts;
mod evaluation;
mod hit_verdict;
mod interleaved;
mod memory;
mod method_label;
mod pareto;
mod peer;
mod processor;
mod program;
mod ranking;
mod reference_cache;
mod sampling_check;
mod settings;

pub use banding::Banding;
pub use borderline::{Borderline, Closeness, excuse_dips};
pub use bound_reached::BoundReached;
pub use counts::Counts;
pub use evaluation::{
    Evaluation, FrameTime, error_scale, evaluate, evaluate_pixels, evaluated_planes, time,
};
pub use hit_verdict::{Answer, HitChecker, HitVerdict};
pub use interleaved::{Times, interleaved, rounds};
pub use memory::host_peak_bytes;
pub use method_label::method_label;
pub use pareto::{TIME_NOISE, Tradeoff, front};
pub use peer::{Peer, PeerFrame, PeerScene, PeerTime, Readiness};
pub use program::{hash_kernels, hash_program};
pub use ranking::RankingMetric;
pub use reference_cache::{ReferenceCache, ReferenceFrame};
pub use sampling_check::SamplingCheck;
pub use settings::{accurate, built_in, grid};
