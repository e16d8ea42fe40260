//! The rival: rays that begin where the coarse rays around them met the surface.
//!
//! Belyaev et al. 2018 (Journal of Engineering Science and Technology): a first pass of low resolution finds the
//! isosurface's depth, from which each pixel's ray then starts. Nothing proves that a pixel does not see something
//! nearer than its neighbours do, so that what is thinner than the coarse grid is lost or begins too late.

use crate::error::Result;
use crate::lab::bench::Dataset;
use crate::octree::Octree;
use crate::render::{FirstCrossing, IndexRay, RayCaster};
use crate::scene::{Picture, Scene};
use crate::volume::Volume;

/// How far before its neighbours' depth a ray begins, in voxels of the smallest spacing.
pub const MARGIN_VOXELS: f64 = 2.0;

/// The hits of all pixels of a picture.
pub struct Crossings {
    /// One for each pixel, row by row; t in mm from the ray's origin.
    pub pixels: Vec<FirstCrossing>,
    /// The rays of all passes.
    pub rays: u64,
    /// The device's time of all passes, ms.
    pub ms: f64,
}

/// Casts rays of a picture one by one.
pub struct Rival<'a> {
    pub dataset: &'a Dataset,
    pub octree: &'a Octree,
    pub caster: RayCaster<'a>,
}

impl Rival<'_> {
    /// The surface along every pixel's whole ray.
    ///
    /// # Errors
    /// The device fails or has no room.
    pub fn whole(&mut self, scene: &Scene) -> Result<Crossings> {
        self.cast(scene, &rays(scene, &self.dataset.volume))
    }

    /// The surface along rays that begin at the depth of the coarse rays around them, which are `spacing` pixels
    /// apart; along whole rays where none of those met anything.
    ///
    /// # Errors
    /// As [`Rival::whole`].
    pub fn by_neighbours(&mut self, scene: &Scene, spacing: u32) -> Result<Crossings> {
        let volume = &self.dataset.volume;
        let mut all = rays(scene, volume);
        let grid = Grid::new(scene, spacing);
        let coarse: Vec<IndexRay> = grid.pixels().map(|pixel| all[pixel]).collect();
        let coarse = self.cast(scene, &coarse)?;
        let margin_mm = MARGIN_VOXELS * volume.geometry().smallest_spacing_mm();
        let depth_mm: Vec<f32> = coarse.pixels.iter().map(|found| found.t).collect();
        for (pixel, ray) in all.iter_mut().enumerate() {
            let nearest = grid.nearest(&depth_mm, pixel);
            if nearest.is_finite() {
                ray.t[0] = (nearest - margin_mm as f32).max(0.0);
            }
        }
        let fine = self.cast(scene, &all)?;
        Ok(Crossings {
            pixels: fine.pixels,
            rays: coarse.rays + fine.rays,
            ms: coarse.ms + fine.ms,
        })
    }

    fn cast(&mut self, scene: &Scene, rays: &[IndexRay]) -> Result<Crossings> {
        let caps = matches!(scene.picture, Picture::Surface { caps: true, .. });
        let (volume, iso) = (&self.dataset.volume, self.dataset.iso);
        let cast = self
            .caster
            .cast_timed(volume, self.octree, iso, caps, rays)?;
        Ok(Crossings {
            pixels: cast.crossings,
            rays: rays.len() as u64,
            ms: cast.device_ms,
        })
    }
}

/// The rays through the centres of all pixels, row by row; t in mm.
fn rays(scene: &Scene, volume: &Volume) -> Vec<IndexRay> {
    let index_from_world = volume.geometry().world_from_index().inverse();
    let (width, height) = (scene.size.width(), scene.size.height());
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let ray = |(x, y)| {
        let ray = (scene.camera).ray(scene.size, f64::from(x) + 0.5, f64::from(y) + 0.5);
        let origin = index_from_world.transform_point3(ray.origin_world);
        let dir = index_from_world.transform_vector3(ray.dir_world);
        IndexRay::forward(origin.as_vec3().to_array(), dir.as_vec3().to_array())
    };
    pixels.map(ray).collect()
}

/// The grid of coarse rays: every so many pixels along both axes, and the last ones.
struct Grid {
    spacing: usize,
    size: [usize; 2],
}

impl Grid {
    fn new(scene: &Scene, spacing: u32) -> Self {
        let size = [scene.size.width(), scene.size.height()];
        Self {
            spacing: spacing as usize,
            size: size.map(|n| n as usize),
        }
    }

    /// The number of lines along an axis.
    fn lines(&self, axis: usize) -> usize {
        (self.size[axis] - 1).div_ceil(self.spacing) + 1
    }

    /// The place of a line along an axis.
    fn at(&self, axis: usize, line: usize) -> usize {
        (line * self.spacing).min(self.size[axis] - 1)
    }

    /// The pixels of the grid, row by row.
    fn pixels(&self) -> impl Iterator<Item = usize> {
        let row =
            move |v| (0..self.lines(0)).map(move |u| self.at(1, v) * self.size[0] + self.at(0, u));
        (0..self.lines(1)).flat_map(row)
    }

    /// The least of the grid's depths at the corners of the block that a pixel lies in.
    fn nearest(&self, depths: &[f32], pixel: usize) -> f32 {
        let at = [pixel % self.size[0], pixel / self.size[0]];
        let [u, v] = at.map(|n| n / self.spacing);
        let next = |axis: usize, line: usize| (line + 1).min(self.lines(axis) - 1);
        let corners = [
            [u, v],
            [next(0, u), v],
            [u, next(1, v)],
            [next(0, u), next(1, v)],
        ];
        let depths = corners.map(|[u, v]| depths[v * self.lines(0) + u]);
        depths.into_iter().fold(f32::INFINITY, f32::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_begins_at_the_nearest_corner_of_its_block() {
        let grid = Grid {
            spacing: 4,
            size: [10, 6],
        };
        assert_eq!((grid.lines(0), grid.lines(1)), (4, 3));
        let pixels: Vec<usize> = grid.pixels().collect();
        assert_eq!(pixels, [0, 4, 8, 9, 40, 44, 48, 49, 50, 54, 58, 59]);
        let mut depths = vec![f32::INFINITY; 12];
        depths[5] = 3.0; // pixel 4, 4
        depths[11] = 2.0; // the last pixel
        assert_eq!(grid.nearest(&depths, 0), 3.0);
        assert_eq!(grid.nearest(&depths, 7 + 5 * 10), 3.0);
        assert_eq!(grid.nearest(&depths, 8), f32::INFINITY);
        assert_eq!(grid.nearest(&depths, 59), 2.0);
    }
}
