//! How far around each leaf nothing else begins: a Chebyshev distance map over the leaves (Deakin and
//! Knackstedt 2019), in the upper bits of their bytes.

use crate::error::Result;
use crate::memory;
use crate::octree::{Level, Octree};
use crate::render::abi::{CLASS_BITS, Class, MAX_DISTANCE};

/// Adds to the byte of every leaf that can be leapt over its distance: so many leaves around it, in
/// every direction, diagonals included, are of its class too.
///
/// A leaf below the iso value never borders on one above it: their ranges share the voxels between
/// them. So the distance to the nearest leaf that cannot be leapt over bounds both.
///
/// # Errors
/// Not enough memory.
pub fn add_distances(octree: &Octree, classes: &mut [u8]) -> Result<()> {
    let leaves = octree.levels()[0];
    let leap = |class: u8| class == Class::Below as u8 || class == Class::Above as u8;
    let own = &mut classes[..leaves.nodes()];
    // Of the leaves that can be leapt over, eroded layer by layer, every layer that is left is one
    // more of distance.
    let mut left: Vec<u8> = memory::room(own.len(), "the leaves' distances")?;
    left.extend(own.iter().map(|&class| u8::from(leap(class))));
    let mut before = memory::filled(own.len(), 0, "the leaves' distances")?;
    for _ in 0..MAX_DISTANCE {
        erode(leaves, &mut left, &mut before);
        if left.iter().all(|&leaf| leaf == 0) {
            break;
        }
        for (byte, &leaf) in own.iter_mut().zip(&left) {
            *byte += leaf << CLASS_BITS;
        }
    }
    Ok(())
}

/// Keeps a leaf (1) only where all its neighbours are there; what is outside the volume is. `before` is as
/// long as `left`, whatever is in it.
fn erode(leaves: Level, left: &mut [u8], before: &mut [u8]) {
    let [nx, ny, _] = leaves.size.map(|n| n as usize);
    // Along x, within rows; along y, rows of a slice; along z, slices.
    for (run, stride) in [(nx, 1), (nx * ny, nx), (left.len(), nx * ny)] {
        before.copy_from_slice(left);
        for (left, before) in left.chunks_exact_mut(run).zip(before.chunks_exact(run)) {
            let neighbours = |left: &mut [u8], other: &[u8]| {
                for (leaf, &neighbour) in left.iter_mut().zip(other) {
                    *leaf &= neighbour;
                }
            };
            neighbours(&mut left[stride..], before);
            neighbours(left, &before[stride..]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::extent::Dims;
    use crate::octree::Leaf;
    use crate::progress::Silent;
    use crate::volume::{Geometry, NonFinite, Rescale, Volume, Voxels};

    fn octree(dims: [u64; 3]) -> Octree {
        let dims = Dims::new(dims).unwrap();
        let voxels = Voxels::from(vec![0u8; dims.voxels() as usize]);
        let (geometry, rescale) = (Geometry::default(), Rescale::IDENTITY);
        let volume = Volume::new(dims, voxels, geometry, rescale, NonFinite::Refuse).unwrap();
        Octree::build(&volume, Leaf::new(4).unwrap(), &Silent).unwrap()
    }

    /// Compares with the definition, leaf by leaf; returns how many leaves have a distance.
    fn check(dims: [u64; 3], visit: impl Fn(usize) -> bool) -> usize {
        let octree = octree(dims);
        let leaves = octree.levels()[0];
        let class = |i: usize| if visit(i) { Class::Visit } else { Class::Below };
        let all: usize = octree.levels().iter().map(Level::nodes).sum();
        let mut classes: Vec<u8> = (0..all).map(|i| class(i) as u8).collect();
        let before = classes.clone();
        add_distances(&octree, &mut classes).unwrap();
        assert_eq!(classes[leaves.nodes()..], before[leaves.nodes()..]);
        let [nx, ny, _] = leaves.size.map(|n| n as usize);
        let place = |i: usize| [i % nx, i / nx % ny, i / (nx * ny)];
        let apart = |a: usize, b: usize| {
            let (a, b) = (place(a), place(b));
            (0..3).map(|k| a[k].abs_diff(b[k])).max().unwrap()
        };
        let mut distant = 0;
        for i in 0..leaves.nodes() {
            let nearest = (0..leaves.nodes())
                .filter(|&j| visit(j))
                .map(|j| apart(i, j))
                .min();
            let distance = nearest.unwrap_or(usize::MAX).saturating_sub(1);
            let expected = if visit(i) {
                0
            } else {
                distance.min(MAX_DISTANCE as usize)
            };
            assert_eq!(usize::from(classes[i] >> CLASS_BITS), expected, "leaf {i}");
            assert_eq!(classes[i] & 3, before[i]);
            distant += usize::from(expected > 0);
        }
        distant
    }

    #[test]
    fn distances_are_chessboard_distances_less_one() {
        for seed in 0..40_usize {
            let lone = |i: usize| (i + seed * 7).is_multiple_of(61);
            assert!(check([29, 33, 21], lone) > 0);
            assert!(check([5, 60, 9], |i| i == seed % 20) > 0);
        }
        assert_eq!(check([9, 9, 9], |_| true), 0);
        assert!(check([300, 5, 5], |i| i == 0) > 60);
        assert!(check([13, 13, 13], |_| false) > 0);
    }
}
