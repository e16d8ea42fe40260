//! Quantities that only options have: what a scene is made of has them worked in.

use super::text_form::{readable, text_form};
use crate::error::{Error, Result};
use crate::number_text::{too_large, whole};
use crate::scene::Precomputed;
use crate::scene::quantities::quantities;

quantities! {
    /// An angle by which the camera turns, degrees.
    AngleDeg = 0.0: "an angle", "within -3600 to 3600 degrees", |v| v.abs() <= 3600.0;
    /// Magnification of the picture.
    Zoom = 1.0: "a zoom", "from 0.001 to 1000", |v| (0.001..=1000.0).contains(&v);
    /// Standard deviation of the Gaussian that smooths the volume, mm; 0 leaves it alone.
    SigmaMm = 0.0: "a sigma", "from 0 to 1000 mm", |v| (0.0..=1000.0).contains(&v);
    /// Standard deviation of the Gaussian before gradients are precomputed, in voxels of the
    /// smallest spacing; 0 for none.
    SigmaVoxels = 0.0: "a gradient's sigma", "from 0 to 100 voxels",
        |v| Precomputed::SIGMAS_VOXELS.contains(&v);
}

text_form!(AngleDeg, Zoom, SigmaMm, SigmaVoxels, GradientScale);

/// How many of something: a whole number from 1 on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Count<T = u32>(T);

impl<T: Copy> Count<T> {
    /// Returns the number, which is at least 1.
    pub fn get(self) -> T {
        self.0
    }
}

impl<T: TryFrom<u64>> std::str::FromStr for Count<T> {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let number = whole(text, 1)?;
        let count = T::try_from(number).ok();
        count.map(Self).ok_or_else(|| too_large(text))
    }
}

readable!(Count<u32>, Count<u64>);

/// `--gradient-scale`: voxels between two precomputed gradients.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GradientScale(u32);

impl GradientScale {
    /// Returns the number of voxels.
    pub fn get(self) -> u32 {
        self.0
    }
}

impl Default for GradientScale {
    fn default() -> Self {
        Self(Precomputed::default().scale())
    }
}

impl std::str::FromStr for GradientScale {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let scale = text.trim().parse().ok();
        let scale = scale.filter(|n| Precomputed::SCALES.contains(n));
        scale.map(Self).ok_or_else(|| {
            Error::usage(format!(
                "'{text}' is not a gradient scale: write a whole number from {} to {}",
                Precomputed::SCALES.start(),
                Precomputed::SCALES.end()
            ))
        })
    }
}

impl std::fmt::Display for GradientScale {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_count_is_refused_in_words() {
        assert_eq!("12".parse::<Count>().unwrap().get(), 12);
        assert_eq!(
            "5000000000".parse::<Count<u64>>().unwrap().get(),
            5_000_000_000
        );
        for wrong in ["1.5", "-3", "0", "", "many"] {
            let refused = wrong.parse::<Count>().unwrap_err().to_string();
            assert_eq!(
                refused,
                format!("'{wrong}' is not a whole number of at least 1")
            );
        }
        for large in ["5000000000", "99999999999999999999"] {
            let refused = large.parse::<Count>().unwrap_err().to_string();
            assert_eq!(refused, format!("'{large}' is too large a number"));
        }
        assert_eq!(whole("0", 0).unwrap(), 0);
    }

    #[test]
    fn defaults_are_in_their_domains() {
        assert!(AngleDeg::new(AngleDeg::default().get()).is_ok());
        assert!(Zoom::new(Zoom::default().get()).is_ok());
        assert!(SigmaMm::new(SigmaMm::default().get()).is_ok());
        assert!(SigmaVoxels::new(SigmaVoxels::default().get()).is_ok());
        assert!(Precomputed::SCALES.contains(&GradientScale::default().get()));
    }
}
