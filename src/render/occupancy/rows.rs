//! The cells that matter, row by row along x: of each row the first and the last, which is all that a convex
//! shape around them depends on.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use crate::error::Result;
use crate::memory;
use crate::scene::Filter;
use crate::volume::{Volume, Voxel};
use crate::with_voxels;

/// The first and the last cell of every row that matter.
pub struct Rows {
    /// Cells along each axis.
    cells: [usize; 3],
    filter: Filter,
    /// The field's domain along each axis, index space.
    domain: [(f64, f64); 3],
    /// A row's first and last cell, rows along y fastest.
    ends: Vec<[u32; 2]>,
}

/// The ends of a row of which nothing matters.
const NONE: [u32; 2] = [u32::MAX, 0];

/// Cells that are looked at together before they are each by itself.
const BLOCK: usize = 64;

impl Rows {
    /// The cells in which a value matters. `matters` is told a range of stored values, and must be true of a
    /// range where it is of a part of it: the values of a cell, between its smallest and its greatest corner;
    /// with the nearest filter the one of a voxel's own box.
    ///
    /// # Errors
    /// Not enough memory.
    pub fn that_hold(
        volume: &Volume,
        filter: Filter,
        matters: impl Fn([f32; 2]) -> bool + Sync,
    ) -> Result<Self> {
        let [nx, _, _] = volume.dims().array().map(|n| n as usize);
        let beyond = usize::from(filter == Filter::Linear);
        with_voxels!(volume.voxels(), voxels => Self::of(volume, filter, |cells, [y, z]| {
            let lines = lines_around(voxels, volume, filter, [y, z]);
            let lines = &lines[..if filter == Filter::Linear { 4 } else { 1 }];
            let touched = |cells: Range<usize>| cells.start..(cells.end + beyond).min(nx);
            ends(
                cells,
                |block| matters(range_of(lines, touched(block))),
                |cell| matters(range_at(lines, touched(cell..cell + 1))),
            )
        }))
    }

    /// The voxels, with the nearest filter, that are inside and have one beside a face that is not. `inside`
    /// is told a stored value.
    ///
    /// # Errors
    /// Not enough memory.
    pub fn at_steps(volume: &Volume, inside: impl Fn(f32) -> bool + Sync) -> Result<Self> {
        let [nx, ny, nz] = volume.dims().array().map(|n| n as usize);
        with_voxels!(volume.voxels(), voxels => Self::of(volume, Filter::Nearest, |cells, [y, z]| {
            let line = |y: usize, z: usize| &voxels[(z * ny + y) * nx..][..nx];
            let own = line(y, z);
            let beside = [
                line(y.saturating_sub(1), z),
                line((y + 1).min(ny - 1), z),
                line(y, z.saturating_sub(1)),
                line(y, (z + 1).min(nz - 1)),
            ];
            let is_inside = |voxel| inside(Into::<f64>::into(voxel) as f32);
            ends(
                cells,
                |block| inside(range_of(&[own], block)[1]),
                |x| {
                    let along = [own[x.saturating_sub(1)], own[(x + 1).min(nx - 1)]];
                    let around = beside.map(|line| line[x]);
                    let mut around = along.into_iter().chain(around);
                    is_inside(own[x]) && around.any(|voxel| !is_inside(voxel))
                },
            )
        }))
    }

    /// The rows of the cells into which the filter parts the volume; `ends` finds those of one.
    fn of(
        volume: &Volume,
        filter: Filter,
        ends: impl Fn(usize, [usize; 2]) -> [u32; 2] + Sync + Send,
    ) -> Result<Self> {
        let cells = match filter {
            Filter::Linear => volume.dims().cells(),
            Filter::Nearest => volume.dims().array(),
        };
        let cells = cells.map(|n| n as usize);
        let rows = (0..cells[1] * cells[2]).into_par_iter().with_min_len(16);
        let rows = rows.map(|row| ends(cells[0], [row % cells[1], row / cells[1]]));
        Ok(Self {
            cells,
            filter,
            domain: volume.dims().domain(),
            ends: memory::collected(rows, "what is shown of the volume")?,
        })
    }

