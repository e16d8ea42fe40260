//! What is recorded of each frame of an orbit, for its statistics.

use crate::frame::Frame;
use crate::lab::measure::Counts;
use crate::render::GradientFigures;
use crate::scene::Picture;

use super::super::backend::Rendered;
use super::super::stats::{PassStats, Times};
use super::plan::Plan;

/// The record of a frame.
pub struct FrameRecord {
    pub times_ms: Times,
    pub passes: Vec<PassStats>,
    /// The counters, where statistics are wanted.
    pub counts: Option<Counts>,
    pub gradients: Option<GradientFigures>,
    pub device_bytes: u64,
    pub uploaded_bytes: u64,
}

impl FrameRecord {
    /// The record, and the frame itself.
    pub fn of(rendered: Rendered, picture: &Picture, plan: &Plan) -> (Self, Frame) {
        let counted = plan.stats.as_ref();
        let rays = rendered.rays();
        let record = Self {
            times_ms: rendered.times_ms,
            passes: rendered.passes,
            counts: counted.map(|_| Counts::of(&rendered.frame, picture, rays)),
            gradients: rendered.gradients,
            device_bytes: rendered.device_bytes,
            uploaded_bytes: rendered.uploaded_bytes,
        };
        (record, rendered.frame)
    }
}
