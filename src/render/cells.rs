//! Which cells a surface may cross: a bit each.

use rayon::prelude::*;

use crate::octree::Octree;
use crate::volume::{Volume, Voxel};
use crate::with_voxels;

use super::classify::Class;

/// A bit per cell, x fastest: whether its corners lie on both sides of `iso`, stored units.
pub fn crossed(volume: &Volume, octree: &Octree, classes: &[u8], iso: f32) -> Vec<u32> {
    with_voxels!(volume.voxels(), voxels => of(voxels, volume, octree, classes, iso))
}

fn of<T: Voxel>(voxels: &[T], volume: &Volume, octree: &Octree, classes: &[u8], iso: f32) -> Vec<u32> {
    let [nx, ny, nz] = volume.dims().array().map(|n| n as usize);
    let [cx, cy, cz] = [nx, ny, nz].map(|n| (n - 1).max(1));
    let leaf = octree.leaf().edge() as usize;
    let [lx, ly, _] = octree.levels()[0].size.map(|n| n as usize);
    let words = (cx * cy * cz).div_ceil(32) + 1;
    let bits: Vec<std::sync::atomic::AtomicU32> = (0..words).map(|_| std::sync::atomic::AtomicU32::new(0)).collect();
    let inside = |x: usize, y: usize, z: usize| voxels[(z.min(nz - 1) * ny + y.min(ny - 1)) * nx + x.min(nx - 1)].into() >= f64::from(iso);
    (0..octree.levels()[0].nodes()).into_par_iter().for_each(|node| {
        if classes[node] != Class::Visit as u8 { return; }
        let (x0, y0, z0) = (node % lx * leaf, node / lx % ly * leaf, node / (lx * ly) * leaf);
        for z in z0..(z0 + leaf).min(cz) { for y in y0..(y0 + leaf).min(cy) { for x in x0..(x0 + leaf).min(cx) {
            let mut any = false; let mut all = true;
            for c in 0..8 { let i = inside(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2)); any |= i; all &= i; }
            if any && !all { let i = (z * cy + y) * cx + x; bits[i >> 5].fetch_or(1 << (i & 31), std::sync::atomic::Ordering::Relaxed); }
        }}}
    });
    bits.into_iter().map(|b| b.into_inner()).collect()
}
