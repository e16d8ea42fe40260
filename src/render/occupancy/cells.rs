//! Which cells a ray must test: a bit each, once per iso value or transfer function.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use crate::error::Result;
use crate::memory;
use crate::octree::Octree;
use crate::render::abi::{BRICK, Class, StoredIso};
use crate::render::resources::Knots;
use crate::volume::{Volume, Voxel};
use crate::with_voxels;

use super::opacity_ranges::OpacityRanges;

/// The cells whose corners lie on both sides of `iso`, or so near to it that its error leaves their side
/// uncertain. `classes` are those of the octree's nodes.
///
/// # Errors
/// Not enough memory.
pub fn crossed(
    volume: &Volume,
    octree: &Octree,
    classes: &[u8],
    iso: StoredIso,
) -> Result<Vec<u64>> {
    visited(volume, octree, classes, |range| may_cross(range, iso))
}

/// The cells in which some value absorbs light. `classes` are those of the octree's nodes.
///
/// # Errors
/// Not enough memory.
pub fn absorbing(
    volume: &Volume,
    octree: &Octree,
    classes: &[u8],
    knots: &Knots,
) -> Result<Vec<u64>> {
    let ranges = OpacityRanges::new(knots);
    visited(volume, octree, classes, |[min, max]| {
        ranges.absorbs(min, max)
    })
}

/// A cell's word and its bit in that, of so many bricks along each axis.
fn place([x, y, z]: [usize; 3], [bricks_x, bricks_y, _]: [usize; 3]) -> (usize, usize) {
    let word = (z / BRICK * bricks_y + y / BRICK) * bricks_x + x / BRICK;
    (word, (z % BRICK * BRICK + y % BRICK) * BRICK + x % BRICK)
}

/// A bit per cell, a word per brick, both x fastest: whether the range of its corners matters. Only leaves
/// of [`Class::Visit`] hold such cells, and those of [`Class::Homogeneous`], at whose ends rays are sampled.
fn visited(
    volume: &Volume,
    octree: &Octree,
    classes: &[u8],
    matters: impl Fn([f32; 2]) -> bool + Sync,
) -> Result<Vec<u64>> {
    let cells = volume.dims().cells().map(|n| n as usize);
    let bricks = cells.map(|n| n.div_ceil(BRICK));
    let count: usize = bricks.iter().product();
    let words = (0..count).into_par_iter().map(|_| AtomicU64::new(0));
    let words: Vec<AtomicU64> = memory::collected(words, "the cells that matter")?;
    let leaf = octree.leaf().edge() as usize;
    let leaves = octree.levels()[0];
    let [leaves_x, leaves_y, _] = leaves.size.map(|n| n as usize);
    with_voxels!(volume.voxels(), voxels => {
        (0..leaves.nodes()).into_par_iter().for_each_init(Vec::new, |lines, node| {
            if ![Class::Visit as u8, Class::Homogeneous as u8].contains(&classes[node]) {
                return;
            }
            let first = [
                node % leaves_x * leaf,
                node / leaves_x % leaves_y * leaf,
                node / (leaves_x * leaves_y) * leaf,
            ];
            let end = [0, 1, 2].map(|axis| (first[axis] + leaf).min(cells[axis]));
            ranges_along_x(voxels, volume, first, end, lines);
            let [width, height] = [end[0] - first[0], end[1] - first[1] + 1];
            for z in first[2]..end[2] {
                for y in first[1]..end[1] {
                    let line = (z - first[2]) * height + (y - first[1]);
                    let around = [line, line + 1, line + height, line + height + 1];
                    let around = around.map(|line| &lines[line * width..(line + 1) * width]);
                    for x in first[0]..end[0] {
                        let [a, b, c, d] = around.map(|line| line[x - first[0]]);
                        let range = join(join(a, b), join(c, d)).map(Into::<f64>::into);
                        let [min, max] = range;
                        if matters([min as f32, max as f32]) {
                            let (word, bit) = place([x, y, z], bricks);
                            words[word].fetch_or(1 << bit, Ordering::Relaxed);
                        }
                    }
                }
            }
        });
    });
    // In place: the two have the same layout.
    Ok(words.into_iter().map(AtomicU64::into_inner).collect())
}

/// The smaller and the greater of each two voxels side by side along x, for the lines of voxels that the
/// cells from `first` to `end` touch, y fastest. An axis with one voxel has no second.
fn ranges_along_x<T: Voxel>(
    voxels: &[T],
    volume: &Volume,
    first: [usize; 3],
    end: [usize; 3],
    lines: &mut Vec<[T; 2]>,
) {
    let [nx, ny, nz] = volume.dims().array().map(|n| n as usize);
    let beyond = usize::from(nx > 1);
    lines.clear();
    for z in first[2]..=end[2] {
        for y in first[1]..=end[1] {
            let line = (z.min(nz - 1) * ny + y.min(ny - 1)) * nx;
            lines.extend((first[0]..end[0]).map(|x| {
                let (a, b) = (voxels[line + x], voxels[line + x + beyond]);
                join([a; 2], [b; 2])
            }));
        }
    }
}

