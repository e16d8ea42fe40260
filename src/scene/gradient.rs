//! How the field's gradient is found, of which normals are made.

use std::ops::RangeInclusive;

use crate::error::{Error, Result};

/// ∇Φ in index space by differences over whole voxels, their points clamped to the domain. Normals
/// are its image under the inverse transpose; where it vanishes, they face the eye.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Gradient {
    /// `(Φ(p + e) − Φ(p − e)) / 2` along each axis: error of second order.
    #[default]
    Central,
    /// `Φ(p + e) − Φ(p)`: half the reads, error of first order.
    Forward,
    /// `(8 (Φ(p + e) − Φ(p − e)) − (Φ(p + 2e) − Φ(p − 2e))) / 12`: error of fourth order.
    FourthOrder,
    /// Interpolated between directions that were computed before. A means of the device: the
    /// reference takes what it stands for, central differences.
    Precomputed(Precomputed),
}

/// Central differences of the smoothed volume at every `scale`-th voxel, stored as directions
/// (Fuller et al. 2009, §3.2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Precomputed {
    scale: u32,
    sigma_voxels: f64,
}

impl Precomputed {
    /// The possible distances of two directions, in voxels.
    pub const SCALES: RangeInclusive<u32> = 1..=8;
    /// The possible standard deviations of the Gaussian, in voxels of the smallest spacing.
    pub const SIGMAS_VOXELS: RangeInclusive<f64> = 0.0..=100.0;

    /// `sigma_voxels`: the standard deviation of the Gaussian before differencing, in voxels of the
    /// smallest spacing; 0 for none.
    ///
    /// # Errors
    /// A number outside its domain.
    pub fn new(scale: u32, sigma_voxels: f64) -> Result<Self> {
        if !Self::SCALES.contains(&scale) {
            return Err(Error::usage(format!(
                "a gradient scale of {scale}: it must be {} to {} voxels",
                Self::SCALES.start(),
                Self::SCALES.end()
            )));
        }
        if !Self::SIGMAS_VOXELS.contains(&sigma_voxels) {
            return Err(Error::usage(format!(
                "gradients smoothed by a sigma of {sigma_voxels} voxels: it must be {} to {}",
                Self::SIGMAS_VOXELS.start(),
                Self::SIGMAS_VOXELS.end()
            )));
        }
        Ok(Self {
            scale,
            sigma_voxels,
        })
    }

    /// Voxels between two directions.
    pub fn scale(self) -> u32 {
        self.scale
    }

    /// The standard deviation of the Gaussian before differencing, in voxels of the smallest spacing; 0
    /// for none.
    pub fn sigma_voxels(self) -> f64 {
        self.sigma_voxels
    }
}

impl Default for Precomputed {
    fn default() -> Self {
        Self {
            scale: 2,
            sigma_voxels: 0.0,
        }
    }
}
