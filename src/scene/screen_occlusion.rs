//! Ambient occlusion estimated from what a picture shows.

use std::fmt;
use std::str::FromStr;

use super::keyed_text::KeyedText;
use super::occlusion::AmbientOcclusion;
use super::quantities::{DistanceMm, Share};
use crate::error::{Error, Result};

/// Ambient occlusion of a surface, estimated from the picture's own layers (`--ssao`): the accessibility within the radius,
/// as [`AmbientOcclusion`] defines it, of which a picture knows no more than the first part of the surface's inside that each
/// pixel's ray passes: from the hit to the next crossing.
///
/// It is found in sections, planes through the eye and the point (Jimenez et al. 2016), in each of which what the pixels beside
/// the point hide is gathered in sectors (Therrien, Levesque and Gilet 2023).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScreenOcclusion {
    /// How far from a point the surface may lie that occludes it.
    pub radius: DistanceMm,
    /// How many pixels are looked at for each.
    pub samples: SampleCount,
    /// The share of the occlusion that is shown.
    pub strength: Share,
    /// How thick what is seen is taken to be; `None`: as thick as it is.
    pub thickness: Option<DistanceMm>,
}

impl ScreenOcclusion {
    const FORM: &'static str =
        "radius=MM,samples=N,strength=S,thickness=MM, of which only radius is needed";
}

impl FromStr for ScreenOcclusion {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let mut keys = KeyedText::read(text, "screen-space ambient occlusion", Self::FORM)?;
        let samples: Option<SampleCount> = keys.take("samples")?;
        let strength: Option<Share> = keys.take("strength")?;
        let thickness = keys.take("thickness")?;
        let radius = keys.need("radius")?;
        keys.end()?;
        Ok(Self {
            radius,
            samples: samples.unwrap_or_default(),
            strength: strength.unwrap_or_default(),
            thickness,
        })
    }
}

impl fmt::Display for ScreenOcclusion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            radius,
            samples,
            strength,
            thickness,
        } = self;
        write!(f, "radius={radius},samples={samples},strength={strength}")?;
        match thickness {
            Some(mm) => write!(f, ",thickness={mm}"),
            None => Ok(()),
        }
    }
}

/// How many pixels are looked at for each: so many sections, with as many pixels on either side in each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SampleCount(u32);

impl SampleCount {
    /// The most of them.
    pub const MAX: u32 = 1024;

    /// The number of sections: the largest by which half of the samples can be divided, of those that leave a side of a section
    /// at least four times as many pixels as there are sections; 1 where there is none.
    pub fn sections(self) -> u32 {
        let a_side = self.0 / 2;
        let is_one =
            |sections: &u32| a_side.is_multiple_of(*sections) && 4 * sections * sections <= a_side;
        (1..=a_side).rev().find(is_one).unwrap_or(1)
    }

    /// The number of pixels on either side of a section.
    pub fn steps(self) -> u32 {
        self.0 / 2 / self.sections()
    }
}

impl Default for SampleCount {
    fn default() -> Self {
        Self(32)
    }
}

impl FromStr for SampleCount {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let samples: Option<u32> = text.trim().parse().ok();
        let is_one = |samples: &u32| (2..=Self::MAX).contains(samples) && samples.is_multiple_of(2);
        samples.filter(is_one).map(Self).ok_or_else(|| {
            Error::usage(format!(
                "'{text}' is not a number of samples: write an even number from 2 to {}",
                Self::MAX
            ))
        })
    }
}

impl fmt::Display for SampleCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// How a device finds how much of the light from everywhere a surface keeps from itself; what is found is the same
/// accessibility within a distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Occlusion {
    /// By what of the volume lies around the hits.
    Volume(AmbientOcclusion),
    /// By what the picture shows.
    Screen(ScreenOcclusion),
}

impl Occlusion {
    /// How far from a point the surface may lie that occludes it.
    pub fn distance(self) -> DistanceMm {
        match self {
            Self::Volume(asked) => asked.distance,
            Self::Screen(asked) => asked.radius,
        }
    }

    /// The share of the occlusion that is shown.
    pub fn strength(self) -> Share {
        match self {
            Self::Volume(asked) => asked.strength,
            Self::Screen(asked) => asked.strength,
        }
    }

    /// What is found in the volume, where it is.
    pub fn in_volume(self) -> Option<AmbientOcclusion> {
        match self {
            Self::Volume(asked) => Some(asked),
            Self::Screen(_) => None,
        }
    }

    /// The estimate from the picture, where it is made so.
    pub fn of_screen(self) -> Option<ScreenOcclusion> {
        match self {
            Self::Volume(_) => None,
            Self::Screen(asked) => Some(asked),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_and_nothing_else() {
        for text in [
            "radius=5,samples=32,strength=1",
            "radius=0.25,samples=2,strength=0.5,thickness=3",
        ] {
            assert_eq!(text.parse::<ScreenOcclusion>().unwrap().to_string(), text);
        }
        let short: ScreenOcclusion = "radius=3".parse().unwrap();
        assert_eq!(short.to_string(), "radius=3,samples=32,strength=1");
        for (wrong, why) in [
            ("samples=16", "'radius' is missing; write radius=MM,"),
            ("radius=1,rays=2", "'rays' is none of its keys"),
            ("radius=0", "a distance of 0 is out of its domain"),
            (
                "radius=1,thickness=-1",
                "a distance of -1 is out of its domain",
            ),
            ("radius=1,strength=2", "a share of 2 is out of its domain"),
            (
                "radius=1,samples=15",
                "'15' is not a number of samples: write an even number from 2 to 1024",
            ),
            ("radius=1,samples=0", "'0' is not a number of samples"),
            ("radius=1,samples=1026", "'1026' is not a number of samples"),
        ] {
            let refused = wrong.parse::<ScreenOcclusion>().unwrap_err().to_string();
            assert!(refused.contains(why), "{wrong}: {refused}");
        }
    }

    #[test]
    fn samples_are_sections_of_equal_sides() {
        for (samples, sections, steps) in
            [(2, 1, 1), (8, 1, 4), (32, 2, 8), (34, 1, 17), (128, 4, 16)]
        {
            let count: SampleCount = samples.to_string().parse().unwrap();
            assert_eq!((count.sections(), count.steps()), (sections, steps));
        }
        for samples in (2..=SampleCount::MAX).step_by(2) {
            let count = SampleCount(samples);
            assert_eq!(2 * count.sections() * count.steps(), samples);
        }
    }
}
