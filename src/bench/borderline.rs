//! Rays whose answer is anyone's: a hair beside them the reference itself answers otherwise.

use std::collections::HashMap;
use std::f64::consts::FRAC_PI_4;

use rayon::prelude::*;

use crate::error::Result;
use crate::frame::Frame;
use crate::reference::Tracer;
use crate::scene::{Ray, Scene};
use crate::volume::Volume;

/// How far a ray is moved, in voxels of the smallest spacing.
const NEAR_VOXELS: f64 = 1e-4;
/// Depths farther apart than this, in voxels, are of different places.
const JUMP_VOXELS: f64 = 1.0;

/// The borderline pixels of one surface, found when they are asked for.
pub struct Borderline<'a> {
    tracer: Tracer<'a>,
    scene: &'a Scene,
    voxel_mm: f64,
    known: HashMap<usize, bool>,
}

impl<'a> Borderline<'a> {
    /// # Errors
    /// As [`Tracer::new`].
    pub fn new(volume: &'a Volume, scene: &'a Scene) -> Result<Self> {
        Ok(Self {
            tracer: Tracer::new(volume, scene)?,
            scene,
            voxel_mm: volume.geometry().smallest_spacing_mm(),
            known: HashMap::new(),
        })
    }

    /// Gives those pixels of a frame that differ from the truth and are borderline the truth's
    /// depth.
    pub fn excuse(&mut self, truth: &Frame, frame: &mut Frame) {
        let (Some(truths), Some(depths)) = (&truth.depth, &mut frame.depth) else {
            return;
        };
        let differs = |pixel: &usize| self.jumps(truths[*pixel], depths[*pixel]);
        let differing: Vec<usize> = (0..truths.len()).filter(differs).collect();
        let unknown = differing.iter().filter(|p| !self.known.contains_key(p));
        let unknown: Vec<usize> = unknown.copied().collect();
        let found = unknown
            .par_iter()
            .map(|&pixel| (pixel, self.is_borderline(pixel, truths[pixel])));
        let found: Vec<(usize, bool)> = found.collect();
        self.known.extend(found);
        for pixel in differing {
            if self.known[&pixel] {
                depths[pixel] = truths[pixel];
            }
        }
    }

    /// How many have been found.
    pub fn count(&self) -> usize {
        self.known.values().filter(|is| **is).count()
    }

    /// Whether one meets something and the other nothing, or something else.
    fn jumps(&self, a_mm: f32, b_mm: f32) -> bool {
        let apart_mm = f64::from((a_mm - b_mm).abs());
        a_mm.is_finite() != b_mm.is_finite() || apart_mm > JUMP_VOXELS * self.voxel_mm
    }

    /// Whether the answer jumps for one of eight rays about the pixel's own.
    fn is_borderline(&self, pixel: usize, truth_mm: f32) -> bool {
        let width = self.scene.size.width() as usize;
        let [x, y] = [pixel % width, pixel / width].map(|at| at as f64 + 0.5);
        let ray = self.scene.camera.ray(self.scene.size, x, y);
        let side = ray.dir_world.any_orthonormal_vector();
        let other = ray.dir_world.cross(side);
        (0..8).any(|eighth| {
            let (sin, cos) = (f64::from(eighth) * FRAC_PI_4).sin_cos();
            let by = (side * cos + other * sin) * (NEAR_VOXELS * self.voxel_mm);
            let beside = Ray {
                origin_world: ray.origin_world + by,
                ..ray
            };
            self.jumps(self.tracer.cast(beside).depth_mm as f32, truth_mm)
        })
    }
}
