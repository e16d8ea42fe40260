//! How many rays a work-item follows side by side.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result};
use crate::gpu::{DeviceInfo, DeviceKind};

/// Rays that a work-item follows side by side, in the lanes of the processor's vectors: 1, 8 or 16.
/// Never changes a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Lanes(u32);

impl Lanes {
    /// A single ray.
    pub const ONE: Self = Self(1);
    /// Every number of rays, ascending.
    pub const ALL: [Self; 3] = [Self::ONE, Self(8), Self(16)];

    /// A number of rays side by side.
    ///
    /// # Errors
    /// Another number than those of [`Lanes::ALL`].
    pub fn new(lanes: u32) -> Result<Self> {
        let known = Self::ALL.into_iter().find(|known| known.0 == lanes);
        known.ok_or_else(|| {
            Error::usage(format!(
                "{lanes} rays side by side: a work item follows 1, 8 or 16"
            ))
        })
    }

    /// The number of lanes for a device: as many single-precision numbers as a CPU's vectors hold; one
    /// on anything else, whose own hardware puts work-items side by side.
    pub fn of(device: &DeviceInfo) -> Self {
        match (device.kind, device.vector_width) {
            (DeviceKind::Cpu, 16..) => Self(16),
            (DeviceKind::Cpu, 4..) => Self(8),
            _ => Self::ONE,
        }
    }

    /// How many rays they are.
    pub fn get(self) -> u32 {
        self.0
    }

    /// The pixels along x and y whose rays they are: as `TILE_WIDTH` and `TILE_HEIGHT` of
    /// `kernels/lib/math/lanes.clh`.
    pub fn tile(self) -> [usize; 2] {
        match self.0 {
            1 => [1, 1],
            lanes => [4, lanes as usize / 4],
        }
    }
}

impl FromStr for Lanes {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        text.parse().map_or_else(
            |_| {
                Err(Error::usage(format!(
                    "'{text}' is not a number of rays side by side: write 1, 8 or 16"
                )))
            },
            Self::new,
        )
    }
}

impl fmt::Display for Lanes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn read_as_they_are_written() {
        for lanes in Lanes::ALL {
            assert_eq!(lanes.to_string().parse::<Lanes>().unwrap(), lanes);
            let [x, y] = lanes.tile();
            assert_eq!(x * y, lanes.get() as usize);
        }
        for wrong in ["0", "2", "32", "-8", "many", ""] {
            assert!(wrong.parse::<Lanes>().is_err(), "{wrong}");
        }
    }
}
