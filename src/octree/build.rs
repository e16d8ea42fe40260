//! Building the tree: leaves from voxels in parallel, then each level from the one below, all in the
//! place that is theirs in the end.

use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::extent::Dims;
use crate::memory;
use crate::progress::{Progress, Silent};
use crate::volume::{Volume, Voxel};
use crate::with_voxels;

use super::{Leaf, Level, Octree};

/// The voxels along one axis that leaf `l` touches, and how many of them are its own.
fn span(leaf: u32, l: u32, leaves: u32, voxels: u32) -> (usize, usize, usize) {
    let first = l * leaf;
    let touched_end = (first + leaf + 1).min(voxels);
    let own_end = if l + 1 == leaves {
        voxels
    } else {
        first + leaf
    };
    (first as usize, touched_end as usize, own_end as usize)
}

/// The nodes' ranges, and the sums of their own voxels: with the counts, which follow from the grid, they make
/// exact averages at every level.
struct Nodes<'a> {
    ranges: &'a mut [[f32; 2]],
    sums: &'a mut [f64],
}

const NO_RANGE: [f32; 2] = [f32::INFINITY, f32::NEG_INFINITY];

impl Octree {
    /// The octree of a volume with leaves of the default size.
    ///
    /// # Errors
    /// As [`Octree::build`].
    pub fn of(volume: &Volume) -> Result<Self> {
        Self::build(volume, Leaf::default(), &Silent)
    }

    /// Besides the tree itself it takes eight bytes a node while it is built.
    ///
    /// # Errors
    /// More nodes than 32 bits count; not enough memory.
    pub fn build(volume: &Volume, leaf: Leaf, progress: &dyn Progress) -> Result<Self> {
        let dims = volume.dims();
        let levels = levels(dims, leaf)?;
        let all = levels.iter().map(Level::nodes).sum();
        let mut ranges = memory::filled(all, NO_RANGE, "the octree")?;
        let mut averages = memory::room(all, "the octree")?;
        let mut sums = memory::filled(all, 0.0, "the octree")?;
        let leaves = levels[0];
        progress.begin(
            "octree",
            u64::from(leaves.size[1]) * u64::from(leaves.size[2]),
        );
        let row = leaves.size[0] as usize;
        with_voxels!(volume.voxels(), voxels => ranges[..leaves.nodes()]
        .par_chunks_mut(row)
        .zip(sums[..leaves.nodes()].par_chunks_mut(row))
        .enumerate()
        .for_each(|(row, (ranges, sums))| {
            leaf_row(voxels, dims, leaf, leaves, row, Nodes { ranges, sums });
            progress.advance(1);
        }));
        for pair in levels.windows(2) {
            parents(&mut ranges, NO_RANGE, join, pair[0], pair[1]);
            parents(&mut sums, 0.0, |a, b| a + b, pair[0], pair[1]);
        }
        for (level, edge) in levels
            .iter()
            .zip((0..).map(|l| u64::from(leaf.edge()) << l))
        {
            let sums = &sums[level.offset as usize..][..level.nodes()];
            let mean =
                |(node, sum): (usize, &f64)| (sum / own_voxels(node, *level, edge, dims)) as f32;
            averages.par_extend(sums.par_iter().enumerate().map(mean));
        }
        progress.end();
        Ok(Self {
            leaf,
            levels,
            ranges,
            averages,
        })
    }
}

