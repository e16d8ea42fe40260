//! Sizes and ranges: of a volume in voxels, of an image in pixels, of values.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// The number of voxels along x, y, z: each at least 1, their product representable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(into = "[u32; 3]")]
pub struct Dims([u32; 3]);

impl Dims {
    /// The longest axis: beyond, single precision would place a sample worse than 1/256 voxel.
    pub const MAX_AXIS: u64 = 1 << 16;
    /// The largest volume, in voxels.
    pub const MAX_VOXELS: u64 = 1 << 40;

    /// Makes dimensions of the numbers of voxels along x, y, z.
    ///
    /// # Errors
    /// Input: an axis is empty or longer than [`Dims::MAX_AXIS`], or the product exceeds
    /// [`Dims::MAX_VOXELS`].
    pub fn new(dims: [u64; 3]) -> Result<Self> {
        let [nx, ny, nz] = dims;
        if dims.contains(&0) {
            return Err(Error::input(format!(
                "the volume is {nx}x{ny}x{nz} voxels: every axis needs at least one"
            )));
        }
        if dims.iter().any(|&n| n > Self::MAX_AXIS)
            || u128::from(nx) * u128::from(ny) * u128::from(nz) > u128::from(Self::MAX_VOXELS)
        {
            return Err(Error::input(format!(
                "the volume is {nx}x{ny}x{nz} voxels: more than {} along an axis or 2^40 in all",
                Self::MAX_AXIS
            )));
        }
        Ok(Self(dims.map(|n| n as u32)))
    }

    /// The sizes along x, y and z.
    pub fn array(self) -> [u32; 3] {
        self.0
    }

    /// The sizes as indices of arrays.
    pub fn usize(self) -> [usize; 3] {
        self.0.map(|n| n as usize)
    }

    /// The number of voxels.
    pub fn voxels(self) -> u64 {
        self.0.iter().map(|&n| u64::from(n)).product()
    }

    /// Cells (cubes between 8 voxel centres) along each axis; an axis with one voxel has one cell,
    /// constant along it.
    pub fn cells(self) -> [u32; 3] {
        self.0.map(|n| (n - 1).max(1))
    }

    /// The field's domain along each axis in index space: `[0, n-1]`, or `[-0.5, 0.5]` where n = 1.
    pub fn domain(self) -> [(f64, f64); 3] {
        self.0.map(|n| {
            if n == 1 {
                (-0.5, 0.5)
            } else {
                (0.0, f64::from(n - 1))
            }
        })
    }
}

impl From<Dims> for [u32; 3] {
    fn from(dims: Dims) -> Self {
        dims.0
    }
}

impl fmt::Display for Dims {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [nx, ny, nz] = self.0;
        write!(f, "{nx}x{ny}x{nz}")
    }
}

/// Width and height of a picture in pixels: each 1 to 65,535. Written `WxH`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ImageSize {
    width: u32,
    height: u32,
}

impl ImageSize {
    /// The most pixels along a side.
    pub const MAX_SIDE_PX: u32 = 65_535;
    /// The most pixels: all layers of a picture then take a few GiB.
    pub const MAX_PIXELS: u64 = 1 << 26;

    /// The size of a picture where none is given.
    pub const DEFAULT: Self = Self {
        width: 512,
        height: 512,
    };

    /// Makes the size of a picture, in pixels.
    ///
    /// # Errors
    /// A side outside 1 to [`Self::MAX_SIDE_PX`], or more than [`Self::MAX_PIXELS`] in all (usage).
    pub fn new(width: u32, height: u32) -> Result<Self> {
        let side = 1..=Self::MAX_SIDE_PX;
        if !side.contains(&width)
            || !side.contains(&height)
            || u64::from(width) * u64::from(height) > Self::MAX_PIXELS
        {
            return Err(Error::usage(format!(
                "a picture of {width}x{height} pixels: each side must be 1 to {}, and at most 2^26 pixels in all",
                Self::MAX_SIDE_PX
            )));
        }
        Ok(Self { width, height })
    }

    /// So many pixels side by side.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn row(pixels: usize) -> Result<Self> {
        Self::new(u32::try_from(pixels).unwrap_or(u32::MAX), 1)
    }

    /// The width in pixels.
    pub fn width(self) -> u32 {
        self.width
    }

    /// The height in pixels.
    pub fn height(self) -> u32 {
        self.height
    }

    /// The number of pixels.
    pub fn pixels(self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Width / height.
    pub fn aspect(self) -> f64 {
        f64::from(self.width) / f64::from(self.height)
    }
}

impl FromStr for ImageSize {
    type Err = Error;

    /// `WxH`, or `N` for a square.
    fn from_str(text: &str) -> Result<Self> {
        let side = |s: &str| {
            s.trim().parse::<u32>().map_err(|_| {
                Error::usage(format!(
                    "'{text}' is not a picture size: write WIDTHxHEIGHT, such as 512x512"
                ))
            })
        };
        match text.split_once(['x', 'X']) {
            Some((w, h)) => Self::new(side(w)?, side(h)?),
            None => Self::new(side(text)?, side(text)?),
        }
    }
}

impl fmt::Display for ImageSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

/// A closed range of finite values, `min <= max`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Range {
    /// The smallest value.
    pub min: f64,
    /// The largest value.
    pub max: f64,
}

impl Range {
    /// The difference of the largest and the smallest value.
    pub fn width(self) -> f64 {
        self.max - self.min
    }

    /// The value at a fraction of the range: `min` at 0, `max` at 1.
    pub fn at(self, fraction: f64) -> f64 {
        self.min + self.width() * fraction
    }

    /// Whether a value lies in the range, its ends included.
    pub fn contains(self, value: f64) -> bool {
        self.min <= value && value <= self.max
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dims_refuse_empty_and_absurd_volumes() {
        assert!(Dims::new([1, 1, 1]).is_ok());
        assert!(Dims::new([0, 4, 4]).is_err());
        assert!(Dims::new([u64::MAX, u64::MAX, u64::MAX]).is_err());
        assert!(Dims::new([1 << 16, 1 << 16, 1 << 8]).is_ok());
        assert!(Dims::new([1 << 16, 1 << 16, 1 << 9]).is_err());
        assert!(Dims::new([(1 << 16) + 1, 1, 1]).is_err());
    }

    #[test]
    fn a_single_voxel_axis_spans_half_a_voxel_each_way() {
        let dims = Dims::new([1, 5, 2]).unwrap();
        assert_eq!(dims.domain(), [(-0.5, 0.5), (0.0, 4.0), (0.0, 1.0)]);
        assert_eq!(dims.cells(), [1, 4, 1]);
    }

    #[test]
    fn image_sizes_parse_and_refuse() {
        assert_eq!("640x480".parse(), ImageSize::new(640, 480));
        assert_eq!("64".parse(), ImageSize::new(64, 64));
        for bad in [
            "",
            "0x4",
            "4x",
            "x",
            "-1x4",
            "70000x1",
            "16384x16384",
            "1e3x4",
        ] {
            assert!(bad.parse::<ImageSize>().is_err(), "{bad}");
        }
    }
}
