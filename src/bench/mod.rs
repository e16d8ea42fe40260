//! Measuring the renderer against the reference, ray by ray.

pub mod aimed;
mod verdict;

pub use verdict::{Judge, Met, Verdict};
