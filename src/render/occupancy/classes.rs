//! The classes of the octree's nodes: once per iso value, floor or transfer function.

use rayon::prelude::*;

use crate::error::Result;
use crate::memory;
use crate::octree::Octree;
use crate::render::abi::{Class, StoredIso};
use crate::render::resources::Knots;

use super::floor::Floor;
use super::homogeneity::Limit;
use super::opacity_ranges::OpacityRanges;

/// Classes of all nodes against an iso value; inside is Φ ≥ iso. Where the scene's own iso value lies
/// beside the device's, a node whose range ends at the device's is visited: on which side of the scene's
/// it lies is uncertain.
///
/// # Errors
/// Not enough memory.
pub fn by_iso(octree: &Octree, iso: StoredIso) -> Result<Vec<u8>> {
    let StoredIso { value: iso, error } = iso;
    classes(octree, |_, [min, max]| {
        if max < iso {
            Class::Below
        } else if min > iso || (min == iso && error == 0.0) {
            Class::Above
        } else {
            Class::Visit
        }
    })
}

/// Classes of all nodes against a floor: `Below` where nothing is above it.
///
/// # Errors
/// Not enough memory.
pub fn by_floor(octree: &Octree, floor: Floor) -> Result<Vec<u8>> {
    let Floor { sign, floor } = floor;
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
    let ranges = OpacityRanges::new(knots);
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