    /// The box from the first to the last cell of each row that has any: its least and greatest corner, index
    /// space.
    pub fn boxes(&self) -> impl ParallelIterator<Item = [DVec3; 2]> {
        let rows = self.ends.par_iter().enumerate();
        let rows = rows.filter(|(_, ends)| **ends != NONE);
        rows.map(|(row, &[first, last])| {
            let along = [
                [first as usize, last as usize],
                [row % self.cells[1]; 2],
                [row / self.cells[1]; 2],
            ];
            let least = [0, 1, 2].map(|axis| self.faces(axis, along[axis][0])[0]);
            let greatest = [0, 1, 2].map(|axis| self.faces(axis, along[axis][1])[1]);
            [least, greatest].map(DVec3::from_array)
        })
    }

    /// Where a cell begins and ends along an axis.
    fn faces(&self, axis: usize, cell: usize) -> [f64; 2] {
        let (from, to) = self.domain[axis];
        let first = match self.filter {
            _ if self.cells[axis] == 1 => return [from, to],
            Filter::Linear => cell as f64,
            Filter::Nearest => cell as f64 - 0.5,
        };
        [first.max(from), (first + 1.0).min(to)]
    }
}

/// The lines of voxels along x that the cells of a row touch: with the linear filter four, with the nearest
/// one the first of these alone. An axis with one voxel has no second.
fn lines_around<'a, T: Voxel>(
    voxels: &'a [T],
    volume: &Volume,
    filter: Filter,
    [y, z]: [usize; 2],
) -> [&'a [T]; 4] {
    let [nx, ny, nz] = volume.dims().array().map(|n| n as usize);
    let beyond = usize::from(filter == Filter::Linear);
    let [ys, zs] = [[y, (y + beyond).min(ny - 1)], [z, (z + beyond).min(nz - 1)]];
    let places = [(0, 0), (1, 0), (0, 1), (1, 1)];
    places.map(|(at_y, at_z)| &voxels[(zs[at_z] * ny + ys[at_y]) * nx..][..nx])
}

/// The first and the last of so many cells that `is_one`. `may_hold` is false of blocks without any.
fn ends(
    cells: usize,
    may_hold: impl Fn(Range<usize>) -> bool,
    is_one: impl Fn(usize) -> bool,
) -> [u32; 2] {
    let blocks = cells.div_ceil(BLOCK);
    let block = |at: usize| at * BLOCK..((at + 1) * BLOCK).min(cells);
    let is_one = |cell: &usize| is_one(*cell);
    let mut forth = (0..blocks)
        .map(block)
        .filter(|cells| may_hold(cells.clone()));
    let Some(first) = forth.find_map(|mut cells| cells.find(is_one)) else {
        return NONE;
    };
    let mut back = (0..blocks)
        .rev()
        .map(block)
        .filter(|cells| may_hold(cells.clone()));
    let last = back.find_map(|cells| cells.rev().find(is_one));
    [first as u32, last.unwrap_or(first) as u32]
}

/// The smallest and the greatest of many voxels of each line.
fn range_of<T: Voxel>(lines: &[&[T]], voxels: Range<usize>) -> [f32; 2] {
    // Lane by lane, as vector registers do it.
    const LANES: usize = 16;
    let first = lines[0][voxels.start];
    let (mut min, mut max) = ([first; LANES], [first; LANES]);
    for line in lines {
        for chunk in line[voxels.clone()].chunks(LANES) {
            for ((min, max), &voxel) in min.iter_mut().zip(&mut max).zip(chunk) {
                *min = if voxel < *min { voxel } else { *min };
                *max = if voxel > *max { voxel } else { *max };
            }
        }
    }
    let [least, _] = range_at(&[&min], 0..LANES);
    let [_, greatest] = range_at(&[&max], 0..LANES);
    [least, greatest]
}

/// The smallest and the greatest of a few voxels of each line.
fn range_at<T: Voxel>(lines: &[&[T]], voxels: Range<usize>) -> [f32; 2] {
    let first = lines[0][voxels.start];
    let (mut min, mut max) = (first, first);
    for line in lines {
        for &voxel in &line[voxels.clone()] {
            min = if voxel < min { voxel } else { min };
            max = if voxel > max { voxel } else { max };
        }
    }
    [min, max].map(|voxel| Into::<f64>::into(voxel) as f32)
}
