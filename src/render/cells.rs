//! Which cells a ray must look at: a bit each, once per iso value or transfer function.

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use crate::octree::Octree;
use crate::volume::{Volume, Voxel};
use crate::with_voxels;

use super::classify::Class;
use super::medium::Knots;
use super::ranges::ValueRanges;

/// The cells whose corners lie on both sides of `iso` (stored units), or so near to it that `iso_error`
/// leaves their side uncertain. `classes` are those of the octree's nodes.
pub fn crossed(
    volume: &Volume,
    octree: &Octree,
    classes: &[u8],
    iso: f32,
    iso_error: f32,
) -> Vec<u32> {
    visited(volume, octree, classes, |range| {
        may_cross(range, iso, iso_error)
    })
}

/// The cells in which some value absorbs light. `classes` are those of the octree's nodes.
pub fn absorbing(volume: &Volume, octree: &Octree, classes: &[u8], knots: &Knots) -> Vec<u32> {
    let ranges = ValueRanges::new(knots);
    visited(volume, octree, classes, |[least, most]| {
        !ranges.is_transparent(least, most)
    })
}

/// A bit per cell, x fastest, the lowest bit of a word first: whether the range of its corners matters.
/// Only leaves of [`Class::Visit`] hold such cells.
fn visited(
    volume: &Volume,
    octree: &Octree,
    classes: &[u8],
    matters: impl Fn([f32; 2]) -> bool + Sync,
) -> Vec<u32> {
    let cells = volume.dims().cells().map(|n| n as usize);
    let count: usize = cells.iter().product();
    let words: Vec<AtomicU32> = (0..count.div_ceil(32)).map(|_| AtomicU32::new(0)).collect();
    let leaf = octree.leaf().edge() as usize;
    let leaves = octree.levels()[0];
    let [leaves_x, leaves_y, _] = leaves.size.map(|n| n as usize);
    with_voxels!(volume.voxels(), voxels => {
        (0..leaves.nodes()).into_par_iter().for_each(|node| {
            if classes[node] != Class::Visit as u8 {
                return;
            }
            let first = [
                node % leaves_x * leaf,
                node / leaves_x % leaves_y * leaf,
                node / (leaves_x * leaves_y) * leaf,
            ];
            let [x, y, z] = [0, 1, 2].map(|axis| first[axis]..(first[axis] + leaf).min(cells[axis]));
            for z in z {
                for y in y.clone() {
                    for x in x.clone() {
                        if matters(range_of(voxels, volume, [x, y, z])) {
                            let cell = (z * cells[1] + y) * cells[0] + x;
                            words[cell / 32].fetch_or(1 << (cell % 32), Ordering::Relaxed);
                        }
                    }
                }
            }
        });
    });
    words.into_iter().map(AtomicU32::into_inner).collect()
}

/// The least and the greatest voxel at a cell's corners.
fn range_of<T: Voxel>(voxels: &[T], volume: &Volume, [x, y, z]: [usize; 3]) -> [f32; 2] {
    let [nx, ny, nz] = volume.dims().array().map(|n| n as usize);
    let (mut least, mut most) = (f32::INFINITY, f32::NEG_INFINITY);
    for z in z..(z + 2).min(nz) {
        for y in y..(y + 2).min(ny) {
            for x in x..(x + 2).min(nx) {
                let value: f64 = voxels[(z * ny + y) * nx + x].into();
                least = least.min(value as f32);
                most = most.max(value as f32);
            }
        }
    }
    [least, most]
}

/// As the kernels tell a cell's side: heights are single-precision differences.
fn may_cross([least, most]: [f32; 2], iso: f32, iso_error: f32) -> bool {
    let above = least - iso >= iso_error;
    let below = most - iso < -iso_error;
    !(above || below)
}
