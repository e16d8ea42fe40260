//! Ambient occlusion: how much of the light from everywhere reaches a point of a surface.

use std::fmt;
use std::str::FromStr;

use super::keyed_text::KeyedText;
use super::quantities::{DistanceMm, RayCount, Share};
use crate::error::{Error, Result};

/// Ambient occlusion of a surface (`--ao`).
///
/// The accessibility of a point p with the geometric normal n is A(p) = (1/π) ∫ V(p,ω) (n·ω) dω over the hemisphere
/// about n: V = 0 where the ray p + tω, 0 < t ≤ `distance`, meets the surface, else 1. The light from everywhere is
/// multiplied by 1 − strength · (1 − A). n is the exact gradient of Φ in the hit's cell, turned to the side from which the
/// surface is seen; of a cap it is the face's. Zhukov, Iones and Kronin 1998 (obscurances), with V alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AmbientOcclusion {
    /// The number of rays from each point by which a device estimates the accessibility.
    pub rays: RayCount,
    /// How far from a point the surface may lie that occludes it.
    pub distance: DistanceMm,
    /// The share of the occlusion that is shown.
    pub strength: Share,
}

impl AmbientOcclusion {
    /// The number of rays where none is given.
    pub const DEFAULT_RAYS: RayCount = RayCount::of(64);

    const FORM: &'static str =
        "rays=N,distance=MM,strength=S, of which rays and strength may be left out";
}

impl FromStr for AmbientOcclusion {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let mut keys = KeyedText::read(text, "ambient occlusion", Self::FORM)?;
        let rays: Option<RayCount> = keys.take("rays")?;
        let strength: Option<Share> = keys.take("strength")?;
        let distance = keys.need("distance")?;
        keys.end()?;
        Ok(Self {
            rays: rays.unwrap_or(Self::DEFAULT_RAYS),
            distance,
            strength: strength.unwrap_or_default(),
        })
    }
}

impl fmt::Display for AmbientOcclusion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            rays,
            distance,
            strength,
        } = self;
        write!(f, "rays={rays},distance={distance},strength={strength}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_and_nothing_else() {
        for text in [
            "rays=16,distance=5,strength=1",
            "rays=1,distance=0.25,strength=0.5",
        ] {
            assert_eq!(text.parse::<AmbientOcclusion>().unwrap().to_string(), text);
        }
        let short: AmbientOcclusion = "distance=3".parse().unwrap();
        assert_eq!(short.to_string(), "rays=64,distance=3,strength=1");
        for (wrong, why) in [
            (
                "rays=16",
                "ambient occlusion 'rays=16': 'distance' is missing; write rays=N,",
            ),
            ("", "'' is no key with a value"),
            ("distance", "'distance' is no key with a value"),
            ("distance=1,distance=2", "'distance' is given twice"),
            ("distance=1,size=2", "'size' is none of its keys"),
            ("distance=x", "'x' is not a number"),
            ("distance=0", "a distance of 0 is out of its domain"),
            ("distance=1,strength=2", "a share of 2 is out of its domain"),
            (
                "distance=1,rays=1.5",
                "'1.5' is not a number of rays: write a whole number from 1 to 1024",
            ),
            ("distance=1,rays=0", "'0' is not a number of rays"),
        ] {
            let refused = wrong.parse::<AmbientOcclusion>().unwrap_err().to_string();
            assert!(refused.contains(why), "{wrong}: {refused}");
        }
    }
}
