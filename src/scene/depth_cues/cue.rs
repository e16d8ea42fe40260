//! What a depth cue may be, and how it is written.

use std::fmt;
use std::str::FromStr;

use super::super::enum_names::enum_names;
use super::super::keyed_text::KeyedText;
use super::super::quantities::{RimPower, Share};
use crate::error::{Error, Result};
use crate::extent::ImageSize;

/// A depth cue, as one is asked for (`--cue`): its kind, how strong it is, and what else that kind has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DepthCue {
    /// What is far away fades into the background.
    Fog(Share),
    /// Near is red and far is blue.
    Chromadepth(Chromadepth),
    /// What is far away is dark around what is near.
    Halo(Edge),
    /// What is in front of something is outlined.
    Contour(Edge),
}

/// Pseudo-chromadepth: colours by depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chromadepth {
    /// The share of the colour that is the depth's.
    pub strength: Share,
    /// The colours from near to far.
    pub ramp: Ramp,
    /// How many depths are told apart; `None`: all.
    pub steps: Option<StepCount>,
    /// The exponent of the mask that confines it to the rim of things; `None`: it is all over them.
    pub rim: Option<RimPower>,
}

/// What is drawn where depths differ between neighbouring pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// The share of the light that it takes where it is darkest.
    pub strength: Share,
    /// How wide it is; `None`: as suits the picture's height.
    pub width: Option<WidthPx>,
}

/// The colours of depths, from near to far, linear light in between.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Ramp {
    /// Red, yellow, green, cyan, blue (Steenblik 1987).
    #[default]
    Full,
    /// Red, white, blue, which ordinary screens tell apart better (Schemali and Eisemann 2014).
    RedWhiteBlue,
}

enum_names!(Ramp, "a ramp of colours": Full = "full", RedWhiteBlue = "red-white-blue");

impl Ramp {
    /// The colour of a share of the way from near to far, linear light: between its colours, which follow in equal steps, all
    /// channels are linear.
    pub fn color(self, share: f64) -> [f64; 3] {
        let unit = |x: f64| x.clamp(0.0, 1.0);
        match self {
            Self::Full => {
                let x = 4.0 * share;
                [unit(2.0 - x), unit(x.min(4.0 - x)), unit(x - 2.0)]
            }
            Self::RedWhiteBlue => {
                let x = 2.0 * share;
                [unit(2.0 - x), unit(x.min(2.0 - x)), unit(x)]
            }
        }
    }
}

/// Declares counts with a domain.
macro_rules! counts {
    ($($(#[$meta:meta])* $name:ident: $what:literal, $from:literal, $to:literal;)*) => {$(
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub struct $name(u32);

        impl $name {
            /// Returns the number.
            pub const fn get(self) -> u32 {
                self.0
            }
        }

        impl FromStr for $name {
            type Err = Error;

            fn from_str(text: &str) -> Result<Self> {
                let count: Option<u32> = text.trim().parse().ok();
                let is_one = |count: &u32| ($from..=$to).contains(count);
                count.filter(is_one).map(Self).ok_or_else(|| {
                    Error::usage(format!(
                        concat!("'{}' is not ", $what, ": write a whole number from {} to {}"),
                        text, $from, $to
                    ))
                })
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.fmt(f)
            }
        }
    )*};
}

counts! {
    /// How many depths are told apart.
    StepCount: "a number of steps", 2, 64;
    /// How wide what is drawn at edges is, pixels.
    WidthPx: "a width in pixels", 1, 64;
}

impl WidthPx {
    /// As wide as suits a picture's height: one pixel for so many rows.
    pub(super) fn of_rows(size: ImageSize, rows: u32) -> Self {
        Self((size.height() / rows).clamp(1, 64))
    }
}

impl DepthCue {
    const FORM: &'static str = "fog:S, chromadepth:S, halo:S or contour:S, S from 0 to 1, and behind it, such as chromadepth:1,steps=8, \
         of chromadepth ramp=full|red-white-blue, steps=N and rim=P, of halo and contour width=PX";

    /// The name of its kind.
    pub(super) fn kind(self) -> &'static str {
        match self {
            Self::Fog(_) => "fog",
            Self::Chromadepth(_) => "chromadepth",
            Self::Halo(_) => "halo",
            Self::Contour(_) => "contour",
        }
    }
}