fn join<T: Voxel>(a: [T; 2], b: [T; 2]) -> [T; 2] {
    [
        if b[0] < a[0] { b[0] } else { a[0] },
        if b[1] > a[1] { b[1] } else { a[1] },
    ]
}

/// Whether a cell may be crossed, as the kernels find its side: heights are single-precision differences.
pub fn may_cross([min, max]: [f32; 2], iso: StoredIso) -> bool {
    let above = min - iso.value >= iso.error;
    let below = max - iso.value < -iso.error;
    !(above || below)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::extent::Dims;
    use crate::octree::Leaf;
    use crate::progress::Silent;
    use crate::render::occupancy::classes;
    use crate::volume::{Geometry, NonFinite, Rescale, Voxels};

    /// Every voxel its own hash, all low but for one in 50.
    fn volume(dims: [u64; 3]) -> Volume {
        let dims = Dims::new(dims).unwrap();
        let hash = |i: u64| i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40;
        let voxels: Vec<i16> = (0..dims.voxels())
            .map(|i| (hash(i) % 90) as i16 - if hash(i + 7) % 50 == 0 { 0 } else { 100 })
            .collect();
        let (geometry, rescale) = (Geometry::default(), Rescale::IDENTITY);
        Volume::new(
            dims,
            Voxels::from(voxels),
            geometry,
            rescale,
            NonFinite::Refuse,
        )
        .unwrap()
    }

    /// How many cells' bits differ from `matters`, called with all values at a cell's corners.
    fn differing(volume: &Volume, bits: &[u64], matters: impl Fn(&[f64]) -> bool) -> usize {
        let [nx, ny, nz] = volume.dims().array().map(|n| n as usize);
        let [cx, cy, cz] = volume.dims().cells().map(|n| n as usize);
        let bricks = [cx, cy, cz].map(|n| n.div_ceil(BRICK));
        assert_eq!(bits.len(), bricks.iter().product::<usize>());
        let differs = |cell: usize| {
            let (x, y, z) = (cell % cx, cell / cx % cy, cell / (cx * cy));
            let corners: Vec<f64> = (0..8)
                .map(|c| [x + (c & 1), y + (c >> 1 & 1), z + (c >> 2)])
                .map(|[x, y, z]| {
                    let (x, y, z) = (x.min(nx - 1), y.min(ny - 1), z.min(nz - 1));
                    volume.voxels().stored((z * ny + y) * nx + x)
                })
                .collect();
            let (word, bit) = place([x, y, z], bricks);
            (bits[word] >> bit & 1 == 1) != matters(&corners)
        };
        (0..cx * cy * cz).filter(|&cell| differs(cell)).count()
    }

    const SIZES: [[u64; 3]; 5] = [[9, 10, 11], [33, 5, 17], [1, 20, 9], [13, 1, 1], [2, 2, 2]];

    #[test]
    fn crossed_cells_are_those_with_corners_on_both_sides() {
        for dims in SIZES {
            let volume = volume(dims);
            for edge in [4, 5, 8] {
                let octree = Octree::build(&volume, Leaf::new(edge).unwrap(), &Silent).unwrap();
                let iso = StoredIso {
                    value: 0.5,
                    error: 0.0,
                };
                let classes = classes::by_iso(&octree, iso).unwrap();
                let bits = crossed(&volume, &octree, &classes, iso).unwrap();
                let crosses = |iso: f64| {
                    move |v: &[f64]| v.iter().any(|&v| v >= iso) && v.iter().any(|&v| v < iso)
                };
                assert_eq!(
                    differing(&volume, &bits, crosses(0.5)),
                    0,
                    "{dims:?} {edge}"
                );
                // The control: another iso value's.
                let others = differing(&volume, &bits, crosses(-50.5));
                assert!(others > 0 || dims == [2, 2, 2], "{dims:?} {edge}");
            }
        }
    }

    #[test]
    fn absorbing_cells_are_those_with_a_value_that_absorbs() {
        let knots = Knots {
            values: vec![-60.0, -40.0, -20.0, 10.0, 30.0],
            colors: [0.0, 0.2, 0.0, 0.0, 0.5].map(|a| [1.0, 1.0, 1.0, a]).into(),
        };
        // Of all values between a cell's smallest and greatest.
        let absorbs = |v: &[f64]| {
            let min = v.iter().copied().fold(f64::INFINITY, f64::min);
            let max = v.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            max > -60.0 && min < -20.0 || max > 10.0
        };
        for dims in SIZES {
            let volume = volume(dims);
            let octree = Octree::build(&volume, Leaf::new(4).unwrap(), &Silent).unwrap();
            let classes = classes::by_opacity(&octree, &knots, true, None).unwrap();
            let bits = absorbing(&volume, &octree, &classes, &knots).unwrap();
            assert_eq!(differing(&volume, &bits, absorbs), 0, "{dims:?}");
            let above = |v: &[f64]| v.iter().any(|&v| v > 10.0);
            let others = differing(&volume, &bits, above);
            assert!(others > 0 || dims == [2, 2, 2], "{dims:?}");
        }
    }
}
