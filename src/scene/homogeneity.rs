//! When a finest octree node counts as homogeneous, so that it is integrated in one step.

use super::HomogeneityLimit;

/// The quantity that `--homogeneity E` limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum HomogeneityRule {
    /// The error of a pixel: a node counts when no ray can lose more than E, in any channel of its
    /// premultiplied linear light or in its opacity, by taking all such nodes for their averages.
    #[default]
    Optical,
    /// The node's value range: maximum − minimum < E times the volume's range (Lesar et al. 2015,
    /// §III-E). A transfer function that changes much within it makes any error possible.
    Range,
}

/// Nodes taken for their average value, in one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Homogeneity {
    /// The quantity that is limited.
    pub rule: HomogeneityRule,
    /// E: the limit of the error, or of the range.
    pub limit: HomogeneityLimit,
}