impl FromStr for DepthCue {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let refused = |why: &str| {
            let form = Self::FORM;
            Error::usage(format!("'{text}' is not a depth cue: {why}; write {form}"))
        };
        let (first, keys) = match text.split_once(',') {
            Some((first, keys)) => (first, Some(keys)),
            None => (text, None),
        };
        let (kind, strength) = match first.split_once(':') {
            Some((kind, strength)) => (kind.trim(), strength.parse()?),
            None => (first.trim(), Share::default()),
        };
        let mut keys = keys
            .map(|keys| KeyedText::read(keys, "what follows a depth cue", Self::FORM))
            .transpose()?;
        /// The value of a key, where there are keys and it is among them.
        fn take<T: FromStr<Err = Error>>(
            keys: &mut Option<KeyedText>,
            key: &str,
        ) -> Result<Option<T>> {
            match keys {
                Some(keys) => keys.take(key),
                None => Ok(None),
            }
        }
        let mut edge = || -> Result<Edge> {
            let width = take(&mut keys, "width")?;
            Ok(Edge { strength, width })
        };
        let cue = match kind.to_ascii_lowercase().as_str() {
            "fog" => Self::Fog(strength),
            "halo" => Self::Halo(edge()?),
            "contour" => Self::Contour(edge()?),
            "chromadepth" => Self::Chromadepth(Chromadepth {
                strength,
                ramp: take(&mut keys, "ramp")?.unwrap_or_default(),
                steps: take(&mut keys, "steps")?,
                rim: take(&mut keys, "rim")?,
            }),
            _ => return Err(refused(&format!("there is none named '{kind}'"))),
        };
        keys.map_or(Ok(()), |keys| keys.end())?;
        Ok(cue)
    }
}

impl fmt::Display for DepthCue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = self.kind();
        match self {
            Self::Fog(strength) => write!(f, "{kind}:{strength}"),
            Self::Halo(edge) | Self::Contour(edge) => {
                write!(f, "{kind}:{}", edge.strength)?;
                edge.width.map_or(Ok(()), |px| write!(f, ",width={px}"))
            }
            Self::Chromadepth(Chromadepth {
                strength,
                ramp,
                steps,
                rim,
            }) => {
                write!(f, "{kind}:{strength},ramp={ramp}")?;
                steps.map_or(Ok(()), |steps| write!(f, ",steps={steps}"))?;
                rim.map_or(Ok(()), |power| write!(f, ",rim={power}"))
            }
        }
    }
}

impl Chromadepth {
    /// A share of the way from near to far as it is told apart.
    pub(super) fn stepped(self, share: f64) -> f64 {
        match self.steps {
            None => share,
            Some(steps) => {
                let count = f64::from(steps.get());
                ((share * count).min(count - 1.0).floor() + 0.5) / count
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_and_nothing_else() {
        for text in [
            "fog:0.5",
            "chromadepth:1,ramp=full",
            "chromadepth:0.8,ramp=red-white-blue,steps=8,rim=2",
            "halo:0.7,width=12",
            "contour:1",
        ] {
            assert_eq!(text.parse::<DepthCue>().unwrap().to_string(), text);
        }
        let short: DepthCue = "chromadepth".parse().unwrap();
        assert_eq!(short.to_string(), "chromadepth:1,ramp=full");
        for (wrong, why) in [
            ("mist:1", "there is none named 'mist'; write fog:S"),
            ("fog:2", "a share of 2 is out of its domain"),
            ("fog:1,width=3", "'width' is none of its keys"),
            ("halo:1,width=0", "'0' is not a width in pixels"),
            ("chromadepth:1,steps=1", "'1' is not a number of steps"),
            ("chromadepth:1,ramp=jet", "'jet' is not a ramp of colours"),
            (
                "chromadepth:1,rim=0",
                "an exponent of 0 is out of its domain",
            ),
        ] {
            let refused = wrong.parse::<DepthCue>().unwrap_err().to_string();
            assert!(refused.contains(why), "{wrong}: {refused}");
        }
    }

    #[test]
    fn ramps_pass_their_colours_in_equal_steps() {
        let full = [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| Ramp::Full.color(share));
        assert_eq!(
            full,
            [
                [1.0, 0.0, 0.0],
                [1.0, 1.0, 0.0],
                [0.0, 1.0, 0.0],
                [0.0, 1.0, 1.0],
                [0.0, 0.0, 1.0]
            ]
        );
        let three = [0.0, 0.5, 1.0].map(|share| Ramp::RedWhiteBlue.color(share));
        assert_eq!(three, [[1.0, 0.0, 0.0], [1.0; 3], [0.0, 0.0, 1.0]]);
        assert_eq!(Ramp::RedWhiteBlue.color(0.25), [1.0, 0.5, 0.5]);
    }
}
