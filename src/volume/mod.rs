//! Voxels and their geometry: what every reader produces and everything else consumes.
//!
//! Index space: voxel (i,j,k)'s centre is at (i,j,k), x fastest. World space: millimetres, LPS.

mod buffer;
mod content;
mod geometry;
mod histogram;
mod mapped;
mod percentiles;
mod phantom;
mod read;
mod robust;
mod shortened;
mod smooth;
mod subject;
mod tally;
mod write_nrrd;

pub use buffer::{Voxel, VoxelBuffer, VoxelType, Voxels};
pub use geometry::Geometry;
pub use histogram::{Histogram, suggested_iso};
pub use mapped::MappedFile;
pub use percentiles::percentiles;
pub use phantom::{
    MURRAY_EXPONENT, Phantom, PhantomKind, PhantomSpec, VesselSegment, VesselTree, phantom,
};
pub use read::{Accept, RawLayout, RawSize, RawType, ReadOptions, files_of, read, read_if};
pub use shortened::end_when_shortened;
pub use smooth::smooth;
pub use write_nrrd::{write_nrrd, write_nrrd_of};

use glam::DVec3;
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::extent::{Dims, Range};

/// `physical = slope · stored + intercept`, slope > 0: the file's own calibration, stored beside the
/// voxels so that they keep their type.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rescale {
    /// The factor, positive.
    pub slope: f64,
    /// The physical value of the stored 0.
    pub intercept: f64,
}

impl Rescale {
    /// The calibration that changes nothing.
    pub const IDENTITY: Self = Self {
        slope: 1.0,
        intercept: 0.0,
    };

    /// Converts a stored value to a physical one.
    pub fn physical(self, stored: f64) -> f64 {
        self.slope * stored + self.intercept
    }

    /// Converts a physical value to a stored one.
    pub fn stored(self, physical: f64) -> f64 {
        (physical - self.intercept) / self.slope
    }

    /// The physical value without the intercept, so that values far from zero keep their digits. A
    /// voxel's own value becomes exactly `slope · stored`.
    pub fn without_intercept(self, physical: f64) -> f64 {
        let stored = f64::from(self.stored(physical) as f32);
        if self.physical(stored) == physical {
            self.slope * stored
        } else {
            physical - self.intercept
        }
    }

    /// Combines this calibration with `inner`, which is applied first.
    #[must_use]
    pub fn after(self, inner: Self) -> Self {
        Self {
            slope: self.slope * inner.slope,
            intercept: self.physical(inner.intercept),
        }
    }
}

/// The treatment of NaN and ±Inf voxels (`--non-finite`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NonFinite {
    /// Count them and read them as the smallest finite value of the volume.
    #[default]
    Replace,
    /// An error is returned.
    Refuse,
}

/// A scalar volume: voxels in their own type, geometry, calibration.
#[derive(Debug)]
pub struct Volume {
    dims: Dims,
    voxels: Voxels,
    geometry: Geometry,
    rescale: Rescale,
    stored_range: Range,
    non_finite: u64,
    notes: Vec<String>,
}

impl Volume {
    /// Checks, scans and settles a volume. All its stored values are finite afterwards, its slope
    /// is positive, and float values lie where single precision can be multiplied safely.
    ///
    /// # Errors
    /// The voxel count differs from `dims`; no voxel is finite; a voxel is not finite and
    /// `non_finite` refuses it; `rescale` is not finite, or makes values beyond single precision.
    pub fn new(
        dims: Dims,
        voxels: Voxels,
        geometry: Geometry,
        rescale: Rescale,
        non_finite: NonFinite,
    ) -> Result<Self> {
        if voxels.len() as u64 != dims.voxels() {
            return Err(Error::input(format!(
                "{dims} voxels announced, {} given",
                voxels.len()
            )));
        }
        if !rescale.slope.is_finite() || !rescale.intercept.is_finite() || rescale.slope == 0.0 {
            return Err(Error::input(format!(
                "the calibration slope {}, intercept {} is unusable",
                rescale.slope, rescale.intercept
            )));
        }
        let mut volume = Self {
            dims,
            voxels,
            geometry,
            rescale,
            stored_range: Range { min: 0.0, max: 0.0 },
            non_finite: 0,
            notes: Vec::new(),
        };
        volume.settle_non_finite(non_finite)?;
        volume.settle_falling_slope()?;
        volume.settle_exponent()?;
        volume.settle_offset()?;
        let range = volume.range();
        let largest = range.min.abs().max(range.max.abs());
        if largest > f64::from(f32::MAX) {
            return Err(Error::input(format!(
                "the values reach {largest:e} after the calibration slope {}, intercept {}: pictures hold single precision, {:e} at most",
                rescale.slope,
                rescale.intercept,
                f32::MAX
            )));
        }
        Ok(volume)
    }

