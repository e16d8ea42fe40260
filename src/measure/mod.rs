//! One setting in one scene, measured: its error against the reference, its time beside those of
//! its rivals.

mod interleaved;

pub use interleaved::{Times, interleaved};
