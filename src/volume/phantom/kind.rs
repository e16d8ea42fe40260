//! The test volumes by name.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result};

/// A test volume whose field is known in closed form.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PhantomKind {
    /// A ball, whose mid-value isosurface is a sphere.
    Sphere,
    /// A plate across one axis.
    Slab,
    /// Values that rise linearly along x.
    Ramp,
    /// A Gaussian bump.
    Blob,
    /// The test signal of Marschner and Lobb (1994).
    MarschnerLobb,
    /// A single bright voxel.
    Voxel,
    /// White noise.
    Noise,
    /// A vessel tree that branches by Murray's law.
    Vessels,
}

impl PhantomKind {
    /// All kinds.
    pub const ALL: [Self; 8] = [
        Self::Sphere,
        Self::Slab,
        Self::Ramp,
        Self::Blob,
        Self::MarschnerLobb,
        Self::Voxel,
        Self::Noise,
        Self::Vessels,
    ];

    /// The kind's name, as users write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sphere => "sphere",
            Self::Slab => "slab",
            Self::Ramp => "ramp",
            Self::Blob => "gaussian",
            Self::MarschnerLobb => "marschner-lobb",
            Self::Voxel => "voxel",
            Self::Noise => "noise",
            Self::Vessels => "vessels",
        }
    }

    /// One sentence for the user.
    pub fn description(self) -> &'static str {
        match self {
            Self::Sphere => "A ball whose mid-value isosurface is a sphere of known radius.",
            Self::Slab => "A plate across one axis, of known thickness.",
            Self::Ramp => "Values rising linearly along x.",
            Self::Blob => "A Gaussian bump of known width.",
            Self::MarschnerLobb => {
                "The test signal of Marschner and Lobb (1994), hard on reconstruction filters."
            }
            Self::Voxel => "A single bright voxel in the middle of nothing.",
            Self::Noise => "White noise: every voxel independent and uniform.",
            Self::Vessels => {
                "A seeded vessel tree branching by Murray's law, its centrelines and radii known."
            }
        }
    }

    /// The customary edge length in voxels: the published 41 for Marschner–Lobb, else 128.
    pub fn default_size(self) -> u32 {
        match self {
            Self::MarschnerLobb => 41,
            _ => 128,
        }
    }
}

impl fmt::Display for PhantomKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for PhantomKind {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        Self::ALL
            .into_iter()
            .find(|kind| kind.name().eq_ignore_ascii_case(text.trim()))
            .ok_or_else(|| {
                Error::usage(format!("there is no phantom '{text}'")).hint(format!(
                    "the phantoms are {}",
                    Self::ALL.map(Self::name).join(", ")
                ))
            })
    }
}
