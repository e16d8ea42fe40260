//! One setting in one scene, measured: its error against the reference, its time beside those of
//! its rivals; and a rival that is another program.

mod interleaved;
mod peer;

pub use interleaved::{Times, interleaved};
pub use peer::{Peer, PeerFrame, PeerScene, PeerTime, Readiness};
