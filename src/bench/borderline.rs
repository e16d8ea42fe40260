//! Rays whose answer is anyone's: a hair beside them the reference itself answers otherwise.

use std::collections::HashMap;

use rayon::prelude::*;

use super::Judge;
use crate::error::Result;
use crate::frame::Frame;
use crate::scene::Scene;
use crate::volume::Volume;

/// Depths farther apart than this, in voxels, are of different places.
const JUMP_VOXELS: f64 = 1.0;

/// The borderline pixels of one surface, found when they are asked for.
pub struct Borderline<'a> {
    judge: Judge<'a>,
    scene: &'a Scene,
    voxel_mm: f64,
    known: HashMap<usize, bool>,
}

impl<'a> Borderline<'a> {
    /// # Errors
    /// As [`Judge::new`].
    pub fn new(volume: &'a Volume, scene: &'a Scene) -> Result<Self> {
        Ok(Self {
            judge: Judge::new(volume, scene)?,
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
        let differing: Vec<usize> = (0..truths.len())
            .filter(|&pixel| self.differ(truths[pixel], depths[pixel]))
            .collect();
        let unknown: Vec<usize> = differing
            .iter()
            .filter(|pixel| !self.known.contains_key(pixel))
            .copied()
            .collect();
        let found = unknown
            .par_iter()
            .map(|&pixel| (pixel, self.is_borderline(pixel)));
        let found: Vec<(usize, bool)> = found.collect();
        self.known.extend(found);
        for pixel in differing {
            if self.known.get(&pixel) == Some(&true) {
                depths[pixel] = truths[pixel];
            }
        }
    }

    /// How many have been found.
    pub fn count(&self) -> usize {
        self.known.values().filter(|is| **is).count()
    }

    /// Whether one meets something and the other nothing, or something else.
    fn differ(&self, a_mm: f32, b_mm: f32) -> bool {
        let apart_mm = f64::from((a_mm - b_mm).abs());
        a_mm.is_finite() != b_mm.is_finite() || apart_mm > JUMP_VOXELS * self.voxel_mm
    }

    fn is_borderline(&self, pixel: usize) -> bool {
        let width = self.scene.size.width() as usize;
        let [x, y] = [pixel % width, pixel / width].map(|at| at as f64 + 0.5);
        let ray = self.scene.camera.ray(self.scene.size, x, y);
        self.judge.hangs_by_a_hair(ray, self.judge.truth(ray))
    }
}
