//! How figures were measured, for those who read them later.

use super::{Bench, Protocol};

/// Nothing where there is nothing to say, or where the rows say it, each for itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Conduct {
    /// Width and height of the pictures.
    pub side_px: Option<u32>,
    /// What the camera did while frames were timed.
    pub protocol: Option<Protocol>,
    /// How often each setting was timed.
    pub repeats: Option<usize>,
}

impl Conduct {
    /// Pictures of the effort's size, timed as the user wants.
    pub(super) fn usual(bench: &Bench) -> Self {
        Self {
            side_px: Some(bench.effort.side_px()),
            protocol: Some(bench.protocol()),
            repeats: Some(bench.protocol().frames(bench.effort)),
        }
    }
}
