//! The experiments, a file each.

mod traversals;
mod vessels;

use super::Experiment;

/// In the order in which they are listed.
pub const EXPERIMENTS: &[Experiment] = &[vessels::EXPERIMENT, traversals::EXPERIMENT];
