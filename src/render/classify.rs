//! What is known of each octree node before a ray meets it: once per iso value or transfer function.

use rayon::prelude::*;

use crate::error::Result;
use crate::memory;
use crate::octree::Octree;

use super::homogeneity::Limit;
use super::medium::Knots;
use super::ranges::ValueRanges;

/// A node's class, as the kernels read it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Class {
    /// Nothing to see: wholly below the iso value, nowhere above the floor, or wholly transparent.
    Below = 0,
    /// Wholly at or above the iso value.
    Above = 1,
    /// Must be sampled.
    Visit = 2,
    /// A leaf that its average value stands for.
    Homogeneous = 3,
}

/// Classes of all nodes against an iso value in stored units; inside is Φ ≥ iso. Where the value
/// that was asked for lies `iso_error` beside it, a node that reaches down to it is visited: on which
/// side of the other it lies is uncertain.
///
/// # Errors
/// Not enough memory.
pub fn by_iso(octree: &Octree, iso: f32, iso_error: f32) -> Result<Vec<u8>> {
    classes(octree, |_, [min, max]| {
        if max < iso {
            Class::Below
        } else if min > iso || (min == iso && iso_error == 0.0) {
            Class::Above
        } else {
            Class::Visit
        }
    })
}

/// Classes of all nodes against a floor in stored units, of sign · Φ: `Below` where nothing is above
/// it.
///
/// # Errors
/// Not enough memory.
pub fn by_floor(octree: &Octree, sign: f32, floor: f32) -> Result<Vec<u8>> {
    classes(octree, |_, [min, max]| {
        if f32::max(sign * min, sign * max) <= floor {
            Class::Below
        } else {
            Class::Visit
        }
    })
}

/// Classes of all nodes under a transfer function: `Below` where every value of the node's range
/// is fully transparent and `skip` allows it; `Homogeneous` for leaves within `limit`.
///
/// # Errors
/// Not enough memory.
pub fn by_opacity(
    octree: &Octree,
    knots: &Knots,
    skip: bool,
    limit: Option<Limit>,
) -> Result<Vec<u8>> {
    let ranges = ValueRanges::new(knots);
    let leaves = octree.levels()[0].nodes();
    classes(octree, |node, [min, max]| {
        if skip && ranges.is_transparent(min, max) {
            return Class::Below;
        }
        match limit {
            Some(limit) if node < leaves && limit.holds(&ranges, min, max) => Class::Homogeneous,
            _ => Class::Visit,
        }
    })
}

fn classes(
    octree: &Octree,
    class: impl Fn(usize, [f32; 2]) -> Class + Sync + Send,
) -> Result<Vec<u8>> {
    let nodes = octree.ranges().par_iter().enumerate();
    let classes = nodes.map(|(node, &range)| class(node, range) as u8);
    memory::collected(classes, "the octree's classes")
}
