//! Sequences of frames: which there are, which of them are this process's, which are finished already,
//! and where they go.

mod destination;
mod finished_frames;
mod names;
mod pipelined;
mod shard;

pub use destination::{Destination, Provenance, Shot, Written};
pub use finished_frames::FinishedFrames;
pub use names::FrameNames;
pub use pipelined::pipelined;
pub use shard::{Shard, ShardChoice};