fn join(a: [f32; 2], b: [f32; 2]) -> [f32; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// How many voxels are a node's own, of a level whose nodes have this edge.
fn own_voxels(node: usize, level: Level, edge: u64, dims: Dims) -> f64 {
    let [nx, ny, _] = level.size.map(|n| n as usize);
    let place = [node % nx, node / nx % ny, node / (nx * ny)];
    let along = [0, 1, 2].map(|axis| {
        let (first, voxels) = (place[axis] as u64 * edge, u64::from(dims.array()[axis]));
        if place[axis] + 1 == level.size[axis] as usize {
            voxels - first
        } else {
            edge
        }
    });
    along.iter().product::<u64>() as f64
}

/// Sizes and offsets of all levels up to the single root.
fn levels(dims: Dims, leaf: Leaf) -> Result<Vec<Level>> {
    let mut size = dims.cells().map(|cells| cells.div_ceil(leaf.edge()));
    let mut levels: Vec<Level> = Vec::new();
    let mut offset: u64 = 0;
    loop {
        let level = Level {
            size,
            offset: u32::try_from(offset).unwrap_or(u32::MAX),
        };
        offset += level.nodes() as u64;
        levels.push(level);
        if size == [1, 1, 1] {
            break;
        }
        size = size.map(|n| n.div_ceil(2));
    }
    if offset > u64::from(u32::MAX) {
        return Err(Error::usage(format!(
            "an octree of {offset} nodes over {dims} voxels is too large"
        ))
        .hint("choose a larger --octree-leaf"));
    }
    Ok(levels)
}

/// One row of leaves along x, from rows of voxels read in memory order.
fn leaf_row<T: Voxel>(
    voxels: &[T],
    dims: Dims,
    leaf: Leaf,
    leaves: Level,
    row: usize,
    nodes: Nodes,
) {
    let [nx, ny, nz] = dims.array();
    let rows_y = leaves.size[1] as usize;
    let (ly, lz) = ((row % rows_y) as u32, (row / rows_y) as u32);
    let (y0, y1, own_y1) = span(leaf.edge(), ly, leaves.size[1], ny);
    let (z0, z1, own_z1) = span(leaf.edge(), lz, leaves.size[2], nz);
    for z in z0..z1 {
        for y in y0..y1 {
            let start = (z * ny as usize + y) * nx as usize;
            let line = &voxels[start..start + nx as usize];
            let own_line = y < own_y1 && z < own_z1;
            let of_nodes = nodes.ranges.iter_mut().zip(nodes.sums.iter_mut());
            for (lx, (range, sum)) in of_nodes.enumerate() {
                let (x0, x1, own_x1) = span(leaf.edge(), lx as u32, leaves.size[0], nx);
                let touched = &line[x0..x1];
                let (mut min, mut max) = (touched[0], touched[0]);
                for &v in touched {
                    min = if v < min { v } else { min };
                    max = if v > max { v } else { max };
                }
                let (min, max): (f64, f64) = (min.into(), max.into());
                *range = join(*range, [min as f32, max as f32]);
                if own_line {
                    let own = &line[x0..own_x1];
                    *sum += own.iter().map(|&v| v.into()).sum::<f64>();
                }
            }
        }
    }
}

/// Fills the level above `below`: each node is joined from its children, beginning with `nothing`.
fn parents<T: Copy + Send + Sync>(
    nodes: &mut [T],
    nothing: T,
    join: impl Fn(T, T) -> T + Sync,
    below: Level,
    level: Level,
) {
    let [sx, sy, sz] = below.size.map(|n| n as usize);
    let [px, py, _] = level.size.map(|n| n as usize);
    let (lower, upper) = nodes.split_at_mut(level.offset as usize);
    let children = &lower[below.offset as usize..];
    let parents = &mut upper[..level.nodes()];
    parents.par_iter_mut().enumerate().for_each(|(i, parent)| {
        let (x, y, z) = (2 * (i % px), 2 * (i / px % py), 2 * (i / (px * py)));
        *parent = nothing;
        for cz in z..(z + 2).min(sz) {
            for cy in y..(y + 2).min(sy) {
                for cx in x..(x + 2).min(sx) {
                    *parent = join(*parent, children[(cz * sy + cy) * sx + cx]);
                }
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Silent;
    use crate::volume::{Geometry, NonFinite, Rescale, Voxels};

    /// A volume without symmetry: every voxel its own hash.
    fn volume(dims: [u64; 3]) -> Volume {
        let dims = Dims::new(dims).unwrap();
        let voxels: Vec<u16> = (0..dims.voxels())
            .map(|i| (i.wrapping_mul(2_654_435_761) >> 7) as u16)
            .collect();
        Volume::new(
            dims,
            Voxels::from(voxels),
            Geometry::default(),
            Rescale::IDENTITY,
            NonFinite::Refuse,
        )
        .unwrap()
    }

    /// Minimum, maximum and own-voxel mean of one node, straight from the definition.
    fn brute_force(volume: &Volume, edge: u64, node: [u64; 3], border: u64) -> (f32, f32, f64) {
        let n = volume.dims().array().map(u64::from);
        let (mut min, mut max) = (f32::INFINITY, f32::NEG_INFINITY);
        let (mut sum, mut count) = (0.0, 0.0);
        let first = node.map(|c| c * edge);
        let touched = [0, 1, 2].map(|a| first[a]..(first[a] + edge + border).min(n[a]));
        for z in touched[2].clone() {
            for y in touched[1].clone() {
                for x in touched[0].clone() {
                    let v = volume.voxels().stored(((z * n[1] + y) * n[0] + x) as usize);
                    min = min.min(v as f32);
                    max = max.max(v as f32);
                    let cells = volume.dims().cells().map(u64::from);
                    let own = [x, y, z]
                        .iter()
                        .enumerate()
                        .all(|(a, &p)| p < first[a] + edge || first[a] + edge >= cells[a]);
                    if own {
                        sum += v;
                        count += 1.0;
                    }
                }
            }
        }
        (min, max, sum / count)
    }

    /// Nodes that differ from the definition taken with a border of `border` voxels.
    fn differing_nodes(dims: [u64; 3], leaf: u32, border: u64) -> usize {
        let volume = volume(dims);
        let tree = Octree::build(&volume, Leaf::new(leaf).unwrap(), &Silent).unwrap();
        assert_eq!(tree.levels().last().unwrap().size, [1, 1, 1]);
        let mut differing = 0;
        for (l, level) in tree.levels().iter().enumerate() {
            let [sx, sy, _] = level.size.map(u64::from);
            for i in 0..level.nodes() as u64 {
                let node = [i % sx, i / sx % sy, i / (sx * sy)];
                let (min, max, mean) = brute_force(&volume, u64::from(leaf) << l, node, border);
                let at = level.offset as usize + i as usize;
                let same = tree.ranges()[at] == [min, max]
                    && (f64::from(tree.averages()[at]) - mean).abs() <= mean.abs() * 1e-6;
                differing += usize::from(!same);
            }
        }
        differing
    }

    #[test]
    fn every_node_equals_brute_force() {
        for dims in [
            [1, 1, 1],
            [2, 2, 2],
            [3, 5, 7],
            [1, 20, 9],
            [8, 8, 8],
            [9, 9, 9],
            [10, 17, 33],
            [15, 16, 17],
        ] {
            for leaf in [4, 5, 8, 32] {
                assert_eq!(differing_nodes(dims, leaf, 1), 0, "{dims:?} leaf {leaf}");
            }
        }
    }

    #[test]
    fn a_node_without_its_border_voxel_is_noticed() {
        assert!(differing_nodes([10, 17, 33], 4, 0) > 0);
    }

    #[test]
    fn leaf_8_takes_at_most_5_percent_of_8_bit_voxels() {
        let dims = Dims::new([512, 512, 512]).unwrap();
        let nodes: usize = levels(dims, Leaf::new(8).unwrap())
            .unwrap()
            .iter()
            .map(Level::nodes)
            .sum();
        let bytes = nodes * (size_of::<[f32; 2]>() + size_of::<f32>());
        assert!(
            (bytes as f64) < 0.05 * dims.voxels() as f64,
            "{bytes} bytes"
        );
    }

    #[test]
    fn leaves_of_unusable_edges_are_refused() {
        for edge in ["3", "33", "0", "-8", "eight", ""] {
            assert!(edge.parse::<Leaf>().is_err(), "{edge}");
        }
        assert_eq!("4".parse::<Leaf>().unwrap(), Leaf::default());
    }
}
