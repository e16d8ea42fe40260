//! Wrong changes on purpose.

use angioray::scene::Scene;
use angioray::volume::Volume;

pub use crate::mutated::{CAUGHT, assert_caught, is_mutant};

/// A change that a case must catch.
pub enum Mutant {
    /// In a kernel file: each text must be there exactly once, and is replaced by the other.
    Kernel {
        file: &'static str,
        changes: &'static [(&'static str, &'static str)],
    },
    /// In the scene as the device gets it.
    Scene(fn(&mut Scene)),
    /// In the volume as the device gets it.
    Volume(fn(&Volume) -> Volume),
    /// In the volume from which the device's octree is built.
    Octree(fn(&Volume) -> Volume),
}

/// One change in one kernel file.
pub const fn kernel(
    file: &'static str,
    changes: &'static [(&'static str, &'static str)],
) -> Mutant {
    Mutant::Kernel { file, changes }
}

/// Nodes that lie above the iso value taken for ones below it.
pub const NEVER_ABOVE: [(&str, &str); 1] = [(
    "skip.class == CLASS_ABOVE ? FLOATS(1.0f) : FLOATS(-1.0f)",
    "FLOATS(-1.0f)",
)];
