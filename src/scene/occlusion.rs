//! Ambient occlusion: how much of the light from everywhere reaches a point of a surface.

use std::fmt;
use std::str::FromStr;

use super::keyed_text::KeyedText;
use super::quantities::{DistanceMm, OcclusionError, RayCount, Share};
use crate::error::{Error, Result};

/// Ambient occlusion of a surface (`--ao`).
///
/// The accessibility of a point p with the geometric normal n is A(p) = (1/π) ∫ V(p,ω) (n·ω) dω over the hemisphere
/// about n: V = 0 where the ray p + tω, 0 < t ≤ `distance`, meets the surface, else 1. The light from everywhere is
/// multiplied by 1 − strength · (1 − A). n is the exact gradient of Φ in the hit's cell, turned to the side from which the
/// surface is seen; of a cap it is the face's. Zhukov, Iones and Kronin 1998 (obscurances), with V alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AmbientOcclusion {
    /// How a device finds the accessibility.
    pub by: OcclusionBy,
    /// How far from a point the surface may lie that occludes it.
    pub distance: DistanceMm,
    /// The share of the occlusion that is shown.
    pub strength: Share,
}

/// How a device finds how accessible points are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OcclusionBy {
    /// An estimate by so many rays from each point.
    Rays(RayCount),
    /// Bounds from both sides that hold the accessibility between them: the middle between them is no farther from it than this
    /// where the volume is fine enough to decide that.
    Bound(OcclusionError),
}

impl Default for OcclusionBy {
    fn default() -> Self {
        Self::Rays(RayCount::of(64))
    }
}

impl AmbientOcclusion {
    const FORM: &'static str = "rays=N,distance=MM,strength=S or bound=E,distance=MM,strength=S, of which only distance is needed";
}

impl FromStr for AmbientOcclusion {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let mut keys = KeyedText::read(text, "ambient occlusion", Self::FORM)?;
        let rays = keys.take("rays")?.map(OcclusionBy::Rays);
        let bound = keys.take("bound")?.map(OcclusionBy::Bound);
        if rays.is_some() && bound.is_some() {
            return Err(Error::usage(format!(
                "ambient occlusion '{text}': 'rays' and 'bound' are two ways to find the same; give one of them"
            )));
        }
        let strength: Option<Share> = keys.take("strength")?;
        let distance = keys.need("distance")?;
        keys.end()?;
        Ok(Self {
            by: rays.or(bound).unwrap_or_default(),
            distance,
            strength: strength.unwrap_or_default(),
        })
    }
}

impl fmt::Display for AmbientOcclusion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            by,
            distance,
            strength,
        } = self;
        match by {
            OcclusionBy::Rays(rays) => write!(f, "rays={rays},")?,
            OcclusionBy::Bound(error) => write!(f, "bound={error},")?,
        }
        write!(f, "distance={distance},strength={strength}")
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
            "bound=0.05,distance=5,strength=1",
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
            (
                "distance=1,bound=0",
                "a bound of occlusion of 0 is out of its domain",
            ),
            (
                "distance=1,bound=0.1,rays=4",
                "'rays' and 'bound' are two ways to find the same; give one of them",
            ),
        ] {
            let refused = wrong.parse::<AmbientOcclusion>().unwrap_err().to_string();
            assert!(refused.contains(why), "{wrong}: {refused}");
        }
    }
}
