//! The conditions under which figures were measured, for those who read them later.

use super::{Bench, Protocol};

/// The conditions of an outcome; `None` where there is nothing to say, or where each row says it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Conditions {
    /// Width and height of the pictures.
    pub side_px: Option<u32>,
    /// How the camera moved while frames were timed.
    pub protocol: Option<Protocol>,
    /// How often each setting was timed.
    pub repeats: Option<usize>,
}

impl Conditions {
    /// The usual conditions: pictures of the preset's size, timed as the user wants.
    pub(super) fn usual(bench: &Bench) -> Self {
        Self {
            side_px: Some(bench.preset.side_px()),
            protocol: Some(bench.protocol()),
            repeats: Some(bench.protocol().frames(bench.preset)),
        }
    }
}
