//! The experiments, a file each.

mod gradients;
mod rays;
mod traversals;
mod vessels;

use super::Experiment;

/// In the order in which they are listed.
pub const EXPERIMENTS: &[Experiment] = &[
    vessels::EXPERIMENT,
    traversals::EXPERIMENT,
    rays::EXPERIMENT,
    gradients::EXPERIMENT,
];
