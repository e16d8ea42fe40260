//! The experiments, a file each.

mod b1;
mod b10;
mod b13;
mod b15;
mod b16;
mod b17;
mod b18;
mod b2;
mod b3;
mod b8;
mod b9;
mod convergence;
mod gradients;
mod pareto;
mod rays;
mod speed;
mod tolerance;
mod traversals;
mod vessels;

use super::Experiment;

/// In the order in which they are listed.
pub const EXPERIMENTS: &[Experiment] = &[
    vessels::EXPERIMENT,
    pareto::EXPERIMENT,
    speed::EXPERIMENT,
    traversals::EXPERIMENT,
    convergence::EXPERIMENT,
    rays::EXPERIMENT,
    gradients::EXPERIMENT,
    tolerance::EXPERIMENT,
    b1::EXPERIMENT,
    b2::EXPERIMENT,
    b3::EXPERIMENT,
    b8::EXPERIMENT,
    b9::EXPERIMENT,
    b10::EXPERIMENT,
    b13::EXPERIMENT,
    b15::EXPERIMENT,
    b16::EXPERIMENT,
    b17::EXPERIMENT,
    b18::EXPERIMENT,
];
