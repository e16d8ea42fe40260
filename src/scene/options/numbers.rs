//! Numbers with a domain: valid once constructed.

use super::plain::plain;

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
    let rounded: f64 = format!("{value:.6e}").parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".to_owned(),
        1e-4..1e10 => rounded.to_string(),
        _ => format!("{rounded:e}"),
    }
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
