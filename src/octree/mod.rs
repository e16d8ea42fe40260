//! The implicit, full octree over a volume's cells: minimum, maximum and average of every node.
//!
//! After Lesar et al. 2015, §III-C, without padding to powers of two: a level's size is the number
//! of cells divided by the node's edge, rounded up. A node's range takes in every voxel that its
//! cells touch, the one-voxel border shared with its neighbours included (Scharsach 2005, §3), so
//! that it bounds every interpolated value inside the node's closed box.

mod build;

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result};

/// The edge of a finest node in cells: 4 to 32, 4 unless chosen: ray packets skip more than with the 8 of
/// Lesar et al. 2015 (level 3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Leaf(u32);

impl Leaf {
    /// The possible edges, in cells.
    pub const ALLOWED: std::ops::RangeInclusive<u32> = 4..=32;

    /// Makes a leaf of this edge, in cells.
    ///
    /// # Errors
    /// An edge outside [`Leaf::ALLOWED`].
    pub fn new(edge: u32) -> Result<Self> {
        if Self::ALLOWED.contains(&edge) {
            Ok(Self(edge))
        } else {
            Err(Error::usage(format!(
                "an octree leaf of {edge} cells: the edge must be {} to {}",
                Self::ALLOWED.start(),
                Self::ALLOWED.end()
            )))
        }
    }

    /// The number of cells along an edge.
    pub fn edge(self) -> u32 {
        self.0
    }
}

impl Default for Leaf {
    fn default() -> Self {
        Self(4)
    }
}

impl FromStr for Leaf {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        text.parse().map_or_else(
            |_| {
                Err(Error::usage(format!(
                    "'{text}' is not an octree leaf edge: write a number of cells from 4 to 32"
                )))
            },
            Self::new,
        )
    }
}

impl fmt::Display for Leaf {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// One level of nodes. Level l's nodes have an edge of `leaf << l` cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Level {
    /// Nodes along x, y, z.
    pub size: [u32; 3],
    /// The index of the level's first node in the tree's arrays; nodes follow x fastest.
    pub offset: u32,
}

impl Level {
    /// The number of nodes of the level.
    pub fn nodes(&self) -> usize {
        self.size.iter().map(|&n| n as usize).product()
    }
}

/// The nodes of all levels, leaves first, the single root last. Values are stored values (before
/// the volume's calibration), which single precision holds exactly.
#[derive(Debug)]
pub struct Octree {
    leaf: Leaf,
    levels: Vec<Level>,
    ranges: Vec<[f32; 2]>,
    averages: Vec<f32>,
}

impl Octree {
    /// The edge of the finest nodes.
    pub fn leaf(&self) -> Leaf {
        self.leaf
    }

    /// The levels, leaves first, the single root last.
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// The minimum and the maximum over every voxel that a node's cells touch, for each node.
    pub fn ranges(&self) -> &[[f32; 2]] {
        &self.ranges
    }

    /// The mean of each node's own voxels: those at its cells' lower corners, and at the volume's upper
    /// faces for the nodes that touch them. Every voxel belongs to exactly one leaf.
    pub fn averages(&self) -> &[f32] {
        &self.averages
    }

    /// The size of all nodes' minima, maxima and averages, in bytes.
    pub fn bytes(&self) -> u64 {
        (size_of_val(&*self.ranges) + size_of_val(&*self.averages)) as u64
    }
}
