//! The errors of pictures in random pixels: the reference would take minutes for all of them.

use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::extent::ImageSize;
use crate::frame::Frame;
use crate::lab::bench::rng::Rng;
use crate::lab::bench::{Bench, Dataset, Preset};
use crate::lab::measure::{RankingMetric, error_scale, evaluate_pixels, evaluated_planes};
use crate::reference;
use crate::scene::{Mode, Scene};

/// The seed of the pixels.
const SEED: u64 = 5;

/// The error of a picture; `None` where it has no such plane.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PictureError {
    /// The error by the mode's first metric of [`RankingMetric::of_mode`].
    pub first: Option<f64>,
    pub color_rmse: Option<f64>,
    pub color_max: Option<f64>,
}

/// The reference's picture in some pixels.
pub struct SparseReference<'a> {
    dataset: &'a Dataset,
    pixels: Vec<u32>,
    reference: Frame,
}

/// The number of pixels that are checked.
pub fn checked_pixels(preset: Preset) -> usize {
    match preset {
        Preset::Quick => 1024,
        Preset::Usual => 4096,
        Preset::Full => 16_384,
    }
}

/// Pixels of a picture, which is cut into so many parts of equal size, one of each at random; the same
/// for equal sizes.
fn drawn(size: ImageSize, preset: Preset) -> Vec<u32> {
    let mut rng = Rng::new(SEED);
    let parts = checked_pixels(preset).min(size.pixels());
    let bound = |part: usize| (part * size.pixels() / parts) as u32;
    let one = |part| bound(part) + rng.below(bound(part + 1) - bound(part));
    (0..parts).map(one).collect()
}

impl<'a> SparseReference<'a> {
    /// The reference's picture of a scene in random pixels.
    ///
    /// # Errors
    /// As [`reference::render_pixels`].
    pub fn of(bench: &Bench, dataset: &'a Dataset, scene: &Scene) -> Result<Self> {
        let pixels = drawn(scene.size, bench.preset);
        let wanted = evaluated_planes(scene);
        let volume = &dataset.volume;
        let reference = reference::render_pixels(volume, scene, wanted, &pixels, bench.progress)?;
        Ok(Self {
            dataset,
            pixels,
            reference,
        })
    }

    /// The error of a picture in these pixels.
    ///
    /// # Errors
    /// An entry that cannot be compared.
    pub fn error(&self, mode: Mode, frame: &Frame) -> Result<PictureError> {
        let scale = error_scale(&self.dataset.volume);
        let figures = evaluate_pixels(&self.reference, frame, &self.pixels, scale)?;
        let first = &RankingMetric::of_mode(mode)[0];
        Ok(PictureError {
            first: first.unscaled(&figures),
            color_rmse: figures.color.map(|color| color.rmse),
            color_max: figures.color.map(|color| color.max),
        })
    }
}
