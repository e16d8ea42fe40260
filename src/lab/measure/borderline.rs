//! Answers that differ from the reference's and are as right: those that the reference itself gives a
//! hair beside the ray.

use std::collections::{HashMap, HashSet};

use glam::DQuat;
use rayon::prelude::*;

use super::{Answer, HitChecker, HitVerdict};
use crate::error::Result;
use crate::frame::{DEPTH, Frame, KIND, Kind};
use crate::reference::Tracer;
use crate::scene::{Ray, Scene};
use crate::volume::Volume;

/// Depths farther apart than this, in voxels, belong to different places.
const JUMP_VOXELS: f64 = 1.0;

/// The resolution of a fixed step's depth, in voxels: [`HitChecker::verdict`] takes five times as much,
/// [`JUMP_VOXELS`], for the same place.
const RESOLUTION_VOXELS: f64 = JUMP_VOXELS / 5.0;

/// Depths of exact casting farther apart than this, in voxels, need a verdict.
const CLOSE_VOXELS: f64 = 1e-4;

/// How near depths must be to need no verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Closeness {
    /// All depths that differ, for exact casting; the kind of the hit is taken from the frame.
    Exact,
    /// Depths of another place, for fixed steps, whatever the kind of the hit.
    Jumps,
}

impl Closeness {
    fn limit_voxels(self) -> f64 {
        match self {
            Self::Exact => CLOSE_VOXELS,
            Self::Jumps => JUMP_VOXELS,
        }
    }

    fn resolution_voxels(self) -> f64 {
        match self {
            Self::Exact => 0.0,
            Self::Jumps => RESOLUTION_VOXELS,
        }
    }
}

/// A pixel, the bits of its depth, and the kind of its hit where that counts.
type PixelAnswer = (usize, u32, Option<u32>);

/// The borderline answers for one surface; each is looked into once.
pub struct Borderline<'a> {
    checker: HitChecker<'a>,
    scene: &'a Scene,
    voxel_mm: f64,
    closeness: Closeness,
    known: HashMap<PixelAnswer, bool>,
}

impl<'a> Borderline<'a> {
    /// Prepares the comparison of pictures of `scene`.
    ///
    /// # Errors
    /// As [`HitChecker::new`].
    pub fn new(volume: &'a Volume, scene: &'a Scene, closeness: Closeness) -> Result<Self> {
        Ok(Self {
            checker: HitChecker::new(volume, scene)?,
            scene,
            voxel_mm: volume.geometry().smallest_spacing_mm(),
            closeness,
            known: HashMap::new(),
        })
    }

    /// Gives those pixels of a frame whose depths differ from the reference's and are
    /// [`HitVerdict::Borderline`] the reference's depth; returns how many.
    pub fn excuse(&mut self, reference: &Frame, frame: &mut Frame) -> usize {
        let kinds = match self.closeness {
            Closeness::Exact => frame.plane(KIND).map(<[u32]>::to_vec),
            Closeness::Jumps => None,
        };
        let (Some(references), Some(depths)) = (reference.plane(DEPTH), frame.plane_mut(DEPTH))
        else {
            return 0;
        };
        let differing: Vec<PixelAnswer> = (0..references.len())
            .filter(|&pixel| self.differ(references[pixel], depths[pixel]))
            .map(|pixel| {
                (
                    pixel,
                    depths[pixel].to_bits(),
                    kinds.as_ref().map(|kinds| kinds[pixel]),
                )
            })
            .collect();
        let unknown: Vec<_> = differing
            .iter()
            .filter(|answer| !self.known.contains_key(answer))
            .copied()
            .collect();
        let verdicts = unknown
            .par_iter()
            .map(|&answer| (answer, self.is_borderline(answer)));
        let verdicts: Vec<_> = verdicts.collect();
        self.known.extend(verdicts);
        let mut excused = 0;
        for answer in differing {
            if self.known.get(&answer) == Some(&true) {
                depths[answer.0] = references[answer.0];
                excused += 1;
            }
        }
        excused
    }

    /// The number of pixels at which a borderline answer was found.
    pub fn count(&self) -> usize {
        let borderline = self.known.iter().filter(|(_, is)| **is);
        let pixels: HashSet<usize> = borderline.map(|((pixel, ..), _)| *pixel).collect();
        pixels.len()
    }

    /// Whether one hits something and the other nothing, or something at another place.
    fn differ(&self, a_mm: f32, b_mm: f32) -> bool {
        let apart_mm = f64::from((a_mm - b_mm).abs());
        a_mm.is_finite() != b_mm.is_finite()
            || apart_mm > self.closeness.limit_voxels() * self.voxel_mm
    }

    fn is_borderline(&self, (pixel, depth_bits, kind): PixelAnswer) -> bool {
        let depth_mm = f64::from(f32::from_bits(depth_bits));
        let ray = pixel_ray(self.scene, pixel);
        let reference = self.checker.reference(ray);
        let kinds: &[Kind] = match kind {
            Some(kind) if kind == Kind::Nothing as u32 => &[Kind::Nothing],
            Some(kind) if kind == Kind::Surface as u32 => &[Kind::Surface],
            Some(_) => &[Kind::Cap],
            // A depth does not say whether it is a cap's.
            None if depth_mm.is_finite() => &[Kind::Surface, Kind::Cap],
            None => &[Kind::Nothing],
        };
        let resolution_mm = self.closeness.resolution_voxels() * self.voxel_mm;
        kinds.iter().any(|&kind| {
            let answer = Answer { kind, depth_mm };
            let verdict = self.checker.verdict(ray, reference, answer, resolution_mm);
            verdict == HitVerdict::Borderline
        })
    }
}

/// Gives pixels of local maxima that differ from the reference's by more than `close` (physical) the
/// reference's value where the reference itself gives theirs for a ray no farther away than
/// [`HitChecker::NEAR_VOXELS`].
///
/// Whether a ray dips between two maxima, no finite precision decides.
///
/// # Errors
/// As [`Tracer::new`].
pub fn excuse_dips(
    volume: &Volume,
    scene: &Scene,
    reference: &[f32],
    values: &mut [f32],
    close: f64,
) -> Result<()> {
    const EIGHTH_TURN: f64 = 0.785;
    let near_mm = HitChecker::NEAR_VOXELS * volume.geometry().smallest_spacing_mm();
    let tracer = Tracer::new(volume, scene)?;
    for (pixel, (value, &reference)) in values.iter_mut().zip(reference).enumerate() {
        if f64::from((*value - reference).abs()) <= close {
            continue;
        }
        let ray = pixel_ray(scene, pixel);
        let side = ray.dir_world.any_orthonormal_vector();
        let is_excused = (0..8).any(|k| {
            let turn = DQuat::from_axis_angle(ray.dir_world, f64::from(k) * EIGHTH_TURN);
            let mut beside = ray;
            beside.origin_world += (turn * side) * near_mm;
            let moved = tracer.cast(beside).value as f32;
            // The frame's value rather than the reference's own.
            let off = (moved - *value).abs();
            off < 0.25 * (reference - *value).abs() || f64::from(off) <= 100.0 * close
        });
        if is_excused {
            *value = reference;
        }
    }
    Ok(())
}

/// The ray through a pixel's centre.
fn pixel_ray(scene: &Scene, pixel: usize) -> Ray {
    let width = scene.size.width() as usize;
    let [x, y] = [pixel % width, pixel / width].map(|at| at as f64 + 0.5);
    scene.camera.ray(scene.size, x, y)
}