    /// Finds the range; replaces NaN and ±Inf.
    fn settle_non_finite(&mut self, policy: NonFinite) -> Result<()> {
        let (range, bad) = self.voxels.scan();
        let Some(range) = range else {
            return Err(Error::input("no voxel has a finite value"));
        };
        self.stored_range = range;
        self.non_finite = bad;
        if bad == 0 {
            return Ok(());
        }
        if policy == NonFinite::Refuse {
            return Err(Error::input(format!(
                "{bad} of {} voxels are NaN or infinite",
                self.dims.voxels()
            ))
            .hint("without '--non-finite refuse' they are read as the smallest finite value"));
        }
        // The smallest physical value: the largest stored one where the slope falls.
        let stand_in = if self.rescale.slope > 0.0 {
            range.min
        } else {
            range.max
        };
        self.voxels
            .map_f32(|v| if v.is_finite() { v } else { stand_in as f32 })?;
        self.notes.push(format!(
            "{bad} of {} voxels are NaN or infinite: read as {}, the smallest finite value",
            self.dims.voxels(),
            self.rescale.physical(stand_in)
        ));
        Ok(())
    }

    /// A negative slope would turn maxima into minima: such voxels are stored negated, which is exact
    /// in single precision, with the slope's magnitude.
    fn settle_falling_slope(&mut self) -> Result<()> {
        if self.rescale.slope > 0.0 {
            return Ok(());
        }
        self.voxels = self.voxels.each_with(|v| -v as f32)?.into();
        self.rescale.slope = -self.rescale.slope;
        self.stored_range = Range {
            min: -self.stored_range.max,
            max: -self.stored_range.min,
        };
        self.notes.push(
            "the calibration slope is negative: the voxels are stored negated, as f32".into(),
        );
        Ok(())
    }

    /// Floats of extreme magnitude are scaled by a power of two, so that products of two differences
    /// neither overflow nor vanish in single precision: exactly, as [`Self::exponent_off`] sees to.
    fn settle_exponent(&mut self) -> Result<()> {
        if !matches!(self.voxels, Voxels::F32(_)) {
            return Ok(());
        }
        let largest = self.stored_range.min.abs().max(self.stored_range.max.abs());
        if largest == 0.0 || (-40.0..40.0).contains(&largest.log2()) {
            return Ok(());
        }
        let shift = self.exponent_off(largest);
        let down = (-shift).exp2();
        self.voxels.map_f32(|v| (f64::from(v) * down) as f32)?;
        self.rescale.slope *= shift.exp2();
        // As the voxels are, which may be coarser.
        let scaled = |value: f64| f64::from((value * down) as f32);
        self.stored_range = Range {
            min: scaled(self.stored_range.min),
            max: scaled(self.stored_range.max),
        };
        Ok(())
    }

    /// The power of two by which the voxels, of `largest` magnitude, are divided: to about 1, but large
    /// ones only so far that the smallest beside them keeps its digits. Where no power does both,
    /// differences must not overflow, and the smallest are coarser.
    fn exponent_off(&self, largest: f64) -> f64 {
        /// A difference and its multiples below this have room.
        const MAX_EXPONENT: f64 = 120.0;
        let to_one = largest.log2().floor();
        let min = match &self.voxels {
            Voxels::F32(voxels) if to_one > 0.0 => voxels
                .par_iter()
                .map(|voxel| voxel.abs())
                .filter(|magnitude| *magnitude > 0.0)
                .reduce(|| f32::INFINITY, f32::min),
            _ => return to_one,
        };
        let exactly = (min / f32::MIN_POSITIVE).log2().floor();
        f64::from(exactly)
            .max(to_one - MAX_EXPONENT)
            .clamp(0.0, to_one)
    }

    /// Floats far from zero compared with their range are counted from their minimum (exact, after
    /// Sterbenz 1974), so that single precision spends its digits on their differences.
    fn settle_offset(&mut self) -> Result<()> {
        let Range { min, max } = self.stored_range;
        let near_each_other = min > 0.0 && max <= 2.0 * min || max < 0.0 && min >= 2.0 * max;
        if !matches!(self.voxels, Voxels::F32(_)) || !near_each_other || min == max {
            return Ok(());
        }
        self.voxels.map_f32(|v| (f64::from(v) - min) as f32)?;
        self.rescale.intercept += self.rescale.slope * min;
        self.stored_range = Range {
            min: 0.0,
            max: max - min,
        };
        Ok(())
    }

