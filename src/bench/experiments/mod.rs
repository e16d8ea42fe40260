//! The experiments, a file each.

mod convergence;
mod gradients;
mod rays;
mod tolerance;
mod traversals;
mod vessels;

use super::Experiment;

/// In the order in which they are listed.
pub const EXPERIMENTS: &[Experiment] = &[
    vessels::EXPERIMENT,
    traversals::EXPERIMENT,
    convergence::EXPERIMENT,
    rays::EXPERIMENT,
    gradients::EXPERIMENT,
    tolerance::EXPERIMENT,
];
