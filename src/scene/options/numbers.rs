//! Numbers with a domain: valid once constructed.

use super::plain::plain;
use crate::extent::Range;

/// Newtypes of `f64`, each with one fallible constructor.
macro_rules! numbers {
    ($($(#[$meta:meta])* $name:ident: $what:literal, $domain:literal, $valid:expr;)*) => {$(
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $name(f64);

        impl $name {
            /// # Errors
            /// A number outside the domain, NaN included.
            pub fn new(value: f64) -> crate::error::Result<Self> {
                let valid: fn(f64) -> bool = $valid;
                if !valid(value) {
                    return Err(crate::error::Error::usage(format!(
                        concat!($what, " of {} is out of its domain: it must be ", $domain),
                        $crate::scene::options::concise(value)
                    )));
                }
                Ok(Self(value))
            }

            pub fn get(self) -> f64 {
                self.0
            }
        }

        impl std::str::FromStr for $name {
            type Err = crate::error::Error;

            fn from_str(text: &str) -> crate::error::Result<Self> {
                Self::new(number(text)?)
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(f, "{}", self.0)
            }
        }

        plain!($name);
    )*};
}

/// A number as a reader wants it: seven significant digits, very large and very small ones with an
/// exponent.
pub(crate) fn concise(value: f64) -> String {
    in_digits(value, 7)
}

/// As [`concise`], with as many digits as tell values of `range` apart that is far from zero.
pub(crate) fn concise_within(value: f64, range: Range) -> String {
    let magnitude = range.min.abs().max(range.max.abs());
    let lost = match range.width() {
        0.0 => 0.0,
        width => (magnitude / width).log10().clamp(0.0, 11.0),
    };
    in_digits(value, (6 + lost as usize).max(7))
}

fn in_digits(value: f64, digits: usize) -> String {
    let rounded: f64 = format!("{value:.*e}", digits - 1).parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".to_owned(),
        1e-4..1e10 => rounded.to_string(),
        _ => format!("{rounded:e}"),
    }
}

/// How many of something: a whole number from 1 on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Count<T = u32>(T);

impl<T: Copy> Count<T> {
    pub fn get(self) -> T {
        self.0
    }
}

impl<T: TryFrom<u64>> std::str::FromStr for Count<T> {
    type Err = crate::error::Error;

    fn from_str(text: &str) -> crate::error::Result<Self> {
        let number = whole(text, 1)?;
        let count = T::try_from(number).ok();
        count.map(Self).ok_or_else(|| too_large(text))
    }
}

super::plain::readable!(Count<u32>, Count<u64>);

/// A whole number from `least` on.
pub(crate) fn whole(text: &str, least: u64) -> crate::error::Result<u64> {
    use std::num::IntErrorKind::PosOverflow;
    match text.trim().parse::<u64>() {
        Ok(number) if number >= least => Ok(number),
        Err(error) if *error.kind() == PosOverflow => Err(too_large(text)),
        _ => Err(crate::error::Error::usage(format!(
            "'{text}' is not a whole number from {least} on"
        ))),
    }
}

fn too_large(text: &str) -> crate::error::Error {
    crate::error::Error::usage(format!("'{text}' is too large a number"))
}

/// A finite number.
pub(super) fn number(text: &str) -> crate::error::Result<f64> {
    let value: Option<f64> = text.trim().parse().ok();
    value
        .filter(|v| v.is_finite())
        .ok_or_else(|| crate::error::Error::usage(format!("'{text}' is not a number")))
}

numbers! {
    /// Vertical field of view, degrees.
    FovDeg: "a field of view", "from 1e-6 to less than 180 degrees",
        |v| (1e-6..180.0).contains(&v);
    /// Height of an orthographic image, mm.
    HeightMm: "an image height", "from 1e-12 to 1e12 mm",
        |v| (1e-12..=1e12).contains(&v);
    /// An angle by which the camera turns, degrees.
    AngleDeg: "an angle", "within -3600 to 3600 degrees", |v| v.abs() <= 3600.0;
    /// Magnification of the picture.
    Zoom: "a zoom", "from 0.001 to 1000", |v| (0.001..=1000.0).contains(&v);
    /// Distance of samples along a ray, in voxels of the smallest spacing.
    StepVoxels: "a step", "from 0.001 to 100 voxels",
        |v| crate::scene::Sampling::STEP_VOXELS.contains(&v);
    /// A share of light reflected: ambient, diffuse, specular.
    Reflectance: "a reflectance", "from 0 to 10", |v| (0.0..=10.0).contains(&v);
    /// Exponent of the specular term.
    Shininess: "a shininess", "from 1 to 1000", |v| (1.0..=1000.0).contains(&v);
    /// Opacity at which a ray ends.
    Termination: "a termination", "above 0 and at most 1", |v| v > 0.0 && v <= 1.0;
    /// Error or share of the value range within which a node is homogeneous.
    HomogeneityLimit: "a homogeneity", "above 0 and at most 1", |v| v > 0.0 && v <= 1.0;
    /// Added to the display picture.
    Brightness: "a brightness", "from -1 to 1", |v| (-1.0..=1.0).contains(&v);
    /// Slope about the display picture's middle grey.
    Contrast: "a contrast", "from 0 to 100", |v| (0.0..=100.0).contains(&v);
    /// Exponent's inverse of the display picture.
    Gamma: "a gamma", "from 0.1 to 10", |v| (0.1..=10.0).contains(&v);
    /// Standard deviation of the Gaussian that smooths the volume, mm; 0 leaves it alone.
    SigmaMm: "a sigma", "from 0 to 1000 mm", |v| (0.0..=1000.0).contains(&v);
    /// Standard deviation of the Gaussian before gradients are precomputed, in voxels of the
    /// smallest spacing; 0 for none.
    SigmaVoxels: "a gradient's sigma", "from 0 to 100 voxels",
        |v| crate::scene::Precomputed::SIGMAS_VOXELS.contains(&v);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        for (value, text) in [
            (7.000000000000001, "7"),
            (563.2000029087067, "563.2"),
            (-32768.0, "-32768"),
            (16777.216, "16777.22"),
            (-0.0, "0"),
            (0.00573585, "0.00573585"),
            (1e200, "1e200"),
            (-3.25e-12, "-3.25e-12"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(concise(value), text);
        }
        // The control: what is printed otherwise.
        assert_ne!(concise(1e200), 1e200.to_string());
    }

    #[test]
    fn what_is_no_count_is_refused_in_words() {
        assert_eq!("12".parse::<Count>().unwrap().get(), 12);
        assert_eq!(
            "5000000000".parse::<Count<u64>>().unwrap().get(),
            5_000_000_000
        );
        for wrong in ["1.5", "-3", "0", "", "many"] {
            let said = wrong.parse::<Count>().unwrap_err().to_string();
            assert_eq!(said, format!("'{wrong}' is not a whole number from 1 on"));
        }
        for large in ["5000000000", "99999999999999999999"] {
            let said = large.parse::<Count>().unwrap_err().to_string();
            assert_eq!(said, format!("'{large}' is too large a number"));
        }
        assert_eq!(whole("0", 0).unwrap(), 0);
    }

    #[test]
    fn a_refusal_names_an_absurd_number_in_short() {
        let said = FovDeg::new(1e300).unwrap_err().to_string();
        assert!(
            said.starts_with("a field of view of 1e300 is out"),
            "{said}"
        );
        let said = Zoom::new(-1.5).unwrap_err().to_string();
        assert!(said.starts_with("a zoom of -1.5 is out"), "{said}");
    }
}