    /// Adds a sentence for the user, such as about digits lost on reading.
    #[must_use]
    pub fn with_note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }

    /// The number of voxels along each axis.
    pub fn dims(&self) -> Dims {
        self.dims
    }

    /// The stored voxels.
    pub fn voxels(&self) -> &Voxels {
        &self.voxels
    }

    /// The spacing, origin and direction.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// The calibration from stored to physical values.
    pub fn rescale(&self) -> Rescale {
        self.rescale
    }

    /// The range of the stored values.
    pub fn stored_range(&self) -> Range {
        self.stored_range
    }

    /// The range of the physical values.
    pub fn range(&self) -> Range {
        Range {
            min: self.rescale.physical(self.stored_range.min),
            max: self.rescale.physical(self.stored_range.max),
        }
    }

    /// How many voxels were NaN or infinite in the file.
    pub fn non_finite(&self) -> u64 {
        self.non_finite
    }

    /// One sentence each, for the user, about what reading changed or chose.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The smallest ball around the domain's eight corners' centre that holds them all: world
    /// centre and radius in mm.
    pub fn bounding_sphere(&self) -> (DVec3, f64) {
        let world_from_index = self.geometry.world_from_index();
        let [x, y, z] = self.dims.domain();
        let middle = DVec3::new(x.0 + x.1, y.0 + y.1, z.0 + z.1) * 0.5;
        let center = world_from_index.transform_point3(middle);
        let mut radius_mm: f64 = 0.0;
        for corner in 0..8 {
            let pick =
                |bit: u32, (lo, hi): (f64, f64)| if corner >> bit & 1 == 0 { lo } else { hi };
            let p_index = DVec3::new(pick(0, x), pick(1, y), pick(2, z));
            radius_mm = radius_mm.max(world_from_index.transform_point3(p_index).distance(center));
        }
        (center, radius_mm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_voxels(slope: f64) -> Result<Volume> {
        let dims = Dims::new([2, 1, 1]).unwrap();
        let rescale = Rescale {
            slope,
            intercept: 0.0,
        };
        Volume::new(
            dims,
            vec![0_u8, 255].into(),
            Geometry::default(),
            rescale,
            NonFinite::Replace,
        )
    }

    #[test]
    fn values_beyond_single_precision_are_refused() {
        assert!(two_voxels(1e36).is_ok());
        for slope in [1e37, -1e37, 1e307, f64::MAX, f64::INFINITY, f64::NAN, 0.0] {
            assert_eq!(
                two_voxels(slope).err().map(|e| e.exit_code()),
                Some(65),
                "{slope}"
            );
        }
    }

    #[test]
    fn floats_far_from_zero_are_counted_from_their_minimum() {
        for sign in [1.0_f32, -1.0] {
            let voxels = vec![
                sign * 1_000_000.0,
                sign * (1_000_000.0 + 0.0625),
                sign * 1_000_064.0,
            ];
            let volume = Volume::new(
                Dims::new([3, 1, 1]).unwrap(),
                voxels.clone().into(),
                Geometry::default(),
                Rescale::IDENTITY,
                NonFinite::Refuse,
            )
            .unwrap();
            assert_eq!(
                volume.stored_range(),
                Range {
                    min: 0.0,
                    max: 64.0
                }
            );
            for (i, &voxel) in voxels.iter().enumerate() {
                let stored = volume.voxels().stored(i);
                assert_eq!(volume.rescale().physical(stored), f64::from(voxel));
            }
        }
    }

    /// The values beside each other are as in the file, and the range is theirs.
    #[test]
    fn small_floats_beside_extreme_ones_keep_their_values() {
        let of = |voxels: Vec<f32>| {
            let dims = Dims::new([voxels.len() as u64, 1, 1]).unwrap();
            let (geometry, rescale) = (Geometry::default(), Rescale::IDENTITY);
            Volume::new(dims, voxels.into(), geometry, rescale, NonFinite::Refuse).unwrap()
        };
        let physical = |volume: &Volume| -> Vec<f64> {
            let each = 0..volume.voxels().len();
            each.map(|i| volume.rescale().physical(volume.voxels().stored(i)))
                .collect()
        };
        for voxels in [
            vec![1e30_f32, 1e-30],
            vec![1e30, -1e30, 0.0, 3e-20],
            vec![-3e38, 1e-35],
            vec![1e16, f32::from_bits(1)],
        ] {
            let volume = of(voxels.clone());
            let values: Vec<f64> = voxels.iter().copied().map(f64::from).collect();
            assert_eq!(physical(&volume), values);
            let min = values.iter().copied().fold(f64::INFINITY, f64::min);
            assert_eq!(volume.range().min, min);
            assert!(volume.stored_range().max < 121_f64.exp2());
        }
        // No power does both: the range is still that of the voxels as they are stored.
        let volume = of(vec![3e38, 1e-41]);
        let stored = physical(&volume);
        assert!(volume.stored_range().max < 121_f64.exp2());
        assert!(stored[1] != f64::from(1e-41_f32) && volume.range().min == stored[1]);
    }

    #[test]
    fn extreme_floats_are_scaled_and_keep_their_values() {
        for scale in [1e-30_f32, 1e30] {
            let voxels = vec![scale, 3.0 * scale];
            let volume = Volume::new(
                Dims::new([2, 1, 1]).unwrap(),
                voxels.clone().into(),
                Geometry::default(),
                Rescale::IDENTITY,
                NonFinite::Refuse,
            )
            .unwrap();
            assert!((1.0..4.0).contains(&volume.stored_range().max));
            for (i, &voxel) in voxels.iter().enumerate() {
                let stored = volume.voxels().stored(i);
                assert_eq!(volume.rescale().physical(stored), f64::from(voxel));
            }
        }
    }
}
