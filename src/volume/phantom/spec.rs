//! The specification of a phantom.

use glam::DVec3;

use super::PhantomKind;
use crate::error::{Error, Result};
use crate::extent::{Dims, Range};
use crate::volume::VoxelType;

/// A phantom's kind, grid and shape. Every `Option` has a default that depends on the grid; the
/// *extent* in those defaults is the smallest `voxels · spacing` over the axes with more than one
/// voxel.
#[derive(Debug, Clone, PartialEq)]
pub struct PhantomSpec {
    /// What the volume contains.
    pub kind: PhantomKind,
    /// The number of voxels along each axis.
    pub dims: Dims,
    /// The distance of voxel centres along each axis, mm: each 1e-6 to 1e6.
    pub spacing_mm: DVec3,
    /// The type of the voxels.
    pub voxel_type: VoxelType,
    /// Decides the vessel tree and every noise.
    pub seed: u64,
    /// Sphere: its radius (default 0.35 · extent). Vessels: the root's radius (default extent / 40,
    /// but at least 2 voxels where extent / 8 allows).
    pub radius_mm: Option<f64>,
    /// Vessels: the radius of the finest tips (default half a voxel, of the smallest spacing).
    pub tip_radius_mm: Option<f64>,
    /// Slab: default 0.3 · the volume's length along its axis.
    pub thickness_mm: Option<f64>,
    /// Slab: the index axis it lies across, 0 to 2 (default 2, z).
    pub axis: Option<usize>,
    /// Gaussian: its standard deviation (default 0.15 · extent).
    pub sigma_mm: Option<f64>,
    /// Standard deviation of Gaussian noise added to every voxel, as a share of the value range
    /// (default 0). The voxel type's limits cut it off. Not for [`PhantomKind::Noise`].
    pub noise: f64,
}

/// Phantoms end here: 2^34 bytes.
const MAX_BYTES: u64 = 1 << 34;
/// Ten times the value range: beyond, the voxel type's limits are all that is left.
const MAX_NOISE: f64 = 10.0;
const MIN_SPACING_MM: f64 = 1e-6;
const MAX_SPACING_MM: f64 = 1e6;

impl PhantomSpec {
    /// Isotropic 1 mm, u8, seed 1, every shape at its default.
    pub fn new(kind: PhantomKind, dims: Dims) -> Self {
        Self {
            kind,
            dims,
            spacing_mm: DVec3::ONE,
            voxel_type: VoxelType::U8,
            seed: 1,
            radius_mm: None,
            tip_radius_mm: None,
            thickness_mm: None,
            axis: None,
            sigma_mm: None,
            noise: 0.0,
        }
    }

    /// The values that the field's 0 and 1 become in each voxel type: u8 0 to 200, u16 0 to 50,000, i16
    /// −1,000 to 3,000 (as in CT, so that negative values occur), f32 0 to 1. Whole numbers are rounded
    /// to the nearest.
    pub fn values(&self) -> Range {
        let (min, max) = match self.voxel_type {
            VoxelType::U8 => (0.0, 200.0),
            VoxelType::U16 => (0.0, 50_000.0),
            VoxelType::I16 => (-1_000.0, 3_000.0),
            VoxelType::F32 => (0.0, 1.0),
        };
        Range { min, max }
    }

    /// The smallest `voxels · spacing` over the axes with more than one voxel (over all, where
    /// there is none), mm.
    pub(super) fn extent_mm(&self) -> f64 {
        let lengths = self.lengths_mm().to_array();
        let n = self.dims.array();
        let long = (0..3).filter(|&axis| n[axis] > 1).map(|axis| lengths[axis]);
        let smallest = long.fold(f64::INFINITY, f64::min);
        if smallest.is_finite() {
            smallest
        } else {
            self.lengths_mm().min_element()
        }
    }

    /// `voxels · spacing` along each axis, mm.
    pub(super) fn lengths_mm(&self) -> DVec3 {
        DVec3::from_array(self.dims.array().map(f64::from)) * self.spacing_mm
    }

    /// Index of the volume's centre: the world's origin.
    pub(super) fn centre_index(&self) -> DVec3 {
        DVec3::from_array(self.dims.array().map(|n| f64::from(n - 1) / 2.0))
    }

    /// Checks the numbers that a user may give.
    ///
    /// # Errors
    /// Usage: a length that is not positive, an absurd spacing, a negative noise, an axis beyond 2,
    /// a shape parameter that the kind does not have, more voxels than a phantom may have.
    pub(super) fn check(&self) -> Result<()> {
        use PhantomKind::{Blob, Noise, Slab, Sphere, Vessels};
        let lengths: [(&str, Option<f64>, &[PhantomKind]); 4] = [
            ("radius", self.radius_mm, &[Sphere, Vessels]),
            ("tip radius", self.tip_radius_mm, &[Vessels]),
            ("thickness", self.thickness_mm, &[Slab]),
            ("sigma", self.sigma_mm, &[Blob]),
        ];
        for (name, value, kinds) in lengths {
            let Some(value) = value else { continue };
            if !kinds.contains(&self.kind) {
                return Err(Error::usage(format!("a {} has no {name}", self.kind)));
            }
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::usage(format!(
                    "a phantom's {name} of {value} mm is not positive"
                )));
            }
        }
        if let Some(axis) = self.axis {
            if self.kind != Slab {
                return Err(Error::usage(format!("a {} has no axis", self.kind)));
            }
            if axis > 2 {
                return Err(Error::usage(format!(
                    "there is no axis {axis}: x, y and z are 0, 1 and 2"
                )));
            }
        }
        if !(0.0..=MAX_NOISE).contains(&self.noise) {
            return Err(Error::usage(format!(
                "a noise of {:e} of the value range: it must be 0 to {MAX_NOISE}",
                self.noise
            )));
        }
        if self.noise > 0.0 && self.kind == Noise {
            return Err(Error::usage("the noise phantom takes no further noise"));
        }
        let spacing = self.spacing_mm;
        let usable = |mm: f64| (MIN_SPACING_MM..=MAX_SPACING_MM).contains(&mm);
        if !spacing.to_array().into_iter().all(usable) {
            return Err(Error::usage(format!(
                "a phantom's spacing of {spacing} mm: each must be {MIN_SPACING_MM:e} to {MAX_SPACING_MM:e} mm"
            )));
        }
        if self.dims.voxels() * self.voxel_type.bytes() as u64 > MAX_BYTES {
            return Err(Error::usage(format!(
                "a phantom of {} {} voxels is larger than 16 GiB",
                self.dims, self.voxel_type
            )));
        }
        Ok(())
    }
}
