//! Quantities with a domain: numbers that are valid once they are constructed.

/// Declares newtypes of `f64`, each with one fallible constructor and one text form; `= value` gives one its
/// default.
macro_rules! quantities {
    ($($(#[$meta:meta])* $name:ident $(= $default:literal)?: $what:literal, $domain:literal, $valid:expr;)*) => {$(
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $name(f64);

        impl $name {
            /// Constructs the quantity from a number of its domain.
            ///
            /// # Errors
            /// Usage: a number outside the domain, NaN included.
            pub fn new(value: f64) -> crate::error::Result<Self> {
                let valid: fn(f64) -> bool = $valid;
                if !valid(value) {
                    return Err(crate::error::Error::usage(format!(
                        concat!($what, " of {} is out of its domain: it must be ", $domain),
                        $crate::number_text::concise(value)
                    )));
                }
                Ok(Self(value))
            }

            /// Returns the number.
            pub const fn get(self) -> f64 {
                self.0
            }
        }

        $(impl Default for $name {
            fn default() -> Self {
                Self($default)
            }
        })?

        impl std::str::FromStr for $name {
            type Err = crate::error::Error;

            fn from_str(text: &str) -> crate::error::Result<Self> {
                Self::new($crate::number_text::number(text)?)
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(f, "{}", self.0)
            }
        }
    )*};
}
pub(crate) use quantities;

quantities! {
    /// Vertical field of view, degrees.
    FovDeg = 30.0: "a field of view", "from 1e-6 to less than 180 degrees",
        |v| (1e-6..180.0).contains(&v);
    /// Height of an orthographic image, mm.
    HeightMm: "an image height", "from 1e-12 to 1e12 mm",
        |v| (1e-12..=1e12).contains(&v);
    /// Distance of samples along a ray, in voxels of the smallest spacing: finer steps only cost, coarser
    /// ones miss everything.
    StepVoxels = 0.5: "a step", "from 0.001 to 100 voxels", |v| (0.001..=100.0).contains(&v);
    /// Share of light that a surface reflects: ambient, diffuse, specular.
    Reflectance: "a reflectance", "from 0 to 10", |v| (0.0..=10.0).contains(&v);
    /// Factor of a light's colour, in linear light.
    Intensity: "an intensity", "from 0 to 1000", |v| (0.0..=1000.0).contains(&v);
    /// Magnitude of Φ's gradient, values per mm, from which a medium is shaded fully; 0: everywhere.
    ShadedFrom = 0.0: "a gradient to shade from", "from 0 to 1e30 values per mm",
        |v| (0.0..=1e30).contains(&v);
    /// Exponent of the specular term.
    Shininess = 32.0: "a shininess", "from 1 to 1000", |v| (1.0..=1000.0).contains(&v);
    /// Opacity at which a ray ends: the colour lost is at most 1 minus this times the brightest colour.
    Termination = 0.999: "a termination", "above 0 and at most 1", |v| v > 0.0 && v <= 1.0;
    /// Error of a pixel, or share of the value range, within which a node is homogeneous.
    HomogeneityLimit: "a homogeneity", "above 0 and at most 1", |v| v > 0.0 && v <= 1.0;
    /// How much a pixel that is not cast may differ from what its ray would show: voxels of depth of a surface, a
    /// share of the volume's range of values of a projection, a channel's linear light of a medium.
    ScreenError: "a screen error", "from 0 to 10", |v| (0.0..=10.0).contains(&v);
    /// How far something may act, mm.
    DistanceMm: "a distance", "above 0 and at most 1e12 mm", |v| v > 0.0 && v <= 1e12;
    /// The angle that a light fills, degrees; 0: it casts hard shadows.
    LightSizeDeg = 0.0: "a light's size", "from 0 to 90 degrees", |v| (0.0..=90.0).contains(&v);
    /// The distance of samples toward a light, in sample steps of the eye's rays.
    ShadowStep: "a shadow step", "from 0.1 to 100 sample steps", |v| (0.1..=100.0).contains(&v);
    /// How much of the light from everywhere may be left undecided to either side: what is less takes squares that are no longer
    /// parted.
    OcclusionError: "a bound of occlusion", "from 0.001 to 0.5", |v| (0.001..=0.5).contains(&v);
    /// Exponent of the mask that confines a colour to the rim of things.
    RimPower: "an exponent", "from 0.1 to 100", |v| (0.1..=100.0).contains(&v);
    /// A share of a whole.
    Share = 1.0: "a share", "from 0 to 1", |v| (0.0..=1.0).contains(&v);
    /// Number added to the encoded channels of a display picture.
    Brightness = 0.0: "a brightness", "from -1 to 1", |v| (-1.0..=1.0).contains(&v);
    /// Slope about a display picture's middle grey.
    Contrast = 1.0: "a contrast", "from 0 to 100", |v| (0.0..=100.0).contains(&v);
    /// Reciprocal of the exponent of a display picture's channels.
    Gamma = 1.0: "a gamma", "from 0.1 to 10", |v| (0.1..=10.0).contains(&v);
}

/// How many rays estimate something.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RayCount(u32);

impl RayCount {
    /// The most of them.
    pub const MAX: u32 = 1024;

    /// Constructs a number of rays that is known.
    pub(crate) const fn of(rays: u32) -> Self {
        Self(rays)
    }

    /// Constructs a number of rays.
    ///
    /// # Errors
    /// Usage: a number outside 1 to [`Self::MAX`].
    pub fn new(rays: u32) -> crate::error::Result<Self> {
        rays.to_string().parse()
    }

    /// Returns the number.
    pub const fn get(self) -> u32 {
        self.0
    }
}

impl std::str::FromStr for RayCount {
    type Err = crate::error::Error;

    fn from_str(text: &str) -> crate::error::Result<Self> {
        let rays = text.trim().parse().ok();
        let rays = rays.filter(|rays| (1..=Self::MAX).contains(rays));
        rays.map(Self).ok_or_else(|| {
            crate::error::Error::usage(format!(
                "'{text}' is not a number of rays: write a whole number from 1 to {}",
                Self::MAX
            ))
        })
    }
}

impl std::fmt::Display for RayCount {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

impl Reflectance {
    /// Light reflected from everywhere, where none is given.
    pub const AMBIENT: Self = Self(0.1);
    /// Light reflected in all directions, where none is given.
    pub const DIFFUSE: Self = Self(0.9);
    /// Light mirrored, where none is given.
    pub const SPECULAR: Self = Self(0.2);
    /// Light from everywhere, and light reflected in all directions, where none is given and the former is occluded.
    pub const OCCLUDED: Self = Self(0.5);
}

impl Share {
    /// Nothing of it.
    pub const NONE: Self = Self(0.0);
}

impl Intensity {
    /// The intensity of a light where none is given.
    pub const ONE: Self = Self(1.0);
}

impl Termination {
    /// The termination that ends no ray before the volume does.
    pub const NEVER: Self = Self(1.0);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_names_an_absurd_number_in_short() {
        let refused = FovDeg::new(1e300).unwrap_err().to_string();
        assert!(
            refused.starts_with("a field of view of 1e300 is out"),
            "{refused}"
        );
        let refused = Contrast::new(-1.5).unwrap_err().to_string();
        assert!(
            refused.starts_with("a contrast of -1.5 is out"),
            "{refused}"
        );
    }

    #[test]
    fn defaults_are_in_their_domains() {
        assert!(FovDeg::new(FovDeg::default().get()).is_ok());
        assert!(StepVoxels::new(StepVoxels::default().get()).is_ok());
        assert!(Shininess::new(Shininess::default().get()).is_ok());
        assert!(Termination::new(Termination::default().get()).is_ok());
        assert!(Termination::new(Termination::NEVER.get()).is_ok());
        assert!(Brightness::new(Brightness::default().get()).is_ok());
        assert!(Contrast::new(Contrast::default().get()).is_ok());
        assert!(Gamma::new(Gamma::default().get()).is_ok());
        assert!(Intensity::new(Intensity::ONE.get()).is_ok());
        assert!(ShadedFrom::new(ShadedFrom::default().get()).is_ok());
        for reflectance in [
            Reflectance::AMBIENT,
            Reflectance::DIFFUSE,
            Reflectance::SPECULAR,
            Reflectance::OCCLUDED,
        ] {
            assert!(Reflectance::new(reflectance.get()).is_ok());
        }
    }
}
