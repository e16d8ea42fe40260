//! What is seen, and the ways in which its pixels get their colours.

use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::lab::bench::Dataset;
use crate::scene::{Mode, Refill, Scene, ScreenError, Sparse, SparseGrid};

/// A picture that is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    /// The shaded surface.
    Surface,
    /// The maximum along each ray.
    Maximum,
}

impl Shown {
    pub const ALL: [Self; 2] = [Self::Surface, Self::Maximum];

    pub fn mode(self) -> Mode {
        match self {
            Self::Surface => Mode::Iso,
            Self::Maximum => Mode::Mip,
        }
    }

    pub fn name(self) -> &'static str {
        self.mode().name()
    }

    pub fn scene(self, dataset: &Dataset, side_px: u32) -> Result<Scene> {
        let iso = dataset.iso;
        match self {
            Self::Surface => dataset.scene(side_px, &format!("mode = 'iso'\niso = {iso:?}\n")),
            Self::Maximum => dataset.maximum(side_px),
        }
    }
}

/// A way in which pixels get their colours, or rays their hits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Way {
    /// A ray in every pixel.
    Whole,
    /// Rays in some pixels.
    Sparse(Sparse),
    /// Rays in the pixels that cannot be filled within an error.
    Within(Sparse),
    /// A ray for every pixel, given one by one.
    OneByOne,
    /// The same rays, each from the depth that coarse rays around it found, those being so many pixels apart
    /// (Belyaev et al. 2018).
    FromNeighbours(u32),
}

/// How a way is called in tables and plots.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Family {
    Whole,
    None,
    Gradient,
    Flood,
    Certified,
    Adaptive,
    OneByOne,
    FromNeighbours,
}

impl Family {
    pub fn name(self) -> &'static str {
        match self {
            Self::Whole => "every pixel",
            Self::None => "no refill",
            Self::Gradient => "gradient",
            Self::Flood => "flood",
            Self::Certified => "certified",
            Self::Adaptive => "adaptive",
            Self::OneByOne => "rays one by one",
            Self::FromNeighbours => "from neighbours' depth",
        }
    }
}

const SPACINGS: [u32; 3] = [2, 4, 8];

impl Way {
    /// All ways of a picture. The first is that with which the others are compared, and [`Way::OneByOne`] that with
    /// which [`Way::FromNeighbours`] are.
    ///
    /// # Errors
    /// A refill that the mode does not have, which tests rule out.
    pub fn all(shown: Shown) -> Result<Vec<Self>> {
        let mut ways = vec![Self::Whole];
        for &refill in refills(shown) {
            for spacing in SPACINGS {
                let grid = SparseGrid::new(spacing, None)?;
                ways.push(Self::Sparse(Sparse::new(
                    Some(grid),
                    Some(refill),
                    None,
                    shown.mode(),
                )?));
            }
        }
        for &error in screen_errors(shown) {
            let error = Some(ScreenError::new(error)?);
            ways.push(Self::Within(Sparse::new(None, None, error, shown.mode())?));
        }
        if shown == Shown::Surface {
            ways.push(Self::OneByOne);
            ways.extend(SPACINGS.map(Self::FromNeighbours));
        }
        Ok(ways)
    }

    pub fn family(self) -> Family {
        match self {
            Self::Whole => Family::Whole,
            Self::Sparse(sparse) => match sparse.refill {
                Refill::None => Family::None,
                Refill::Gradient => Family::Gradient,
                Refill::Flood => Family::Flood,
                Refill::Certified => Family::Certified,
            },
            Self::Within(_) => Family::Adaptive,
            Self::OneByOne => Family::OneByOne,
            Self::FromNeighbours(_) => Family::FromNeighbours,
        }
    }

    /// Pixels from one ray of the grid to the next, where there is one.
    pub fn spacing(self) -> Option<u32> {
        match self {
            Self::Sparse(sparse) => Some(sparse.spacing),
            Self::FromNeighbours(spacing) => Some(spacing),
            Self::Whole | Self::Within(_) | Self::OneByOne => None,
        }
    }

    /// The error within which pixels are filled, where it is what differs.
    pub fn screen_error(self) -> Option<f64> {
        match self {
            Self::Within(sparse) => Some(sparse.screen_error.get()),
            _ => None,
        }
    }

    /// Whether rays are given one by one, and are not a picture's.
    pub fn is_one_by_one(self) -> bool {
        matches!(self, Self::OneByOne | Self::FromNeighbours(_))
    }
}

fn refills(shown: Shown) -> &'static [Refill] {
    match shown {
        Shown::Surface => &[Refill::Gradient, Refill::Flood, Refill::Certified],
        Shown::Maximum => &[Refill::Gradient, Refill::Flood],
    }
}

/// The errors of adaptive casting (`--screen-error`): voxels of depth, or shares of the range of values.
fn screen_errors(shown: Shown) -> &'static [f64] {
    match shown {
        Shown::Surface => &[0.2, 1.0],
        Shown::Maximum => &[0.01, 0.05],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_picture_has_its_refills_at_every_spacing() {
        let count = |shown, family| {
            let ways = Way::all(shown).unwrap();
            ways.iter().filter(|way| way.family() == family).count()
        };
        for shown in Shown::ALL {
            assert_eq!(Way::all(shown).unwrap()[0], Way::Whole);
            assert_eq!(count(shown, Family::Gradient), SPACINGS.len());
        }
        assert_eq!(count(Shown::Surface, Family::Certified), SPACINGS.len());
        assert_eq!(
            count(Shown::Surface, Family::FromNeighbours),
            SPACINGS.len()
        );
        assert_eq!(count(Shown::Maximum, Family::Certified), 0);
        assert_eq!(count(Shown::Maximum, Family::Adaptive), 2);
    }
}
