//! Answers that differ from the reference's and are as right: its own, a hair beside the ray.

use std::collections::{HashMap, HashSet};

use rayon::prelude::*;

use super::{Judge, Met, Verdict};
use crate::error::Result;
use crate::frame::{DEPTH, Frame, Kind};
use crate::scene::Scene;
use crate::volume::Volume;

/// Depths farther apart than this, in voxels, are of different places.
const JUMP_VOXELS: f64 = 1.0;

/// What a fixed step's depth tells apart, in voxels: [`Judge::verdict`] takes five times as much,
/// [`JUMP_VOXELS`], for the same place.
const RESOLUTION_VOXELS: f64 = JUMP_VOXELS / 5.0;

/// The borderline answers for one surface, found when they are asked for.
pub struct Borderline<'a> {
    judge: Judge<'a>,
    scene: &'a Scene,
    voxel_mm: f64,
    /// Of pixels and the depths that were met there, as bits.
    known: HashMap<(usize, u32), bool>,
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

    /// Gives those pixels of a frame whose depths differ from the truth's and are
    /// [`Verdict::Borderline`] the truth's depth; says how many.
    pub fn excuse(&mut self, truth: &Frame, frame: &mut Frame) -> usize {
        let (Some(truths), Some(depths)) = (truth.plane(DEPTH), frame.plane_mut(DEPTH)) else {
            return 0;
        };
        let differing: Vec<(usize, u32)> = (0..truths.len())
            .filter(|&pixel| self.differ(truths[pixel], depths[pixel]))
            .map(|pixel| (pixel, depths[pixel].to_bits()))
            .collect();
        let unknown: Vec<_> = differing
            .iter()
            .filter(|answer| !self.known.contains_key(answer))
            .copied()
            .collect();
        let found = unknown.par_iter().map(|&(pixel, bits)| {
            (
                (pixel, bits),
                self.is_borderline(pixel, f32::from_bits(bits)),
            )
        });
        let found: Vec<_> = found.collect();
        self.known.extend(found);
        let mut excused = 0;
        for answer in differing {
            if self.known.get(&answer) == Some(&true) {
                depths[answer.0] = truths[answer.0];
                excused += 1;
            }
        }
        excused
    }

    /// At how many pixels any has been found.
    pub fn count(&self) -> usize {
        let found = self.known.iter().filter(|(_, is)| **is);
        found
            .map(|((pixel, _), _)| pixel)
            .collect::<HashSet<_>>()
            .len()
    }

    /// Whether one meets something and the other nothing, or something else.
    fn differ(&self, a_mm: f32, b_mm: f32) -> bool {
        let apart_mm = f64::from((a_mm - b_mm).abs());
        a_mm.is_finite() != b_mm.is_finite() || apart_mm > JUMP_VOXELS * self.voxel_mm
    }

    fn is_borderline(&self, pixel: usize, depth_mm: f32) -> bool {
        let width = self.scene.size.width() as usize;
        let [x, y] = [pixel % width, pixel / width].map(|at| at as f64 + 0.5);
        let ray = self.scene.camera.ray(self.scene.size, x, y);
        let truth = self.judge.truth(ray);
        // A depth does not say whether it is a cap's.
        let kinds: &[Kind] = if depth_mm.is_finite() {
            &[Kind::Surface, Kind::Cap]
        } else {
            &[Kind::Nothing]
        };
        kinds.iter().any(|&kind| {
            let met = Met {
                kind,
                depth_mm: depth_mm.into(),
            };
            let resolution_mm = RESOLUTION_VOXELS * self.voxel_mm;
            self.judge.verdict(ray, truth, met, resolution_mm) == Verdict::Borderline
        })
    }
}
