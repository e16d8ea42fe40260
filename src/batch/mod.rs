//! Frame after frame: which there are, which of them are this process's, which are made already,
//! and where they go.

mod beside;
mod destination;
mod kept_frames;
mod names;
mod shard;

pub use beside::beside;
pub use destination::{Destination, Provenance, Shot, Written};
pub use kept_frames::KeptFrames;
pub use names::FrameNames;
pub use shard::{Shard, ShardChoice};
